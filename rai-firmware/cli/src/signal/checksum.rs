//! Checksums of frames and sentences, without any code of the firmware.
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

use crc::{CRC_16_XMODEM, CRC_24_LTE_A, Crc, Table};

/// CRC-24Q, which LTE uses too.
static CRC_24Q: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_24_LTE_A);

/// Returns the parity that ends an RTCM frame.
pub fn crc24q(bytes: &[u8]) -> [u8; 3] {
    let [_, parity @ ..] = CRC_24Q.checksum(bytes).to_be_bytes();
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

/// Returns the CRC of an SBF block, over the bytes from its number on.
pub fn crc16(bytes: &[u8]) -> [u8; 2] {
    static CRC: Crc<u16> = Crc::<u16>::new(&CRC_16_XMODEM);
    CRC.checksum(bytes).to_le_bytes()
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
