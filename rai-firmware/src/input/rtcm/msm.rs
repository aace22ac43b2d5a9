//! Multiple signal messages: their code ranges and range rates.
//!
//! ```text
//! P = c · (whole ms + rough/1024 ms + fine · 2⁻²⁴ or 2⁻²⁹ ms)
//! ```
//!
//! The message numbers are regular: 1070 + 10 · system + level, with system 0 GPS, 1 GLONASS, 2
//! Galileo, 3 SBAS, 4 QZSS, 5 `BeiDou`, 6 `NavIC`. All begin with the same header and masks. Then
//! each field is listed for all satellites, or for all cells (a cell is one signal of one
//! satellite), before the next field begins:
//!
//! | part | bits (levels 4, 5, 6, 7) | field |
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
//! A message without satellites is valid, because a system without satellites in view still states
//! when the instant is complete.
//!
//! The module uses four of ten fields, so that it reads the message in place. A general decoder
//! (`rtcm-rs`) returned every field of 64 cells by value. That took 44 KiB of stack and 65 KiB of
//! flash, and one unknown signal dropped a whole message.
//!
//! Reference: [RTCM-10403.3] 3.5.16, tables 3.5-73 to 3.5-101.
//!
//! [RTCM-10403.3]: crate#references

use raim_core::frame::SPEED_OF_LIGHT_M_S;
use raim_core::satellite::SatelliteId;

use super::signals;
use crate::counters::count;
use crate::ephemeris::{mul_high, scaled};
use crate::input::bits::Bits;
use crate::input::calendar::Calendar;
use crate::input::protocol::Measurements;
use crate::input::system::System;
use crate::input::{Counters, Measured, Ranges, Unread};
use crate::raw::{Carrier, RawSignal};
use crate::time::{BEIDOU_OFFSET_MS, GLONASS_OFFSET_MS, WEEK_MS};

/// Metres of range in a step of levels 6 and 7, 2⁻²⁹ ms, in 2⁻⁷² m.
const STEP_2_72: i64 = (((SPEED_OF_LIGHT_M_S as i128) << 43) / 1000) as i64;

/// Returns the metres of a range in steps.
///
/// Here, multiplying integers costs a tenth of multiplying doubles.
fn range_m(steps: i64) -> f64 {
    scaled(mul_high(steps << 24, STEP_2_72), -32)
}

/// Step of a cell's rate, m/s; the step of a satellite's rough rate is 1 m/s.
const FINE_RATE_M_S: f32 = 1e-4;

/// First bits of the masks.
const SATELLITE_MASK: usize = 73;
const SIGNAL_MASK: usize = SATELLITE_MASK + 64;
const CELL_MASK: usize = SIGNAL_MASK + 32;

/// Largest number of cells, and hence of satellites, in one message.
const MOST_CELLS: usize = 64;

/// Reads header, masks and positions of a multiple signal message; its ranges are read later.
///
/// A message that contradicts itself is refused before it can affect the time.
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
    if payload.len() * 8 < SATELLITE_MASK {
        return Err(Unread::Malformed);
    }
    let (time_ms, more_follow) = (Bits(payload).unsigned(24, 30), Bits(payload).is_set(54));
    let mut of_utc_ms = None;
    let (tow_ms, measured) = match system {
        Some(system) => {
            let layout = Layout::new(payload, level).ok_or(Unread::Malformed)?;
            let tow_ms = match (system, calendar.leap_second()) {
                (System::Glonass, leap) => {
                    let utc_ms = utc_week_ms(time_ms, calendar)?;
                    of_utc_ms = Some(utc_ms);
                    leap.map(|leap| (utc_ms + 1000 * u32::from(leap.seconds)) % WEEK_MS)
                }
                _ => Some(gps_tow_ms(system, time_ms).ok_or(Unread::Time)?),
            };
            (tow_ms, Measured::Rtcm(Msm { system, layout }))
        }
        None => (None, Measured::Nothing),
    };
    let station = Bits(payload).unsigned(12, 12) as u16;
    Ok(Ranges {
        station,
        series: Some(series as u8),
        tow_ms,
        of_utc_ms,
        stated: None,
        more_follow,
        #[cfg(feature = "sbf")]
        clock_jumps_ms: None,
        measured,
    })
}

/// Returns the milliseconds into the week of GPS time, or `None` if the field is beyond the week.
fn gps_tow_ms(system: System, time_ms: u32) -> Option<u32> {
    let offset_ms = match system {
        System::Beidou => BEIDOU_OFFSET_MS,
        _ => 0,
    };
    (time_ms < WEEK_MS).then_some((time_ms + offset_ms) % WEEK_MS)
}

/// Returns the milliseconds into the week of UTC, from day and time of day in GLONASS time. GLONASS
/// time is three hours ahead of UTC.
///
/// Day 7 means that the day is unknown (DF416). The day that brings the time nearest to the present
/// is then taken.
fn utc_week_ms(time: u32, calendar: &Calendar) -> Result<u32, Unread> {
    const UNKNOWN_DAY: u32 = 7;
    const DAY_MS: u32 = 86_400_000;
    /// Longest day, because a leap second may be inserted at its end.
    const LONGEST_DAY_MS: u32 = DAY_MS + 1000;
    const AHEAD_MS: u32 = GLONASS_OFFSET_MS as u32;
    let (day, of_day_ms) = (time >> 27, time & 0x7FF_FFFF);
    if of_day_ms >= LONGEST_DAY_MS {
        return Err(Unread::Time);
    }
    let on_day = |day: u32| (day * DAY_MS + of_day_ms + WEEK_MS - AHEAD_MS) % WEEK_MS;
    if day != UNKNOWN_DAY {
        return Ok(on_day(day));
    }
    // Leap seconds are far less than the half day that would select a wrong day.
    let present_ms = calendar.present().ok_or(Unread::WithoutWeek)?.tow_ms;
    let since_midnight_ms = present_ms + AHEAD_MS + WEEK_MS + DAY_MS / 2 - of_day_ms;
    Ok(on_day(since_midnight_ms % WEEK_MS / DAY_MS))
}

/// A message whose masks are allowed and whose payload is long enough for them.
#[derive(Debug)]
pub(in crate::input) struct Msm<'a> {
    system: System,
    layout: Layout<'a>,
}

impl Measurements for Msm<'_> {
    fn is_empty(&self) -> bool {
        self.layout.satellites == Mask(0)
    }

    /// Counts unusable cells.
    fn each(
        &self,
        counters: &mut Counters,
        add: &mut impl FnMut(SatelliteId, RawSignal, bool, &mut Counters),
    ) {
        let (mut position, mut cell) = (0, 0);
        for (index, satellite) in self.layout.satellites.positions().enumerate() {
            let row = self.layout.row(index);
            for signal in self.layout.signals.positions() {
                let is_there = self.layout.cells.has(position);
                position += 1;
                if !is_there {
                    continue;
                }
                // The masks count from 1.
                match self.one((satellite + 1, signal + 1), &row, cell) {
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
    }
}

impl Msm<'_> {
    /// Returns the range of a cell.
    fn one(
        &self,
        (satellite, signal): (u8, u8),
        row: &Row,
        cell: usize,
    ) -> Result<(SatelliteId, RawSignal), Unused> {
        let satellite = self.system.satellite(satellite).ok_or(Unused::Satellite)?;
        let band = signals::band(self.system, signal).ok_or(Unused::Signal)?;
        let (rough, fine) = row.rough.zip(self.layout.fine(cell)).ok_or(Unused::Range)?;
        let channel = if self.system == System::Glonass { row.channel } else { 0 };
        let carrier = Carrier { band, channel };
        let range =
            RawSignal::new(carrier, range_m(rough + fine)).with_code(signals::code(self.system, signal));
        let signal = if signals::is_codeless(self.system, signal) {
            range.codeless()
        } else {
            range.with_cn0_dbhz(self.layout.cn0_dbhz(cell))
        };
        // If the range grows, the frequency falls.
        let doppler_hz = self.layout.rate_m_s(row, cell).map(|rate| -rate * carrier.doppler_of_a_metre_hz());
        Ok((satellite, doppler_hz.map_or(signal, |doppler_hz| signal.with_doppler_hz(doppler_hz))))
    }
}

/// Reason for which a cell has no range.
enum Unused {
    Satellite,
    Signal,
    Range,
}

/// Widths of the fields that differ by level, bits.
#[derive(Debug)]
struct Widths {
    /// Extended information of a satellite. Like the two rates below, only levels 5 and 7 have it.
    extended: usize,
    satellite_rate: usize,
    cell_rate: usize,
    fine: usize,
    /// Phase, lock time and half cycle indicator.
    between: usize,
    cn0: usize,
    /// Steps of level 7 in a step of the fine range, as a power of two.
    fine_power: u32,
    /// Step of the carrier to noise density, dB-Hz.
    cn0_dbhz: f32,
}

impl Widths {
    fn of(level: u16) -> Self {
        let (extended, satellite_rate, cell_rate) =
            if matches!(level, 5 | 7) { (4, 14, 15) } else { (0, 0, 0) };
        let (fine, between, cn0, fine_power, cn0_dbhz) =
            if level >= 6 { (20, 24 + 10 + 1, 10, 0, 1.0 / 16.0) } else { (15, 22 + 4 + 1, 6, 5, 1.0) };
        Self { extended, satellite_rate, cell_rate, fine, between, cn0, fine_power, cn0_dbhz }
    }
}

/// Positions of the fields of a message.
#[derive(Debug)]
struct Layout<'a> {
    payload: Bits<'a>,
    widths: Widths,
    satellites: Mask,
    signals: Mask,
    cells: Mask,
    /// First bits of the four fields of the satellites: whole milliseconds, extended information,
    /// fraction of a millisecond, rate.
    satellite_starts: [usize; 4],
    /// First bits of three fields of the cells: fine range, strength, rate.
    cell_starts: [usize; 3],
}

/// Fields of one satellite.
struct Row {
    /// Rough range, steps of 2⁻²⁹ ms; `None` if the message has none.
    rough: Option<i64>,
    /// Rough rate, m/s; `None` if the level or the message has none.
    rate_m_s: Option<i32>,
    /// Frequency channel of GLONASS; 0 if the message has none.
    channel: i8,
}

impl<'a> Layout<'a> {
    fn new(payload: &'a [u8], level: u16) -> Option<Self> {
        let is_within = |end: usize| (end <= payload.len() * 8).then_some(Bits(payload));
        let header = is_within(CELL_MASK)?;
        let satellites = Mask::of(header, SATELLITE_MASK, 64);
        let signals = Mask::of(header, SIGNAL_MASK, 32);
        let grid = satellites.count() * signals.count();
        if grid > MOST_CELLS {
            return None;
        }
        let rough_start = CELL_MASK + grid;
        let cells = Mask::of(is_within(rough_start)?, CELL_MASK, grid);
        let widths = Widths::of(level);
        // Computed once, because the counts are expensive and the same for every satellite and
        // cell.
        let (rows, filled) = (satellites.count(), cells.count());
        let extended_start = rough_start + rows * 8;
        let part_start = extended_start + rows * widths.extended;
        let satellite_rate_start = part_start + rows * 10;
        let fine_start = satellite_rate_start + rows * widths.satellite_rate;
        let cn0_start = fine_start + filled * (widths.fine + widths.between);
        let rate_start = cn0_start + filled * widths.cn0;
        let payload = is_within(rate_start + filled * widths.cell_rate)?;
        let satellite_starts = [rough_start, extended_start, part_start, satellite_rate_start];
        let cell_starts = [fine_start, cn0_start, rate_start];
        Some(Self { payload, widths, satellites, signals, cells, satellite_starts, cell_starts })
    }

    /// Returns the fields of the `index`th satellite.
    fn row(&self, index: usize) -> Row {
        let (extended, rate) = (self.widths.extended, self.widths.satellite_rate);
        let [whole_start, extended_start, part_start, rate_start] = self.satellite_starts;
        let whole = self.payload.unsigned(whole_start + 8 * index, 8);
        let part = self.payload.unsigned(part_start + 10 * index, 10);
        let channel = match extended {
            0 => None,
            width => {
                Some(self.payload.small(extended_start + width * index, width)).filter(|field| *field <= 13)
            }
        };
        Row {
            rough: (whole != 255).then_some(i64::from(whole << 10 | part) << 19),
            rate_m_s: self.optional(rate_start + rate * index, rate),
            channel: channel.map_or(0, |field| field.cast_signed() - 7),
        }
    }

    /// Returns the fine range of the `index`th cell, steps of 2⁻²⁹ ms; `None` if the message has
    /// none.
    fn fine(&self, index: usize) -> Option<i64> {
        let width = self.widths.fine;
        let [start, ..] = self.cell_starts;
        let steps = self.optional(start + width * index, width)?;
        Some(i64::from(steps << self.widths.fine_power))
    }

    /// Returns the carrier to noise density of the `index`th cell, dB-Hz; 0 if the message has
    /// none.
    fn cn0_dbhz(&self, index: usize) -> f32 {
        let [_, start, _] = self.cell_starts;
        let field = self.payload.unsigned(start + self.widths.cn0 * index, self.widths.cn0);
        field as f32 * self.widths.cn0_dbhz
    }

    /// Returns the range rate of a cell, m/s; `None` if the level or the message has none.
    fn rate_m_s(&self, row: &Row, cell: usize) -> Option<f32> {
        let (cell_rate, [.., start]) = (self.widths.cell_rate, self.cell_starts);
        let fine = self.optional(start + cell_rate * cell, cell_rate)?;
        Some(row.rate_m_s? as f32 + fine as f32 * FINE_RATE_M_S)
    }

    /// Returns a signed number; `None` for the most negative one, which marks a missing value, and
    /// for a width of 0.
    fn optional(&self, start: usize, width: usize) -> Option<i32> {
        if width == 0 {
            return None;
        }
        let number = self.payload.signed(start, width);
        (number != -1 << (width - 1)).then_some(number)
    }
}

/// A mask, with its first bit on top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Mask(u64);

impl Mask {
    /// Returns the `length` bits from `start` on, at most 64.
    fn of(payload: Bits<'_>, start: usize, length: usize) -> Self {
        let half = |start, length: usize| match length {
            0 => 0,
            _ => u64::from(payload.unsigned(start, length)) << (32 - length),
        };
        let first = length.min(32);
        Self(half(start, first) << 32 | half(start + first, length - first))
    }

    /// Counts the ones. Not inlined, because this processor needs some thirty instructions for it.
    #[inline(never)]
    const fn count(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Returns true if the bit at a position below 64 is set.
    const fn has(self, position: usize) -> bool {
        (self.0 << position) >> 63 == 1
    }

    /// Returns the positions of the ones, from 0.
    fn positions(self) -> impl Iterator<Item = u8> {
        let mut left = self.0;
        core::iter::from_fn(move || {
            let position = left.leading_zeros();
            left &= !(1_u64 << 63).checked_shr(position)?;
            Some(position as u8)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_those_of_the_speed_of_light() {
        // From no time of travel to the longest of the message, and a fine range below zero.
        let steps = (0..2_000_i64).map(|index| index * 68_719_477).chain([-524_287, (255 << 29) - 1]);
        for steps in steps {
            // Exact: 58 bits, and one rounding.
            let want = (i128::from(steps) * 299_792_458) as f64 / (1000.0 * (1_u64 << 29) as f64);
            let have = range_m(steps);
            assert!((have - want).abs() <= 1.5e-8, "{steps}: {have}, not {want}");
        }
    }
}
