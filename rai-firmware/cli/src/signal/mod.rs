//! Signals that the module receives: simulated, recorded or captured, with faults, as bytes.
//!
//! A source returns raw epochs, faults are injected, and the epochs are encoded as RTCM or UBX. The
//! bytes of one epoch are a lump.
//!
//! | module | content |
//! |---|---|
//! | [`sky`] | simulated skies: orbits, noise, receiver clock |
//! | [`measurement`] | measurements of a receiver and broadcasts of satellites, before any wire format |
//! | [`recording`], [`sample`] | RINEX 2, 3 and 4; a small real recording for users without one |
//! | [`capture`] | bytes of a receiver: UBX, SBF and RTCM 3, cut into epochs |
//! | [`fault`] | steps, ramps, shifts of a constellation, outages, clock jumps, around any source |
//! | `osnma` | a Galileo sky that a key of the tests signs; with the feature `sign` |
//! | [`encode`] | raw epochs and ephemerides to RTCM 3, UBX and SBF |
//! | [`lump`], [`lumps`], [`pieces`] | bytes of one epoch, a source of them, and the frames in them |
//! | [`sort`] | what a file holds, by its content |
//! | [`advice`] | what an input holds, what of it is not read, and what is missing |
//! | [`corrected`](mod@corrected) | ranges as the module corrects them |
//! | [`skipped`] | records that cannot be read, counted |
//! | [`calendar`] | dates, leap seconds |
//! | [`checksum`] | checksums of frames and sentences |
//! | [`clock_models`] | clock series with known predictions |

pub mod calendar;
pub mod checksum;
pub mod encode;
pub mod fault;
pub mod measurement;
#[cfg(feature = "sign")]
pub mod osnma;
#[cfg(feature = "recordings")]
pub mod recording;
pub mod skipped;
pub mod sky;

#[cfg(feature = "replay")]
pub mod advice;
#[cfg(feature = "replay")]
pub mod capture;
#[cfg(feature = "commands")]
pub mod clock_models;
#[cfg(feature = "replay")]
pub mod corrected;
#[cfg(feature = "replay")]
pub mod lump;
#[cfg(feature = "replay")]
pub mod lumps;
#[cfg(feature = "replay")]
pub mod pieces;
#[cfg(feature = "replay")]
pub mod sample;
#[cfg(feature = "replay")]
pub mod sort;
