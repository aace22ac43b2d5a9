//! Live view of a module: its sentences as a picture in the terminal.
//!
//! ```text
//! source ──lines──► Dashboard ──► draw ──► terminal
//!    └─────────────► recording
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`source`] | sources of sentences: a serial port, TCP, a recording of sentences, a capture |
//! | [`speed`] | speed at which a file is shown |
//! | [`Dashboard`] | state of the module, as far as it is shown |
//! | [`draw`] | the picture |
//! | [`plain`] | the same as lines of text |
//! | [`heaven`] | directions of satellites, if the source sends orbits |
//!
//! The pin is shown as the source knows it. The emulated board reports its level; behind a wire the
//! verdict implies the level, and the picture marks it so.

mod charts;
pub mod command;
pub mod draw;
pub mod heaven;
mod model;
pub mod plain;
pub mod source;
pub mod speed;

pub use model::{Dashboard, Pin, Point};
