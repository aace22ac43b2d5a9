//! Counters of the receiver: unused input by its reason, verdicts, commands.

use core::ffi::c_char;

use crate::pointer::{Versioned, give, status_of};
use crate::receiver::{at, rai_receiver_t};
use crate::status::{RAI_STATUS_COUNT, rai_status_t};

/// Bytes of a counter's name, with the NUL at its end.
pub const RAI_COUNTER_NAME_SIZE: usize = 36;

/// Counter of a receiver.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rai_counter_t {
    /// `sizeof(rai_counter_t)`, set by the caller.
    pub size: u32,
    /// Count since start; it stays at its largest value.
    pub value: u32,
    /// Name, as in the answer to the command `STATS`, with a NUL at its end.
    pub name: [c_char; RAI_COUNTER_NAME_SIZE],
}

#[allow(unsafe_code)]
// SAFETY: `repr(C)`, its size first, and integers, of which every pattern of bits is a value.
unsafe impl Versioned for rai_counter_t {
    const FIRST_SIZE: usize = 44;
}

const _: () =
    assert!(size_of::<rai_counter_t>() == 44, "a field came or moved: raise RAI_ABI_VERSION if it moved");

impl rai_counter_t {
    #[allow(
        clippy::cast_possible_wrap,
        reason = "characters of C are signed here and there; names are ASCII"
    )]
    fn of(name: &str, value: u32) -> Self {
        let mut counter = Self { size: size_of::<Self>() as u32, value, name: [0; RAI_COUNTER_NAME_SIZE] };
        // The last byte stays NUL.
        let room = counter.name.iter_mut().take(RAI_COUNTER_NAME_SIZE - 1);
        for (place, byte) in room.zip(name.bytes()) {
            *place = byte as c_char;
        }
        counter
    }
}

/// Writes the counter with this number, counted from 0. Refuses numbers beyond the last with
/// `RAI_STATUS_COUNT`, so that a loop ends there.
///
/// The numbers are those of one build of the library; a program that wants one counter compares the
/// names.
///
/// # Safety
/// As for `rai_receiver_pin`; `counter` is null or points to a struct of the size that it begins
/// with.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_counter(
    receiver: *const rai_receiver_t,
    number: usize,
    counter: *mut rai_counter_t,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let receiver = unsafe { at(receiver) };
    status_of(receiver.and_then(|receiver| {
        let (name, value) = receiver.statistic(number).ok_or(RAI_STATUS_COUNT)?;
        // SAFETY: guaranteed by the caller.
        unsafe { give(counter, &rai_counter_t::of(name, value)) }
    }))
}
