//! Frames of UBX.
//!
//! ```text
//! B5 62 | class | id | length (16 bit) | payload | checksum from class on (2 × 8 bit)
//! ```
//!
//! A false header that announces a long frame could delay seconds of good frames. A payload may
//! therefore have at most [`ORDINARY_PAYLOAD`] bytes. Only RXM-RAWX and NAV-SIG may be longer, if
//! their numbers of measurements and of signals explain their lengths.
//!
//! References: [UBX-F9] 3.2 and 3.4.
//!
//! [UBX-F9]: crate#references

use super::rawx::{self, Rawx};
use super::security;
use crate::correction::CAPACITY;
use crate::input::calendar::Calendar;
use crate::input::protocol::{Extent, Frame, Protocol, Shared};
use crate::input::{Counters, Message, Unread};

/// Bytes before the payload.
const HEADER: usize = 6;

/// Bytes of the checksum after the payload.
const CHECKSUM: usize = 2;

/// Longest payload of other messages than RXM-RAWX and NAV-SIG, bytes.
const ORDINARY_PAYLOAD: usize = 1023;

/// Longest payload of RXM-RAWX that is read, bytes: all that a message can have, or 160 measurements
/// in a build with less memory, which 45 satellites with four bands exceed.
const RAWX_PAYLOAD: usize = rawx::payload_of(if CAPACITY < 48 { 160 } else { 255 });

/// Format of UBX.
#[derive(Debug)]
pub(in crate::input) struct Ubx;

impl Protocol for Ubx {
    const SYNC: &'static [u8] = &[0xB5, 0x62];
    const LONGEST: usize = HEADER + RAWX_PAYLOAD + CHECKSUM;

    type Memory = ();

    type Ranges<'a> = Rawx<'a>;

    fn at_start() {}

    fn length(bytes: &[u8]) -> Extent {
        let &[_, _, class, id, low, high, ref payload @ ..] = bytes else { return Extent::Unknown };
        let length = usize::from(high) << 8 | usize::from(low);
        let is_possible = match [class, id] {
            _ if length <= ORDINARY_PAYLOAD => true,
            rawx::MESSAGE => length <= RAWX_PAYLOAD && rawx::may_have(payload, length),
            // At most 255 signals, which are shorter than as many measurements.
            security::NAV_SIG => security::may_be_signals(payload, length),
            _ => false,
        };
        if is_possible { Extent::Bytes(HEADER + length + CHECKSUM) } else { Extent::NoFrame }
    }

    fn check(frame: &[u8]) -> bool {
        sums_match(frame)
    }

    fn read<'a>(
        frame: &Frame<'a>,
        (): &mut (),
        shared: &mut Shared,
        calendar: &Calendar,
        counters: &mut Counters,
    ) -> Result<Option<Message<'a>>, Unread> {
        super::read(frame, &mut shared.navigation, calendar, counters)
    }
}

/// Returns the bytes between the header, which includes class and id, and the checksum.
pub(super) fn payload<'a>(frame: &Frame<'a>) -> &'a [u8] {
    frame.between(HEADER, CHECKSUM)
}

/// Returns true if the two sums of the checksum (Fletcher) of a frame hold.
fn sums_match(frame: &[u8]) -> bool {
    let [_, _, checked @ .., sum_a, sum_b] = frame else { return false };
    let (words, rest) = checked.as_chunks::<4>();
    let sums = words.iter().fold((0, 0), |sums, word| with_word(sums, u32::from_le_bytes(*word)));
    let (a, b) = rest.iter().fold(sums, |(a, b), &byte| {
        let a = u32::wrapping_add(a, u32::from(byte));
        (a, b.wrapping_add(a))
    });
    (a as u8, b as u8) == (*sum_a, *sum_b)
}

/// Returns the two sums after the four bytes `x₀` to `x₃` of a word: `a + x₀ + x₁ + x₂ + x₃` and
/// `b + 4 a + 4 x₀ + 3 x₁ + 2 x₂ + x₃`, of which the lowest eight bits count.
fn with_word((a, b): (u32, u32), word: u32) -> (u32, u32) {
    const PAIR: u32 = 0x00FF_00FF;
    // Two bytes in the halves of a word; a product with two factors has its sum from bit 16 on.
    let (even, odd) = (word & PAIR, word >> 8 & PAIR);
    let weighted = even.wrapping_mul(0x0004_0002).wrapping_add(odd.wrapping_mul(0x0003_0001)) >> 16;
    let sum = (even + odd).wrapping_mul(0x0001_0001) >> 16;
    (a.wrapping_add(sum), b.wrapping_add(a << 2).wrapping_add(weighted))
}
