//! Faults in a capture: the ranges of a frame are altered in place, and all other bytes stay as
//! they came.
//!
//! ```text
//! RXM-RAWX    prMes, a double                            P' = P + Δ
//! MeasEpoch   CodeMSB, CodeLSB: millimetres              n' = n + round(Δ / 1 mm)
//! MSM4 … 7    whole ms + rough/1024 ms + fine            in steps s of the fine range: n' = n + round(Δ / s)
//! ```
//!
//! | | step |
//! |---|---|
//! | RXM-RAWX | none |
//! | `MeasEpoch` | 1 mm |
//! | MSM4, MSM5 | 2⁻²⁴ ms, 18 mm |
//! | MSM6, MSM7 | 2⁻²⁹ ms, 0.6 mm |
//!
//! The fine range reaches 292 m to either side of the rough one, which all signals of a satellite
//! share. The rough range stays if the faulty ranges fit, and is moved if they do not. A lost
//! satellite has no measurement in RXM-RAWX, no first range in `MeasEpoch`, to which its others refer,
//! and ranges marked as invalid in MSM. Carrier phases
//! and rates are unchanged, because a check of code ranges does not use them.
//!
//! Reference: [RTCM-10403.3] 3.5.16, tables 3.5-73 to 3.5-101.
//!
//! [RTCM-10403.3]: crate#references

use anyhow::{Context as _, Result, ensure};
use raim_core::frame::SPEED_OF_LIGHT_M_S;
use raim_core::satellite::SatelliteId;
use raim_firmware::output::nmea::GPS_MINUS_UTC_S;
use raim_firmware::time::{BEIDOU_OFFSET_MS, GLONASS_OFFSET_MS, GpsTime, WEEK_MS};

use crate::signal::checksum::{crc16, crc24q};
use crate::signal::encode::ubx;
use crate::signal::fault::{Fault, Kind as What};
use crate::signal::pieces::{Kind, Piece};

/// Distance that light travels in a millisecond, m.
const M_PER_MS: f64 = SPEED_OF_LIGHT_M_S * 1e-3;

/// Bytes before the measurements of RXM-RAWX, and of each measurement.
const HEADER: usize = 16;
const MEASUREMENT: usize = 32;

/// First bits of the masks of an MSM.
const SATELLITE_MASK: usize = 73;
const SIGNAL_MASK: usize = SATELLITE_MASK + 64;
const CELL_MASK: usize = SIGNAL_MASK + 32;

/// Value of the whole milliseconds that marks an invalid range.
const NO_WHOLE: u64 = 255;

/// Change of a satellite's ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Change {
    Longer(f64),
    Lost,
}

/// Returns the change by the faults for a satellite at an instant.
fn change(faults: &[Fault], satellite: SatelliteId, elapsed_s: f64) -> Option<Change> {
    let active =
        || faults.iter().filter(|fault| fault.is_active(elapsed_s) && fault.target.covers(satellite));
    if active().any(|fault| matches!(fault.kind, What::Outage)) {
        return Some(Change::Lost);
    }
    let bias_m: f64 = active().map(|fault| fault.bias_m(elapsed_s)).sum();
    (bias_m != 0.0).then_some(Change::Longer(bias_m))
}

/// Returns the time of week of a frame's ranges, ms of GPS time; `None` if it has no ranges or its
/// time is unknown.
pub(super) fn tow_ms(piece: &Piece<'_>) -> Option<u32> {
    let payload = payload(piece);
    if piece.kind == Kind::RAWX {
        let tow_s = f64::from_le_bytes(*payload.first_chunk()?);
        return (0.0..604_800.0).contains(&tow_s).then(|| (tow_s * 1e3).round() as u32 % WEEK_MS);
    }
    if piece.kind == Kind::MEAS_EPOCH {
        let tow_ms = u32::from_le_bytes(*piece.bytes.get(8..)?.first_chunk()?);
        return (tow_ms < WEEK_MS).then_some(tow_ms);
    }
    let Kind::Rtcm(number @ 1071..=1137) = piece.kind else { return None };
    let time = bits(payload, 24, 30)? as u32;
    match (number - 1070) / 10 {
        1 => {
            let leap_ms = 1000 * u32::from(GPS_MINUS_UTC_S);
            let of_week_ms = (time >> 27) * 86_400_000 + (time & 0x7FF_FFFF);
            Some((of_week_ms + WEEK_MS - GLONASS_OFFSET_MS as u32 + leap_ms) % WEEK_MS)
        }
        5 => Some((time + BEIDOU_OFFSET_MS) % WEEK_MS),
        _ => Some(time % WEEK_MS),
    }
}

/// Returns the frame with the faults; `None` if they do not affect it. `epoch` is the one that it
/// came with, `elapsed_s` after the first.
///
/// # Errors
/// A fault does not fit the message.
pub(super) fn falsify(
    piece: &Piece<'_>,
    (epoch, elapsed_s): (GpsTime, f64),
    faults: &[Fault],
) -> Result<Option<Vec<u8>>> {
    let Some(tow_ms) = tow_ms(piece) else { return Ok(None) };
    // The first message of the next epoch may come with this one.
    let at_s = elapsed_s + GpsTime::nearest(tow_ms, epoch).since_ms(epoch) as f64 * 1e-3;
    let change = |satellite| change(faults, satellite, at_s);
    match piece.kind {
        Kind::Ubx(_) => Ok(rawx(payload(piece), change)),
        Kind::Rtcm(number) => msm(number, piece.bytes, change),
        Kind::MEAS_EPOCH => meas_epoch(piece.bytes, change),
        Kind::Sbf(_) | Kind::Line | Kind::Rest => Ok(None),
    }
}

/// Returns the bytes between header and check.
pub(super) fn payload<'a>(piece: &Piece<'a>) -> &'a [u8] {
    let (header, check) = match piece.kind {
        Kind::Ubx(_) => (6, 2),
        Kind::Rtcm(_) => (3, 3),
        Kind::Sbf(_) => (14, 0),
        Kind::Line | Kind::Rest => (0, 0),
    };
    piece.bytes.get(header..piece.bytes.len() - check).unwrap_or_default()
}

fn rawx(payload: &[u8], change: impl Fn(SatelliteId) -> Option<Change>) -> Option<Vec<u8>> {
    let (header, measurements) = payload.split_at_checked(HEADER)?;
    let (mut altered, mut is_altered) = (header.to_vec(), false);
    for measurement in measurements.chunks_exact(MEASUREMENT) {
        let change = ubx_satellite(measurement[20], measurement[21]).and_then(&change);
        is_altered |= change.is_some();
        match change {
            Some(Change::Lost) => {}
            Some(Change::Longer(by_m)) => {
                let range_m = f64::from_le_bytes(*measurement.first_chunk()?) + by_m;
                altered.extend_from_slice(&range_m.to_le_bytes());
                altered.extend_from_slice(&measurement[8..]);
            }
            None => altered.extend_from_slice(measurement),
        }
    }
    altered[11] = ((altered.len() - HEADER) / MEASUREMENT) as u8;
    is_altered.then(|| ubx::frame([0x02, 0x15], &altered))
}

/// Alters the first range of each satellite, to which the others refer.
fn meas_epoch(block: &[u8], change: impl Fn(SatelliteId) -> Option<Change>) -> Result<Option<Vec<u8>>> {
    /// Bytes before the sub-blocks.
    const HEADER: usize = 20;
    let mut altered = block.to_vec();
    let &[many, first_bytes, further_bytes] = &block[14..17] else { return Ok(None) };
    let (mut at, mut is_altered) = (HEADER, false);
    for _ in 0..many {
        let Some(first) = altered.get_mut(at..).and_then(|rest| rest.first_chunk_mut::<20>()) else { break };
        at += usize::from(first_bytes) + usize::from(first[19]) * usize::from(further_bytes);
        let Some(satellite) = sbf_satellite(first[2]) else { continue };
        let Some(change) = change(satellite) else { continue };
        let range_mm = u64::from(first[3] & 15) << 32
            | u64::from(u32::from_le_bytes([first[4], first[5], first[6], first[7]]));
        let range_mm = match change {
            Change::Longer(by_m) if range_mm != 0 => range_mm
                .checked_add_signed((by_m * 1e3).round() as i64)
                .filter(|range_mm| *range_mm < 1 << 36),
            Change::Longer(_) | Change::Lost => Some(0),
        };
        let range_mm = range_mm
            .with_context(|| format!("{satellite}: the range does not fit MeasEpoch with this fault"))?;
        first[3] = first[3] & 0xF0 | (range_mm >> 32) as u8;
        first[4..8].copy_from_slice(&(range_mm as u32).to_le_bytes());
        is_altered = true;
    }
    let crc = crc16(&altered[4..]);
    altered[2..4].copy_from_slice(&crc);
    Ok(is_altered.then_some(altered))
}

/// Returns the satellite behind Septentrio's number.
pub(super) fn sbf_satellite(svid: u8) -> Option<SatelliteId> {
    let (letter, before) = match svid {
        1..=37 => ('G', 0),
        38..=61 => ('R', 37),
        63..=68 => ('R', 38),
        71..=106 => ('E', 70),
        141..=180 => ('C', 140),
        181..=190 => ('J', 180),
        223..=245 => ('C', 182),
        _ => return None,
    };
    SatelliteId::from_name(letter, svid - before)
}

/// Returns the satellite behind u-blox's numbers of a system and a satellite.
pub(super) fn ubx_satellite(system: u8, number: u8) -> Option<SatelliteId> {
    let letter = match system {
        0 => 'G',
        2 => 'E',
        3 => 'C',
        5 => 'J',
        6 => 'R',
        _ => return None,
    };
    SatelliteId::from_name(letter, number)
}

/// Positions of the ranges in an MSM.
struct Layout {
    /// Numbers of the satellites.
    satellites: Vec<u8>,
    /// Satellite of each cell, as an index in `satellites`.
    cells: Vec<usize>,
    /// First bits of the whole milliseconds, of the rough and of the fine ranges.
    whole_at: usize,
    rough_at: usize,
    fine_at: usize,
    /// Width of a fine range, bits, and number of its steps in a step of the rough one.
    fine_bits: usize,
    fine_per_rough: i64,
}

impl Layout {
    fn of(number: u16, payload: &[u8]) -> Option<Self> {
        let ones = |start: usize, length: usize| {
            (0..length).filter(move |index| bits(payload, start + index, 1) == Some(1)).collect::<Vec<_>>()
        };
        let (satellites, signals) = (ones(SATELLITE_MASK, 64), ones(SIGNAL_MASK, 32));
        let grid = satellites.len() * signals.len();
        let cells: Vec<usize> =
            ones(CELL_MASK, grid).iter().map(|position| position / signals.len()).collect();
        let has_rates = matches!(number % 10, 5 | 7);
        let (fine_bits, fine_per_rough) = if number % 10 >= 6 { (20, 1 << 19) } else { (15, 1 << 14) };
        let whole_at = CELL_MASK + grid;
        let rough_at = whole_at + satellites.len() * if has_rates { 12 } else { 8 };
        let fine_at = rough_at + satellites.len() * if has_rates { 24 } else { 10 };
        let satellites = satellites.iter().map(|index| *index as u8 + 1).collect();
        let fits = fine_at + fine_bits * cells.len() <= 8 * payload.len();
        fits.then_some(Self { satellites, cells, whole_at, rough_at, fine_at, fine_bits, fine_per_rough })
    }

    /// Returns a step of the fine range, m.
    fn step_m(&self) -> f64 {
        M_PER_MS / (1024 * self.fine_per_rough) as f64
    }

    /// Returns the positions of a satellite's fine ranges.
    fn fine_of(&self, row: usize) -> impl Iterator<Item = usize> + '_ {
        let of_row = self.cells.iter().enumerate().filter(move |(_, of)| **of == row);
        of_row.map(|(cell, _)| self.fine_at + cell * self.fine_bits)
    }

    /// Returns the value of an invalid fine range.
    fn none(&self) -> i64 {
        -(1 << (self.fine_bits - 1))
    }

    fn lose(&self, payload: &mut [u8], row: usize) {
        set(payload, self.whole_at + 8 * row, 8, NO_WHOLE);
        for at in self.fine_of(row) {
            set(payload, at, self.fine_bits, self.none().cast_unsigned());
        }
    }

    /// Lengthens the ranges of a satellite; returns false if they do not fit the message.
    fn lengthen(&self, payload: &mut [u8], row: usize, by_m: f64) -> bool {
        let (whole_at, rough_at) = (self.whole_at + 8 * row, self.rough_at + 10 * row);
        let (Some(whole), Some(rough)) = (bits(payload, whole_at, 8), bits(payload, rough_at, 10)) else {
            return false;
        };
        let fine =
            |at: usize| bits(payload, at, self.fine_bits).map_or(0, |value| signed(value, self.fine_bits));
        let ranges: Vec<(usize, i64)> =
            self.fine_of(row).map(|at| (at, fine(at))).filter(|(_, fine)| *fine != self.none()).collect();
        let (Some(least), Some(most)) =
            (ranges.iter().map(|(_, fine)| *fine).min(), ranges.iter().map(|(_, fine)| *fine).max())
        else {
            return true;
        };
        if whole == NO_WHOLE {
            return true;
        }
        let by = (by_m / self.step_m()).round() as i64;
        let fits = |fine: i64| fine.abs() < -self.none();
        // The middle of the signals stays as near to the rough range as possible.
        let middle = by + i64::midpoint(least, most);
        let moved = if fits(least + by) && fits(most + by) {
            0
        } else {
            (middle + self.fine_per_rough / 2).div_euclid(self.fine_per_rough)
        };
        let by = by - moved * self.fine_per_rough;
        let rough = (whole << 10 | rough).cast_signed() + moved;
        if !fits(least + by) || !fits(most + by) || !(0..255 << 10).contains(&rough) {
            return false;
        }
        set(payload, whole_at, 8, (rough >> 10).cast_unsigned());
        set(payload, rough_at, 10, (rough & 1023).cast_unsigned());
        for (at, fine) in ranges {
            set(payload, at, self.fine_bits, (fine + by).cast_unsigned());
        }
        true
    }
}

fn msm(number: u16, frame: &[u8], change: impl Fn(SatelliteId) -> Option<Change>) -> Result<Option<Vec<u8>>> {
    let letter = match (number - 1070) / 10 {
        0 => 'G',
        1 => 'R',
        2 => 'E',
        4 => 'J',
        5 => 'C',
        _ => return Ok(None),
    };
    let mut altered = frame.to_vec();
    let end = altered.len() - 3;
    let payload = &mut altered[3..end];
    let Some(layout) = Some(payload.len())
        .filter(|_| (4..=7).contains(&(number % 10)))
        .and_then(|_| Layout::of(number, payload))
    else {
        return Ok(None);
    };
    let mut is_altered = false;
    for (row, satellite) in layout.satellites.iter().enumerate() {
        let Some(satellite) = SatelliteId::from_name(letter, *satellite) else { continue };
        match change(satellite) {
            None => continue,
            Some(Change::Lost) => layout.lose(payload, row),
            Some(Change::Longer(by_m)) => ensure!(
                layout.lengthen(payload, row, by_m),
                "{satellite}: message {number} of the capture has no room for a range {by_m:+} m longer"
            ),
        }
        is_altered = true;
    }
    let parity = crc24q(&altered[..end]);
    altered[end..].copy_from_slice(&parity);
    Ok(is_altered.then_some(altered))
}

/// Reads an unsigned field, high bit first.
pub(super) fn bits(bytes: &[u8], start: usize, length: usize) -> Option<u64> {
    (start..start + length).try_fold(0, |value, at| {
        let byte = bytes.get(at / 8)?;
        Some(value << 1 | u64::from(byte >> (7 - at % 8) & 1))
    })
}

/// Sets a field to the low bits of a value.
fn set(bytes: &mut [u8], start: usize, length: usize, value: u64) {
    for (at, bit) in (start..start + length).zip((0..length).rev()) {
        let Some(byte) = bytes.get_mut(at / 8) else { return };
        let mask = 1 << (7 - at % 8);
        *byte = if value >> bit & 1 == 1 { *byte | mask } else { *byte & !mask };
    }
}

/// Converts a field in two's complement.
fn signed(value: u64, length: usize) -> i64 {
    let shift = 64 - length;
    (value << shift).cast_signed() >> shift
}
