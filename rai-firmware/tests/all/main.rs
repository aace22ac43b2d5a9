//! Behaviour of the firmware's library, seen from outside.
//!
//! All tests are one program, so that their common part is compiled and linked once.

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
