//! The bits of a message, in the order of the standard.
//!
//! ```text
//! header        number 12, station 12, time 30, more follow 1, others 15 and 3
//!               satellites 64, signals 32, cells (satellites × signals)
//! satellites    whole 8, (channel or reserved) 4, mod1 10, rough rate 14; each field for all in turn
//! signals       fine 20, phase 24, lock 10, half 1, C/N0 10, fine rate 15; likewise
//! ```
//!
//! A field that is unknown has the value that the standard reserves for it. A general library took
//! a fifth of the time of a replay of RINEX. Tests compare every bit with that library.
//!
//! Reference: [RTCM-10403.3] tables 3.5-78 to 3.5-90.
//!
//! [RTCM-10403.3]: crate#references

use raim_firmware::time::{BEIDOU_OFFSET_MS, GLONASS_OFFSET_MS, GpsTime, WEEK_MS};

use super::{Cell, Row};
use crate::signal::checksum::rtcm_frame;

/// Length of a message with 64 cells and 64 satellites, bytes.
const LONGEST: usize = 1024;

/// Milliseconds of a day.
const DAY_MS: u32 = 86_400_000;

/// Returns the frame of the rows of one system by its letter, at an instant with GPS time minus UTC,
/// s; `more` is true if other messages of the same epoch follow.
pub(super) fn frame(letter: char, time: (GpsTime, u8), more: bool, rows: &[Row]) -> Vec<u8> {
    let mut bits = Bits { bytes: Vec::with_capacity(LONGEST), held: 0, count: 0 };
    header(&mut bits, letter, time, more);
    let (satellites, signals) = masks(rows);
    bits.put(satellites, 64);
    bits.put(signals.into(), 32);
    for row in rows {
        cell_mask(&mut bits, row, signals);
    }
    satellite_data(&mut bits, letter, rows);
    signal_data(&mut bits, rows);
    rtcm_frame(&bits.finish())
}

/// Puts the fields before the masks.
fn header(bits: &mut Bits, letter: char, (time, leap_s): (GpsTime, u8), more: bool) {
    let (number, time_field) = match letter {
        'R' => (1087, glonass_time(time, leap_s)),
        'E' => (1097, time.tow_ms),
        'J' => (1117, time.tow_ms),
        'C' => (1127, (time.tow_ms + WEEK_MS - BEIDOU_OFFSET_MS) % WEEK_MS),
        _ => (1077, time.tow_ms),
    };
    bits.put(number, 12);
    bits.put(0, 12);
    bits.put(time_field.into(), 30);
    bits.put(more.into(), 1);
    // Issue of data station, reserved, clock steering, external clock and smoothing are not stated.
    bits.put(0, 3 + 7 + 2 + 2 + 1 + 3);
}

/// Returns the day of the week and the time of day of GLONASS, three hours ahead of UTC, as one
/// field of 3 and 27 bits.
fn glonass_time(time: GpsTime, leap_s: u8) -> u32 {
    let utc_ms = time.tow_ms + WEEK_MS - 1000 * u32::from(leap_s);
    let of_week_ms = (utc_ms + GLONASS_OFFSET_MS as u32) % WEEK_MS;
    ((of_week_ms / DAY_MS) << 27) | (of_week_ms % DAY_MS)
}

/// Returns the satellites and the signals of the rows, the first in the highest bit.
fn masks(rows: &[Row]) -> (u64, u32) {
    let satellites = rows.iter().fold(0, |mask, row| mask | 1 << (64 - row.number));
    let signals = rows.iter().flat_map(|row| &row.cells).fold(0, |mask, cell| mask | 1 << (32 - cell.signal));
    (satellites, signals)
}

/// Puts a bit for each signal of the message, which is 1 if the satellite has it.
fn cell_mask(bits: &mut Bits, row: &Row, mut signals: u32) {
    let of_row = row.cells.iter().fold(0_u32, |mask, cell| mask | 1 << (32 - cell.signal));
    while signals != 0 {
        let highest = 1 << signals.ilog2();
        bits.put((of_row & highest != 0).into(), 1);
        signals &= !highest;
    }
}

fn satellite_data(bits: &mut Bits, letter: char, rows: &[Row]) {
    // GLONASS states the channel, from 0 for the slot -7; for other systems the field is reserved.
    let channel = |row: &Row| if letter == 'R' { i64::from(row.slot) + 7 } else { 0 };
    bits.put_each(rows, |bits, row| bits.put(row.whole_ms.into(), 8));
    bits.put_each(rows, |bits, row| bits.put_signed(channel(row), 4));
    bits.put_each(rows, |bits, row| bits.put_signed(steps(row.mod1_ms, MOD1_MS), 10));
    bits.put_each(rows, |bits, row| bits.put_steps(row.rate_m_s, 1.0, 14));
}

fn signal_data(bits: &mut Bits, rows: &[Row]) {
    let cells = || rows.iter().flat_map(|row| &row.cells);
    bits.put_each(cells(), |bits, cell| bits.put_steps(Some(cell.fine_ms), FINE_MS, 20));
    bits.put_each(cells(), |bits, _| bits.put_steps(None, 1.0, 24));
    // No lock time and no ambiguity, because no phase is sent.
    bits.put_each(cells(), |bits, _| bits.put(0, 10));
    bits.put_each(cells(), |bits, _| bits.put(0, 1));
    let strength = |cell: &Cell| cell.cn0_dbhz.map_or(0, |cn0_dbhz| steps(cn0_dbhz, CN0_DBHZ));
    bits.put_each(cells(), |bits, cell| bits.put_signed(strength(cell), 10));
    bits.put_each(cells(), |bits, cell| bits.put_steps(cell.fine_rate_m_s, FINE_RATE_M_S, 15));
}

/// Resolutions of the fields.
const MOD1_MS: f64 = 1.0 / 1024.0;
const FINE_MS: f64 = 1.0 / 536_870_912.0;
const CN0_DBHZ: f64 = 1.0 / 16.0;
const FINE_RATE_M_S: f64 = 1e-4;

/// Returns the number of steps nearest to a value.
fn steps(value: f64, resolution: f64) -> i64 {
    (value / resolution).round() as i64
}

/// Bits, the first in the highest place of the first byte.
struct Bits {
    bytes: Vec<u8>,
    /// The last bits; the lowest `count`, fewer than 32, are not among the bytes yet.
    held: u64,
    count: u32,
}

impl Bits {
    /// Puts the lowest `width` bits of a value, at most 64.
    fn put(&mut self, value: u64, width: u32) {
        if width > 32 {
            self.put(value >> 32, width - 32);
            return self.put(value & u64::from(u32::MAX), 32);
        }
        let kept = value & ((1 << width) - 1);
        self.held = self.held << width | kept;
        self.count += width;
        if self.count >= 32 {
            self.count -= 32;
            self.bytes.extend_from_slice(&((self.held >> self.count) as u32).to_be_bytes());
        }
    }

    /// Puts a number in two's complement.
    fn put_signed(&mut self, value: i64, width: u32) {
        self.put(value.cast_unsigned(), width);
    }

    /// Puts a signed value in steps of a resolution. The least number of the field means unknown.
    fn put_steps(&mut self, value: Option<f64>, resolution: f64, width: u32) {
        let unknown = -1 << (width - 1);
        self.put_signed(value.map_or(unknown, |value| steps(value, resolution)), width);
    }

    /// Puts one field of all satellites or signals.
    fn put_each<'r, R: 'r>(&mut self, of: impl IntoIterator<Item = &'r R>, put: impl Fn(&mut Self, &'r R)) {
        for one in of {
            put(self, one);
        }
    }

    /// Returns the bytes, the last filled with zeros.
    fn finish(mut self) -> Vec<u8> {
        let used = self.count.div_ceil(8) as usize;
        self.put(0, 32 - self.count);
        self.bytes.truncate(self.bytes.len() - (4 - used));
        self.bytes
    }
}
