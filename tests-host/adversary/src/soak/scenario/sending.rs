//! The receiver's part: encodes the epochs of a passage, and repeats ephemerides in turn.

use std::collections::VecDeque;

use anyhow::Result;
use raim::signal::encode::Encoder;
use raim::signal::measurement::{MeasuredEpoch, TimedEphemeris};
use raim::signal::sky::Site;
use rig::demo::Accepter;

use super::Passage;
use crate::soak::noise;

/// Elevation mask of the module at start, degrees, also applied to the position from all
/// satellites.
const MASK_DEG: f64 = 10.0;

/// State of sending a passage.
pub(super) struct Sending<'a> {
    pub(super) passage: &'a Passage,
    encoder: Encoder,
    repeated: VecDeque<Vec<u8>>,
    pub(super) accepter: Accepter,
    pub(super) site: Site,
}

impl<'a> Sending<'a> {
    pub(super) fn new(passage: &'a Passage) -> Self {
        let encoder = Encoder::new(&passage.recording.ephemerides, passage.selection.clone());
        let (accepter, site) = (Accepter::new(MASK_DEG.to_radians()), Site::at(passage.truth));
        Self { passage, encoder, repeated: VecDeque::new(), accepter, site }
    }

    /// Encodes an epoch after the ephemerides whose turn it is.
    pub(super) fn bytes(&mut self, epoch: &MeasuredEpoch, repeated: usize) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        for _ in 0..repeated {
            if self.repeated.is_empty() {
                self.repeated = self.known(epoch)?;
            }
            bytes.extend(self.repeated.pop_front().unwrap_or_default());
        }
        bytes.extend(self.encoder.epoch(epoch)?);
        Ok(bytes)
    }

    /// Returns a frame for each known ephemeris of a satellite in view.
    fn known(&self, epoch: &MeasuredEpoch) -> Result<VecDeque<Vec<u8>>> {
        let is_seen = |ephemeris: &&TimedEphemeris| {
            epoch.satellites.iter().any(|seen| seen.satellite == ephemeris.satellite)
        };
        let seen: Vec<TimedEphemeris> =
            self.passage.recording.ephemerides.iter().filter(is_seen).cloned().collect();
        let lump = self.frames(epoch, &seen)?;
        Ok(noise::frames(&lump).into_iter().map(<[u8]>::to_vec).collect())
    }

    /// Encodes ephemerides as they are sent at an epoch.
    pub(super) fn frames(&self, epoch: &MeasuredEpoch, sets: &[TimedEphemeris]) -> Result<Vec<u8>> {
        let nothing = MeasuredEpoch { time: epoch.time, satellites: Vec::new() };
        Encoder::new(sets, self.passage.selection.clone()).epoch(&nothing)
    }
}
