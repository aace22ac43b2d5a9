//! Sentences into memory of the caller, whole or not at all.

use core::mem::MaybeUninit;

use embedded_io::{ErrorKind, ErrorType, Write};

use crate::receiver::rai_text_t;
use crate::status::{RAI_STATUS_COUNT, RAI_STATUS_MISALIGNED, RAI_STATUS_NULL, rai_status_t};

/// A caller's text for the time of one call.
pub(crate) struct Lines<'t> {
    /// Only written to: the caller need not have initialised it.
    room: &'t mut [MaybeUninit<u8>],
    length: &'t mut usize,
    lost: &'t mut usize,
}

impl Lines<'_> {
    /// The text that a pointer names.
    ///
    /// # Safety
    /// `text` is null or points to a text whose `bytes` are null or point to `capacity` bytes that nobody else uses during the call.
    #[allow(unsafe_code)]
    pub(crate) unsafe fn at(text: *mut rai_text_t) -> Result<Self, rai_status_t> {
        if text.is_null() {
            return Err(RAI_STATUS_NULL);
        }
        if !text.is_aligned() {
            return Err(RAI_STATUS_MISALIGNED);
        }
        // SAFETY: not null and aligned, and for this call nobody else's.
        let text = unsafe { &mut *text };
        if text.bytes.is_null() {
            return Err(RAI_STATUS_NULL);
        }
        if text.length > text.capacity || text.capacity > isize::MAX as usize {
            return Err(RAI_STATUS_COUNT);
        }
        // SAFETY: not null, of bytes that may be anything, and as long as said.
        let room = unsafe { core::slice::from_raw_parts_mut(text.bytes.cast(), text.capacity) };
        Ok(Self { room, length: &mut text.length, lost: &mut text.lost })
    }
}

impl ErrorType for Lines<'_> {
    type Error = ErrorKind;
}

impl Write for Lines<'_> {
    /// Takes a sentence whole: the receiver hands each over in one piece.
    fn write(&mut self, sentence: &[u8]) -> Result<usize, ErrorKind> {
        let end = self.length.saturating_add(sentence.len());
        let Some(place) = self.room.get_mut(*self.length..end) else {
            *self.lost = self.lost.saturating_add(1);
            return Err(ErrorKind::OutOfMemory);
        };
        for (place, byte) in place.iter_mut().zip(sentence) {
            place.write(*byte);
        }
        *self.length = end;
        Ok(sentence.len())
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}
