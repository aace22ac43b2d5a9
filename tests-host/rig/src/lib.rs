//! The emulated boards, their measurements and the proofs about the image.
//!
//! | module | content |
//! |---|---|
//! | [`image`](mod@image), [`board`] | the firmware's image; the chip in the emulator: start, feed, read, stop |
//! | [`lockstep`] | a replay on the emulated board, beside the module in process |
//! | [`paced`] | the module on a model of its ports, in simulated time |
//! | [`demo`] | the demonstration, from input to report |
//! | [`no_panic`] | the proof that nothing panics, by the linker |
//! | [`bench`](mod@bench), [`laboratory`] | cost of each stage on the chip; single stages on the emulated core |
//! | [`capi`] | the C interface: its header, its library, and programs that call it |
//! | [`document`] | documents of the project, compared with what tests compute |
//! | [`skip`] | tests that are skipped on a machine without their requirements |
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
pub mod board;
pub mod capi;
pub mod demo;
pub mod document;
pub mod image;
pub mod laboratory;
pub mod lockstep;
pub mod no_panic;
pub mod paced;
pub mod recordings;
pub mod shared;
pub mod skip;
mod source_lines;
pub mod stations;

pub use xtask::setup;
