//! The C interface of RAI: whether the position of a GNSS receiver may be used, for firmware written in C.
//!
//! Two levels, each with storage that the caller allocates:
//!
//! | functions | in | out |
//! |---|---|---|
//! | `rai_monitor_*` | corrected ranges and satellite positions of one instant | verdict, position, protection levels, satellites left out |
//! | `rai_receiver_*` | bytes of a GNSS receiver, the time, commands | sentences, pin, verdict |
//!
//! The header `include/rai.h` is made from these files (`cargo xtask header`), with what stands in this documentation.
//!
//! # Contract
//!
//! - **Memory.** An object lives in memory of the caller, at least `RAI_…_SIZE` bytes, aligned as `uint64_t`:
//!   a `rai_monitor_t` or `rai_receiver_t` is just that. The library allocates nothing, keeps no globals, calls nothing back
//!   and holds no pointer after a call has returned. An object may be copied or moved with `memcpy` between calls, and is
//!   forgotten by forgetting its memory.
//! - **Refusals.** Each function that can refuse returns a status; `RAI_STATUS_OK` is 0. Null and misaligned pointers, short
//!   memory and an object that was never initialised are refused by name, and nothing has changed then. A refusal is about the
//!   call: a fault of a satellite is a verdict.
//! - **Growth.** What is handed in or out as a struct begins with its size, set by the caller to `sizeof`. A library that knows
//!   more fields than the caller leaves those alone; one that knows fewer refuses with `RAI_STATUS_SIZE`. Enumerations are bytes
//!   with constants, so that a value from a later version is only an unknown number.
//! - **Threads.** One object, one thread at a time; different objects do not know of each other.
//!
//! - **Stack.** What each call needs stands at the top of the header, and is held to it on the emulated chip
//!   (`tests-host/tests/all/capi_bits`).
//!
//! # What is built in
//!
//! The smallest library is one of `rai_monitor_*` alone and holds classic RAIM (the global test under every policy, the search of
//! up to three satellites, protection levels, clock aiding) with the thresholds of the phases of flight. Features add to that;
//! without a choice all are in.
//!
//! | feature | adds |
//! |---|---|
//! | `receiver` | `rai_receiver_*`: RTCM 3 in, sentences and pin out |
//! | `ubx`, `glonass`, `mavlink` | messages of u-blox receivers, orbits of GLONASS, messages for autopilots |
//! | `tables` | thresholds for all committed probabilities |
//! | `searches` | `RAI_METHOD_SIMULTANEOUS` to `RAI_METHOD_RANSAC` |
//! | `araim` | `RAI_METHOD_SEPARATION` |
//! | `whole` | all of these |
//! | `satellites-16`, `satellites-32` | room for fewer satellites than 48 |
//!
//! `cargo xtask bench` prints what each takes of the flash, and the memory of the objects.
//!
//! # Safety
//!
//! This package is the only place beside the board files where `unsafe` stands, and it holds no logic: pointers are checked for
//! what can be checked, and become references for the time of the call. What cannot be checked is the caller's to promise: that
//! the memory behind a pointer is as long as said, and that nobody else writes to it during the call.
#![cfg_attr(target_os = "none", no_std)]
// The names are those of the header.
#![allow(non_camel_case_types)]

mod monitor;
#[cfg(all(target_os = "none", feature = "panic-handler"))]
mod panic;
mod pointer;
#[cfg(feature = "receiver")]
mod receiver;
mod settings;
mod status;
mod storage;
#[cfg(feature = "receiver")]
mod text;
mod verdict;

pub use monitor::*;
#[cfg(feature = "receiver")]
pub use receiver::*;
pub use settings::*;
pub use status::*;
pub use storage::*;
pub use verdict::*;

/// The version of this interface. It grows by one with every change that a program compiled against an older header would
/// misunderstand: a field that moved, a size that grew, a constant that means something else.
pub const RAI_ABI_VERSION: u32 = 2;

/// The version of the interface that the library was compiled with; equal to `RAI_ABI_VERSION` of a matching header.
#[unsafe(no_mangle)]
pub extern "C" fn rai_abi_version() -> u32 {
    RAI_ABI_VERSION
}
