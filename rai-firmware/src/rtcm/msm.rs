//! Multiple signal messages: the code ranges in them.
//!
//! ```text
//! P = c · (rough integer ms + rough part ms + fine part ms)
//! ```
//!
//! The message numbers are regular: 1070 + 10 · system + level, with system 0 GPS, 1 GLONASS, 2 Galileo, 3 SBAS,
//! 4 QZSS, 5 `BeiDou`, 6 `NavIC`. All begin alike:
//!
//! | bits | what |
//! |---|---|
//! | 0..12 | number |
//! | 12..24 | station |
//! | 24..54 | time (GPS, Galileo, `BeiDou`: ms of the system's own week) |
//! | 54 | more messages of this instant follow |
//! | 73..137, 137..169 | masks of satellites and of signals |
//!
//! The header is read here, before the message is decoded, because the decoder shifts by the product of the two
//! masks' populations and may only see those that the standard allows (1 to 64).
//!
//! Reference: [RTCM-10403.3] 3.5.16.

use rai_core::frame::SPEED_OF_LIGHT_M_S;
use rai_core::satellite::{Constellation, SatelliteId};
use rtcm_rs::Message;

use super::{Counters, RawEpoch, decode, framer};
use crate::counters::count;
use crate::signal::{Band, Signal};
use crate::time::{BEIDOU_OFFSET_MS, WEEK_MS};

/// Metres of range per millisecond.
const M_PER_MS: f64 = SPEED_OF_LIGHT_M_S * 1e-3;

/// What all multiple signal messages begin with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Header {
    /// The system and level, if they are used.
    constellation: Option<Constellation>,
    time: u32,
    pub(super) more_follow: bool,
}

/// A header that the standard does not allow, or a payload that ends before it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Malformed;

impl Header {
    /// The header, or `None` when the number is none of a multiple signal message.
    pub(super) fn read(number: u16, frame: &[u8]) -> Option<Result<Self, Malformed>> {
        let (system, level) = match number {
            1071..=1137 => ((number - 1070) / 10, (number - 1070) % 10),
            _ => return None,
        };
        if !(1..=7).contains(&level) {
            return None;
        }
        let constellation = match system {
            0 => Some(Constellation::Gps),
            2 => Some(Constellation::Galileo),
            5 => Some(Constellation::Beidou),
            _ => None,
        };
        // Levels 1 to 3 carry no full range.
        Some(Self::parse(constellation.filter(|_| level >= 4), frame).ok_or(Malformed))
    }

    fn parse(constellation: Option<Constellation>, frame: &[u8]) -> Option<Self> {
        let payload = framer::payload(frame)?;
        let satellites = (bits(payload, 73, 32)?.count_ones()) + bits(payload, 105, 32)?.count_ones();
        let cells = satellites * bits(payload, 137, 32)?.count_ones();
        if constellation.is_some() && !(1..=64).contains(&cells) {
            return None;
        }
        Some(Self { constellation, time: bits(payload, 24, 30)?, more_follow: bits(payload, 54, 1)? == 1 })
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

/// Bits of a payload, most significant first, at most 32; `None` beyond its end.
fn bits(payload: &[u8], start: usize, length: usize) -> Option<u32> {
    (start..start + length).try_fold(0, |value, position| {
        let byte = payload.get(position / 8)?;
        Some(value << 1 | u32::from(byte >> (7 - position % 8) & 1))
    })
}

/// Adds the ranges of a message to the epoch.
#[inline(never)]
pub(super) fn read(header: Header, frame: &[u8], epoch: &mut RawEpoch, counters: &mut Counters) {
    let Some(constellation) = header.constellation else {
        return;
    };
    let mut cells = Cells { constellation, earlier: epoch.satellites.len(), epoch, counters };
    visit(&decode(frame), &mut cells);
}

/// Where the ranges of one message go.
struct Cells<'a> {
    constellation: Constellation,
    /// How many satellites the epoch held before this message.
    earlier: usize,
    epoch: &'a mut RawEpoch,
    counters: &'a mut Counters,
}

/// One satellite's one signal, as it stands in the message.
struct Cell {
    satellite: u8,
    band: u8,
    attribute: char,
    rough_ms: Option<f64>,
    fine_ms: Option<f64>,
    cn0_dbhz: f32,
}

impl Cells<'_> {
    fn add(&mut self, cell: &Cell) {
        let Some(satellite) = satellite(self.constellation, cell.satellite) else {
            return count(&mut self.counters.satellites_unknown);
        };
        let Some(band) = Band::from_rinex(self.constellation, cell.band, cell.attribute) else {
            return count(&mut self.counters.signals_other);
        };
        let (Some(rough_ms), Some(fine_ms)) = (cell.rough_ms, cell.fine_ms) else {
            return count(&mut self.counters.ranges_missing);
        };
        let range_m = (rough_ms + fine_ms) * M_PER_MS;
        let signal = Signal { band, cn0_dbhz: cell.cn0_dbhz, range_m };
        self.epoch.add(satellite, signal, self.earlier, self.counters);
    }
}

/// The satellite of a position in the mask.
fn satellite(constellation: Constellation, number: u8) -> Option<SatelliteId> {
    let highest = match constellation {
        Constellation::Gps => 32,
        Constellation::Galileo => 36,
        Constellation::Beidou => 63,
        Constellation::Glonass => 0,
    };
    if number <= highest { SatelliteId::new(constellation, number) } else { None }
}

/// The twelve messages differ in the names of two fields and in the width of the numbers, not in structure.
macro_rules! visit_levels {
    ($message:expr, $cells:expr, $($variant:ident: $fine:ident, $cn0:ident;)*) => {
        match $message {
            $(Message::$variant(message) => {
                for signal in message.data_segment.signal_data.iter() {
                    let mut satellites = message.data_segment.satellite_data.iter();
                    let rough = satellites.find(|satellite| satellite.satellite_id == signal.satellite_id);
                    $cells.add(&Cell {
                        satellite: signal.satellite_id,
                        band: signal.signal_id.band(),
                        attribute: signal.signal_id.attribute(),
                        rough_ms: rough.and_then(|rough| {
                            let whole_ms = f64::from(rough.gnss_satellite_rough_range_integer_ms?);
                            Some(whole_ms + rough.gnss_satellite_rough_range_mod1ms_ms)
                        }),
                        fine_ms: signal.$fine,
                        cn0_dbhz: signal.$cn0.map_or(0.0, |cn0| cn0 as f32),
                    });
                }
            })*
            _ => count(&mut $cells.counters.messages_malformed),
        }
    };
}

fn visit(message: &Message, cells: &mut Cells<'_>) {
    visit_levels!(message, cells,
        Msg1074: gnss_signal_fine_pseudorange_ms, gnss_signal_cnr_dbhz;
        Msg1075: gnss_signal_fine_pseudorange_ms, gnss_signal_cnr_dbhz;
        Msg1076: gnss_signal_fine_pseudorange_ext_ms, gnss_signal_cnr_ext_dbhz;
        Msg1077: gnss_signal_fine_pseudorange_ext_ms, gnss_signal_cnr_ext_dbhz;
        Msg1094: gnss_signal_fine_pseudorange_ms, gnss_signal_cnr_dbhz;
        Msg1095: gnss_signal_fine_pseudorange_ms, gnss_signal_cnr_dbhz;
        Msg1096: gnss_signal_fine_pseudorange_ext_ms, gnss_signal_cnr_ext_dbhz;
        Msg1097: gnss_signal_fine_pseudorange_ext_ms, gnss_signal_cnr_ext_dbhz;
        Msg1124: gnss_signal_fine_pseudorange_ms, gnss_signal_cnr_dbhz;
        Msg1125: gnss_signal_fine_pseudorange_ms, gnss_signal_cnr_dbhz;
        Msg1126: gnss_signal_fine_pseudorange_ext_ms, gnss_signal_cnr_ext_dbhz;
        Msg1127: gnss_signal_fine_pseudorange_ext_ms, gnss_signal_cnr_ext_dbhz;
    );
}
