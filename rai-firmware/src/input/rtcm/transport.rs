//! Frames of RTCM 3.
//!
//! ```text
//! D3 | 000000 | length (10 bit) | payload (0 to 1023 bytes) | CRC-24Q over all before (24 bit)
//! ```
//!
//! Reference: [RTCM-10403.3] 4.
//!
//! [RTCM-10403.3]: crate#references

use super::Msm;
use crate::input::calendar::Calendar;
use crate::input::protocol::{Extent, Frame, Protocol};
use crate::input::{Counters, Message, Unread};

/// Bytes before and after the payload.
const HEADER: usize = 3;
const PARITY: usize = 3;

/// Format of RTCM 3.
#[derive(Debug)]
pub(in crate::input) struct Rtcm;

impl Protocol for Rtcm {
    const SYNC: &'static [u8] = &[0xD3];
    const LONGEST: usize = HEADER + 1023 + PARITY;

    type Memory = ();

    type Ranges<'a> = Msm<'a>;

    fn at_start() {}

    fn length(bytes: &[u8]) -> Extent {
        match *bytes {
            [_, high, low, ..] if high & 0b1111_1100 == 0 => {
                Extent::Bytes(HEADER + (usize::from(high) << 8 | usize::from(low)) + PARITY)
            }
            [_] | [_, _] => Extent::Unknown,
            _ => Extent::NoFrame,
        }
    }

    fn check(frame: &[u8]) -> bool {
        crc24q(frame) == 0
    }

    fn read<'a>(
        frame: &Frame<'a>,
        (): &mut (),
        calendar: &Calendar,
        _: &mut Counters,
    ) -> Result<Option<Message<'a>>, Unread> {
        super::read(payload(frame), calendar).map(Some)
    }
}

/// Returns the bytes between the header and the check.
pub(super) fn payload<'a>(frame: &Frame<'a>) -> &'a [u8] {
    frame.between(HEADER, PARITY)
}

/// Returns the CRC of a frame; zero if the frame includes its valid parity.
///
/// The remainder is kept in the upper bits of a word, four bytes enter it at once, and a table
/// takes half a byte out of it.
fn crc24q(bytes: &[u8]) -> u32 {
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
