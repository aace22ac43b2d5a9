//! Behaviour of the module `raim-firmware`, seen from outside.
//!
//! They stand here and not beside it, because the module is compiled in one part, as a release inlines it, and its own test
//! programs with it. This package compiles only what changed.

mod atmosphere;
mod commands;
mod ephemeris;
mod ephemeris_store;
mod frequency;
mod nmea;
mod orbit_reference;
mod orbits;
mod osnma;
mod rtcm;
mod single_frequency;
mod walker;
mod wire;
