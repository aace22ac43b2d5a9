//! A live view of a module: its sentences as a picture in the terminal.
//!
//! ```text
//! source ──lines──► Dashboard ──► draw ──► terminal
//!    └─────────────► recording
//! ```
//!
//! | module | what |
//! |---|---|
//! | [`source`] | where sentences come from: a serial port, TCP, a recording of sentences, a capture, the emulated board |
//! | [`speed`] | how fast a file is shown |
//! | [`Dashboard`] | what has been heard, and what of it is shown |
//! | [`draw`] | the picture |
//! | [`plain`] | the same as lines of text |
//! | [`heaven`] | where satellites stand, as far as the source sends orbits |
//!
//! The pin is shown as the source knows it: the emulated board tells its level; behind a wire it is
//! what the verdict says it must be, and marked so.

mod charts;
pub mod draw;
pub mod heaven;
mod model;
pub mod plain;
pub mod source;
pub mod speed;

pub use model::{Dashboard, Pin, Point};
