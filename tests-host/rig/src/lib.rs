//! Measurements on the emulated boards, replays there, and the proofs about the image.
//!
//! | module | content |
//! |---|---|
//! | [`board`], [`demo`], [`skip`] | those of the package `emulated` |
//! | [`image`](mod@image) | the firmware's images: their builds, names and memory |
//! | [`lockstep`] | a replay on the emulated board, beside the module in process |
//! | [`paced`] | the module on a model of its ports, in simulated time |
//! | [`watched`](mod@watched) | the demonstration as a source of the live view |
//! | [`no_panic`] | the proof that nothing panics, by the linker |
//! | [`bench`](mod@bench), [`laboratory`] | cost of each stage on the chip; single stages on the emulated core |
//! | [`capi`] | the C interface: its library, and programs that call it |
//! | [`document`] | documents of the project, compared with what tests compute |
//! | [`shared`], [`stations`], [`recordings`] | recordings of real stations: in the reference folder, and in packages |
//!
//! # References
//!
//! | tag | source |
//! |---|---|
//! | `ARMv7-M` | ARM DDI 0403, *ARMv7-M Architecture Reference Manual* |
//! | `DS8626` | STMicroelectronics, *STM32F405xx STM32F407xx*, data sheet |
//! | `RM0090` | STMicroelectronics, RM0090, *STM32F405/415, STM32F407/417, STM32F427/437 and STM32F429/439 advanced Arm-based 32-bit MCUs*, reference manual |

pub mod bench;
pub mod capi;
pub mod document;
pub mod image;
pub mod laboratory;
pub mod lockstep;
pub mod no_panic;
pub mod paced;
pub mod recordings;
pub mod shared;
mod source_lines;
pub mod stations;
mod watched;

pub use emulated::{board, demo, skip};
pub use watched::watched;
pub use xtask::setup;
