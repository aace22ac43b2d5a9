//! Checksums of frames and sentences, written from their standards without any code of the
//! firmware.
//!
//! | format | checksum |
//! |---|---|
//! | RTCM 3 | CRC-24Q over header and payload ([RTCM-10403.3] 4.2) |
//! | UBX | two sums from the class on ([UBX-F9] 3.4) |
//! | SBF | CRC-16 with the polynomial 1021 from the number of the block on ([SBF] 4.1.1) |
//! | NMEA 0183 | exclusive or of the bytes between `$` and `*` |
//!
//! [RTCM-10403.3]: crate#references
//! [SBF]: crate#references
//! [UBX-F9]: crate#references

/// CRC-24Q of each byte, bit by bit, followed by no, one, two and three bytes of zeros, in the
/// upper bits of a word.
static PARITIES: [[u32; 256]; 4] = {
    const POLYNOMIAL: u32 = 0x0186_4CFB << 8;
    let mut parities = [[0; 256]; 4];
    let mut index = 0;
    while index < 1024 {
        let (behind, byte) = (index / 256, index % 256);
        let (mut crc, mut bit) = ((byte as u32) << 24, 0);
        while bit < 8 * (behind + 1) {
            crc = (crc << 1) ^ if crc >> 31 == 0 { 0 } else { POLYNOMIAL };
            bit += 1;
        }
        parities[behind][byte] = crc;
        index += 1;
    }
    parities
};

/// Returns the parity that ends an RTCM frame.
pub fn crc24q(bytes: &[u8]) -> [u8; 3] {
    let (words, rest) = bytes.as_chunks::<4>();
    let crc = words.iter().fold(0_u32, |crc, word| {
        let [first, second, third, last] = (crc ^ u32::from_be_bytes(*word)).to_be_bytes();
        PARITIES[3][usize::from(first)]
            ^ PARITIES[2][usize::from(second)]
            ^ PARITIES[1][usize::from(third)]
            ^ PARITIES[0][usize::from(last)]
    });
    let crc = rest.iter().fold(crc, |crc, byte| {
        let first = (crc >> 24) as u8 ^ byte;
        crc << 8 ^ PARITIES[0][usize::from(first)]
    });
    let [parity @ .., _] = crc.to_be_bytes();
    parity
}

/// Returns the two sums that end a UBX frame, over the bytes from its class on.
pub fn fletcher(bytes: &[u8]) -> [u8; 2] {
    let (mut a, mut b) = (0_u8, 0_u8);
    for byte in bytes {
        a = a.wrapping_add(*byte);
        b = b.wrapping_add(a);
    }
    [a, b]
}

/// Returns the CRC of an SBF block, over the bytes from its number on, bit by bit.
pub fn crc16(bytes: &[u8]) -> [u8; 2] {
    const POLYNOMIAL: u16 = 0x1021;
    let crc = bytes.iter().fold(0, |crc, byte| {
        (0..8).fold(crc ^ u16::from(*byte) << 8, |crc, _| {
            (crc << 1) ^ if crc >> 15 == 1 { POLYNOMIAL } else { 0 }
        })
    });
    crc.to_le_bytes()
}

/// Frames a payload of at most 1023 bytes, of any content, with preamble, length and parity.
pub fn rtcm_frame(payload: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(payload.len() + 6);
    bytes.extend_from_slice(&[0xD3, (payload.len() >> 8) as u8, payload.len() as u8]);
    bytes.extend_from_slice(payload);
    let parity = crc24q(&bytes);
    bytes.extend_from_slice(&parity);
    bytes
}

/// Returns a sentence with `$`, checksum and line end.
pub fn nmea_line(body: &str) -> String {
    format!("${body}*{:02X}\r\n", body.bytes().fold(0_u8, |sum, byte| sum ^ byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checks_are_those_that_the_standards_print() {
        // The examples are RTCM's message 1005, u-blox's poll of MON-VER, and a sentence common in
        // descriptions of NMEA.
        let station = [
            0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98, 0x0E, 0xDE, 0xEF, 0x34, 0xB4, 0xBD, 0x62, 0xAC, 0x09, 0x41,
            0x98, 0x6F, 0x33,
        ];
        assert_eq!(rtcm_frame(&station)[22..], [0x36, 0x0B, 0x98]);
        assert_eq!(fletcher(&[0x0A, 0x04, 0, 0]), [0x0E, 0x34]);
        // CRC-16/XMODEM in the catalogue of Greg Cook.
        assert_eq!(crc16(b"123456789"), [0xC3, 0x31]);
        assert!(nmea_line("GPGLL,4916.45,N,12311.12,W,225444,A,").ends_with("*1D\r\n"));
    }
}
