//! Parities and checksums of the navigation messages.
//!
//! The receiver sends only pages with a valid code. But the line to the module may flip a bit. The
//! checksum of a frame misses 1 error in 65,536, which is too many for an orbit.
//!
//! | message | code | over |
//! |---|---|---|
//! | GPS LNAV | extended Hamming (32, 26) | each word and the last two bits of the one before |
//! | Galileo | CRC-24Q (`input/crc24q.rs`) | each page |
//! | `BeiDou` D1, D2 | BCH (15, 11), `x⁴ + x + 1` | each eleven bits |
//! | GLONASS | extended Hamming (85, 77) | each string |
//!
//! References: [IS-GPS-200] table 20-XIV; [OS-SIS-ICD] 5.1.9.4; [BDS-SIS-B1I] 5.1.3; [GLO-ICD] 4.7.
//!
//! [IS-GPS-200]: crate#references
//! [OS-SIS-ICD]: crate#references
//! [BDS-SIS-B1I]: crate#references
//! [GLO-ICD]: crate#references

use crate::input::bits::Bits;

/// Bits of a GPS word and its predecessor that each parity bit covers: `D29* D30* d1 … d24`, then
/// the six parity bits.
const LNAV: [u32; 6] = [0xBB1F_3480, 0x5D8F_9A40, 0xAEC7_CD00, 0x5763_E680, 0x6BB1_F340, 0x8B7A_89C0];

/// Returns true if the parity of a GPS word in normal order holds.
///
/// Bits 31 and 30 are `D29*` and `D30*`, the last two bits of the word before. If `D30*` was 1, the
/// satellite has inverted the data, and normal order complements all 32 bits. The data are then
/// correct, and the parity and both bits are complemented. The equations also hold for the
/// complement, because each parity bit covers one of the two. Bit 30 is thus always 0. A 1 there
/// could hide a wrong `d21`, because both are in the same equations.
pub(super) fn is_lnav_word(word: u32) -> bool {
    const STAR_30: u32 = 1 << 30;
    let covered = word & 0xFFFF_FFC0;
    let parity = LNAV.iter().fold(0, |parity, mask| parity << 1 | (covered & mask).count_ones() & 1);
    parity == word & 0x3F && word & STAR_30 == 0
}

/// Returns true if a `BeiDou` word of 30 bits is valid. The code of a subframe's first word covers
/// only its last eleven information bits.
pub(super) fn is_beidou_word(word: u32, is_first: bool) -> bool {
    if is_first {
        return bch(word >> 4 & 0x7FF) == word & 15;
    }
    bch(word >> 19 & 0x7FF) == word >> 4 & 15 && bch(word >> 8 & 0x7FF) == word & 15
}

/// Returns the four parity bits of eleven bits.
fn bch(eleven: u32) -> u32 {
    const POLYNOMIAL: u32 = 0b1_0011;
    let divide = |rest: u32, position: u32| {
        if rest >> position & 1 == 1 { rest ^ POLYNOMIAL << (position - 4) } else { rest }
    };
    (4..15).rev().fold(eleven << 4, divide)
}

/// Returns true if a GLONASS string of 85 bits, with the idle bit first, is valid.
///
/// The last seven bits are the check bits of a Hamming code, the last one first. From the last one
/// on, its 77 data bits are numbered by the integers from 3 that are no power of two. The bit
/// before the last seven makes the number of ones even.
pub(super) fn is_glonass_string(bits: Bits<'_>) -> bool {
    // The interface document numbers the bits from the end: the first one sent is 85, the check
    // bits are 8 to 1.
    let bit = |number: usize| bits.is_set(85 - number);
    let mut syndrome = 0;
    let mut number = 2;
    for position in 9..=85 {
        number += 1;
        if usize::is_power_of_two(number) {
            number += 1;
        }
        if bit(position) {
            syndrome ^= number;
        }
    }
    let checks = (1..=7).fold(0, |checks, position| checks | usize::from(bit(position)) << (position - 1));
    let is_even = (1..=85).filter(|&position| bit(position)).count() % 2 == 0;
    syndrome == checks && is_even
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::bits::Packed;

    /// [IS-GPS-200] table 20-XIV: the data bits in each equation, and true if it begins with D29*,
    /// false for D30*.
    ///
    /// [IS-GPS-200]: crate#references
    const EQUATIONS: [(bool, &[u32]); 6] = [
        (true, &[1, 2, 3, 5, 6, 10, 11, 12, 13, 14, 17, 18, 20, 23]),
        (false, &[2, 3, 4, 6, 7, 11, 12, 13, 14, 15, 18, 19, 21, 24]),
        (true, &[1, 3, 4, 5, 7, 8, 12, 13, 14, 15, 16, 19, 20, 22]),
        (false, &[2, 4, 5, 6, 8, 9, 13, 14, 15, 16, 17, 20, 21, 23]),
        (false, &[1, 3, 5, 6, 7, 9, 10, 14, 15, 16, 17, 18, 21, 22, 24]),
        (true, &[3, 5, 6, 8, 9, 10, 11, 13, 15, 19, 22, 23, 24]),
    ];

    #[test]
    fn the_masks_are_the_equations_of_the_interface_document() {
        for (mask, (starts_with_29, terms)) in LNAV.into_iter().zip(EQUATIONS) {
            let star = if starts_with_29 { 1 << 31 } else { 1 << 30 };
            let want = terms.iter().fold(star, |mask, term| mask | 1 << (30 - term));
            assert_eq!(mask, want, "{mask:08x} {want:08x}");
        }
    }

    /// Returns the words that a receiver sends of one subframe, from the rules of [IS-GPS-200]
    /// 20.3.5.2 alone, and the number of them for which `D30*` was 1.
    ///
    /// [IS-GPS-200]: crate#references
    fn as_sent(data: [u32; 10]) -> ([u32; 10], usize) {
        let (mut star, mut inverted) = ([0, 0], 0);
        let words = data.map(|data| {
            let bit = |number: &u32| data >> (24 - number) & 1;
            let parity = EQUATIONS.iter().fold(0, |parity, (starts_with_29, terms)| {
                let first = if *starts_with_29 { star[0] } else { star[1] };
                parity << 1 | terms.iter().map(bit).fold(first, |sum, bit| sum ^ bit)
            });
            // The satellite sends the data inverted if D30* is 1.
            let broadcast = (if star[1] == 1 { !data & 0xFF_FFFF } else { data }) << 6 | parity;
            let word = star[0] << 31 | star[1] << 30 | broadcast;
            let sent = if star[1] == 1 { !word } else { word };
            inverted += usize::from(star[1] == 1);
            star = [parity >> 1 & 1, parity & 1];
            sent
        });
        (words, inverted)
    }

    /// Returns a source of random words.
    fn xorshift(mut state: u32) -> impl FnMut() -> u32 {
        move || {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            state
        }
    }

    #[test]
    fn words_pass_as_a_receiver_sends_them_and_with_one_or_two_wrong_bits_none_does() {
        let mut next = xorshift(0x9E37_79B9);
        let mut inverted = 0;
        for _ in 0..40 {
            let data = [(); 10].map(|()| next() & 0xFF_FFFF);
            let (words, of_them) = as_sent(data);
            inverted += of_them;
            for (word, data) in words.into_iter().zip(data) {
                assert!(is_lnav_word(word), "{word:08x}");
                assert_eq!(word >> 6 & 0xFF_FFFF, data, "the data are as meant");
                assert_eq!(word >> 30 & 1, 0, "D30* or its complement");
                for first in 0..32 {
                    for second in first..32 {
                        let wrong = word ^ 1 << first ^ if second > first { 1 << second } else { 0 };
                        assert!(!is_lnav_word(wrong), "{word:08x}: bits {first} and {second}");
                    }
                }
            }
        }
        assert!((100..300).contains(&inverted), "{inverted} of 400 words after a word that ends in 1");
    }

    #[test]
    fn every_single_and_double_error_of_eleven_bits_is_seen() {
        let right = |eleven: u32| 0b101_0101_0101_0101 << 15 | eleven << 4 | bch(eleven);
        let word = right(0b110_0110_0111);
        assert!(is_beidou_word(word, true));
        for first in 0..15 {
            assert!(!is_beidou_word(word ^ 1 << first, true), "{first}");
        }
        assert!(is_beidou_word(0, false), "a linear code has the zero word");
    }

    /// The sums of positions in the interface document as masks, in hexadecimal, as in receivers'
    /// software.
    const GLONASS: [[u8; 11]; 8] = [
        [0x55, 0x55, 0x5A, 0xAA, 0xAA, 0xAA, 0xB5, 0x55, 0x6A, 0xD8, 0x08],
        [0x66, 0x66, 0x6C, 0xCC, 0xCC, 0xCC, 0xD9, 0x99, 0xB3, 0x68, 0x10],
        [0x87, 0x87, 0x8F, 0x0F, 0x0F, 0x0F, 0x1E, 0x1E, 0x3C, 0x70, 0x20],
        [0x07, 0xF8, 0x0F, 0xF0, 0x0F, 0xF0, 0x1F, 0xE0, 0x3F, 0x80, 0x40],
        [0xF8, 0x00, 0x0F, 0xFF, 0xF0, 0x00, 0x1F, 0xFF, 0xC0, 0x00, 0x80],
        [0x00, 0x00, 0x0F, 0xFF, 0xFF, 0xFF, 0xE0, 0x00, 0x00, 0x01, 0x00],
        [0xFF, 0xFF, 0xF0, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x02, 0x00],
        [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xF8],
    ];

    fn masks_hold(bytes: &[u8; 11]) -> bool {
        GLONASS.iter().all(|mask| {
            mask.iter().zip(bytes).map(|(mask, byte)| (mask & byte).count_ones()).sum::<u32>() % 2 == 0
        })
    }

    #[test]
    fn glonass_strings_are_judged_as_by_the_masks() {
        let mut next = xorshift(0x2545_F491);
        let mut right = 0;
        for _ in 0..20_000 {
            let mut packed = Packed::<11>::new();
            packed.push(next(), 32);
            packed.push(next(), 32);
            packed.push(next(), 21);
            // Half of the strings get valid check bits from the masks, so that both outcomes occur.
            let mut bytes = packed.bytes;
            if next() & 1 == 0 {
                for (mask, bit) in GLONASS.iter().zip([84, 83, 82, 81, 80, 79, 78, 77]) {
                    let odd = mask.iter().zip(&bytes).map(|(m, b)| (m & b).count_ones()).sum::<u32>() % 2;
                    bytes[bit / 8] ^= (odd as u8) << (7 - bit % 8);
                }
            }
            right += usize::from(masks_hold(&bytes));
            assert_eq!(is_glonass_string(Bits(&bytes)), masks_hold(&bytes), "{bytes:02x?}");
        }
        assert!(right > 5_000, "{right}");
    }
}
