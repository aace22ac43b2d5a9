//! Replay of a recording through the module, and its results.
//!
//! ```text
//! recording, capture ─► lumps (window, faults) ─► on the host │ on the board ─► verdicts ─► track ─► summary, CSV, report
//! ```
//!
//! One lump is the bytes of one epoch: the RTCM encoding of a recording, or the bytes of a receiver
//! ([`crate::signal::capture`]). Lumps are encoded and played one by one, so that the length of a
//! recording does not matter.
//!
//! Time passes as it was recorded. If epochs are missing, the line is silent and the module must
//! detect this. The host runs the firmware's library in process and reads its verdicts by an observer;
//! the board is the emulated chip. Both receive the same bytes, and their sentences are compared byte
//! for byte. The board receives the next lump after its sentences for the last one, and thus has no
//! silence. It is in a package of its own, whose caller passes it to the [`command`].

mod ahead;
mod arguments;
mod board_run;
pub mod command;
pub mod host;
mod injected;
mod page;
mod progress;
mod quantiles;
pub(crate) mod settings;
mod sink;
mod source;
mod summary;
mod track;
mod tracks;
mod truth;

pub use crate::signal::corrected::corrected;
pub use crate::signal::lump::Lump;
pub use crate::signal::lumps::{Broadcast, Encoding, Window, encode};
pub use board_run::BoardRun;
pub use host::{HostRun, Module, Pace, Playback, Reported, Setup, check_answers, on_host};
pub use injected::Injected;
pub use page::{About, Report};
pub use settings::{command_for, every, setting, words};
pub use summary::{RunningSummary, Summary};
pub use track::{Moment, Rows, Track, track};
pub use truth::Truth;
