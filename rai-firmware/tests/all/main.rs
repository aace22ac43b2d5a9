//! What the library of the firmware does, seen from outside.
//!
//! One program for all: what they have in common is compiled and linked once.

mod atmosphere;
mod commands;
mod ephemeris;
mod ephemeris_store;
mod frequency;
mod nmea;
mod orbit_reference;
mod orbits;
mod rtcm;
mod single_frequency;
mod walker;
mod wire;
