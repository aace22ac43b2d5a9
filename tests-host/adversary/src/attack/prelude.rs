//! What nearly every attack uses.

pub(super) use anyhow::{Context as _, Result};
pub(super) use raim::in_order::Together as _;
pub(super) use raim::signal::encode::{Encoder, Frequency, Selection};
pub(super) use raim::signal::fault::Measured as _;
pub(super) use raim::signal::measurement::{Ephemeris, MeasuredEpoch, TimedEphemeris};
pub(super) use raim::signal::recording::Recording;
pub(super) use raim::signal::sky::raw::Simulation;
pub(super) use raim::signal::sky::{Fleet, Oscillator, Sight, Site};
pub(super) use raim_core::frame::{Ecef, Enu, SPEED_OF_LIGHT_M_S};
pub(super) use raim_core::satellite::{Constellation, SatelliteId};
pub(super) use raim_firmware::time::GpsTime;
pub(super) use rand::rngs::ChaCha8Rng;
pub(super) use rand::seq::IndexedRandom as _;
pub(super) use rand::{RngExt as _, SeedableRng as _};
pub(super) use rig::shared;

pub(super) use super::forgery::{
    GPS, GPS_BEIDOU, GPS_GALILEO, Sky, Systems, THREE, elsewhere, lasting, lengthen_all, move_ranges,
    of_system, satellites, signed_size, size, start_s, step_s,
};
pub(super) use super::tally::{MISSED, Tally, least_rate};
pub(super) use super::victim::{Seen, Victim};
pub(super) use super::{Attack, Branch, Effort, Figure};
