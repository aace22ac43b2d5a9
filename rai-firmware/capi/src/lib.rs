//! The C interface of RAI, for firmware written in C: a verdict on the position of a GNSS receiver.
//!
//! Two levels, each with storage that the caller allocates:
//!
//! | functions | in | out |
//! |---|---|---|
//! | `rai_monitor_*` | corrected ranges and satellite positions of one instant | verdict, position, protection levels, satellites left out |
//! | `rai_receiver_*` | bytes of a GNSS receiver, the time, commands | sentences, pin, verdict |
//!
//! `rai_receiver_set` takes a command as a key and its values, without a checksum. Both levels
//! explain their last epoch: `…_accuracy` (covariance, dilutions, clocks) and `…_residuals` (one
//! for each satellite), the receiver also `rai_receiver_velocity`, `rai_receiver_counter` and, with
//! OSNMA, `rai_receiver_authentication`.
//!
//! `cargo xtask header` makes the header `include/rai.h` from these files, with this documentation.
//!
//! # Contract
//!
//! - **Memory.** An object lives in memory of the caller, at least `RAI_…_SIZE` bytes, aligned as
//!   `uint64_t`. A `rai_monitor_t` or `rai_receiver_t` has that size and alignment. The library
//!   allocates nothing, keeps no globals, calls nothing back and holds no pointer after a call has
//!   returned. An object may be copied or moved with `memcpy` between calls. It needs no end: its
//!   memory may be reused.
//! - **Refusals.** Each function that can refuse returns a status; `RAI_STATUS_OK` is 0. Null and
//!   misaligned pointers, short memory and an object that was never initialised each have their own
//!   status. A refused call has changed nothing. A refusal is about the call, whereas a fault of a
//!   satellite is a verdict.
//! - **Growth.** A struct that is passed in or out begins with its size, set by the caller to
//!   `sizeof`. A library that knows more fields than the caller does not touch them; one that knows
//!   fewer refuses with `RAI_STATUS_SIZE`. Enumerations are bytes with constants, so that a value
//!   from a later version is only an unknown number.
//! - **Threads.** One thread at a time may use an object. Different objects are independent.
//! - **Stack.** The top of the header states the stack of each call. A test on the emulated chip
//!   compares it (`tests-host/tests/all/at_length/capi_bits`).
//!
//! # Features
//!
//! The smallest library has `rai_monitor_*` alone with classic RAIM: the global test under every
//! policy, the search of up to three satellites, protection levels and clock aiding. It has the
//! thresholds of the phases of flight. Features add to that; the default is all of them.
//!
//! | feature | adds |
//! |---|---|
//! | `receiver` | `rai_receiver_*`: RTCM 3 in, sentences and pin out |
//! | `ubx`, `sbf`, `glonass`, `mavlink` | messages of u-blox receivers, blocks of Septentrio receivers, orbits of GLONASS, messages for autopilots |
//! | `gsv` | satellites in view (`OUTPUT,GSV`); not part of `whole` |
//! | `osnma` | authenticated ephemerides of Galileo; not part of `whole` |
//! | `tables` | thresholds for all committed probabilities |
//! | `searches` | `RAI_METHOD_SIMULTANEOUS` to `RAI_METHOD_RANSAC` |
//! | `araim` | `RAI_METHOD_SEPARATION` |
//! | `whole` | all of the above |
//! | `watcher` | on a computer: the receiver keeps its account of the satellites of an epoch, for Python; not in the header and not part of `whole` |
//! | `satellites-32`, `satellites-48` | at most 32 or 48 satellites in an epoch; without both 16, in less memory |
//!
//! `cargo xtask bench` prints the flash of each feature, and the memory of the objects.
//!
//! # Safety
//!
//! Only this package and the board files contain `unsafe` in shipped code. It holds no logic:
//! it checks pointers as far as possible, and converts them to references for the time of the call.
//! The caller must ensure the rest: the memory behind a pointer has the stated length, and no other
//! code writes to it during the call.
#![cfg_attr(target_os = "none", no_std)]
// These are the names of the header.
#![allow(non_camel_case_types)]

mod accuracy;
#[cfg(feature = "receiver")]
mod authentication;
#[cfg(feature = "receiver")]
mod counter;
mod monitor;
#[cfg(all(target_os = "none", feature = "panic-handler"))]
mod panic;
mod pointer;
#[cfg(feature = "receiver")]
mod receiver;
mod residual;
mod settings;
mod status;
mod storage;
#[cfg(feature = "receiver")]
mod text;
#[cfg(feature = "receiver")]
mod velocity;
mod verdict;
#[cfg(feature = "watcher")]
mod watcher;

pub use accuracy::*;
#[cfg(feature = "receiver")]
pub use authentication::*;
#[cfg(feature = "receiver")]
pub use counter::*;
pub use monitor::*;
#[cfg(feature = "receiver")]
pub use receiver::*;
pub use residual::*;
pub use settings::*;
pub use status::*;
pub use storage::*;
#[cfg(feature = "receiver")]
pub use text::rai_text_t;
#[cfg(feature = "receiver")]
pub use velocity::*;
pub use verdict::*;
#[cfg(feature = "watcher")]
pub use watcher::*;

use core::ffi::{CStr, c_char};

/// Version of this interface. It grows by one with every change that would break a program compiled
/// against an older header. Such changes are a field that moved, a size that grew, and a constant
/// with a new meaning.
pub const RAI_ABI_VERSION: u32 = 4;

/// Returns the version of the interface that the library was compiled with, equal to
/// `RAI_ABI_VERSION` of a matching header.
#[unsafe(no_mangle)]
pub extern "C" fn rai_abi_version() -> u32 {
    RAI_ABI_VERSION
}

/// Returns the version of the library, equal to `RAI_VERSION` of the header that came with it; a
/// string that lives as long as the program.
#[unsafe(no_mangle)]
pub extern "C" fn rai_version() -> *const c_char {
    const VERSION: &CStr =
        match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(version) => version,
            Err(_) => panic!("the version has no NUL but the last"),
        };
    VERSION.as_ptr()
}
