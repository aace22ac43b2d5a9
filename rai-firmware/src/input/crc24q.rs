//! CRC-24Q, the check of an RTCM frame and of a Galileo page.
//!
//! Zero bits in front do not change it, so that a page of any length can be padded to whole bytes.
//!
//! References: [RTCM-10403.3] 4.2; [OS-SIS-ICD] 5.1.9.4.
//!
//! [OS-SIS-ICD]: crate#references
//! [RTCM-10403.3]: crate#references

/// The generator polynomial, in the upper bits of a word.
const POLYNOMIAL: u32 = 0x0186_4CFB << 8;

/// Returns the CRC of bytes; zero if they end in their valid parity.
///
/// The remainder is in the upper bits of a word, and four bytes are added at once.
pub(super) fn crc24q(bytes: &[u8]) -> u32 {
    let (words, rest) = bytes.as_chunks::<4>();
    let crc = words.iter().fold(0, |crc, next| word(crc ^ u32::from_be_bytes(*next)));
    rest.iter().fold(crc, |crc, &next| byte(crc ^ u32::from(next) << 24)) >> 8
}

/// Returns the remainder after this many more bits.
const fn shifted(mut crc: u32, bits: u32) -> u32 {
    let mut bit = 0;
    while bit < bits {
        crc = (crc << 1) ^ if crc & 1 << 31 == 0 { 0 } else { POLYNOMIAL };
        bit += 1;
    }
    crc
}

/// Returns the remainder after eight more bits, by two steps of a small table.
fn byte(crc: u32) -> u32 {
    /// Remainder of each value of the upper four bits.
    const TABLE: [u32; 16] = {
        let mut table = [0; 16];
        let mut index = 0;
        while index < 16 {
            table[index] = shifted((index as u32) << 28, 4);
            index += 1;
        }
        table
    };
    let half = |crc: u32| crc << 4 ^ TABLE[(crc >> 28) as usize];
    half(half(crc))
}

/// Returns the remainder after 32 more bits.
// Written out, because a loop would cost as much again.
#[cfg(target_os = "none")]
fn word(crc: u32) -> u32 {
    byte(byte(byte(byte(crc))))
}

/// Returns the same by four tables of a kilobyte, which a host can afford. It takes a third of the
/// instructions.
#[cfg(not(target_os = "none"))]
fn word(crc: u32) -> u32 {
    /// Remainders of the lowest byte of a word, of the next one, and so on.
    const TABLES: [[u32; 256]; 4] = {
        let mut tables = [[0; 256]; 4];
        let mut index = 0;
        while index < 1024 {
            let (place, value) = (index / 256, index % 256);
            tables[place][value] = shifted((value as u32) << (8 * place), 32);
            index += 1;
        }
        tables
    };
    static OF_HOST: [[u32; 256]; 4] = TABLES;
    let [third, second, first, last] = crc.to_be_bytes().map(usize::from);
    OF_HOST[3][third] ^ OF_HOST[2][second] ^ OF_HOST[1][first] ^ OF_HOST[0][last]
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

    #[test]
    fn a_word_is_four_bytes() {
        for crc in (0..100_000_u32).map(|index| index.wrapping_mul(0x9E37_79B1)) {
            assert_eq!(word(crc), byte(byte(byte(byte(crc)))), "{crc:#x}");
        }
    }
}
