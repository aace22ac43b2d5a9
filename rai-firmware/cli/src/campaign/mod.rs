//! Campaigns: availability and integrity over places and times, for many skies, masks, error models
//! and methods.
//!
//! ```text
//! SPEC.toml ──► cells (sky × mask × errors × place) ──► the module's own monitor, epoch by epoch ──► rows ──► CSV
//!                                                               CSV ──► maps, curves, one page
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`spec`] | the specification, checked once |
//! | [`sky`], [`almanac`], [`navigation`] | satellites: built in, of a YUMA almanac, of RINEX navigation files |
//! | [`place`] | points, a track, a grid over the globe |
//! | [`errors`] | sigmas, and the ranges of an epoch |
//! | [`cell`] | one place under one sky, judged by every method |
//! | [`statistics`] | outcomes, levels and errors of its epochs |
//! | [`table`] | rows as text: written in order, read again, merged |
//! | [`run`] | all cells or a share of them, from the beginning or from an interrupted run |
//! | [`picture`], [`map`], [`curve`], [`page`] | pictures of a table |
//!
//! A cell depends on the specification and on nothing else: not on threads, shares, or earlier
//! work. Hence any division of the work gives the same bytes.
//!
//! Epochs are judged by `rai-core`'s monitor in `f32`, set by the commands of the module. Positions
//! are not linearised beforehand: the monitor receives satellites and ranges. Each epoch is judged
//! independently.

pub mod almanac;
pub mod cell;
pub mod command;
pub mod curve;
pub mod errors;
pub mod map;
pub mod navigation;
pub mod page;
pub mod picture;
pub mod place;
pub mod run;
pub mod sky;
pub mod spec;
pub mod statistics;
pub mod table;
mod world;

pub use page::write_report;
pub use run::{Campaign, Share};
pub use table::{Table, merge};
