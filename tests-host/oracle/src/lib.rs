//! Second opinions on the module: other programs and reference values.
//!
//! | module | content |
//! |---|---|
//! | [`gpsd`], [`chrony`] | programs that read the module's sentences |
//! | [`browser`] | browsers that open a page |
//! | [`geoid`] | the geoid table, from EGM96 |
//! | [`tables`] | the threshold tables and their check |
//! | [`vectors`] | reference values |
//!
//! Second opinions by slow and exact methods are in [`raim::second_opinion`].

pub mod browser;
pub mod chrony;
pub mod geoid;
pub mod gpsd;
pub mod tables;
pub mod vectors;
