//! The transport layer: finds frames in a stream of bytes.
//!
//! ```text
//! 0xD3 | 000000 | length (10 bit) | payload (0 to 1023 bytes) | CRC-24Q over all before (24 bit)
//! ```
//!
//! A preamble may be an accident, and its length field then swallows good frames. So nothing is thrown away before
//! it has been searched: when a candidate fails, only its first byte goes, and the search starts again behind it.
//!
//! Reference: [RTCM-10403.3] 4.

use heapless::Vec;
use rtcm_rs::MessageFrame;

use super::Counters;
use crate::counters::{count, count_many};

/// First byte of every frame.
const PREAMBLE: u8 = 0xD3;

/// Bytes before and after the payload.
const HEADER: usize = 3;
const PARITY: usize = 3;

/// The longest frame.
const CAPACITY: usize = HEADER + 1023 + PARITY;

/// Bytes that may be part of a frame.
#[derive(Debug)]
pub(super) struct Framer {
    buffer: Vec<u8, CAPACITY>,
}

/// What the front of the buffer is.
enum Front {
    Incomplete,
    Complete { length: usize },
    NoFrame,
    WrongCrc,
}

impl Framer {
    pub(super) const fn new() -> Self {
        Self { buffer: Vec::new() }
    }

    /// Takes a byte. Full is only the buffer of a caller who does not fetch what is complete; the oldest byte goes.
    pub(super) fn push(&mut self, byte: u8, counters: &mut Counters) {
        if self.buffer.is_full() {
            count(&mut counters.bytes_skipped);
            self.discard(1);
        }
        let _ = self.buffer.push(byte);
    }

    /// Whether nothing waits.
    pub(super) fn is_empty(&self) -> bool {
        self.buffer.is_empty()
    }

    /// The frame at the front, if one is complete. It stays there until [`Framer::consume`].
    pub(super) fn frame(&mut self, counters: &mut Counters) -> Option<&[u8]> {
        let length = loop {
            match self.front() {
                Front::Complete { length } => break length,
                Front::Incomplete => return None,
                Front::NoFrame => self.resynchronise(counters),
                Front::WrongCrc => {
                    count(&mut counters.crc_failures);
                    self.resynchronise(counters);
                }
            }
        };
        self.buffer.get(..length)
    }

    /// Removes the frame that [`Framer::frame`] returned.
    pub(super) fn consume(&mut self) {
        if let Front::Complete { length } = self.front() {
            self.discard(length);
        }
    }

    /// Drops what no byte will complete, up to the first complete frame.
    pub(super) fn give_up(&mut self, counters: &mut Counters) {
        while !self.buffer.is_empty() {
            match self.front() {
                Front::Complete { .. } => return,
                Front::Incomplete => count(&mut counters.frames_cut),
                Front::WrongCrc => count(&mut counters.crc_failures),
                Front::NoFrame => {}
            }
            self.resynchronise(counters);
        }
    }

    fn front(&self) -> Front {
        let Some(&first) = self.buffer.first() else {
            return Front::Incomplete;
        };
        if first != PREAMBLE {
            return Front::NoFrame;
        }
        let Some(&[_, high, low]) = self.buffer.first_chunk::<HEADER>() else {
            return Front::Incomplete;
        };
        if high & 0b1111_1100 != 0 {
            return Front::NoFrame;
        }
        let length = HEADER + (usize::from(high) << 8 | usize::from(low)) + PARITY;
        match self.buffer.get(..length) {
            None => Front::Incomplete,
            Some(frame) if MessageFrame::new(frame).is_ok() => Front::Complete { length },
            Some(_) => Front::WrongCrc,
        }
    }

    /// Drops the first byte and all up to the next preamble.
    fn resynchronise(&mut self, counters: &mut Counters) {
        let next = self.buffer.iter().skip(1).position(|&byte| byte == PREAMBLE);
        let skipped = next.map_or(self.buffer.len(), |position| position + 1);
        count_many(&mut counters.bytes_skipped, skipped);
        self.discard(skipped);
    }

    fn discard(&mut self, many: usize) {
        let many = many.min(self.buffer.len());
        self.buffer.copy_within(many.., 0);
        self.buffer.truncate(self.buffer.len() - many);
    }
}

/// What is inside a frame.
pub(super) fn payload(frame: &[u8]) -> Option<&[u8]> {
    frame.get(HEADER..frame.len().checked_sub(PARITY)?)
}
