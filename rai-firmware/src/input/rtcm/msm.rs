//! Multiple signal messages: the code ranges and the rates in them.
//!
//! ```text
//! P = c · (whole ms + rough/1024 ms + fine · 2⁻²⁴ or 2⁻²⁹ ms)
//! ```
//!
//! The message numbers are regular: 1070 + 10 · system + level, with system 0 GPS, 1 GLONASS, 2 Galileo, 3 SBAS,
//! 4 QZSS, 5 `BeiDou`, 6 `NavIC`. All begin alike; then each field stands for all satellites, or for all cells (a
//! satellite's signal), before the next field begins:
//!
//! | part | bits (levels 4, 5, 6, 7) | what |
//! |---|---|---|
//! | header | 12, 12, 30, 1, 18 | number, station, time, more messages of this instant follow, others |
//! | masks | 64, 32, satellites × signals | which satellites, which signals, which of both together |
//! | satellite | 8 | whole ms, 255 for none |
//! | | 0, 4, 0, 4 | extended information |
//! | | 10 | rough range, 1/1024 ms |
//! | | 0, 14, 0, 14 | rough rate, signed, m/s, the most negative for none |
//! | cell | 15, 15, 20, 20 | fine range, signed, the most negative for none |
//! | | 22, 22, 24, 24 and 4, 4, 10, 10 and 1 | phase, lock time, half cycle |
//! | | 6, 6, 10, 10 | C/N0, 1 dB-Hz or 1/16 dB-Hz, 0 for none |
//! | | 0, 15, 0, 15 | rate, signed, 0.1 mm/s, the most negative for none |
//!
//! A message without satellites is as good as any: a system that sees none still says when the instant is complete.
//!
//! Four of ten fields are of use here, so the message is read in place. A general decoder (`rtcm-rs`, which reads
//! the small messages) returns every field of 64 cells by value, which took 44 KiB of stack and 65 KiB of flash,
//! and it drops a whole message for one signal that it does not know.
//!
//! Reference: [RTCM-10403.3] 3.5.16, tables 3.5-73 to 3.5-101.
//!
//! [RTCM-10403.3]: crate#references

use rai_core::frame::SPEED_OF_LIGHT_M_S;
use rai_core::satellite::SatelliteId;

use super::signals;
use crate::counters::count;
use crate::input::calendar::Calendar;
use crate::input::system::System;
use crate::input::{Counters, Measured, Ranges, Unread};
use crate::raw::{Carrier, RawSignal};
use crate::time::{BEIDOU_OFFSET_MS, GLONASS_OFFSET_MS, WEEK_MS};

/// Metres of range per millisecond.
const M_PER_MS: f64 = SPEED_OF_LIGHT_M_S * 1e-3;

/// Metres a second of a step of a cell's rate; a satellite's rough rate has whole ones.
const FINE_RATE_M_S: f32 = 1e-4;

/// Where the masks begin, bits.
const SATELLITE_MASK: usize = 73;
const SIGNAL_MASK: usize = SATELLITE_MASK + 64;
const CELL_MASK: usize = SIGNAL_MASK + 32;

/// Most cells, hence most satellites, that one message may have.
const MOST_CELLS: usize = 64;

/// Reads a multiple signal message, and lays it out once; nothing of it has been used yet.
///
/// A message that contradicts itself is refused before it can move time.
pub(super) fn read<'a>(number: u16, payload: &'a [u8], calendar: &Calendar) -> Result<Ranges<'a>, Unread> {
    let (series, level) = match number {
        1071..=1137 => ((number - 1070) / 10, (number - 1070) % 10),
        _ => return Err(Unread::Other),
    };
    // Levels 1 to 3 carry no full range.
    let system = match (series, level) {
        (_, 0 | 8 | 9) => return Err(Unread::Other),
        (0, 4..) => Some(System::Gps),
        (1, 4..) => Some(System::Glonass),
        (2, 4..) => Some(System::Galileo),
        (4, 4..) => Some(System::Qzss),
        (5, 4..) => Some(System::Beidou),
        _ => None,
    };
    let field = |start, length| bits(payload, start, length).ok_or(Unread::Malformed);
    let (time_ms, more) = (field(24, 30)?, field(54, 1)?);
    let mut of_utc_ms = None;
    let (tow_ms, measured) = match system {
        Some(system) => {
            let layout = Layout::new(payload, level).ok_or(Unread::Malformed)?;
            let tow_ms = match (system, calendar.leap_second()) {
                (System::Glonass, leap) => {
                    let utc_ms = utc_week_ms(time_ms).ok_or(Unread::Time)?;
                    of_utc_ms = Some(utc_ms);
                    leap.map(|leap| (utc_ms + 1000 * u32::from(leap.seconds)) % WEEK_MS)
                }
                _ => Some(gps_tow_ms(system, time_ms).ok_or(Unread::Time)?),
            };
            (tow_ms, Measured::Msm(Msm { system, layout }))
        }
        None => (None, Measured::Nothing),
    };
    Ok(Ranges {
        series: Some(series as u8),
        tow_ms,
        of_utc_ms,
        stated: None,
        more_follow: more == 1,
        measured,
    })
}

/// Milliseconds into the week of GPS time; `None` when the field is beyond the week.
fn gps_tow_ms(system: System, time_ms: u32) -> Option<u32> {
    let offset_ms = match system {
        System::Beidou => BEIDOU_OFFSET_MS,
        _ => 0,
    };
    (time_ms < WEEK_MS).then_some((time_ms + offset_ms) % WEEK_MS)
}

/// Milliseconds into the week of UTC from the day and the time of day of GLONASS, which are three hours ahead; `None`
/// for an unknown day.
fn utc_week_ms(time: u32) -> Option<u32> {
    const DAY_MS: u32 = 86_400_000;
    /// The day has a leap second at its end where there is one.
    const LONGEST_DAY_MS: u32 = DAY_MS + 1000;
    const AHEAD_MS: u32 = GLONASS_OFFSET_MS as u32;
    let (day, of_day_ms) = (time >> 27, time & 0x7FF_FFFF);
    (day < 7 && of_day_ms < LONGEST_DAY_MS).then(|| (day * DAY_MS + of_day_ms + WEEK_MS - AHEAD_MS) % WEEK_MS)
}

/// A message whose masks are allowed and whose payload is long enough for them.
#[derive(Debug)]
pub(in crate::input) struct Msm<'a> {
    system: System,
    layout: Layout<'a>,
}

impl Msm<'_> {
    /// Whether it has no satellite.
    pub(in crate::input) fn is_empty(&self) -> bool {
        self.layout.satellites == 0
    }

    /// Hands every range to `add`, with whether its code is the one that the broadcast clock is of; what cannot be used
    /// is counted.
    pub(in crate::input) fn each(
        &self,
        counters: &mut Counters,
        add: &mut impl FnMut(SatelliteId, RawSignal, bool, &mut Counters),
    ) {
        let layout = &self.layout;
        let grid = layout.ones(SATELLITE_MASK, 64).enumerate();
        let grid =
            grid.flat_map(|satellite| layout.ones(SIGNAL_MASK, 32).map(move |signal| (satellite, signal)));
        let mut cell = 0;
        for (position, ((index, satellite), signal)) in grid.enumerate() {
            if bits(layout.payload, CELL_MASK + position, 1) != Some(1) {
                continue;
            }
            // The masks count from 1.
            match self.one((satellite + 1, signal + 1), index, cell) {
                Ok((satellite, range)) => {
                    add(satellite, range, signals::is_reference(self.system, signal + 1), counters);
                }
                Err(Unused::Satellite) => count(&mut counters.satellites_unknown),
                Err(Unused::Signal) => count(&mut counters.signals_other),
                Err(Unused::Range) => count(&mut counters.ranges_missing),
            }
            cell += 1;
        }
    }

    /// The range of a cell.
    fn one(
        &self,
        (satellite, signal): (u8, u8),
        row: usize,
        cell: usize,
    ) -> Result<(SatelliteId, RawSignal), Unused> {
        let satellite = self.system.satellite(satellite).ok_or(Unused::Satellite)?;
        let band = signals::band(self.system, signal).ok_or(Unused::Signal)?;
        let (rough, fine) = self.layout.rough_ms(row).zip(self.layout.fine_ms(cell)).ok_or(Unused::Range)?;
        let channel = if self.system == System::Glonass { self.layout.channel(row) } else { 0 };
        let carrier = Carrier { band, channel };
        let is_codeless = signals::is_codeless(self.system, signal);
        let cn0_dbhz = if is_codeless { 0.0 } else { self.layout.cn0_dbhz(cell) };
        let signal = RawSignal::new(carrier, (rough + fine) * M_PER_MS).with_cn0_dbhz(cn0_dbhz);
        // A range that grows comes with a frequency that falls.
        let doppler_hz = self.layout.rate_m_s(row, cell).map(|rate| -rate * doppler_of_a_metre(carrier));
        Ok((satellite, doppler_hz.map_or(signal, |doppler_hz| signal.with_doppler_hz(doppler_hz))))
    }
}

/// Hertz that a metre a second shifts a carrier by.
fn doppler_of_a_metre(carrier: Carrier) -> f32 {
    (carrier.frequency_hz() / SPEED_OF_LIGHT_M_S) as f32
}

/// Why a cell is no range.
enum Unused {
    Satellite,
    Signal,
    Range,
}

/// Widths of the fields that the levels differ in, bits.
#[derive(Debug)]
struct Widths {
    /// What levels 5 and 7 have besides: extended information and rough rate of a satellite, rate of a cell.
    extended: usize,
    satellite_rate: usize,
    cell_rate: usize,
    fine: usize,
    /// Phase, lock time and half cycle indicator.
    between: usize,
    cn0: usize,
    /// Milliseconds of a step of the fine range.
    fine_ms: f64,
    /// dB-Hz of a step of the carrier to noise density.
    cn0_dbhz: f32,
}

impl Widths {
    fn of(level: u16) -> Self {
        let (extended, satellite_rate, cell_rate) =
            if matches!(level, 5 | 7) { (4, 14, 15) } else { (0, 0, 0) };
        let (fine, between, cn0, fine_ms, cn0_dbhz) = if level >= 6 {
            (20, 24 + 10 + 1, 10, 1.0 / 536_870_912.0, 1.0 / 16.0)
        } else {
            (15, 22 + 4 + 1, 6, 1.0 / 16_777_216.0, 1.0)
        };
        Self { extended, satellite_rate, cell_rate, fine, between, cn0, fine_ms, cn0_dbhz }
    }
}

/// Where the fields of a message are.
#[derive(Debug)]
struct Layout<'a> {
    payload: &'a [u8],
    widths: Widths,
    satellites: usize,
    signals: usize,
    cells: usize,
}

impl<'a> Layout<'a> {
    fn new(payload: &'a [u8], level: u16) -> Option<Self> {
        let ones = |start, length| Some(bits(payload, start, length)?.count_ones() as usize);
        let satellites = ones(SATELLITE_MASK, 32)? + ones(SATELLITE_MASK + 32, 32)?;
        let signals = ones(SIGNAL_MASK, 32)?;
        let grid = satellites * signals;
        if grid > MOST_CELLS {
            return None;
        }
        let low = grid.min(32);
        let cells = ones(CELL_MASK, low)? + ones(CELL_MASK + low, grid - low)?;
        let layout = Self { payload, widths: Widths::of(level), satellites, signals, cells };
        if layout.end() <= payload.len() * 8 { Some(layout) } else { None }
    }

    fn rough_start(&self) -> usize {
        CELL_MASK + self.satellites * self.signals
    }

    fn cell_start(&self) -> usize {
        let satellite = 8 + self.widths.extended + 10 + self.widths.satellite_rate;
        self.rough_start() + self.satellites * satellite
    }

    fn end(&self) -> usize {
        let widths = &self.widths;
        self.cell_start() + self.cells * (widths.fine + widths.between + widths.cn0 + widths.cell_rate)
    }

    /// Rough range of the `index`th satellite, ms; `None` when the message does not say.
    fn rough_ms(&self, index: usize) -> Option<f64> {
        let whole = bits(self.payload, self.rough_start() + 8 * index, 8)?;
        let part_start = self.rough_start() + self.satellites * (8 + self.widths.extended);
        let part = bits(self.payload, part_start + 10 * index, 10)?;
        if whole == 255 { None } else { Some(f64::from(whole * 1024 + part) / 1024.0) }
    }

    /// Frequency channel of the `index`th satellite, of GLONASS; 0 when the message does not say.
    fn channel(&self, index: usize) -> i8 {
        let width = self.widths.extended;
        let start = self.rough_start() + 8 * self.satellites + width * index;
        match bits(self.payload, start, width) {
            Some(field @ 0..=13) if width > 0 => field as i8 - 7,
            _ => 0,
        }
    }

    /// Fine range of the `index`th cell, ms; `None` when the message does not say.
    fn fine_ms(&self, index: usize) -> Option<f64> {
        let width = self.widths.fine;
        let field = bits(self.payload, self.cell_start() + width * index, width)?;
        let half = 1 << (width - 1);
        if field == half {
            return None;
        }
        let signed = if field > half { f64::from(field) - f64::from(2 * half) } else { f64::from(field) };
        Some(signed * self.widths.fine_ms)
    }

    /// Carrier to noise density of the `index`th cell, dB-Hz; 0 when the message does not say.
    fn cn0_dbhz(&self, index: usize) -> f32 {
        let start = self.cell_start() + self.cells * (self.widths.fine + self.widths.between);
        let field = bits(self.payload, start + self.widths.cn0 * index, self.widths.cn0).unwrap_or(0);
        field as f32 * self.widths.cn0_dbhz
    }

    /// How fast the range of a cell grows, m/s; `None` where the level has no rates, or the message does not say.
    fn rate_m_s(&self, row: usize, cell: usize) -> Option<f32> {
        let widths = &self.widths;
        if widths.cell_rate == 0 {
            return None;
        }
        let rough_start = self.cell_start() - self.satellites * widths.satellite_rate;
        let rough = signed(self.payload, rough_start + widths.satellite_rate * row, widths.satellite_rate)?;
        let fine_start = self.end() - self.cells * widths.cell_rate;
        let fine = signed(self.payload, fine_start + widths.cell_rate * cell, widths.cell_rate)?;
        Some(rough as f32 + fine as f32 * FINE_RATE_M_S)
    }

    /// Positions of the ones in a mask, from 0.
    fn ones(&self, start: usize, length: usize) -> impl Iterator<Item = u8> {
        let is_one = move |&position: &u8| bits(self.payload, start + usize::from(position), 1) == Some(1);
        (0..length as u8).filter(is_one)
    }
}

/// Bits of a payload, most significant first, at most 32; `None` beyond its end.
fn bits(payload: &[u8], start: usize, length: usize) -> Option<u32> {
    let end = start + length;
    let bytes = payload.get(start / 8..end.div_ceil(8))?;
    let window = bytes.iter().fold(0_u64, |window, &byte| window << 8 | u64::from(byte));
    let behind = end.div_ceil(8) * 8 - end;
    Some(((window >> behind) & ((1 << length) - 1)) as u32)
}

/// A number with a sign; `None` for the most negative one, which says that there is none.
fn signed(payload: &[u8], start: usize, length: usize) -> Option<i32> {
    let field = bits(payload, start, length)?;
    let half = 1_u32 << (length - 1);
    if field == half {
        return None;
    }
    // The sign bit at the top, and back.
    Some((field << (32 - length)).cast_signed() >> (32 - length))
}
