//! The firmware's image on the emulated boards.
//!
//! | module | content |
//! |---|---|
//! | [`image`](mod@image) | its build by cargo |
//! | [`board`] | the chip in the emulator: start, feed, read, stop |
//! | [`demo`] | the demonstration, from input to report |
//! | [`skip`] | tests that are skipped on a machine without their requirements |
//!
//! Measurements, proofs and replays on the board are in the package `rig`, which takes longer to
//! compile.

pub mod board;
pub mod demo;
pub mod image;
pub mod skip;
