//! CRC-24Q, the check of an RTCM frame and of a Galileo page.
//!
//! Zero bits in front do not change it, so that a page of any number of bits becomes whole bytes.
//!
//! References: [RTCM-10403.3] 4.2; [OS-SIS-ICD] 5.1.9.4.
//!
//! [OS-SIS-ICD]: crate#references
//! [RTCM-10403.3]: crate#references

/// Returns the CRC of bytes; zero if they end in their valid parity.
///
/// The remainder is kept in the upper bits of a word, four bytes enter it at once, and a table
/// takes half a byte out of it.
pub(super) fn crc24q(bytes: &[u8]) -> u32 {
    const POLYNOMIAL: u32 = 0x0186_4CFB << 8;
    /// Remainder of each value of the upper four bits.
    const TABLE: [u32; 16] = {
        let mut table = [0; 16];
        let mut index = 0;
        while index < 16 {
            let mut crc = (index as u32) << 28;
            let mut bit = 0;
            while bit < 4 {
                crc = (crc << 1) ^ if crc & 1 << 31 == 0 { 0 } else { POLYNOMIAL };
                bit += 1;
            }
            table[index] = crc;
            index += 1;
        }
        table
    };
    let half = |crc: u32| crc << 4 ^ TABLE[(crc >> 28) as usize];
    let byte = |crc| half(half(crc));
    // Written out, because a loop would cost as much again.
    let word = |crc| byte(byte(byte(byte(crc))));
    let (words, rest) = bytes.as_chunks::<4>();
    let crc = words.iter().fold(0, |crc, next| word(crc ^ u32::from_be_bytes(*next)));
    rest.iter().fold(crc, |crc, &next| byte(crc ^ u32::from(next) << 24)) >> 8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crc_of_the_example_of_the_standard() {
        // [RTCM-10403.3] 4.2: the reference station message 1005 and its CRC.
        let frame = [
            0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98, 0x0E, 0xDE, 0xEF, 0x34, 0xB4, 0xBD, 0x62,
            0xAC, 0x09, 0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98,
        ];
        assert_eq!(crc24q(&frame[..22]), 0x36_0B98);
        assert_eq!(crc24q(&frame), 0);
        assert_eq!(crc24q(&[&[0, 0], &frame[..22]].concat()), 0x36_0B98);
    }
}
