//! RTCM 3 written bit by bit from the tables of the standard: an encoder that shares nothing with the decoder.
#![allow(dead_code, reason = "each test program uses a part")]

use rai_core::satellite::Constellation;
use rai_firmware::rtcm::{Decoder, Event, RawEpoch};

use crate::orbits::Case;

/// Bits, most significant first.
#[derive(Clone, Default)]
pub struct Bits(Vec<bool>);

impl Bits {
    pub fn put(mut self, length: u32, value: i64) -> Self {
        self.0.extend((0..length).rev().map(|bit| value >> bit & 1 == 1));
        self
    }

    /// A number in units of `2^exponent`.
    pub fn scaled(self, length: u32, exponent: i32, value: f64) -> Self {
        self.put(length, (value / 2f64.powi(exponent)).round() as i64)
    }

    pub fn bytes(&self) -> Vec<u8> {
        let byte = |bits: &[bool]| (0..8).fold(0, |byte, i| byte << 1 | u8::from(bits.get(i) == Some(&true)));
        self.0.chunks(8).map(byte).collect()
    }
}

/// CRC-24Q, bit by bit.
pub fn crc24q(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte) << 16, |crc, _| {
            if crc & 0x80_0000 == 0 { crc << 1 } else { (crc << 1 ^ 0x186_4CFB) & 0xFF_FFFF }
        })
    })
}

/// A payload with preamble, length and parity.
pub fn frame(payload: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0xD3, (payload.len() >> 8) as u8, payload.len() as u8];
    bytes.extend_from_slice(payload);
    let parity = crc24q(&bytes);
    bytes.extend_from_slice(&parity.to_be_bytes()[1..]);
    bytes
}

/// One cell of an MSM: satellite, signal id of the standard, pseudorange in m, C/N0 in dB-Hz.
#[derive(Clone, Copy)]
pub struct Cell(pub u8, pub u8, pub f64, pub f64);

/// Signal ids of the standard.
pub const L1C: u8 = 2;
pub const L2W: u8 = 10;
pub const E1C: u8 = 2;
pub const E5A_Q: u8 = 23;
pub const B1I: u8 = 2;
pub const B3I: u8 = 8;

/// An MSM7 frame. Cells are sorted by satellite and signal, every satellite with the same signals.
pub fn msm7(number: u16, time: u32, more: bool, cells: &[Cell]) -> Vec<u8> {
    let mut satellites: Vec<u8> = cells.iter().map(|cell| cell.0).collect();
    let mut signals: Vec<u8> = cells.iter().map(|cell| cell.1).collect();
    for ids in [&mut satellites, &mut signals] {
        ids.sort_unstable();
        ids.dedup();
    }
    let find = |satellite, signal| cells.iter().find(|cell| (cell.0, cell.1) == (satellite, signal));
    let mut bits = Bits::default().put(12, i64::from(number)).put(12, 1).put(30, i64::from(time));
    bits = bits.put(1, i64::from(more)).put(18, 0);
    bits = (1..=64).fold(bits, |bits, id| bits.put(1, i64::from(satellites.contains(&id))));
    bits = (1..=32).fold(bits, |bits, id| bits.put(1, i64::from(signals.contains(&id))));
    for &satellite in &satellites {
        bits = signals
            .iter()
            .fold(bits, |bits, &signal| bits.put(1, i64::from(find(satellite, signal).is_some())));
    }
    // Rough range: whole and 1/1024 ms of the satellite's first cell; the fine part says the rest.
    let rough = |satellite| {
        let cell = cells.iter().find(|cell| cell.0 == satellite).unwrap();
        (cell.2 / 299_792.458 * 1024.0).round() as i64
    };
    bits = satellites.iter().fold(bits, |bits, &satellite| bits.put(8, rough(satellite) / 1024));
    bits = satellites.iter().fold(bits, |bits, _| bits.put(4, 0));
    bits = satellites.iter().fold(bits, |bits, &satellite| bits.put(10, rough(satellite) % 1024));
    bits = satellites.iter().fold(bits, |bits, _| bits.put(14, 0));
    let present: Vec<&Cell> =
        satellites.iter().flat_map(|&sat| signals.iter().filter_map(move |&sig| find(sat, sig))).collect();
    let fine = |cell: &Cell| cell.2 / 299_792.458 - rough(cell.0) as f64 / 1024.0;
    bits = present.iter().fold(bits, |bits, cell| bits.scaled(20, -29, fine(cell)));
    for (length, _) in [(24, "phase"), (10, "lock"), (1, "half cycle")] {
        bits = present.iter().fold(bits, |bits, _| bits.put(length, 0));
    }
    bits = present.iter().fold(bits, |bits, cell| bits.put(10, (cell.3 * 16.0) as i64));
    bits = present.iter().fold(bits, |bits, _| bits.put(15, 0));
    frame(&bits.bytes())
}

/// The ephemeris message of a case: 1019, 1042 or 1046.
pub fn ephemeris(case: &Case) -> Vec<u8> {
    let bits = match case.satellite.0 {
        Constellation::Gps => message_1019(case),
        Constellation::Beidou => message_1042(case),
        _ => message_1046(case),
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

fn message_1046(case: &Case) -> Bits {
    let [m0, omega0, i0, omega] = case.angles_sc();
    let [delta_n, omegadot, idot] = case.rates_sc_s();
    let [cuc, cus, crc, crs, cic, cis] = case.corrections;
    let start = Bits::default().put(12, 1046).put(6, i64::from(case.satellite.1));
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
        .put(10, -3)
        .put(10, 9)
        .put(6, 0)
        .put(2, 0)
}

/// What came out, by value.
#[derive(Debug)]
pub enum Seen {
    Epoch(RawEpoch),
    Ephemeris(rai_firmware::ephemeris::Ephemeris),
    Position(rai_core::frame::Ecef),
}

/// Feeds bytes and collects all events.
pub fn feed(decoder: &mut Decoder, bytes: &[u8]) -> Vec<Seen> {
    let mut seen = Vec::new();
    for &byte in bytes {
        let mut event = decoder.push(byte);
        while let Some(happened) = event {
            seen.push(match happened {
                Event::Epoch(epoch) => Seen::Epoch(epoch.clone()),
                Event::Ephemeris(ephemeris) => Seen::Ephemeris(ephemeris),
                Event::ReferencePosition(position) => Seen::Position(position),
            });
            event = decoder.pending();
        }
    }
    seen
}

/// The epochs among what came out.
pub fn epochs(seen: Vec<Seen>) -> Vec<RawEpoch> {
    seen.into_iter()
        .filter_map(|seen| if let Seen::Epoch(epoch) = seen { Some(epoch) } else { None })
        .collect()
}
