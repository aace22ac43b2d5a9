//! Corrected checksums: without them a mutation would hardly ever pass the first check.

use raim::signal::checksum::{crc16, crc24q, fletcher};

/// First byte of an RTCM frame, and bytes before and after its payload.
const RTCM: u8 = 0xD3;
const RTCM_HEADER: usize = 3;
const RTCM_PARITY: usize = 3;

/// First bytes of a UBX frame, and bytes before and after its payload.
const UBX: [u8; 2] = [0xB5, 0x62];
const UBX_HEADER: usize = 6;
const UBX_PARITY: usize = 2;

/// First bytes of an SBF block, and bytes before those that its CRC covers.
const SBF: [u8; 2] = *b"$@";
const SBF_UNCHECKED: usize = 4;

/// Corrects the checksum of every frame that its length field delimits.
pub(super) fn seal_frames(bytes: &mut [u8]) {
    let mut rest = bytes;
    while !rest.is_empty() {
        let length = seal_first(rest).unwrap_or(1);
        rest = &mut rest[length..];
    }
}

/// Corrects the checksum of the first frame; returns its length if it is complete.
fn seal_first(bytes: &mut [u8]) -> Option<usize> {
    match *bytes {
        [RTCM, high, low, ..] if high & 0b1111_1100 == 0 => {
            let covered = RTCM_HEADER + usize::from(u16::from_be_bytes([high, low]));
            let frame = bytes.get_mut(..covered + RTCM_PARITY)?;
            let (covered, parity) = frame.split_at_mut(covered);
            parity.copy_from_slice(&crc24q(covered));
            Some(frame.len())
        }
        [first, second, _, _, low, high, ..] if [first, second] == UBX => {
            let covered = UBX_HEADER + usize::from(u16::from_le_bytes([low, high]));
            let frame = bytes.get_mut(..covered + UBX_PARITY)?;
            let (covered, parity) = frame.split_at_mut(covered);
            parity.copy_from_slice(&fletcher(&covered[2..]));
            Some(frame.len())
        }
        [first, second, _, _, _, _, low, high, ..] if [first, second] == SBF => {
            let block = bytes.get_mut(..usize::from(u16::from_le_bytes([low, high])))?;
            let (head, covered) = block.split_at_mut_checked(SBF_UNCHECKED)?;
            head[2..].copy_from_slice(&crc16(covered));
            Some(block.len())
        }
        _ => None,
    }
}

/// Corrects the checksum of every line with a star.
pub(super) fn seal_lines(bytes: &[u8]) -> Vec<u8> {
    bytes.split_inclusive(|&byte| byte == b'\n').flat_map(sealed_line).collect()
}

fn sealed_line(line: &[u8]) -> Vec<u8> {
    let (Some(start), Some(star)) =
        (line.iter().rposition(|&byte| byte == b'$'), line.iter().rposition(|&byte| byte == b'*'))
    else {
        return line.to_vec();
    };
    let Some(body) = line.get(start + 1..star) else { return line.to_vec() };
    let checksum = body.iter().fold(0, |sum, byte| sum ^ byte);
    [&line[..=star], format!("{checksum:02X}\r\n").as_bytes()].concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzing::seeds::STATION;

    #[test]
    fn frame_gets_the_parity_of_the_standards_example() {
        let mut have = [&[0x55], &STATION[..]].concat();
        have[23..].fill(0);
        seal_frames(&mut have);
        assert_eq!(have[1..], STATION);
    }

    #[test]
    fn ubx_frame_gets_the_sums_of_the_makers_example() {
        // MON-VER polled, `B5 62 0A 04 00 00 0E 34`, after a stray byte.
        let mut have = [0xB5, 0xB5, 0x62, 0x0A, 0x04, 0, 0, 0, 0];
        seal_frames(&mut have);
        assert_eq!(have, [0xB5, 0xB5, 0x62, 0x0A, 0x04, 0, 0, 0x0E, 0x34]);
    }

    #[test]
    fn block_of_sbf_gets_the_crc_of_a_recorded_one() {
        // EndOfMeas of a mosaic.
        let want =
            [0x24, 0x40, 0x86, 0x20, 0x22, 0x17, 0x10, 0, 0x48, 0x1E, 0xAB, 0x0C, 0x38, 0x09, 0x44, 0x10];
        let mut have = want;
        have[2..4].fill(0);
        seal_frames(&mut have);
        assert_eq!(have, want);
        // A length shorter than the header seals nothing.
        have[6] = 2;
        seal_frames(&mut have);
    }

    #[test]
    fn line_gets_its_checksum_and_what_is_none_stays() {
        assert_eq!(seal_lines(b"noise$PRAIC,HAL,40*\n$PRAIC\n"), b"noise$PRAIC,HAL,40*08\r\n$PRAIC\n");
    }
}
