//! Text in and out: words of a command, and sentences into memory of the caller, each whole or not
//! at all.

use core::ffi::c_char;
use core::mem::MaybeUninit;

use embedded_io::{ErrorKind, ErrorType, Write};
use raim_firmware::settings::MAX_LINE;

use crate::status::{
    RAI_STATUS_COUNT, RAI_STATUS_MISALIGNED, RAI_STATUS_NULL, RAI_STATUS_TEXT, rai_status_t,
};

/// Returns a caller's text, if a command may contain it.
///
/// # Safety
/// `text` is null or points to bytes of which one is NUL, and which no other code writes to during
/// the call.
#[allow(unsafe_code)]
pub(crate) unsafe fn words<'a>(text: *const c_char) -> Result<&'a str, rai_status_t> {
    if text.is_null() {
        return Err(RAI_STATUS_NULL);
    }
    let text: *const u8 = text.cast();
    for length in 0..=MAX_LINE {
        // SAFETY: no byte before this one is NUL, so that it is part of the text.
        match unsafe { text.add(length).read() } {
            0 => {
                // SAFETY: so many bytes have just been read.
                let bytes = unsafe { core::slice::from_raw_parts(text, length) };
                return core::str::from_utf8(bytes).map_err(|_| RAI_STATUS_TEXT);
            }
            b'$' | b'*' => return Err(RAI_STATUS_TEXT),
            b' '..=b'~' => {}
            _ => return Err(RAI_STATUS_TEXT),
        }
    }
    Err(RAI_STATUS_TEXT)
}

/// Memory of the caller for sentences, with the number of bytes used.
#[repr(C)]
#[derive(Debug)]
pub struct rai_text_t {
    /// Memory for sentences.
    pub bytes: *mut u8,
    /// Length of the memory, bytes; 2,048 hold the sentences of any epoch.
    pub capacity: usize,
    /// Bytes used. A call appends to them; the caller sets it to 0 after sending the text.
    pub length: usize,
    /// Number of sentences without room since the caller last set it to 0. A sentence is written
    /// whole or not at all.
    pub lost: usize,
}

/// A caller's text for the time of one call.
pub(crate) struct Lines<'t> {
    /// Memory that is only written to, so that the caller need not initialise it.
    room: &'t mut [MaybeUninit<u8>],
    length: &'t mut usize,
    lost: &'t mut usize,
}

impl Lines<'_> {
    /// Returns the text behind a pointer.
    ///
    /// # Safety
    /// `text` is null or points to a text whose `bytes` are null or point to `capacity` bytes. No
    /// other code uses them during the call.
    #[allow(unsafe_code)]
    pub(crate) unsafe fn at(text: *mut rai_text_t) -> Result<Self, rai_status_t> {
        if text.is_null() {
            return Err(RAI_STATUS_NULL);
        }
        if !text.is_aligned() {
            return Err(RAI_STATUS_MISALIGNED);
        }
        // SAFETY: not null and aligned, and not shared during this call.
        let text = unsafe { &mut *text };
        if text.bytes.is_null() {
            return Err(RAI_STATUS_NULL);
        }
        if text.length > text.capacity || text.capacity > isize::MAX as usize {
            return Err(RAI_STATUS_COUNT);
        }
        // SAFETY: not null, bytes of any value, and of the stated length.
        let room = unsafe { core::slice::from_raw_parts_mut(text.bytes.cast(), text.capacity) };
        Ok(Self { room, length: &mut text.length, lost: &mut text.lost })
    }
}

impl ErrorType for Lines<'_> {
    type Error = ErrorKind;
}

impl Write for Lines<'_> {
    /// Takes a sentence whole, because the receiver writes each in one piece.
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
