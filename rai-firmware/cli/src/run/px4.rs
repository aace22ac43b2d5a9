//! `GLOBAL_POSITION_SENSOR`: the message of `MAVLink` by which PX4 takes a position from outside.
//!
//! PX4 reads no `GPS_INPUT`. Since 2026 it reads `GLOBAL_POSITION_SENSOR` (PX4-Autopilot#26307) and
//! fuses it as an auxiliary position. Here each `GPS_INPUT` of the module becomes one, if it has a
//! fix, that is while the position is protected. Without a fix nothing is sent, and the position of
//! before grows old at the other end. Other frames are passed on. All are numbered anew, because a
//! number that is missing counts as a loss.
//!
//! | field | from |
//! |---|---|
//! | `lat`, `lon`, `alt`, `time_usec` | `GPS_INPUT` |
//! | `alt_ellipsoid` | `alt`, and the geoid above the ellipsoid there |
//! | `eph`, `epv` | its accuracies, which also cover the protection levels |
//! | `id` | [`SENSOR`], which is a parameter of PX4 |
//! | `source` | GNSS |
//!
//! References: `common.xml` of `MAVLink`, message 296; the serialization guide of `MAVLink`.

use std::io::{self, Write};

use raim_core::frame::Geodetic;
use raim_firmware::output::geoid::Altitude;
use raim_firmware::output::mavlink::dialect::{GNSS_INTEGRITY, GPS_INPUT, HEARTBEAT};

/// Number of the message, and the seed of its checksum.
const GLOBAL_POSITION_SENSOR: (u32, u8) = (296, 158);
/// Number of the sensor.
pub(super) const SENSOR: u8 = 1;
/// GNSS among the sources of a position.
const SOURCE_GNSS: u8 = 1;
/// Bytes of the whole payload of `GPS_INPUT`, of which zeros at the end are not sent.
const GPS_INPUT_BYTES: usize = 63;
/// Fix type of `GPS_INPUT` with a position.
const FIX_3D: u8 = 3;
/// Bytes in front of the payload, and behind it.
const HEADER: usize = 10;
const CHECKSUM: usize = 2;

/// A writer that gets what PX4 reads.
pub(super) struct Px4<W> {
    out: W,
    number: u8,
}

impl<W: Write> Px4<W> {
    pub(super) const fn new(out: W) -> Self {
        Self { out, number: 0 }
    }

    fn send(&mut self, mut frame: Vec<u8>, seed: u8) -> io::Result<()> {
        if let Some(number) = frame.get_mut(4) {
            *number = self.number;
        }
        self.number = self.number.wrapping_add(1);
        let sum = checksum(frame.get(1..).unwrap_or_default(), seed);
        frame.extend(sum.to_le_bytes());
        self.out.write_all(&frame)
    }
}

impl<W: Write> Write for Px4<W> {
    /// Takes one frame, whole.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let taken = bytes.len();
        let Some((header, payload)) = parts(bytes) else { return Ok(taken) };
        let id = u32::from_le_bytes([header[7], header[8], header[9], 0]);
        if id == GPS_INPUT.id {
            if let Some(sensor) = position(payload) {
                let [low, middle, high, _] = GLOBAL_POSITION_SENSOR.0.to_le_bytes();
                let mut frame = header.to_vec();
                frame[1] = sensor.len() as u8;
                frame[7..].copy_from_slice(&[low, middle, high]);
                frame.extend(sensor);
                self.send(frame, GLOBAL_POSITION_SENSOR.1)?;
            }
        } else if let Some(layout) = [HEARTBEAT, GNSS_INTEGRITY].iter().find(|layout| layout.id == id) {
            self.send([&header[..], payload].concat(), layout.crc_extra)?;
        }
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Returns the header and the payload of a frame.
fn parts(frame: &[u8]) -> Option<([u8; HEADER], &[u8])> {
    let (header, rest) = frame.split_first_chunk::<HEADER>()?;
    let payload = rest.get(..rest.len().checked_sub(CHECKSUM)?)?;
    (payload.len() == usize::from(header[1])).then_some((*header, payload))
}

/// Returns the payload of `GLOBAL_POSITION_SENSOR` for one of `GPS_INPUT`; `None` without a fix.
fn position(payload: &[u8]) -> Option<Vec<u8>> {
    let mut whole = [0; GPS_INPUT_BYTES];
    whole.get_mut(..payload.len())?.copy_from_slice(payload);
    let word = |at: usize| whole.get(at..at + 4)?.try_into().ok();
    let (latitude, longitude) = (i32::from_le_bytes(word(12)?), i32::from_le_bytes(word(16)?));
    let float = |at: usize| word(at).map(f32::from_le_bytes);
    let (above_sea_m, horizontal_m, vertical_m) = (float(20)?, float(48)?, float(52)?);
    if *whole.get(61)? != FIX_3D {
        return None;
    }
    let radians = |angle: i32| (f64::from(angle) * 1e-7).to_radians();
    let place =
        Geodetic { latitude_rad: radians(latitude), longitude_rad: radians(longitude), height_m: 0.0 };
    let ellipsoid_m = f64::from(above_sea_m) + Altitude::of(&place).separation_m;
    let mut sensor = whole.get(..8)?.to_vec();
    // The measurement is of that time: nothing is to be subtracted.
    sensor.extend(0_u32.to_le_bytes());
    sensor.extend(latitude.to_le_bytes());
    sensor.extend(longitude.to_le_bytes());
    for value in [ellipsoid_m as f32, above_sea_m, horizontal_m, vertical_m] {
        sensor.extend(value.to_le_bytes());
    }
    // Every system and component; the flags that nothing is wrong would be zeros, which are not sent.
    sensor.extend([0, 0, SENSOR, SOURCE_GNSS]);
    Some(sensor)
}

/// Returns CRC-16/MCRF4XX of bytes and of the seed of their message.
fn checksum(bytes: &[u8], seed: u8) -> u16 {
    bytes.iter().chain([&seed]).fold(0xFFFF, |sum: u16, byte| {
        (0..8).fold(sum ^ u16::from(*byte), |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0x8408 } else { sum >> 1 })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A catalogue of CRCs (reveng) has this check value of CRC-16/MCRF4XX.
    #[test]
    fn checksum_is_that_of_the_catalogue() {
        assert_eq!(checksum(b"12345678", b'9'), 0x6F91);
    }

    fn frame(fix: u8) -> Vec<u8> {
        let mut payload = [0; GPS_INPUT_BYTES];
        payload[..8].copy_from_slice(&1_700_000_000_000_000_u64.to_le_bytes());
        payload[12..16].copy_from_slice(&340_000_000_i32.to_le_bytes());
        payload[16..20].copy_from_slice(&(-1_085_700_000_i32).to_le_bytes());
        payload[20..24].copy_from_slice(&435.5_f32.to_le_bytes());
        payload[48..52].copy_from_slice(&2.5_f32.to_le_bytes());
        payload[52..56].copy_from_slice(&4.5_f32.to_le_bytes());
        payload[61] = fix;
        payload[62] = 9;
        [&[0xFD, 63, 0, 0, 77, 1, 220, 232, 0, 0], &payload[..], &[0, 0]].concat()
    }

    #[test]
    fn position_is_sent_with_a_fix_alone_and_numbered_without_gaps() {
        let mut px4 = Px4::new(Vec::new());
        for fix in [3, 1, 0, 3] {
            px4.write_all(&frame(fix)).unwrap();
        }
        px4.write_all(b"$GNRMC,no,frame\r\n").unwrap();
        let (one, two) = px4.out.split_at(px4.out.len() / 2);
        assert_eq!((one.len(), one[4], two[4]), (HEADER + 40 + CHECKSUM, 0, 1));
        assert_eq!(one[5..10], [1, 220, 0x28, 1, 0]);
        let float = |value: f32| value.to_le_bytes();
        assert_eq!(one[HEADER + 24..HEADER + 36], [435.5, 2.5, 4.5].map(float).concat());
        assert_eq!(one[HEADER + 38..HEADER + 40], [SENSOR, SOURCE_GNSS]);
    }
}
