//! UBX as SBF: the same ranges and navigation bits as a Septentrio receiver would send them.
//!
//! | UBX | SBF |
//! |---|---|
//! | RXM-RAWX | `MeasEpoch`: a satellite's first signal as type 1, its others as type 2 |
//! | RXM-SFRBX | `GPSRawCA`, `GPSRawL2C`, `GPSRawL5`, `QZSRawL1CA`, `QZSRawL2C`, `QZSRawL5`, `GALRawINAV`, `GALRawFNAV`, `BDSRaw`, `GLORawCA` |
//!
//! All other messages are left out. Ranges are rounded to 1 mm, C/N0 to 0.25 dB-Hz. Reference:
//! [SBF].
//!
//! [SBF]: crate#references

use raim_firmware::time::GpsTime;

use crate::signal::checksum::crc16;

/// A signal of UBX: its number in SBF, and its frequency, MHz.
type Signal = (u8, f64);

const CHIP_MHZ: f64 = 10.23;

/// Returns a block: header with CRC, time and body, filled with zeros to a multiple of four bytes.
pub fn block(number: u16, time: GpsTime, body: &[u8]) -> Vec<u8> {
    let mut bytes = vec![b'$', b'@', 0, 0];
    let length = (14 + body.len()).next_multiple_of(4);
    bytes.extend(number.to_le_bytes());
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(time.tow_ms.to_le_bytes());
    bytes.extend(time.week.to_le_bytes());
    bytes.extend(body);
    bytes.resize(length, 0);
    sealed(bytes)
}

/// Returns the block with a correct CRC.
pub fn sealed(mut block: Vec<u8>) -> Vec<u8> {
    if let Some((head, checked)) = block.split_at_mut_checked(4) {
        head[2..].copy_from_slice(&crc16(checked));
    }
    block
}

/// Returns the blocks of whole frames of UBX, whose navigation bits came at `time`.
pub fn of_ubx(frames: &[u8], time: GpsTime) -> Vec<u8> {
    let (mut blocks, mut rest) = (Vec::new(), frames);
    while let [0xB5, 0x62, class, id, low, high, behind @ ..] = rest {
        let length = usize::from(u16::from_le_bytes([*low, *high]));
        let Some((payload, next)) = behind.split_at_checked(length) else { break };
        blocks.extend(match (class, id) {
            (0x02, 0x15) => meas_epoch(payload),
            (0x02, 0x13) => raw_bits(payload, time).unwrap_or_default(),
            _ => Vec::new(),
        });
        rest = next.get(2..).unwrap_or_default();
    }
    blocks
}

/// Returns the number of a satellite in SBF.
fn svid(system: u8, number: u8) -> Option<u8> {
    match (system, number) {
        (0, 1..=32) => Some(number),
        (6, 1..=24) => Some(number + 37),
        (2, 1..=36) => Some(number + 70),
        (3, 1..=40) => Some(number + 140),
        (3, 41..=63) => Some(number + 182),
        (5, 1..=10) => Some(number + 180),
        _ => None,
    }
}

/// Returns the signal with these numbers of UBX.
fn signal(system: u8, signal: u8, channel: u8) -> Option<Signal> {
    let k = f64::from(channel) - 7.0;
    let (number, chips) = match (system, signal) {
        (0, 0) => (0, 154.0),
        (0, 3 | 4) => (3, 120.0),
        (0, 6 | 7) => (4, 115.0),
        (5, 0) => (6, 154.0),
        (5, 4 | 5) => (7, 120.0),
        (5, 8 | 9) => (26, 115.0),
        (2, 0 | 1) => (17, 154.0),
        (2, 3 | 4) => (20, 115.0),
        (2, 5 | 6) => (21, 118.0),
        (3, 0 | 1) => (28, 152.6),
        (3, 2 | 3) => (29, 118.0),
        (3, 4 | 10) => (30, 124.0),
        (3, 5 | 6) => (13, 154.0),
        (3, 7 | 8) => (14, 115.0),
        (6, 0) => return Some((8, 1602.0 + 0.5625 * k)),
        (6, 2) => return Some((11, 1246.0 + 0.4375 * k)),
        _ => return None,
    };
    Some((number, chips * CHIP_MHZ))
}

/// A measurement of RAWX.
struct Measured {
    satellite: [u8; 2],
    signal: Signal,
    channel: u8,
    range_mm: i64,
    /// Doppler frequency, 0.1 mHz.
    doppler: Option<f64>,
    cn0: u8,
}

impl Measured {
    fn of(bytes: &[u8]) -> Option<Self> {
        let range_m = f64::from_le_bytes(*bytes.first_chunk()?);
        let doppler_hz = f32::from_le_bytes(*bytes.get(16..)?.first_chunk()?);
        let &[system, number, signal_number, channel] = bytes.get(20..24)? else { return None };
        let is_valid = bytes.get(30)? & 1 == 1;
        is_valid.then_some(Self {
            satellite: [system, number],
            signal: signal(system, signal_number, channel)?,
            channel,
            range_mm: (range_m * 1e3).round() as i64,
            doppler: doppler_hz.is_finite().then(|| f64::from(doppler_hz) * 1e4),
            cn0: (4 * bytes.get(26)?.saturating_sub(10)).min(254),
        })
    }

    /// Returns the information of a sub-block of type 1: the channel of GLONASS.
    fn information(&self) -> u8 {
        if self.satellite[0] == 6 { (self.channel + 1) << 3 } else { 0 }
    }

    /// Returns the sub-block of type 1, before the number of others.
    fn first(&self, svid: u8) -> [u8; 19] {
        let range_mm = self.range_mm.cast_unsigned();
        let doppler = self.doppler.map_or(i32::MIN, |doppler| doppler.round() as i32).to_le_bytes();
        let low = (range_mm as u32).to_le_bytes();
        let mut bytes = [0; 19];
        bytes[1..4].copy_from_slice(&[self.signal.0, svid, (range_mm >> 32) as u8 & 15]);
        bytes[4..8].copy_from_slice(&low);
        bytes[8..12].copy_from_slice(&doppler);
        bytes[14..16].copy_from_slice(&[0x80, self.cn0]);
        bytes[18] = self.information();
        bytes
    }

    /// Returns the sub-block of type 2 behind the first signal.
    fn further(&self, main: &Self) -> [u8; 12] {
        let code = offset(self.range_mm - main.range_mm, 3);
        let doppler = self
            .doppler
            .zip(main.doppler)
            .map(|(own, main_doppler)| (own - main_doppler * self.signal.1 / main.signal.1).round() as i64);
        let doppler = offset(doppler.unwrap_or(i64::MIN), 5);
        let high = (code >> 16) as u8 & 7 | (doppler >> 16 << 3) as u8;
        let [code, doppler] = [code, doppler].map(|field| (field as u16).to_le_bytes());
        [self.signal.0, 0, self.cn0, high, 0x80, 0, code[0], code[1], 0, 0, doppler[0], doppler[1]]
    }
}

/// Returns a difference, or the number that marks a missing one if it does not fit an MSB of so
/// many bits and an LSB.
fn offset(difference: i64, bits: u32) -> i64 {
    let none = -1_i64 << (15 + bits);
    if (none + 1..-none).contains(&difference) { difference } else { none }
}

fn meas_epoch(payload: &[u8]) -> Vec<u8> {
    let Some((header, measurements)) = payload.split_at_checked(16) else { return Vec::new() };
    let tow_s = header.first_chunk().map_or(0.0, |bytes| f64::from_le_bytes(*bytes));
    let time =
        GpsTime { week: u16::from_le_bytes([header[8], header[9]]), tow_ms: (tow_s * 1e3).round() as u32 };
    let measured: Vec<Measured> = measurements.chunks_exact(32).filter_map(Measured::of).collect();
    let mut body = vec![0, 20, 12, 0, 0, 0];
    for signals in measured.chunk_by(|before, after| before.satellite == after.satellite) {
        let Some((main, others)) = signals.split_first() else { continue };
        let Some(svid) = svid(main.satellite[0], main.satellite[1]) else { continue };
        body[0] += 1;
        body.extend(main.first(svid));
        body.push(others.len() as u8);
        body.extend(others.iter().flat_map(|other| other.further(main)));
    }
    block(4027, time, &body)
}

/// Returns the block of navigation bits, if SBF has one for them.
fn raw_bits(payload: &[u8], time: GpsTime) -> Option<Vec<u8>> {
    let &[system, number, signal_number, channel, ..] = payload else { return None };
    let words: Vec<u32> =
        payload.get(8..)?.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
    let (source, _) = signal(system, signal_number, channel)?;
    let (number_of_block, words) = match (system, source) {
        (0, 0) => (4017, words.iter().map(|word| word & 0x3FFF_FFFF).collect()),
        (5, 6) => (4066, words.iter().map(|word| word & 0x3FFF_FFFF).collect()),
        (0, 3) => (4018, words),
        (0, 4) => (4019, words),
        (5, 7) => (4067, words),
        (5, 26) => (4068, words),
        (2, 20) => (4022, words),
        (2, _) => (4023, spliced(&words, &[(0, 114), (128, 120)])),
        (3, 28..=30) => {
            (4047, spliced(&words, &[2, 34, 66, 98, 130, 162, 194, 226, 258, 290].map(|at| (at, 30))))
        }
        (6, _) => (4026, words.get(..3)?.to_vec()),
        _ => return None,
    };
    let mut body = vec![svid(system, number)?, 1, 0, source, channel + 1, 0];
    body.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    Some(block(number_of_block, time, &body))
}

/// Returns parts of words, without gaps: each its first bit and its length.
fn spliced(words: &[u32], parts: &[(usize, usize)]) -> Vec<u32> {
    let bit = |at: usize| words.get(at / 32).is_some_and(|word| word >> (31 - at % 32) & 1 == 1);
    let bits: Vec<bool> =
        parts.iter().flat_map(|&(start, length)| (start..start + length).map(bit)).collect();
    let word = |bits: &[bool]| {
        (0..32).fold(0, |word, at| word << 1 | u32::from(bits.get(at).copied().unwrap_or(false)))
    };
    bits.chunks(32).map(word).collect()
}
