//! When the epoch under way came, which is not when it is complete.
//!
//! An epoch whose last message is lost ends with the first message of the next one, however long after. What is said of
//! the position must not be younger than the ranges it rests on, so an epoch is as old as its first message is, and that
//! message as old as its first byte may be: it came no earlier than when the decoder last was between two frames.
//!
//! | instant | field | unit |
//! |---|---|---|
//! | the frame under way may have begun | `frame_ms` | ms since start |
//! | the epoch under way came | `epoch_ms` | ms since start |

use crate::rtcm::Decoder;

/// Arrival of the frame and of the epoch under way.
#[derive(Debug, Default)]
pub(crate) struct Arrival {
    frame_ms: u64,
    epoch_ms: Option<u64>,
}

impl Arrival {
    /// To be told before the decoder gets a byte.
    pub(crate) fn before_byte(&mut self, decoder: &Decoder, now_ms: u64) {
        if decoder.is_between_frames() {
            self.frame_ms = now_ms;
        }
    }

    /// To be told when the decoder has no event left: an epoch that is now under way began with the last frame.
    pub(crate) fn after_byte(&mut self, decoder: &Decoder) {
        if decoder.is_within_epoch() {
            self.epoch_ms.get_or_insert(self.frame_ms);
        }
    }

    /// When the epoch came that the decoder has just completed.
    pub(crate) fn of_epoch(&mut self) -> u64 {
        self.epoch_ms.take().unwrap_or(self.frame_ms)
    }
}
