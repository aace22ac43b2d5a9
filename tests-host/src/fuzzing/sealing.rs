//! Checksums put right: without them a mutation would hardly ever get past the first test.

/// First byte of an RTCM frame.
const PREAMBLE: u8 = 0xD3;

/// Bytes before and after the payload of a frame.
const HEADER: usize = 3;
const PARITY: usize = 3;

/// Gives every frame, as far as its length field lets one tell, the CRC-24Q that belongs to it.
pub(super) fn seal_frames(bytes: &mut [u8]) {
    let mut at = 0;
    while let Some(rest) = bytes.get_mut(at..) {
        let Some(&[first, high, low]) = rest.first_chunk::<HEADER>() else { return };
        let end = HEADER + (usize::from(high & 0b11) << 8 | usize::from(low));
        let is_frame = first == PREAMBLE && high & 0b1111_1100 == 0 && rest.len() >= end + PARITY;
        if is_frame {
            let (covered, parity) = rest.split_at_mut(end);
            parity[..PARITY].copy_from_slice(&crc24q(covered).to_be_bytes()[1..]);
        }
        at += if is_frame { end + PARITY } else { 1 };
    }
}

/// CRC-24Q ([RTCM-10403.3] 4.2), bit by bit.
///
/// [RTCM-10403.3]: crate#references
fn crc24q(bytes: &[u8]) -> u32 {
    let shifted =
        |crc: u32| if crc & 0x80_0000 == 0 { crc << 1 } else { (crc << 1 ^ 0x186_4CFB) & 0xFF_FFFF };
    bytes.iter().fold(0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte) << 16, |crc, _| shifted(crc)))
}

/// Gives every line that has a star the checksum that belongs to what stands before it.
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
    fn line_gets_its_checksum_and_what_is_none_stays() {
        assert_eq!(seal_lines(b"noise$PRAIC,HAL,40*\n$PRAIC\n"), b"noise$PRAIC,HAL,40*08\r\n$PRAIC\n");
    }
}
