//! Tools of an adversary: skies as bytes, epoch by epoch, changed on the way.

use std::collections::BTreeSet;

use anyhow::Result;
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::fault::Measured;
use raim::signal::measurement::MeasuredEpoch;
use raim::signal::recording::Recording;
use raim::signal::sky::Site;
use raim::signal::sky::raw::Simulation;
use raim_core::frame::Ecef;
use raim_core::satellite::{Constellation, SatelliteId};
use rtcm_rs::{Message, MessageBuilder, MessageFrame};

/// A sky and the selection of signals to send.
pub(super) struct Sky {
    pub(super) recording: Recording,
    pub(super) truth: Ecef,
    selection: Selection,
}

impl Sky {
    /// Records GPS and `BeiDou` of a simulation, with the ephemerides of all their satellites.
    pub(super) fn of(simulation: &Simulation, frequency: Frequency) -> Result<Self> {
        let selection = Selection::new("GC", frequency)?;
        Ok(Self { recording: simulation.record(), truth: simulation.site.position, selection })
    }

    /// Records the systems with these letters of a simulation, with the ephemerides of the
    /// satellites in view.
    ///
    /// Those of all satellites of three systems would fill the memory of the module.
    pub(super) fn with(simulation: &Simulation, letters: &str, frequency: Frequency) -> Result<Self> {
        let mut sky = Self { selection: Selection::new(letters, frequency)?, ..Self::of(simulation, frequency)? };
        let seen: BTreeSet<SatelliteId> =
            sky.recording.epochs.iter().flat_map(Measured::satellites).collect();
        sky.recording.ephemerides.retain(|set| seen.contains(&set.satellite));
        Ok(sky)
    }

    /// Returns a sky above Xi'an on two frequencies, an epoch a second, halfway between two changes
    /// of ephemerides.
    pub(super) fn quiet(epochs: u32, seed: u64) -> Result<Self> {
        Self::of(&Simulation::above_xian(3600.0, epochs, seed), Frequency::Dual)
    }

    /// Encodes every epoch after `change` has altered it.
    pub(super) fn bytes(&self, mut change: impl FnMut(usize, &mut MeasuredEpoch)) -> Result<Vec<Vec<u8>>> {
        let mut encoder = self.encoder();
        let bytes = |(index, epoch): (usize, &MeasuredEpoch)| {
            let mut epoch = epoch.clone();
            change(index, &mut epoch);
            encoder.epoch(&epoch)
        };
        self.recording.epochs.iter().enumerate().map(bytes).collect()
    }

    /// Encodes the ranges of an epoch, without ephemerides.
    pub(super) fn ranges(&self, epoch: &MeasuredEpoch) -> Result<Vec<u8>> {
        Encoder::new(&[], self.selection.clone()).epoch(epoch)
    }

    /// Returns an encoder that sends ephemerides when they are due.
    pub(super) fn encoder(&self) -> Encoder {
        Encoder::new(&self.recording.ephemerides, self.selection.clone())
    }
}

/// Returns the same sky from a site `north_deg` degrees farther north.
pub(super) fn elsewhere(simulation: &Simulation, north_deg: f64) -> Simulation {
    let geodetic = simulation.site.frame.geodetic();
    let site = Site::geodetic(
        geodetic.latitude_rad.to_degrees() + north_deg,
        geodetic.longitude_rad.to_degrees(),
        geodetic.height_m,
    );
    Simulation { site, ..simulation.clone() }
}

/// Keeps the first `count` satellites of one system, in the order of their numbers, and drops all
/// others.
pub(super) fn keep_first(epoch: &mut MeasuredEpoch, constellation: Constellation, count: usize) {
    let mut kept: Vec<SatelliteId> =
        epoch.satellites().into_iter().filter(|id| id.constellation() == constellation).collect();
    kept.sort_unstable();
    kept.truncate(count);
    epoch.satellites.retain(|raw| kept.contains(&raw.satellite));
}

/// Returns a GPS or `BeiDou` ephemeris dated `weeks` weeks later. Other frames are unchanged.
pub(super) fn of_week(frame: &[u8], weeks: u16) -> Vec<u8> {
    match read(frame) {
        Some(Message::Msg1019(mut set)) => {
            set.gps_week_number = (set.gps_week_number + weeks) % 1024;
            write(&Message::Msg1019(set)).unwrap_or_default()
        }
        Some(Message::Msg1042(mut set)) => {
            set.bds_week_number += weeks;
            write(&Message::Msg1042(set)).unwrap_or_default()
        }
        _ => frame.to_vec(),
    }
}

/// Decodes a frame.
pub(super) fn read(frame: &[u8]) -> Option<Message> {
    MessageFrame::new(frame).ok().map(|frame| frame.get_message())
}

/// Encodes a message as a frame.
pub(super) fn write(message: &Message) -> Option<Vec<u8>> {
    MessageBuilder::new().build_message(message).ok().map(<[u8]>::to_vec)
}
