//! Frames of SBF.
//!
//! ```text
//! 24 40 | CRC u16 | number (13 bits), revision (3 bits) | length of the whole block u16 | …
//! ```
//!
//! The CRC covers everything behind it: `x¹⁶ + x¹² + x⁵ + 1`, from zero, the most significant bit
//! first (CRC-16/XMODEM). A length is a multiple of four. A false header that announces a long
//! frame could delay seconds of good frames. The number and the length of the sub-blocks in
//! `MeasEpoch` must therefore fit into its length.
//!
//! Reference: [SBF].
//!
//! [SBF]: crate#references

use super::State;
use super::meas_epoch::{self, MeasEpoch};
use crate::correction::CAPACITY;
use crate::input::calendar::Calendar;
use crate::input::protocol::{Extent, Frame, Protocol, Shared};
use crate::input::{Counters, Message, Unread};

/// Bytes before those that the CRC covers.
const UNCHECKED: usize = 4;

/// Bytes up to the length.
const HEADER: usize = 8;

/// Longest block that is read, bytes: a `MeasEpoch` of 72 satellites with eight signals each, of both
/// antennas; in a build with less memory, of 64 with five.
const LONGEST: usize = if CAPACITY < 48 { meas_epoch::block_of(64, 5) } else { meas_epoch::block_of(72, 8) };

/// Format of SBF.
#[derive(Debug)]
pub(in crate::input) struct Sbf;

impl Protocol for Sbf {
    const SYNC: &'static [u8] = b"$@";
    const LONGEST: usize = LONGEST;

    type Memory = State;

    type Ranges<'a> = MeasEpoch<'a>;

    fn at_start() -> State {
        State::new()
    }

    fn length(bytes: &[u8]) -> Extent {
        let &[_, _, _, _, id_low, id_high, low, high, ref rest @ ..] = bytes else {
            return Extent::Unknown;
        };
        let length = usize::from(high) << 8 | usize::from(low);
        let number = (u16::from(id_high) << 8 | u16::from(id_low)) & 0x1FFF;
        let is_possible = (HEADER..=LONGEST).contains(&length)
            && length.is_multiple_of(4)
            && (number != meas_epoch::NUMBER || meas_epoch::may_have(rest, length));
        if is_possible { Extent::Bytes(length) } else { Extent::NoFrame }
    }

    fn check(frame: &[u8]) -> bool {
        let [_, _, low, high, checked @ ..] = frame else { return false };
        crc16(checked) == u16::from(*high) << 8 | u16::from(*low)
    }

    fn read<'a>(
        frame: &Frame<'a>,
        state: &mut State,
        shared: &mut Shared,
        calendar: &Calendar,
        counters: &mut Counters,
    ) -> Result<Option<Message<'a>>, Unread> {
        super::read(frame, state, &mut shared.navigation, calendar, counters)
    }
}

/// Returns the CRC of bytes.
///
/// A byte at a time without a table: with `t`, the upper byte of the remainder plus the byte, and
/// `t ⊕ t ≫ 4` in its place, the remainder of `t x¹⁶` is `t x¹² + t x⁵ + t`.
fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |crc: u16, byte| {
        let mut term = crc >> 8 ^ u16::from(*byte);
        term ^= term >> 4;
        crc << 8 ^ term << 12 ^ term << 5 ^ term
    })
}

const _: () = assert!(UNCHECKED < HEADER);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crc_is_that_of_the_catalogue() {
        // CRC-16/XMODEM in the catalogue of Greg Cook, and a block of a mosaic.
        assert_eq!(crc16(b"123456789"), 0x31C3);
    }

    #[test]
    fn what_no_block_can_be_is_no_frame() {
        let header = |number: u16, length: u16| {
            let [id_low, id_high] = number.to_le_bytes();
            let [low, high] = length.to_le_bytes();
            [b'$', b'@', 0, 0, id_low, id_high, low, high]
        };
        assert_eq!(Sbf::length(&header(4092, 20)), Extent::Bytes(20));
        assert_eq!(Sbf::length(&header(4092, 20)[..7]), Extent::Unknown);
        for length in [0, 4, 7, 21, 65_532, LONGEST as u16 + 4] {
            assert_eq!(Sbf::length(&header(4092, length)), Extent::NoFrame, "{length}");
        }
        assert_eq!(Sbf::length(&header(4027, LONGEST as u16)), Extent::Bytes(LONGEST));
        // 45 satellites with eight signals of two antennas: 20 bytes, and 20 and 7 times 12 for each.
        assert_eq!(Sbf::length(&header(4027, 4700)), Extent::Bytes(4700));
    }
}
