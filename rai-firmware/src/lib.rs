//! The receiver around the integrity core: RTCM 3 in, NMEA and a fail-safe pin out.
//!
//! Hardware-free: the same code runs on the host and on the chip.
#![no_std]

#[cfg(test)]
extern crate std;

pub mod atmosphere;
pub mod config;
pub mod correction;
pub mod counters;
pub mod ephemeris;
pub mod navigator;
pub mod nmea;
pub mod receiver;
pub mod reset;
pub mod ring;
pub mod rtcm;
pub mod selftest;
pub mod signal;
pub mod time;
