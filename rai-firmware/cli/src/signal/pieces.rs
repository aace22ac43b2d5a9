//! Pieces of a stream: valid frames, lines of text, and other bytes.
//!
//! ```text
//! UBX      B5 62 | class | id | length (16 bit) | payload | sums over all from class on (2 × 8 bit)
//! RTCM 3   D3 | 000000 | length (10 bit) | payload | CRC-24Q over all before (24 bit)
//! SBF      $@ | CRC (16 bit) | number and revision | length of all (16 bit) | TOW | week | …
//! text     $ or ! | printable | * | two digits, the exclusive or of all between | CR LF
//! ```
//!
//! The module's own framer is not used, because it skips text, and because this is a second opinion
//! on the positions of frames. References: [RTCM-10403.3] 4; u-blox F9 HPG 1.32 interface
//! description 3.2 and 3.4.
//!
//! [RTCM-10403.3]: crate#references

use std::io::{ErrorKind, Read};

use crate::signal::checksum::{crc16, crc24q, fletcher};

/// Longest line of text, bytes; no receiver sends longer ones.
const LINE: usize = 400;

/// Longest payload of a UBX frame, bytes: RXM-RAWX with 255 measurements.
const UBX_PAYLOAD: usize = 16 + 255 * 32;

/// Bytes of an SBF block up to its length.
const SBF_HEADER: usize = 8;

/// Kind of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A UBX frame: class and id.
    Ubx([u8; 2]),
    /// An RTCM 3 frame: number of the message.
    Rtcm(u16),
    /// A block of SBF: its number.
    Sbf(u16),
    /// A line of text with a valid checksum, as in NMEA 0183.
    Line,
    /// Other bytes.
    Rest,
}

impl Kind {
    /// Ranges of u-blox receivers.
    pub const RAWX: Self = Self::Ubx([0x02, 0x15]);
    /// Navigation bits of u-blox receivers.
    pub const SFRBX: Self = Self::Ubx([0x02, 0x13]);

    /// Ranges of Septentrio receivers.
    pub const MEAS_EPOCH: Self = Self::Sbf(4027);

    /// Returns true for ranges from which the module uses ranges or time.
    pub fn has_ranges(self) -> bool {
        matches!(self, Self::RAWX | Self::MEAS_EPOCH | Self::Rtcm(1071..=1137))
    }
}

/// Returns true if a stream has ranges.
pub fn have_ranges(bytes: &[u8]) -> bool {
    pieces(bytes).any(|piece| piece.kind.has_ranges())
}

/// Part of a stream.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'a> {
    /// Kind of the piece.
    pub kind: Kind,
    /// All bytes of the piece.
    pub bytes: &'a [u8],
}

/// Returns the pieces of a stream, in order and without a gap.
pub fn pieces(bytes: &[u8]) -> impl Iterator<Item = Piece<'_>> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        let (kind, length) = first(rest, rest.len())?;
        let (bytes, behind) = rest.split_at_checked(length)?;
        rest = behind;
        Some(Piece { kind, bytes })
    })
}

/// Pieces of a source that is read on demand, so that its length does not matter.
#[derive(Debug)]
pub struct Stream<R> {
    source: R,
    buffer: Vec<u8>,
    /// Position of the next piece in the buffer.
    at: usize,
    has_ended: bool,
}

/// Length of the longest frame, bytes: header, payload and check.
const LONGEST: usize = 6 + UBX_PAYLOAD + 2;

/// Bytes that [`Stream`] requests from its source at once.
const READ: usize = 65_536;

impl<R: Read> Stream<R> {
    /// Returns the pieces of `source`.
    pub fn of(source: R) -> Self {
        Self { source, buffer: Vec::new(), at: 0, has_ended: false }
    }

    /// Returns the next piece, or `None` at the end. Bytes outside frames may come in several
    /// pieces.
    ///
    /// # Errors
    /// The source cannot be read.
    pub fn advance(&mut self) -> std::io::Result<Option<Piece<'_>>> {
        self.fill()?;
        let ahead = self.buffer.get(self.at..).unwrap_or_default();
        // A frame that begins behind this position may be incomplete.
        let known = if self.has_ended { ahead.len() } else { ahead.len() - LONGEST };
        let Some((kind, length)) = first(ahead, known) else { return Ok(None) };
        let bytes = ahead.get(..length).unwrap_or_default();
        self.at += length;
        Ok(Some(Piece { kind, bytes }))
    }

    /// Puts the piece of this length back that was returned last.
    pub fn put_back(&mut self, length: usize) {
        self.at = self.at.saturating_sub(length);
    }

    /// Reads until the buffer holds more than the longest frame, or the source has ended.
    fn fill(&mut self) -> std::io::Result<()> {
        while !self.has_ended && self.buffer.len() - self.at <= LONGEST {
            self.buffer.drain(..self.at);
            self.at = 0;
            let held = self.buffer.len();
            self.buffer.resize(held + READ, 0);
            let read = self.source.read(self.buffer.get_mut(held..).unwrap_or_default());
            self.buffer.truncate(held + *read.as_ref().unwrap_or(&0));
            match read {
                Ok(0) => self.has_ended = true,
                Err(error) if error.kind() != ErrorKind::Interrupted => return Err(error),
                _ => {}
            }
        }
        Ok(())
    }
}

/// Bytes whose checks may fail, for each byte that is searched. Bytes that imitate beginnings of
/// frames would otherwise cost a check of a whole frame each.
const FUTILE: usize = 8;

/// The work on frames that turn out to be none.
#[derive(Debug)]
struct Budget {
    /// Bytes of further checks.
    left: usize,
    /// Bytes of the checks so far.
    spent: usize,
}

impl Budget {
    const fn new() -> Self {
        Self { left: LONGEST, spent: 0 }
    }

    /// Returns true if a check of this many bytes is within the budget.
    fn allows(&mut self, bytes: usize) -> bool {
        let is_within = bytes <= self.left;
        if is_within {
            self.left -= bytes;
            self.spent += bytes;
        }
        is_within
    }
}

/// Returns the kind and the length of the piece at the front. Bytes outside frames end after
/// `known` bytes at the latest.
fn first(bytes: &[u8], known: usize) -> Option<(Kind, usize)> {
    first_within(&mut Budget::new(), bytes, known)
}

fn first_within(budget: &mut Budget, bytes: &[u8], known: usize) -> Option<(Kind, usize)> {
    if bytes.is_empty() {
        return None;
    }
    if let Some(frame) = frame(budget, bytes) {
        return Some(frame);
    }
    let end = (1..known).find(|at| {
        budget.left += FUTILE;
        bytes.get(*at..).is_some_and(|rest| frame(budget, rest).is_some())
    });
    Some((Kind::Rest, end.unwrap_or(known)))
}

/// Returns the frame or line at the front, if it is complete and its check is within the budget.
fn frame(budget: &mut Budget, bytes: &[u8]) -> Option<(Kind, usize)> {
    match bytes {
        [0xB5, 0x62, class, id, low, high, ..] => {
            let payload = usize::from(*high) << 8 | usize::from(*low);
            let length = 6 + payload + 2;
            let sums = bytes.get(length - 2..length).filter(|_| payload <= UBX_PAYLOAD)?;
            let is_right = budget.allows(length) && fletcher(bytes.get(2..length - 2)?) == sums;
            is_right.then_some((Kind::Ubx([*class, *id]), length))
        }
        [0xD3, high, low, ..] if high & 0b1111_1100 == 0 => {
            let length = 3 + (usize::from(*high) << 8 | usize::from(*low)) + 3;
            let parity = bytes.get(length - 3..length)?;
            let number = match bytes.get(3..length - 3)? {
                [high, low, ..] => u16::from(*high) << 4 | u16::from(*low) >> 4,
                _ => 0,
            };
            let is_right = budget.allows(length) && crc24q(bytes.get(..length - 3)?) == parity;
            is_right.then_some((Kind::Rtcm(number), length))
        }
        [b'$', b'@', _, _, id_low, id_high, low, high, ..] => {
            let length = usize::from(*high) << 8 | usize::from(*low);
            let is_possible = length >= SBF_HEADER && length.is_multiple_of(4) && length <= LONGEST;
            let block = bytes.get(..length).filter(|_| is_possible)?;
            let is_right = budget.allows(length) && crc16(block.get(4..)?) == block.get(2..4)?;
            let number = (u16::from(*id_high) << 8 | u16::from(*id_low)) & 0x1FFF;
            is_right.then_some((Kind::Sbf(number), length))
        }
        [b'$' | b'!', ..] if budget.allows(LINE.min(bytes.len())) => {
            let end = bytes.iter().take(LINE).position(|byte| *byte == b'\n')?;
            is_sentence(bytes.get(1..end)?).then_some((Kind::Line, end + 1))
        }
        _ => None,
    }
}

/// Returns true if the checksum holds of the text between the first character and the line feed.
fn is_sentence(text: &[u8]) -> bool {
    let text = text.strip_suffix(b"\r").unwrap_or(text);
    let star = text.iter().rposition(|byte| *byte == b'*').unwrap_or(0);
    let (body, digits) = text.split_at_checked(star).unwrap_or((text, &[]));
    let digits = digits.get(1..).and_then(|digits| std::str::from_utf8(digits).ok()).unwrap_or("");
    let sum = body.iter().fold(0, |sum, byte| sum ^ byte);
    digits.len() == 2 && u8::from_str_radix(digits, 16) == Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// UBX-MON-VER poll and RTCM 1005, as their standards print them.
    const UBX: [u8; 8] = [0xB5, 0x62, 0x0A, 0x04, 0x00, 0x00, 0x0E, 0x34];
    const RTCM: [u8; 25] = [
        0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98, 0x0E, 0xDE, 0xEF, 0x34, 0xB4, 0xBD, 0x62, 0xAC,
        0x09, 0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98,
    ];
    /// `EndOfMeas` as a mosaic sent it.
    const SBF: [u8; 16] =
        [0x24, 0x40, 0x86, 0x20, 0x22, 0x17, 0x10, 0x00, 0x48, 0x1E, 0xAB, 0x0C, 0x38, 0x09, 0x44, 0x10];
    const LINE: &[u8] = b"$GPGLL,4916.45,N,12311.12,W,225444,A,*1D\r\n";

    fn kinds(bytes: &[u8]) -> Vec<(Kind, usize)> {
        pieces(bytes).map(|piece| (piece.kind, piece.bytes.len())).collect()
    }

    #[test]
    fn frames_lines_and_noise_are_told_apart() {
        let stream = [&UBX[..], LINE, &[0xB5, 0x62, 0x02], &RTCM, &SBF, b"$@llo", &UBX[..5]].concat();
        let want = [
            (Kind::Ubx([0x0A, 0x04]), 8),
            (Kind::Line, LINE.len()),
            (Kind::Rest, 3),
            (Kind::Rtcm(1005), 25),
            (Kind::Sbf(5922), 16),
            (Kind::Rest, 10),
        ];
        assert_eq!(kinds(&stream), want);
        assert_eq!(kinds(b""), []);
    }

    /// Source that returns a few bytes at a time.
    struct Slow<'a>(&'a [u8]);

    impl Read for Slow<'_> {
        fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
            let few = into.len().min(7);
            self.0.read(&mut into[..few])
        }
    }

    #[test]
    fn a_stream_has_the_pieces_of_its_bytes() {
        let long = vec![0xAA; 3 * LONGEST];
        let stream = [&UBX[..], &long, &RTCM, LINE, &long, &RTCM[..9], &SBF, &UBX, &RTCM[..20]].concat();
        let mut have = Vec::new();
        let mut read = Stream::of(Slow(&stream));
        while let Some(piece) = read.advance().unwrap() {
            match have.last_mut() {
                Some((Kind::Rest, length)) if piece.kind == Kind::Rest => *length += piece.bytes.len(),
                _ => have.push((piece.kind, piece.bytes.len())),
            }
        }
        assert_eq!(have, kinds(&stream));
    }

    #[test]
    fn what_does_not_check_is_no_frame() {
        for frame in [&UBX[..], &RTCM, &SBF, LINE] {
            for at in 0..frame.len() - 2 {
                let mut broken = frame.to_vec();
                broken[at] ^= 0x10;
                assert_eq!(kinds(&broken), [(Kind::Rest, frame.len())], "{at}");
            }
        }
    }

    /// Beginnings of the longest frames of each kind, again and again.
    #[test]
    fn imitated_frames_cost_some_bytes_of_checks_each() {
        let length = u16::try_from(UBX_PAYLOAD).unwrap().to_le_bytes();
        for imitation in [
            &[0xB5, 0x62, 2, 0x15, length[0], length[1]][..],
            &[0xD3, 3, 0xFF],
            b"$",
            b"$\xD3\x03",
            b"$@$@$@$@\xFC\x1F",
        ] {
            let junk = imitation.repeat(200_000 / imitation.len());
            let mut budget = Budget::new();
            let have = first_within(&mut budget, &junk, junk.len());
            assert_eq!(have, Some((Kind::Rest, junk.len())));
            assert!(budget.spent <= FUTILE * junk.len() + LONGEST, "{imitation:?}: {}", budget.spent);
        }
        // A frame behind a false one, as it comes in a real stream, is found.
        let stream = [&[0xD3, 3, 0xFF][..], &[0x55; 2000], &UBX].concat();
        assert_eq!(kinds(&stream), [(Kind::Rest, 2003), (Kind::Ubx([0x0A, 0x04]), 8)]);
    }
}
