//! A recording through the module, and what came of it.
//!
//! ```text
//! recording, capture ─► lumps (window, faults) ─► on the host │ on the board ─► sentences ─► track ─► summary, CSV, report
//! ```
//!
//! One lump is the bytes of one epoch: the RTCM that a recording becomes, or what a receiver sent ([`crate::capture`]).
//! Lumps are made and played one after the other, so that the length of a recording does not matter.
//!
//! Time runs as it was recorded: where epochs are missing the line is silent, and the module is left to notice. The host runs
//! the firmware's library in process; the board is the emulated chip. Both get the same bytes and both are read only through
//! their sentences, so that they can be compared byte for byte; the board is fed the next lump when it has spoken of the last
//! one, and knows no silence.

mod ahead;
mod corrected;
mod host;
mod lump;
mod lumps;
mod page;
pub mod pieces;
mod quantiles;
mod settings;
mod summary;
mod target;
mod track;
mod truth;

pub use corrected::corrected;
pub use host::{HostRun, Pace, Playback, Said, Setup, on_host};
pub use lump::Lump;
pub(crate) use lumps::Heaven;
pub use lumps::{Broadcast, Encoding, Window, encode};
pub use page::Report;
pub use settings::{command_for, every, words};
pub use summary::{Injected, Summary, Tally};
pub use target::{BoardRun, Heard, is_said_by_the_clock, on_board};
pub use track::{Moment, Rows, Track, track};
pub use truth::Truth;
