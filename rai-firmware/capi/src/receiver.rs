//! Bytes of a GNSS receiver in, sentences and pin out: the whole module.

use core::mem::MaybeUninit;

use core::convert::Infallible;

use embedded_hal::digital::{ErrorType, OutputPin};
use rai_core::monitor::MonitorError;
use rai_firmware::receiver::{Boot, Receiver};

use crate::pointer::{Object, give, slice, status_of};
use crate::settings::refusal_of;
#[allow(clippy::wildcard_imports)] // The statuses are all of the module.
use crate::status::*;
use crate::storage::{RAI_RECEIVER_SIZE, RAI_RECEIVER_WORDS};
use crate::text::Lines;
use crate::verdict::{RAI_REASON_NONE, RAI_STATE_NONE, rai_verdict_t, reason_of, state_of};

/// A receiver's memory. What is in it is the library's affair; all that counts is its size and that it is aligned.
#[repr(C)]
pub struct rai_receiver_t {
    /// Not for reading.
    pub opaque: [u64; RAI_RECEIVER_WORDS],
}

/// A receiver as it was made, or was not: to take it out of the result would lay it out on the stack.
type Made = Result<Receiver<Level>, MonitorError>;

type Stored = Object<Made, 2>;

/// Makes a receiver where it is to stay: behind a reference that is the only one, it need not be on the stack first.
#[inline(never)]
fn make(place: &mut MaybeUninit<Made>) {
    let boot = Boot { clock_error_ppm: Boot::WITHOUT_CRYSTAL_PPM, ..Boot::on_host("library") };
    place.write(Receiver::new(Level { is_high: false }, boot));
}

/// The receiver that a handle points to.
///
/// # Safety
/// As `Stored::at`.
#[allow(unsafe_code)]
unsafe fn at<'a>(handle: *const rai_receiver_t) -> Result<&'a mut Receiver<Level>, rai_status_t> {
    // SAFETY: as promised by the caller.
    unsafe { Stored::at(handle.cast_mut().cast()) }?.as_mut().map_err(|&mut error| refusal_of(error))
}

const _: () = assert!(
    size_of::<Stored>() <= RAI_RECEIVER_SIZE && align_of::<Stored>() <= align_of::<rai_receiver_t>(),
    "the receiver has outgrown RAI_RECEIVER_SIZE: raise it, and RAI_ABI_VERSION with it"
);

// The same for linker scripts, and for whoever reads the library without running it.
#[cfg(target_os = "none")]
core::arch::global_asm!(
    ".globl __rai_receiver_bytes",
    ".set __rai_receiver_bytes, {}",
    const size_of::<Stored>()
);

/// Where a caller's clock ends, ms: sums with what is later by days do not overflow. It is 292 million years.
const LAST_MS: u64 = u64::MAX / 2;

/// The level of a pin that the caller drives.
#[derive(Debug)]
struct Level {
    is_high: bool,
}

impl ErrorType for Level {
    type Error = Infallible;
}

impl OutputPin for Level {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.is_high = false;
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.is_high = true;
        Ok(())
    }
}

/// Where a call writes sentences: memory of the caller, and how much of it is used.
#[repr(C)]
#[derive(Debug)]
pub struct rai_text_t {
    /// Room for sentences.
    pub bytes: *mut u8,
    /// How much room, bytes; 2,048 hold the sentences of any epoch.
    pub capacity: usize,
    /// How much of it is used. A call adds behind what is there; the caller sets it to 0 once it has sent the text on.
    pub length: usize,
    /// Sentences that found no room since the caller last set it to 0. A sentence is written whole or not at all.
    pub lost: usize,
}

/// Makes a receiver that has heard nothing in memory of the caller, and says what runs and whether its arithmetic is right.
///
/// # Safety
/// `memory` is null or points to `length` bytes that nobody else uses during the call; `out` is null or points to a text whose
/// `bytes` point to `capacity` bytes.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_init(
    memory: *mut rai_receiver_t,
    length: usize,
    out: *mut rai_text_t,
) -> rai_status_t {
    // SAFETY: as promised by the caller.
    let lines = unsafe { Lines::at(out) };
    let placed = lines.and_then(|mut lines| {
        // SAFETY: as promised by the caller; all of the result is written.
        unsafe {
            Stored::room(memory.cast(), length)?.fill(
                |place: *mut Made| make(&mut *place.cast()),
                |made| {
                    made.as_mut().map_err(|&mut error| refusal_of(error))?.greet(&mut lines);
                    Ok(())
                },
            )
        }
    });
    status_of(placed)
}

/// Takes bytes of the GNSS port that came at `now_ms`, milliseconds of any clock that does not go back and is within 4 %: what
/// comes later than others by more is found late.
///
/// `judged`, where it is not null, becomes 1 if an epoch was judged during the call, else 0. Set the pin after each call.
///
/// # Safety
/// `receiver` is null or points to memory of that size with initialised contents, not used elsewhere during the call; `bytes` is
/// null or points to `count` bytes; `out` as for `rai_receiver_init`; `judged` is null or points to a byte.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_gnss(
    receiver: *mut rai_receiver_t,
    bytes: *const u8,
    count: usize,
    now_ms: u64,
    out: *mut rai_text_t,
    judged: *mut u8,
) -> rai_status_t {
    // SAFETY: as promised by the caller.
    let (receiver, bytes, lines) = unsafe { (at(receiver), slice(bytes, count), Lines::at(out)) };
    let taken = receiver.and_then(|receiver| Ok(receiver.gnss(bytes?, now_ms.min(LAST_MS), &mut lines?)));
    // SAFETY: as promised by the caller.
    if let Some(judged) = unsafe { judged.as_mut() } {
        *judged = taken.unwrap_or(false).into();
    }
    status_of(taken.map(drop))
}

/// Lets time pass: a silent line is noticed here. To be called at least ten times a second; set the pin after each call.
///
/// # Safety
/// As `rai_receiver_gnss`.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_tick(
    receiver: *mut rai_receiver_t,
    now_ms: u64,
    out: *mut rai_text_t,
) -> rai_status_t {
    // SAFETY: as promised by the caller.
    let (receiver, lines) = unsafe { (at(receiver), Lines::at(out)) };
    status_of(receiver.and_then(|receiver| {
        receiver.tick(now_ms.min(LAST_MS), &mut lines?);
        Ok(())
    }))
}

/// Takes bytes of the host port: commands as sentences. Set the pin after each call.
///
/// # Safety
/// As `rai_receiver_gnss`.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_command(
    receiver: *mut rai_receiver_t,
    bytes: *const u8,
    count: usize,
    out: *mut rai_text_t,
) -> rai_status_t {
    // SAFETY: as promised by the caller.
    let (receiver, bytes, lines) = unsafe { (at(receiver), slice(bytes, count), Lines::at(out)) };
    status_of(receiver.and_then(|receiver| {
        receiver.command(bytes?, &mut lines?);
        Ok(())
    }))
}

/// The level of the integrity pin: 1 while the position of the last epoch may be used; 0 in every other case, bad handles
/// included.
///
/// # Safety
/// `receiver` is null or points to memory of that size with initialised contents, not used elsewhere during the call.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_pin(receiver: *const rai_receiver_t) -> u8 {
    // SAFETY: as promised by the caller.
    unsafe { at(receiver) }.is_ok_and(|receiver| receiver.pin().is_high).into()
}

/// Whether the host has asked for a restart by command: 1 if so. The caller then makes the receiver anew.
///
/// # Safety
/// As `rai_receiver_pin`.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_reset_requested(receiver: *const rai_receiver_t) -> u8 {
    // SAFETY: as promised by the caller.
    unsafe { at(receiver) }.is_ok_and(|receiver| receiver.reset_requested()).into()
}

/// What was said last: state in the low byte (`RAI_STATE_…`), reason in the next (`RAI_REASON_…`).
///
/// # Safety
/// As `rai_receiver_pin`.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_state(receiver: *const rai_receiver_t, reason: *mut u8) -> u8 {
    // SAFETY: as promised by the caller.
    let verdict = unsafe { at(receiver) }.ok().and_then(|receiver| receiver.last_verdict());
    // SAFETY: as promised by the caller.
    if let Some(reason) = unsafe { reason.as_mut() } {
        *reason = verdict.map_or(RAI_REASON_NONE, reason_of);
    }
    verdict.map_or(RAI_STATE_NONE, state_of)
}

/// What was said last, whole: state and reason, and of the last epoch its position, levels and the satellites left out.
///
/// Before the first epoch the state is `RAI_STATE_NONE`; after a silence no position is there. Whether the position may be used
/// now says `rai_receiver_pin`: other settings take the promise back before the next epoch. Ranges are counted by the
/// sentences; `refused_count` is 0 here.
///
/// # Safety
/// As `rai_receiver_pin`; `verdict` is null or points to a struct of the size that it begins with.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_report(
    receiver: *const rai_receiver_t,
    verdict: *mut rai_verdict_t,
) -> rai_status_t {
    // SAFETY: as promised by the caller.
    let receiver = unsafe { at(receiver) };
    // SAFETY: as promised by the caller.
    status_of(receiver.and_then(|receiver| unsafe { give(verdict, &said_last(receiver)) }))
}

fn said_last(receiver: &Receiver<Level>) -> rai_verdict_t {
    match (receiver.last_report(), receiver.last_verdict()) {
        (Some(report), _) => rai_verdict_t::of(report),
        (None, Some(verdict)) => rai_verdict_t::without_position(verdict),
        (None, None) => rai_verdict_t::none(),
    }
}

/// Bytes that a receiver takes here; at most `RAI_RECEIVER_SIZE`.
#[unsafe(no_mangle)]
pub extern "C" fn rai_receiver_size() -> usize {
    size_of::<Stored>()
}

/// The alignment that a receiver needs here, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn rai_receiver_align() -> usize {
    align_of::<Stored>()
}
