//! RTCM 3 written bit by bit from the tables of the standard, by an encoder that shares no code
//! with the decoder.
#![allow(dead_code, reason = "each test program uses a part")]

use crc::{CRC_24_LTE_A, Crc};
use raim_firmware::ephemeris::Source;
use raim_firmware::input::{Event, Input};
use raim_firmware::raw::RawEpoch;

use crate::orbits::Case;

/// Bits, most significant first.
#[derive(Clone, Default)]
pub(crate) struct Bits(Vec<bool>);

impl Bits {
    pub(crate) fn put(mut self, length: u32, value: i64) -> Self {
        self.0.extend((0..length).rev().map(|bit| value >> bit & 1 == 1));
        self
    }

    /// Appends a number in units of `2^exponent`.
    pub(crate) fn scaled(self, length: u32, exponent: i32, value: f64) -> Self {
        self.put(length, (value / 2f64.powi(exponent)).round() as i64)
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let byte = |bits: &[bool]| (0..8).fold(0, |byte, i| byte << 1 | u8::from(bits.get(i) == Some(&true)));
        self.0.chunks(8).map(byte).collect()
    }
}

/// Returns the CRC-24Q, which LTE uses too.
pub(crate) fn crc24q(bytes: &[u8]) -> u32 {
    Crc::<u32>::new(&CRC_24_LTE_A).checksum(bytes)
}

/// Returns a payload with preamble, length and parity.
pub(crate) fn frame(payload: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0xD3, (payload.len() >> 8) as u8, payload.len() as u8];
    bytes.extend_from_slice(payload);
    let parity = crc24q(&bytes);
    bytes.extend_from_slice(&parity.to_be_bytes()[1..]);
    bytes
}

/// One cell of an MSM: satellite, signal id of the standard, pseudorange in m, C/N0 in dB-Hz.
#[derive(Clone, Copy)]
pub(crate) struct Cell(pub(crate) u8, pub(crate) u8, pub(crate) f64, pub(crate) f64);

/// Signal ids of the standard.
pub(crate) const L1C: u8 = 2;
pub(crate) const L2W: u8 = 10;
pub(crate) const E1C: u8 = 2;
pub(crate) const E5A_Q: u8 = 23;
pub(crate) const B1I: u8 = 2;
pub(crate) const B3I: u8 = 8;

/// Returns an MSM frame of level 4 to 7, the last digit of its number.
pub(crate) fn msm(number: u16, time: u32, more: bool, cells: &[Cell]) -> Vec<u8> {
    let sorted = |pick: fn(&Cell) -> u8| {
        let mut ids: Vec<u8> = cells.iter().map(pick).collect();
        ids.sort_unstable();
        ids.dedup();
        ids
    };
    let (satellites, signals) = (sorted(|cell| cell.0), sorted(|cell| cell.1));
    let mut bits = Bits::default().put(12, i64::from(number)).put(12, 1).put(30, i64::from(time));
    bits = bits.put(1, i64::from(more)).put(18, 0);
    bits = (1..=64).fold(bits, |bits, id| bits.put(1, i64::from(satellites.contains(&id))));
    bits = (1..=32).fold(bits, |bits, id| bits.put(1, i64::from(signals.contains(&id))));
    let grid =
        satellites.iter().flat_map(|&satellite| signals.iter().map(move |&signal| (satellite, signal)));
    let grid: Vec<Option<&Cell>> = grid.map(|id| cells.iter().find(|cell| (cell.0, cell.1) == id)).collect();
    bits = grid.iter().fold(bits, |bits, cell| bits.put(1, i64::from(cell.is_some())));
    let present: Vec<&Cell> = grid.into_iter().flatten().collect();
    let level = number % 10;
    bits = satellite_fields(bits, level, &satellites, cells);
    frame(&signal_fields(bits, level, &present, cells).bytes())
}

/// Returns the rough range of the satellite's first cell, 1/1024 ms. The fine part is the rest.
fn rough(satellite: u8, cells: &[Cell]) -> i64 {
    let cell = cells.iter().find(|cell| cell.0 == satellite).unwrap();
    (cell.2 / 299_792.458 * 1024.0).round() as i64
}

/// Returns the rate of a satellite, m/s, and the difference of a signal's rate from it, 0.1 mm/s,
/// in levels 5 and 7. Satellite 9 has none, nor has the second signal of satellite 5.
pub(crate) fn rates(satellite: u8, signal: u8) -> Option<(i64, i64)> {
    let is_said = satellite != 9 && (satellite, signal) != (5, L2W);
    is_said.then(|| (i64::from(satellite) * 37 - 500, i64::from(signal) * 1000 - 7001))
}

/// Appends the fields of the satellites; levels 5 and 7 also carry an extended field and a rate.
fn satellite_fields(bits: Bits, level: u16, satellites: &[u8], cells: &[Cell]) -> Bits {
    let has_rate = matches!(level, 5 | 7);
    let zeros = |bits: Bits, length| satellites.iter().fold(bits, |bits: Bits, _| bits.put(length, 0));
    let mut bits = satellites.iter().fold(bits, |bits, &id| bits.put(8, rough(id, cells) / 1024));
    if has_rate {
        bits = zeros(bits, 4);
    }
    bits = satellites.iter().fold(bits, |bits, &id| bits.put(10, rough(id, cells) % 1024));
    if !has_rate {
        return bits;
    }
    let rate = |id| rates(id, L1C).map_or(-8192, |(rough, _)| rough);
    satellites.iter().fold(bits, |bits, &id| bits.put(14, rate(id)))
}

/// Appends the fields of the cells; levels 6 and 7 have wider ones, 5 and 7 a rate.
fn signal_fields(bits: Bits, level: u16, present: &[&Cell], cells: &[Cell]) -> Bits {
    let is_wide = level >= 6;
    let zeros = |bits: Bits, length| present.iter().fold(bits, |bits: Bits, _| bits.put(length, 0));
    let fine = |cell: &Cell| cell.2 / 299_792.458 - rough(cell.0, cells) as f64 / 1024.0;
    let (range, scale) = if is_wide { (20, -29) } else { (15, -24) };
    let mut bits = present.iter().fold(bits, |bits, cell| bits.scaled(range, scale, fine(cell)));
    for length in if is_wide { [24, 10, 1] } else { [22, 4, 1] } {
        bits = zeros(bits, length);
    }
    let (cn0, steps) = if is_wide { (10, 16.0) } else { (6, 1.0) };
    bits = present.iter().fold(bits, |bits, cell| bits.put(cn0, (cell.3 * steps) as i64));
    if !matches!(level, 5 | 7) {
        return bits;
    }
    let rate = |cell: &Cell| rates(cell.0, cell.1).map_or(-16_384, |(_, fine)| fine);
    present.iter().fold(bits, |bits, cell| bits.put(15, rate(cell)))
}

/// Returns the ephemeris message of a case: 1019, 1042, 1045 or 1046.
pub(crate) fn ephemeris(case: &Case) -> Vec<u8> {
    let bits = match case.source {
        Source::GpsLnav => message_1019(case),
        Source::BeidouD1D2 => message_1042(case),
        // F/NAV ends with one delay and one health, I/NAV with two of each.
        Source::GalileoFnav => galileo(case, 1045).put(10, -3).put(3, 0).put(7, 0),
        Source::GalileoInav => galileo(case, 1046).put(10, -3).put(10, 9).put(6, 0).put(2, 0),
        Source::QzssLnav | Source::GlonassStrings => panic!("not written here"),
    };
    frame(&bits.bytes())
}

fn message_1019(case: &Case) -> Bits {
    let [m0, omega0, i0, omega] = case.angles_sc();
    let [delta_n, omegadot, idot] = case.rates_sc_s();
    let [cuc, cus, crc, crs, cic, cis] = case.corrections;
    let start = Bits::default().put(12, 1019).put(6, i64::from(case.satellite.1));
    let clock = start
        .put(10, i64::from(case.week % 1024))
        .put(4, 0)
        .put(2, 1)
        .scaled(14, -43, idot)
        .put(8, 7)
        .put(16, i64::from(case.toc_ms / 16_000))
        .scaled(8, -55, case.clock[2])
        .scaled(16, -43, case.clock[1])
        .scaled(22, -31, case.clock[0])
        .put(10, 7);
    clock
        .scaled(16, -5, crs)
        .scaled(16, -43, delta_n)
        .scaled(32, -31, m0)
        .scaled(16, -29, cuc)
        .scaled(32, -33, case.eccentricity)
        .scaled(16, -29, cus)
        .scaled(32, -19, case.sqrt_a)
        .put(16, i64::from(case.toe_ms / 16_000))
        .scaled(16, -29, cic)
        .scaled(32, -31, omega0)
        .scaled(16, -29, cis)
        .scaled(32, -31, i0)
        .scaled(16, -5, crc)
        .scaled(32, -31, omega)
        .scaled(24, -43, omegadot)
        .scaled(8, -31, -8.0 / 2_147_483_648.0)
        .put(6, 0)
        .put(2, 0)
}

fn message_1042(case: &Case) -> Bits {
    let [m0, omega0, i0, omega] = case.angles_sc();
    let [delta_n, omegadot, idot] = case.rates_sc_s();
    let [cuc, cus, crc, crs, cic, cis] = case.corrections;
    let start = Bits::default().put(12, 1042).put(6, i64::from(case.satellite.1));
    let clock = start
        .put(13, i64::from(case.week - 1356))
        .put(4, 0)
        .scaled(14, -43, idot)
        .put(5, 1)
        .put(17, i64::from((case.toc_ms - 14_000) / 8_000))
        .scaled(11, -66, case.clock[2])
        .scaled(22, -50, case.clock[1])
        .scaled(24, -33, case.clock[0])
        .put(5, 1);
    clock
        .scaled(18, -6, crs)
        .scaled(16, -43, delta_n)
        .scaled(32, -31, m0)
        .scaled(18, -31, cuc)
        .scaled(32, -33, case.eccentricity)
        .scaled(18, -31, cus)
        .scaled(32, -19, case.sqrt_a)
        .put(17, i64::from((case.toe_ms - 14_000) / 8_000))
        .scaled(18, -31, cic)
        .scaled(32, -31, omega0)
        .scaled(18, -31, cis)
        .scaled(32, -31, i0)
        .scaled(18, -6, crc)
        .scaled(32, -31, omega)
        .scaled(24, -43, omegadot)
        .put(10, 142)
        .put(10, -105)
        .put(1, 0)
}

fn galileo(case: &Case, number: i64) -> Bits {
    let [m0, omega0, i0, omega] = case.angles_sc();
    let [delta_n, omegadot, idot] = case.rates_sc_s();
    let [cuc, cus, crc, crs, cic, cis] = case.corrections;
    let start = Bits::default().put(12, number).put(6, i64::from(case.satellite.1));
    let clock = start
        .put(12, i64::from(case.week - 1024))
        .put(10, 5)
        .put(8, 107)
        .scaled(14, -43, idot)
        .put(14, i64::from(case.toc_ms / 60_000))
        .scaled(6, -59, case.clock[2])
        .scaled(21, -46, case.clock[1])
        .scaled(31, -34, case.clock[0]);
    clock
        .scaled(16, -5, crs)
        .scaled(16, -43, delta_n)
        .scaled(32, -31, m0)
        .scaled(16, -29, cuc)
        .scaled(32, -33, case.eccentricity)
        .scaled(16, -29, cus)
        .scaled(32, -19, case.sqrt_a)
        .put(14, i64::from(case.toe_ms / 60_000))
        .scaled(16, -29, cic)
        .scaled(32, -31, omega0)
        .scaled(16, -29, cis)
        .scaled(32, -31, i0)
        .scaled(16, -5, crc)
        .scaled(32, -31, omega)
        .scaled(24, -43, omegadot)
}

/// Event of the input, by value.
#[derive(Debug)]
pub(crate) enum Seen {
    Epoch(Box<RawEpoch>),
    Ephemeris(raim_firmware::ephemeris::Ephemeris),
    Position(raim_core::frame::Ecef),
    Redated(raim_firmware::time::GpsTime),
    Rivalry(raim_firmware::input::Rivalry),
}

/// Feeds bytes and collects all events.
pub(crate) fn feed(input: &mut Input, bytes: &[u8]) -> Vec<Seen> {
    let mut seen = Vec::new();
    input.feed(bytes, 0, |event| seen.push(Seen::from(event)));
    seen
}

/// Reports silence of the line and collects all events.
pub(crate) fn silence(input: &mut Input) -> Vec<Seen> {
    let mut seen = Vec::new();
    input.silence(|event| seen.push(Seen::from(event)));
    seen
}

/// Reports a silence beyond any pause inside an epoch, and collects all events.
pub(crate) fn end_epoch(input: &mut Input) -> Vec<Seen> {
    let mut seen = Vec::new();
    input.end_epoch(|event| seen.push(Seen::from(event)));
    seen
}

impl From<Event<'_>> for Seen {
    fn from(event: Event<'_>) -> Self {
        match event {
            Event::Epoch(epoch, _) => Self::Epoch(Box::new(epoch.clone())),
            Event::Ephemeris(ephemeris) => Self::Ephemeris(ephemeris),
            Event::Position(position) => Self::Position(position),
            Event::Redated(present) => Self::Redated(present),
            Event::Rivalry(rivalry) => Self::Rivalry(rivalry),
            other => unreachable!("RTCM does not say {other:?}"),
        }
    }
}

/// Returns the epochs among the events.
pub(crate) fn epochs(seen: Vec<Seen>) -> Vec<RawEpoch> {
    seen.into_iter()
        .filter_map(|seen| if let Seen::Epoch(epoch) = seen { Some(*epoch) } else { None })
        .collect()
}
