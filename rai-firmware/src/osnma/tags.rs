//! Tags of a MACK message, and what they are computed from.
//!
//! `tag₀ | MACSEQ 12 | COP 4 | (tag | PRND 8 | ADKD 4 | COP 4) … | key | zeros`
//!
//! ```text
//! tag₀      first bits of HMAC(K, PRNA 8 | GST 32 | 1 | NMAS 2 | words)
//! tag       first bits of HMAC(K, PRND 8 | PRNA 8 | GST 32 | slot 8 | NMAS 2 | words)
//! MACSEQ    first 12 bits of HMAC(K, PRNA 8 | GST 32 | what the flexible slots state)
//! ```
//!
//! `K` is the key of the next subframe, or of the eleventh behind for ADKD 12. `PRNA` sends the tag,
//! and `PRND` is the satellite that it is about.
//!
//! Reference: [OSNMA-ICD] 3.3, 6.6, 6.7.
//!
//! [OSNMA-ICD]: crate#references

use super::chain::Parameters;
use super::gst::Subframe;
use super::hash::hmac;
use super::table::{self, Slot};
use super::words::{About, Chosen, Words};
use crate::input::bits::{Bits, Packed};

/// Bytes of a MACK message.
pub(super) const MACK: usize = 60;

/// Bytes of the longest message of a tag.
const MESSAGE: usize = 77;

/// A tag, and what it is about.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tag {
    /// The tag, in its lowest bits.
    pub(super) value: u64,
    /// Satellite that sent it, and satellite that it is about.
    pub(super) sender: u8,
    pub(super) subject: u8,
    pub(super) adkd: u8,
    pub(super) cop: u8,
    /// Number of its slot, from 1.
    pub(super) slot: u8,
    /// Status in the header: 1 test, 2 operational, 3 don't use.
    pub(super) status: u8,
}

impl Tag {
    /// Returns the words that the tag is about.
    pub(super) const fn about(&self) -> About {
        if self.adkd == 4 { About::Timing } else { About::Orbit }
    }

    /// Returns true if the tag is that of these words.
    // Not inlined, so that its message leaves the stack.
    #[inline(never)]
    pub(super) fn is_right(
        &self,
        bits: u8,
        key: &[u8],
        subframe: Subframe,
        (words, former, chosen): (&Words, Option<&Words>, &Chosen),
    ) -> bool {
        let mut message = Packed::<MESSAGE>::new();
        let mut length = 7 * 8 + 2;
        if self.slot > 1 {
            message.push(u32::from(self.subject), 8);
        } else {
            length -= 8;
        }
        message.push(u32::from(self.sender), 8);
        message.push(subframe.bits(), 32);
        message.push(u32::from(self.slot), 8);
        message.push(u32::from(self.status), 2);
        words.push(former, self.about(), *chosen, &mut message);
        length += if self.adkd == 4 { 141 } else { 549 };
        let message: &[u8] = message.bytes.get(..usize::div_ceil(length, 8)).unwrap_or_default();
        first_bits(&hmac(key, message), u32::from(bits)) == self.value
    }
}

/// Returns the first bits of a code, at most 64.
fn first_bits(code: &[u8; 32], count: u32) -> u64 {
    let first = code.first_chunk().copied().unwrap_or_default();
    u64::from_be_bytes(first) >> (64 - count.clamp(1, 64))
}

/// MACK message of a satellite.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mack<'a> {
    pub(super) bytes: &'a [u8; MACK],
    pub(super) sender: u8,
    pub(super) status: u8,
    pub(super) subframe: Subframe,
}

impl Mack<'_> {
    /// Returns the key that the message discloses.
    pub(super) fn key(&self, parameters: &Parameters) -> [u8; 32] {
        let start = parameters.tags() * (usize::from(parameters.tag_bits) + 16);
        let mut key = [0; 32];
        for (index, place) in key.iter_mut().take(usize::from(parameters.key_bytes)).enumerate() {
            *place = Bits(self.bytes).small(start + 8 * index, 8);
        }
        key
    }

    /// Returns a tag with its slot; `None` behind the last, and if it is not what its slot demands.
    pub(super) fn tag(&self, parameters: &Parameters, slot: u8) -> Option<(Tag, Slot)> {
        let index = usize::from(slot.checked_sub(1)?);
        if index >= parameters.tags() {
            return None;
        }
        let width = usize::from(parameters.tag_bits);
        let start = index * (width + 16);
        let bits = Bits(self.bytes);
        let upper = width.saturating_sub(32);
        let value = u64::from(if upper > 0 { bits.unsigned(start, upper) } else { 0 }) << 32
            | u64::from(bits.unsigned(start + upper, width - upper));
        let mut tag = Tag {
            value,
            sender: self.sender,
            subject: self.sender,
            adkd: 0,
            cop: bits.small(start + width + 12, 4),
            slot,
            status: self.status,
        };
        if slot == 1 {
            return Some((tag, Slot::Fixed(0, true)));
        }
        (tag.subject, tag.adkd) = (bits.small(start + width, 8), bits.small(start + width + 8, 4));
        let sequence = table::sequence(parameters.maclt, self.subframe.is_odd())?;
        let demanded = table::slot(*sequence.get(index.checked_sub(1)?)?);
        let is_demanded = match demanded {
            Slot::Fixed(adkd, is_own) => tag.adkd == adkd && (!is_own || tag.subject == self.sender),
            Slot::Flexible => matches!(tag.adkd, 0 | 4 | 12),
        };
        is_demanded.then_some((tag, demanded))
    }

    /// Returns true if what the flexible slots state is what the sender meant.
    // Not inlined, so that its message leaves the stack.
    #[inline(never)]
    pub(super) fn has_right_sequence(&self, parameters: &Parameters, key: &[u8]) -> bool {
        let bits = Bits(self.bytes);
        let width = usize::from(parameters.tag_bits);
        let Some(sequence) = table::sequence(parameters.maclt, self.subframe.is_odd()) else { return false };
        let mut message = Packed::<32>::new();
        message.push(u32::from(self.sender), 8);
        message.push(self.subframe.bits(), 32);
        let mut length = 5;
        for (index, letter) in sequence.iter().enumerate().take(parameters.tags().saturating_sub(1)) {
            if table::slot(*letter) == Slot::Flexible {
                message.push(bits.unsigned((index + 1) * (width + 16) + width, 16), 16);
                length += 2;
            }
        }
        let code = hmac(key, message.bytes.get(..length).unwrap_or_default());
        first_bits(&code, 12) == u64::from(bits.unsigned(width, 12))
    }
}
