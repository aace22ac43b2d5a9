//! Multiple signal messages: the code ranges in them.
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
//! | | 0, 14, 0, 14 | rough rate |
//! | cell | 15, 15, 20, 20 | fine range, signed, the most negative for none |
//! | | 22, 22, 24, 24 and 4, 4, 10, 10 and 1 | phase, lock time, half cycle |
//! | | 6, 6, 10, 10 | C/N0, 1 dB-Hz or 1/16 dB-Hz, 0 for none |
//! | | 0, 15, 0, 15 | rate |
//!
//! A message without satellites is as good as any: a system that sees none still says when the instant is complete.
//!
//! Two of ten fields are of use here, so the message is read in place. A general decoder (`rtcm-rs`, which reads
//! the small messages) returns every field of 64 cells by value, which took 44 KiB of stack and 65 KiB of flash,
//! and it drops a whole message for one signal that it does not know.
//!
//! Reference: [RTCM-10403.3] 3.5.16, tables 3.5-73 to 3.5-101.

use rai_core::frame::SPEED_OF_LIGHT_M_S;
use rai_core::satellite::{Constellation, SatelliteId};

use super::{Counters, RawEpoch, framer};
use crate::counters::count;
use crate::signal::{Band, Signal};
use crate::time::{BEIDOU_OFFSET_MS, WEEK_MS};

/// Metres of range per millisecond.
const M_PER_MS: f64 = SPEED_OF_LIGHT_M_S * 1e-3;

/// Where the masks begin, bits.
const SATELLITE_MASK: usize = 73;
const SIGNAL_MASK: usize = SATELLITE_MASK + 64;
const CELL_MASK: usize = SIGNAL_MASK + 32;

/// Most cells, hence most satellites, that one message may have.
const MOST_CELLS: usize = 64;

/// What all multiple signal messages begin with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Header {
    /// The system, if its ranges are used.
    constellation: Option<Constellation>,
    level: u16,
    time: u32,
    pub(super) more_follow: bool,
}

/// A message that ends before its masks say it does, or with masks that the standard does not allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Malformed;

impl Header {
    /// The header, or `None` when the number is none of a multiple signal message.
    pub(super) fn read(number: u16, frame: &[u8]) -> Option<Result<Self, Malformed>> {
        let (system, level) = match number {
            1071..=1137 => ((number - 1070) / 10, (number - 1070) % 10),
            _ => return None,
        };
        let constellation = match (system, level) {
            (_, 0 | 8 | 9) => return None,
            // Levels 1 to 3 carry no full range.
            (0, 4..) => Some(Constellation::Gps),
            (2, 4..) => Some(Constellation::Galileo),
            (5, 4..) => Some(Constellation::Beidou),
            _ => None,
        };
        Some(Self::parse(constellation, level, frame).ok_or(Malformed))
    }

    fn parse(constellation: Option<Constellation>, level: u16, frame: &[u8]) -> Option<Self> {
        let payload = framer::payload(frame)?;
        let (time, more) = (bits(payload, 24, 30)?, bits(payload, 54, 1)?);
        if constellation.is_some() {
            // A message that contradicts itself must not move time either.
            Layout::new(payload, level)?;
        }
        Some(Self { constellation, level, time, more_follow: more == 1 })
    }

    /// True when the ranges of the message are used.
    pub(super) fn is_used(self) -> bool {
        self.constellation.is_some()
    }

    /// Milliseconds into the week of GPS time; `None` when the field is beyond the week.
    pub(super) fn gps_tow_ms(self) -> Option<u32> {
        let offset_ms = match self.constellation {
            Some(Constellation::Beidou) => BEIDOU_OFFSET_MS,
            _ => 0,
        };
        if self.time < WEEK_MS { Some((self.time + offset_ms) % WEEK_MS) } else { None }
    }
}

/// Widths of the fields that the levels differ in, bits.
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

/// A message whose masks are allowed and whose payload is long enough for them.
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

/// Adds the ranges of the message that [`Header::read`] has let pass to the epoch.
pub(super) fn read(header: Header, frame: &[u8], epoch: &mut RawEpoch, counters: &mut Counters) {
    let layout = framer::payload(frame).and_then(|payload| Layout::new(payload, header.level));
    let (Some(constellation), Some(layout)) = (header.constellation, layout) else {
        return;
    };
    let mut target = Target { constellation, earlier: epoch.satellites.len(), epoch, counters };
    let grid = layout.ones(SATELLITE_MASK, 64).enumerate();
    let grid = grid.flat_map(|satellite| layout.ones(SIGNAL_MASK, 32).map(move |signal| (satellite, signal)));
    let mut cell = 0;
    for (position, ((index, satellite), signal)) in grid.enumerate() {
        if bits(layout.payload, CELL_MASK + position, 1) == Some(1) {
            let range_ms = layout.rough_ms(index).zip(layout.fine_ms(cell)).map(|(rough, fine)| rough + fine);
            // The masks count from 1.
            target.add((satellite + 1, signal + 1), range_ms, layout.cn0_dbhz(cell));
            cell += 1;
        }
    }
}

/// Where the ranges of one message go.
struct Target<'a> {
    constellation: Constellation,
    /// How many satellites the epoch held before this message.
    earlier: usize,
    epoch: &'a mut RawEpoch,
    counters: &'a mut Counters,
}

impl Target<'_> {
    fn add(&mut self, (satellite, signal): (u8, u8), range_ms: Option<f64>, cn0_dbhz: f32) {
        let Some(satellite) = satellite_id(self.constellation, satellite) else {
            return count(&mut self.counters.satellites_unknown);
        };
        let Some(band) = Band::from_msm(self.constellation, signal) else {
            return count(&mut self.counters.signals_other);
        };
        let Some(range_ms) = range_ms else {
            return count(&mut self.counters.ranges_missing);
        };
        let is_reference = is_reference(self.constellation, signal);
        let signal = Signal { band, cn0_dbhz, range_m: range_ms * M_PER_MS };
        self.epoch.add(satellite, signal, is_reference, self.earlier, self.counters);
    }
}

/// Whether a signal is the one code of its band that the broadcast clock is of, where another one may be beside it:
/// P and Y on L1. To C/A a GPS satellite has a delay of its own, up to a metre, that no message tells.
const fn is_reference(constellation: Constellation, signal: u8) -> bool {
    matches!((constellation, signal), (Constellation::Gps, 3 | 4))
}

/// The satellite of a position in the mask.
fn satellite_id(constellation: Constellation, number: u8) -> Option<SatelliteId> {
    let highest = match constellation {
        Constellation::Gps => 32,
        Constellation::Galileo => 36,
        Constellation::Beidou => 63,
        Constellation::Glonass => 0,
    };
    if number <= highest { SatelliteId::new(constellation, number) } else { None }
}
