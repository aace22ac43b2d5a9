//! The transport layer: finds the frames of RTCM 3 and of UBX in one stream of bytes, and checks each once.
//!
//! ```text
//! RTCM 3   D3 | 000000 | length (10 bit) | payload (0 to 1023 bytes) | CRC-24Q over all before (24 bit)
//! UBX      B5 62 | class | id | length (16 bit) | payload | sums over all from class on (2 × 8 bit)
//! ```
//!
//! The beginning of a frame may be an accident, and its length then swallows good frames. So nothing is thrown away
//! before it has been searched: when a candidate fails, only its first byte goes, and the search starts again behind it.
//!
//! A stream made of nothing but beginnings would have every byte checked a thousand times over. Each byte that comes
//! therefore pays for [`CREDIT_PER_BYTE`] bytes of checking, and [`CREDIT_MOST`] can be saved up, enough for a dozen of
//! the longest RTCM frames that fail in a row. A candidate that cannot be paid for is passed over and counted.
//!
//! References: [RTCM-10403.3] 4; [UBX-F9] 3.2 and 3.4.
//!
//! [RTCM-10403.3]: crate#references
//! [UBX-F9]: crate#references

use heapless::Vec;

use super::Counters;
use crate::counters::{count, count_many};

/// First byte of an RTCM frame.
const RTCM: u8 = 0xD3;
/// First bytes of a UBX frame.
const UBX: [u8; 2] = [0xB5, 0x62];

/// Bytes before and after the payload of an RTCM frame.
const RTCM_HEADER: usize = 3;
const RTCM_PARITY: usize = 3;

/// Bytes before and after the payload of a UBX frame.
const UBX_HEADER: usize = 6;
const UBX_PARITY: usize = 2;

/// Whether this build looks for frames of UBX.
const UBX_IS_READ: bool = cfg!(feature = "ubx");

/// Class and id of the ranges, and the longest payload that is read of them: 160 measurements, of which 64 satellites
/// hardly send more.
const UBX_RANGES: [u8; 2] = [0x02, 0x15];
const UBX_RANGES_PAYLOAD: usize = 16 + 160 * 32;

/// The longest payload of any other UBX frame.
const UBX_PAYLOAD: usize = 1023;

/// The longest frame, and as much again as makes moving it to the front rare.
const CAPACITY: usize = if UBX_IS_READ {
    UBX_HEADER + UBX_RANGES_PAYLOAD + UBX_PARITY + 128
} else {
    RTCM_HEADER + 1023 + RTCM_PARITY + 1024
};

/// Bytes of checking that each byte on the wire pays for.
const CREDIT_PER_BYTE: usize = 4;
/// What can be saved up.
const CREDIT_MOST: usize = 12 * 1029;

/// Whose frame it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Protocol {
    Rtcm,
    Ubx,
}

/// A frame that has passed its check.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame<'a> {
    pub(super) protocol: Protocol,
    /// The whole of it.
    pub(super) bytes: &'a [u8],
    /// Its first byte came at this time or later, ms.
    pub(super) came_ms: u64,
}

impl<'a> Frame<'a> {
    /// Bytes that are one frame of RTCM and nothing else, where they pass its check.
    pub(super) fn of_rtcm(bytes: &'a [u8]) -> Option<Self> {
        let is_whole = match *bytes {
            [RTCM, high, low, ..] => bytes.len() == rtcm_length(high, low) && crc24q(bytes) == 0,
            _ => false,
        };
        is_whole.then_some(Self { protocol: Protocol::Rtcm, bytes, came_ms: 0 })
    }

    /// What is between the header and the check; of a UBX frame, class and id go before.
    pub(super) fn payload(&self) -> &'a [u8] {
        let (header, parity) = self.protocol.overhead();
        let end = self.bytes.len().saturating_sub(parity);
        self.bytes.get(header..end).unwrap_or_default()
    }
}

impl Protocol {
    const ALL: &[Self] = if UBX_IS_READ { &[Self::Rtcm, Self::Ubx] } else { &[Self::Rtcm] };

    /// Whether a frame of any begins with this byte.
    fn may_begin_with(byte: u8) -> bool {
        Self::ALL.iter().any(|protocol| protocol.first() == byte)
    }

    const fn first(self) -> u8 {
        match self {
            Self::Rtcm => RTCM,
            Self::Ubx => UBX[0],
        }
    }

    const fn overhead(self) -> (usize, usize) {
        match self {
            Self::Rtcm => (RTCM_HEADER, RTCM_PARITY),
            Self::Ubx => (UBX_HEADER, UBX_PARITY),
        }
    }
}

/// Bytes that may be part of a frame.
#[derive(Debug)]
pub(super) struct Framer {
    buffer: Vec<u8, CAPACITY>,
    /// Where in the buffer the search is; what is before is done with.
    front: usize,
    /// Length of the frame that was handed out last, still at the front.
    handed: usize,
    /// From here on, the bytes came at `fresh_ms`; those before came at `old_ms` or later.
    fresh: usize,
    fresh_ms: u64,
    old_ms: u64,
    credit: usize,
}

/// What the front of the buffer is.
enum Front {
    Incomplete,
    Complete(Protocol, usize),
    NoFrame,
}

impl Framer {
    pub(super) const fn new() -> Self {
        Self {
            buffer: Vec::new(),
            front: 0,
            handed: 0,
            fresh: 0,
            fresh_ms: 0,
            old_ms: 0,
            credit: CREDIT_MOST,
        }
    }

    /// Takes bytes that came at an instant, as many as there is room for, and gives back the others. There is room for
    /// some when [`Framer::next`] has been asked until it had nothing more.
    pub(super) fn take<'b>(&mut self, bytes: &'b [u8], came_ms: u64, counters: &mut Counters) -> &'b [u8] {
        self.make_room(bytes.len(), counters);
        let room = self.buffer.capacity() - self.buffer.len();
        let (now, later) = bytes.split_at_checked(room).unwrap_or((bytes, &[]));
        // What was fresh before is old now, and no older than what is at the front.
        if self.front >= self.fresh {
            self.old_ms = self.fresh_ms;
        }
        self.fresh = self.buffer.len();
        if self.front == self.fresh {
            self.old_ms = came_ms;
        }
        self.fresh_ms = came_ms;
        // It fits.
        let _ = self.buffer.extend_from_slice(now);
        self.credit = CREDIT_MOST.min(self.credit + CREDIT_PER_BYTE * now.len());
        later
    }

    /// Moves what waits to the beginning of the buffer if there would be no room behind it.
    fn make_room(&mut self, wanted: usize, counters: &mut Counters) {
        if self.buffer.len() + wanted <= self.buffer.capacity() {
            return;
        }
        if self.front == 0 && self.buffer.is_full() {
            // No candidate is that long: only a caller that does not ask for frames gets here.
            count(&mut counters.bytes_skipped);
            self.front = 1;
        }
        let left = self.buffer.len().saturating_sub(self.front);
        let from = self.front.min(self.buffer.len());
        self.buffer.copy_within(from.., 0);
        self.buffer.truncate(left);
        self.fresh = self.fresh.saturating_sub(self.front);
        self.front = 0;
    }

    /// Whether [`Framer::next`] would find more than it did before. Bytes come a few at a time, and asking it whenever some
    /// have come would cost half as much as reading the message.
    pub(super) fn is_worth_a_look(&self) -> bool {
        self.handed > 0 || !matches!(self.candidate(), Front::Incomplete)
    }

    /// The next frame that passes its check; the one before is done with.
    ///
    /// With `is_silent` no more bytes will come to complete a candidate: what is incomplete is counted as cut, and what
    /// it holds is searched.
    pub(super) fn next(&mut self, is_silent: bool, counters: &mut Counters) -> Option<Frame<'_>> {
        self.front += core::mem::take(&mut self.handed);
        let (protocol, length) = loop {
            match self.candidate() {
                Front::Complete(protocol, length) => {
                    if self.passes(protocol, length, counters) {
                        break (protocol, length);
                    }
                }
                Front::Incomplete if self.is_empty() || !is_silent => {
                    self.settle();
                    return None;
                }
                Front::Incomplete => count(&mut counters.frames_cut),
                Front::NoFrame => {}
            }
            self.resynchronise(counters);
        };
        count(&mut counters.frames);
        self.handed = length;
        let came_ms = if self.front >= self.fresh { self.fresh_ms } else { self.old_ms };
        let bytes = self.buffer.get(self.front..self.front + length)?;
        Some(Frame { protocol, bytes, came_ms })
    }

    /// Forgets all that waits.
    pub(super) fn forget(&mut self, counters: &mut Counters) {
        count_many(&mut counters.bytes_skipped, self.waiting().len().saturating_sub(self.handed));
        (self.front, self.handed, self.fresh) = (0, 0, 0);
        self.buffer.clear();
    }

    fn waiting(&self) -> &[u8] {
        self.buffer.get(self.front..).unwrap_or_default()
    }

    fn is_empty(&self) -> bool {
        self.front >= self.buffer.len()
    }

    /// An empty buffer begins anew.
    fn settle(&mut self) {
        if self.is_empty() {
            self.buffer.clear();
            (self.front, self.fresh) = (0, 0);
        }
    }

    fn candidate(&self) -> Front {
        match self.waiting() {
            [] | [RTCM] | [RTCM, _] => Front::Incomplete,
            [RTCM, high, low, ..] if high & 0b1111_1100 == 0 => {
                self.whole(Protocol::Rtcm, rtcm_length(*high, *low))
            }
            [first] if UBX_IS_READ && *first == UBX[0] => Front::Incomplete,
            [first, second, rest @ ..] if UBX_IS_READ && [*first, *second] == UBX => match rest {
                [class, id, low, high, ..] => {
                    let payload = usize::from(*high) << 8 | usize::from(*low);
                    if !may_have([*class, *id], payload) {
                        return Front::NoFrame;
                    }
                    self.whole(Protocol::Ubx, UBX_HEADER + payload + UBX_PARITY)
                }
                _ => Front::Incomplete,
            },
            _ => Front::NoFrame,
        }
    }

    fn whole(&self, protocol: Protocol, length: usize) -> Front {
        if self.waiting().len() < length { Front::Incomplete } else { Front::Complete(protocol, length) }
    }

    /// Checks a complete candidate, if that can be paid for.
    fn passes(&mut self, protocol: Protocol, length: usize, counters: &mut Counters) -> bool {
        let Some(credit) = self.credit.checked_sub(length) else {
            count(&mut counters.frames_unchecked);
            return false;
        };
        self.credit = credit;
        let frame = self.waiting().get(..length).unwrap_or_default();
        let holds = match protocol {
            Protocol::Rtcm => crc24q(frame) == 0,
            Protocol::Ubx => sums_match(frame),
        };
        if !holds {
            count(&mut counters.crc_failures);
        }
        holds
    }

    /// Drops the first byte and all up to the next that may begin a frame.
    fn resynchronise(&mut self, counters: &mut Counters) {
        let waiting = self.waiting();
        let next = waiting.iter().skip(1).position(|&byte| Protocol::may_begin_with(byte));
        let skipped = next.map_or(waiting.len(), |position| position + 1);
        count_many(&mut counters.bytes_skipped, skipped);
        self.front += skipped;
    }
}

/// Bytes of an RTCM frame, from the two bytes of its header that say so.
fn rtcm_length(high: u8, low: u8) -> usize {
    RTCM_HEADER + (usize::from(high) << 8 | usize::from(low)) + RTCM_PARITY
}

/// Whether a message can have that long a payload. An accident of two bytes must not hold back half a second's frames,
/// so only that message may be long which has to be.
fn may_have(message: [u8; 2], payload: usize) -> bool {
    let most = if message == UBX_RANGES && payload % 32 == 16 { UBX_RANGES_PAYLOAD } else { UBX_PAYLOAD };
    payload <= most
}

/// The CRC of RTCM frames; 0 over a frame with its right parity.
fn crc24q(bytes: &[u8]) -> u32 {
    const POLYNOMIAL: u32 = 0x0186_4CFB;
    /// What each value of a byte's upper half leads to.
    const TABLE: [u32; 16] = {
        let mut table = [0; 16];
        let mut index = 0;
        while index < 16 {
            let mut crc = (index as u32) << 20;
            let mut bit = 0;
            while bit < 4 {
                crc = (crc << 1) ^ if crc & 0x80_0000 == 0 { 0 } else { POLYNOMIAL };
                bit += 1;
            }
            table[index] = crc & 0xFF_FFFF;
            index += 1;
        }
        table
    };
    let step = |crc: u32, half: u8| {
        let index = (crc >> 20) as u8 ^ half;
        (crc << 4 & 0xFF_FFFF) ^ TABLE[usize::from(index & 15)]
    };
    bytes.iter().fold(0, |crc, &byte| step(step(crc, byte >> 4), byte & 15))
}

/// Fletcher's two sums of UBX frames.
fn sums_match(frame: &[u8]) -> bool {
    let [_, _, checked @ .., sum_a, sum_b] = frame else { return false };
    let (a, b) = checked.iter().fold((0_u8, 0_u8), |(a, b), &byte| {
        let a = a.wrapping_add(byte);
        (a, b.wrapping_add(a))
    });
    (a, b) == (*sum_a, *sum_b)
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    /// Example of the standard's section 4, a message 1005.
    const RTCM_FRAME: [u8; 25] = [
        0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98, 0x0E, 0xDE, 0xEF, 0x34, 0xB4, 0xBD, 0x62, 0xAC,
        0x09, 0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98,
    ];

    /// MON-VER polled: the example of u-blox's own description, `B5 62 0A 04 00 00 0E 34`.
    const UBX_FRAME: [u8; 8] = [0xB5, 0x62, 0x0A, 0x04, 0x00, 0x00, 0x0E, 0x34];

    /// Asks for frames whenever bytes have come.
    fn frames(framer: &mut Framer, bytes: &[u8], counters: &mut Counters) -> Vec<(Protocol, usize)> {
        frames_asked_when(|_| true, framer, bytes.chunks(46), counters)
    }

    fn frames_asked_when<'b>(
        is_asked: fn(&Framer) -> bool,
        framer: &mut Framer,
        chunks: impl Iterator<Item = &'b [u8]>,
        counters: &mut Counters,
    ) -> Vec<(Protocol, usize)> {
        let mut found = Vec::new();
        for mut rest in chunks {
            while !rest.is_empty() {
                rest = framer.take(rest, 0, counters);
                while is_asked(framer)
                    && let Some(frame) = framer.next(false, counters)
                {
                    found.push((frame.protocol, frame.bytes.len()));
                }
            }
        }
        found
    }

    #[test]
    fn both_formats_are_found_in_one_stream() {
        let (mut framer, mut counters) = (Framer::new(), Counters::default());
        let stream = [&UBX_FRAME[..], b"$GPGGA,,*00\r\n", &RTCM_FRAME, &[UBX[0]], &UBX_FRAME].concat();
        let have = frames(&mut framer, &stream, &mut counters);
        assert_eq!(have, [(Protocol::Ubx, 8), (Protocol::Rtcm, 25), (Protocol::Ubx, 8)]);
        assert_eq!((counters.frames, counters.bytes_skipped, counters.crc_failures), (3, 14, 0));
    }

    /// Whole frames, cut ones, beginnings of long ones and noise, in every order of three, in pieces of every size.
    #[test]
    fn asked_only_when_it_is_worth_a_look_it_finds_the_same() {
        let pieces: [&[u8]; 8] = [
            &UBX_FRAME,
            &RTCM_FRAME,
            &RTCM_FRAME[..11],
            &UBX_FRAME[..5],
            &[0xD3, 0x00, 0x05],
            &[0xB5, 0x62, 0x02, 0x15, 0x30, 0x00],
            &[0xD3, 0x03, 0xFF],
            &[0xB5, 0x00, 0xD3],
        ];
        let orders = (0..pieces.len().pow(3)).map(|n| [n % 8, n / 8 % 8, n / 64].map(|n| pieces[n]).concat());
        let stream: Vec<u8> = orders.flatten().collect();
        for size in 1..=64 {
            let [always, seldom] = [|_: &Framer| true, Framer::is_worth_a_look].map(|is_asked| {
                let (mut framer, mut counters) = (Framer::new(), Counters::default());
                let found = frames_asked_when(is_asked, &mut framer, stream.chunks(size), &mut counters);
                (found, counters)
            });
            assert!(always.0.len() > 100, "{} frames", always.0.len());
            assert_eq!(always, seldom, "in pieces of {size}");
        }
    }

    #[test]
    fn a_ubx_frame_with_one_wrong_bit_is_none() {
        for bit in 0..64 {
            let mut broken = UBX_FRAME;
            broken[bit / 8] ^= 1 << (bit % 8);
            let (mut framer, mut counters) = (Framer::new(), Counters::default());
            let have = frames(&mut framer, &broken, &mut counters);
            assert!(have.is_empty(), "bit {bit}: {have:?}");
        }
    }

    /// Bytes that are checked for each byte that comes, at most: the buffer's own size besides.
    #[test]
    fn a_stream_of_beginnings_is_checked_a_bounded_number_of_times() {
        const BYTES: usize = 100_000;
        for beginning in
            [&[0xD3, 0x03, 0xFF][..], &[0xD3, 0x00][..], &[0xB5, 0x62, 0x02, 0x15, 0xF0, 0x10][..]]
        {
            let (mut framer, mut counters) = (Framer::new(), Counters::default());
            let stream: Vec<u8> = beginning.iter().copied().cycle().take(BYTES).collect();
            let have = frames(&mut framer, &stream, &mut counters);
            assert!(have.is_empty(), "{have:?}");
            // The shortest of these candidates has 217 bytes.
            let most = (CREDIT_PER_BYTE * BYTES + CREDIT_MOST) / 217;
            assert!(counters.crc_failures as usize <= most, "{} checks", counters.crc_failures);
            assert!(counters.frames_unchecked > 0);
            // What comes after the longest of the beginnings has run out is found again.
            frames(&mut framer, &[0; CAPACITY], &mut counters);
            assert_eq!(frames(&mut framer, &RTCM_FRAME, &mut counters), [(Protocol::Rtcm, 25)]);
        }
    }

    #[test]
    fn a_frame_is_as_old_as_its_first_byte_may_be() {
        let (mut framer, mut counters) = (Framer::new(), Counters::default());
        assert!(framer.take(&RTCM_FRAME[..5], 100, &mut counters).is_empty());
        assert!(framer.next(false, &mut counters).is_none());
        assert!(framer.take(&RTCM_FRAME[5..], 200, &mut counters).is_empty());
        assert_eq!(framer.next(false, &mut counters).map(|frame| frame.came_ms), Some(100));
        assert!(framer.next(false, &mut counters).is_none());
        // The end of one and the beginning of the next come together.
        framer.take(&RTCM_FRAME[..20], 300, &mut counters);
        assert!(framer.next(false, &mut counters).is_none());
        let both = [&RTCM_FRAME[20..], &RTCM_FRAME[..]].concat();
        framer.take(&both, 400, &mut counters);
        assert_eq!(framer.next(false, &mut counters).map(|frame| frame.came_ms), Some(300));
        assert_eq!(framer.next(false, &mut counters).map(|frame| frame.came_ms), Some(400));
    }
}
