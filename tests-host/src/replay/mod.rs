//! A recording through the module, and what came of it.
//!
//! ```text
//! recording ─► lumps (window, faults, RTCM) ─► on the host │ on the board ─► sentences ─► track ─► summary, CSV, report
//! ```
//!
//! One lump is the RTCM of one epoch. The host runs the firmware's library in process; the board is the emulated
//! chip. Both get the same bytes and both are read only through their sentences, so that they can be compared byte
//! for byte.

mod corrected;
mod host;
mod lumps;
mod page;
mod summary;
mod target;
mod track;

pub use corrected::corrected;
pub use host::{Setup, on_host};
pub use lumps::{Lump, Window, encode};
pub use page::write_report;
pub use summary::{Injected, Summary};
pub use target::{BoardRun, on_board};
pub use track::{Moment, Track, Truth, track, write_csv};
