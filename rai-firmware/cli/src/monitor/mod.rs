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
//! | [`keys`] | meaning of the keys, and commands to the module |
//!
//! Everything about an epoch reaches the picture in one message, so that no picture contradicts
//! itself. The pin is shown as the source knows it. The emulated board reports its level; behind a
//! wire the verdict implies the level, and the picture marks it so.

mod batch;
mod charts;
pub mod command;
pub mod draw;
pub mod keys;
mod model;
pub mod plain;
pub mod source;
pub mod speed;

pub use model::{Dashboard, Pin, Point};
