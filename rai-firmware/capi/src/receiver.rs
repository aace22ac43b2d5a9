//! The receiver: bytes of a GNSS receiver in, sentences and pin out.

use core::ffi::c_char;
use core::mem::MaybeUninit;

use raim_core::Verdict;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};

use crate::pointer::{Object, give, slice, status_of};
use crate::settings::refusal_of;
#[allow(clippy::wildcard_imports)] // The statuses are all of the module.
use crate::status::*;
use crate::storage::{RAI_RECEIVER_SIZE, RAI_RECEIVER_WORDS};
use crate::text::{Lines, rai_text_t, words};
use crate::verdict::{RAI_REASON_NONE, RAI_STATE_NONE, rai_verdict_t, state_of};
#[cfg(feature = "watcher")]
use crate::watcher::Watch;

/// Memory of a receiver. Its contents are private to the library; only its size and alignment
/// matter.
#[repr(C)]
pub struct rai_receiver_t {
    /// Private contents.
    pub opaque: [u64; RAI_RECEIVER_WORDS],
}

#[cfg(not(feature = "watcher"))]
type Module = Receiver<MemoryPin>;
#[cfg(feature = "watcher")]
type Module = Receiver<MemoryPin, Watch>;

type Stored = Object<Module, 2>;

/// Makes a receiver in place, behind an exclusive reference, so that it is not on the stack first.
#[inline(never)]
fn make(place: &mut MaybeUninit<Module>) -> Result<(), rai_status_t> {
    let mut boot = Boot::on_host("library");
    boot.clock_error_ppm = Boot::WITHOUT_CRYSTAL_PPM;
    #[cfg(not(feature = "watcher"))]
    let placed = Receiver::place(place, MemoryPin::default(), boot);
    #[cfg(feature = "watcher")]
    let placed = Receiver::place_observed(place, MemoryPin::default(), Watch::new(), boot);
    placed.map(|_| ()).map_err(refusal_of)
}

/// Returns the receiver behind a handle.
///
/// # Safety
/// As for `Stored::at`.
#[allow(unsafe_code)]
pub(crate) unsafe fn at<'a>(handle: *const rai_receiver_t) -> Result<&'a mut Module, rai_status_t> {
    // SAFETY: guaranteed by the caller.
    unsafe { Stored::at(handle.cast_mut().cast()) }
}

// A receiver that is watched is larger: its program takes as much as `rai_receiver_size` states.
const _: () = assert!(
    (cfg!(feature = "watcher") || size_of::<Stored>() <= RAI_RECEIVER_SIZE)
        && align_of::<Stored>() <= align_of::<rai_receiver_t>(),
    "the receiver has outgrown RAI_RECEIVER_SIZE: raise it, and RAI_ABI_VERSION with it"
);

// The same for linker scripts, and for tools that read the library without running it.
#[cfg(target_os = "none")]
core::arch::global_asm!(
    ".globl __rai_receiver_bytes",
    ".set __rai_receiver_bytes, {}",
    const size_of::<Stored>()
);

/// Largest time of a caller's clock, ms, 292 million years, so that sums with times later by days
/// do not overflow.
const LAST_MS: u64 = u64::MAX / 2;

/// Makes a receiver in memory of the caller, and writes sentences with its version and the result
/// of the self-test.
///
/// # Safety
/// `memory` is null or points to `length` bytes that no other code uses during the call. `out` is
/// null or points to a text whose `bytes` point to `capacity` bytes.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_init(
    memory: *mut rai_receiver_t,
    length: usize,
    out: *mut rai_text_t,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let lines = unsafe { Lines::at(out) };
    let placed = lines.and_then(|mut lines| {
        // SAFETY: guaranteed by the caller; all of the result is written.
        unsafe {
            Stored::room(memory.cast(), length)?.fill(
                |place: *mut Module| make(&mut *place.cast()),
                |receiver| {
                    receiver.greet(&mut lines);
                    Ok(())
                },
            )
        }
    });
    status_of(placed)
}

/// Takes bytes of the GNSS port that came at `now_ms`, milliseconds of a clock that does not go
/// back and is accurate to 4 %. A larger clock error delays the detection of late bytes.
///
/// If `judged` is not null, it becomes 1 if an epoch was judged during the call, else 0. Set the
/// pin after each call.
///
/// # Safety
/// `receiver` is null or points to memory of that size with initialised contents, not used
/// elsewhere during the call. `bytes` is null or points to `count` bytes; `out` as for
/// `rai_receiver_init`; `judged` is null or points to a byte.
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
    // SAFETY: guaranteed by the caller.
    let (receiver, bytes, lines) = unsafe { (at(receiver), slice(bytes, count), Lines::at(out)) };
    let taken = receiver.and_then(|receiver| Ok(receiver.gnss(bytes?, now_ms.min(LAST_MS), &mut lines?)));
    // SAFETY: guaranteed by the caller.
    if let Some(judged) = unsafe { judged.as_mut() } {
        *judged = taken.unwrap_or(false).into();
    }
    status_of(taken.map(drop))
}

/// Advances the time, which detects a silent line. Call it at least ten times a second, and set the
/// pin after each call.
///
/// # Safety
/// As for `rai_receiver_gnss`.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_tick(
    receiver: *mut rai_receiver_t,
    now_ms: u64,
    out: *mut rai_text_t,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let (receiver, lines) = unsafe { (at(receiver), Lines::at(out)) };
    status_of(receiver.and_then(|receiver| {
        receiver.tick(now_ms.min(LAST_MS), &mut lines?);
        Ok(())
    }))
}

/// Takes bytes of the host port, which are commands as sentences. Set the pin after each call.
///
/// # Safety
/// As for `rai_receiver_gnss`.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_command(
    receiver: *mut rai_receiver_t,
    bytes: *const u8,
    count: usize,
    out: *mut rai_text_t,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let (receiver, bytes, lines) = unsafe { (at(receiver), slice(bytes, count), Lines::at(out)) };
    status_of(receiver.and_then(|receiver| {
        receiver.command(bytes?, &mut lines?);
        Ok(())
    }))
}

/// Obeys one command, given as its key and its values: `"PHASE", "LPV200"` or `"OUTPUT", "RMC,1"`.
/// Null for `values` asks for the value in force. Set the pin after each call.
///
/// Keys and values are those of `rai_receiver_command`, without address and checksum. The answer is
/// written to `out`. A refused command has changed nothing; `rai_status_text` has the reason.
///
/// # Safety
/// As for `rai_receiver_gnss`; `key` is null or points to a text that ends with NUL, and so is
/// `values`.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_set(
    receiver: *mut rai_receiver_t,
    key: *const c_char,
    values: *const c_char,
    out: *mut rai_text_t,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let (receiver, key, lines) = unsafe { (at(receiver), words(key), Lines::at(out)) };
    // SAFETY: guaranteed by the caller.
    let values = if values.is_null() { Ok(None) } else { unsafe { words(values) }.map(Some) };
    status_of(receiver.and_then(|receiver| {
        let key = key?;
        if key.contains(',') {
            return Err(RAI_STATUS_TEXT);
        }
        receiver.set(key, values?, &mut lines?).map_err(of_refused_command)
    }))
}

/// Returns the level of the integrity pin: 1 while the position of the last epoch may be used, else
/// 0, also for an invalid handle.
///
/// # Safety
/// `receiver` is null or points to memory of that size with initialised contents, not used
/// elsewhere during the call.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_pin(receiver: *const rai_receiver_t) -> u8 {
    // SAFETY: guaranteed by the caller.
    unsafe { at(receiver) }.is_ok_and(|receiver| receiver.pin().high).into()
}

/// Returns 1 if the host has requested a restart by command, else 0. The caller then makes the
/// receiver again.
///
/// # Safety
/// As for `rai_receiver_pin`.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_reset_requested(receiver: *const rai_receiver_t) -> u8 {
    // SAFETY: guaranteed by the caller.
    unsafe { at(receiver) }.is_ok_and(|receiver| receiver.reset_requested()).into()
}

/// Returns the state of the last verdict (`RAI_STATE_…`), and writes its reason (`RAI_REASON_…`) to
/// `reason`.
///
/// # Safety
/// As for `rai_receiver_pin`; `reason` is null or points to a byte.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_state(receiver: *const rai_receiver_t, reason: *mut u8) -> u8 {
    // SAFETY: guaranteed by the caller.
    let verdict = unsafe { at(receiver) }.ok().and_then(|receiver| receiver.last_verdict());
    // SAFETY: guaranteed by the caller.
    if let Some(reason) = unsafe { reason.as_mut() } {
        *reason = verdict.map_or(RAI_REASON_NONE, Verdict::code);
    }
    verdict.map_or(RAI_STATE_NONE, state_of)
}

/// Writes the last verdict: state and reason, and of the last epoch its position, levels and the
/// satellites left out.
///
/// Before the first epoch the state is `RAI_STATE_NONE`; after a silence the verdict has no
/// position. Only `rai_receiver_pin` states if the position may be used now, because changed
/// settings drop the pin before the next epoch. The sentences count refused ranges; `refused_count`
/// is 0 here.
///
/// # Safety
/// As for `rai_receiver_pin`; `verdict` is null or points to a struct of the size that it begins
/// with.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_report(
    receiver: *const rai_receiver_t,
    verdict: *mut rai_verdict_t,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let receiver = unsafe { at(receiver) };
    // SAFETY: guaranteed by the caller.
    status_of(receiver.and_then(|receiver| unsafe { give(verdict, &said_last(receiver)) }))
}

fn said_last(receiver: &Module) -> rai_verdict_t {
    match (receiver.last_report(), receiver.last_verdict()) {
        (Some(report), _) => rai_verdict_t::of(report),
        (None, Some(verdict)) => rai_verdict_t::without_position(verdict),
        (None, None) => rai_verdict_t::none(),
    }
}

/// Returns the bytes of a receiver on this processor, at most `RAI_RECEIVER_SIZE`.
#[unsafe(no_mangle)]
pub extern "C" fn rai_receiver_size() -> usize {
    size_of::<Stored>()
}

/// Returns the alignment of a receiver on this processor, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn rai_receiver_align() -> usize {
    align_of::<Stored>()
}
