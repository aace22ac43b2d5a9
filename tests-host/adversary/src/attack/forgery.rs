//! Tools of an adversary: skies as bytes, epoch by epoch, changed on the way.

use std::collections::BTreeSet;
use std::ops::Range;

use anyhow::Result;
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::fault::{Fault, Kind, Measured, Target};
use raim::signal::measurement::MeasuredEpoch;
use raim::signal::recording::Recording;
use raim::signal::sky::raw::Simulation;
use raim::signal::sky::{Fleet, Satellite, Sight, Site};
use raim_core::frame::Ecef;
use raim_core::satellite::{Constellation, SatelliteId};
use rand::RngExt as _;
use rand::rngs::ChaCha8Rng;
use rand::seq::IndexedRandom as _;
use rtcm_rs::{Message, MessageBuilder, MessageFrame};

/// Letters of systems, and their satellites.
pub(super) type Systems = (&'static str, &'static [Fleet]);

pub(super) const GPS: Systems = ("G", &[Fleet::Gps31]);
pub(super) const GPS_BEIDOU: Systems = ("GC", &[Fleet::Gps31, Fleet::BeidouRegional]);
pub(super) const GPS_GALILEO: Systems = ("GE", &[Fleet::Gps31, Fleet::Galileo24]);
pub(super) const THREE: Systems = ("GEC", &[Fleet::Gps31, Fleet::Galileo24, Fleet::BeidouGlobal]);

/// Returns the satellites of several fleets.
pub(super) fn satellites(fleets: &[Fleet]) -> Vec<Satellite> {
    fleets.iter().flat_map(|fleet| fleet.satellites()).collect()
}

/// Draws the start of a sky, s: a time of day on the full minute.
pub(super) fn start_s(chance: &mut ChaCha8Rng) -> f64 {
    f64::from(chance.random_range(0..1440_u32)) * 60.0
}

/// Draws a size uniformly in its logarithm.
pub(super) fn size(sizes: Range<f64>, chance: &mut ChaCha8Rng) -> f64 {
    chance.random_range(sizes.start.ln()..sizes.end.ln()).exp()
}

/// Draws a size uniformly in its logarithm, and its sign.
pub(super) fn signed_size(sizes: Range<f64>, chance: &mut ChaCha8Rng) -> f64 {
    let size = size(sizes, chance);
    if chance.random() { size } else { -size }
}

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
        let mut sky =
            Self { selection: Selection::new(letters, frequency)?, ..Self::of(simulation, frequency)? };
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

    /// Draws satellites of the first epoch, from seven to all in view, and one of them.
    pub(super) fn draw(&self, chance: &mut ChaCha8Rng) -> (Vec<SatelliteId>, SatelliteId) {
        let seen = self.recording.epochs[0].satellites();
        let count = chance.random_range(7..=seen.len().max(8));
        let kept: Vec<SatelliteId> = seen.sample(chance, count).copied().collect();
        let one = *kept.choose(chance).unwrap_or(&seen[0]);
        (kept, one)
    }

    /// Encodes every epoch after `change` has altered it, with the ephemerides that are due.
    pub(super) fn bytes(&self, mut change: impl FnMut(usize, &mut MeasuredEpoch)) -> Result<Vec<Vec<u8>>> {
        let mut encoder = Encoder::new(&self.recording.ephemerides, self.selection.clone());
        let bytes = |(index, epoch): (usize, &MeasuredEpoch)| {
            let mut epoch = epoch.clone();
            change(index, &mut epoch);
            encoder.epoch(&epoch)
        };
        self.recording.epochs.iter().enumerate().map(bytes).collect()
    }

    /// Encodes every epoch as it is.
    pub(super) fn unchanged(&self) -> Result<Vec<Vec<u8>>> {
        self.bytes(|_, _| {})
    }

    /// Encodes the ranges of an epoch, without ephemerides.
    pub(super) fn ranges(&self, epoch: &MeasuredEpoch) -> Result<Vec<u8>> {
        Encoder::new(&[], self.selection.clone()).epoch(epoch)
    }
}

/// Returns the same sky from a site `north_deg` degrees farther north.
pub(super) fn elsewhere(simulation: &Simulation, north_deg: f64) -> Simulation {
    moved(simulation, north_deg, 0.0)
}

/// Returns the same sky from a site so many degrees farther north and metres higher.
pub(super) fn moved(simulation: &Simulation, north_deg: f64, up_m: f64) -> Simulation {
    let geodetic = simulation.site.frame.geodetic();
    let site = Site::geodetic(
        geodetic.latitude_rad.to_degrees() + north_deg,
        geodetic.longitude_rad.to_degrees(),
        geodetic.height_m + up_m,
    );
    Simulation { site, ..simulation.clone() }
}

/// Returns the time between two epochs of a recording, s.
pub(super) fn step_s(recording: &Recording) -> f64 {
    match recording.epochs.as_slice() {
        [first, second, ..] => second.time.since_ms(first.time) as f64 * 1e-3,
        _ => 1.0,
    }
}

/// Returns a fault of one satellite that lasts from an epoch on, of one a second.
pub(super) fn lasting(satellite: SatelliteId, kind: Kind, from: u32) -> Fault {
    Fault { target: Target::Satellite(satellite), kind, start_s: f64::from(from), end_s: f64::INFINITY }
}

/// Makes all ranges longer, m.
pub(super) fn lengthen_all(epoch: &mut MeasuredEpoch, by_m: f64) {
    for satellite in epoch.satellites() {
        epoch.lengthen(satellite, by_m);
    }
}

/// Changes ranges from those of one place to those of another.
pub(super) fn move_ranges(epoch: &mut MeasuredEpoch, here: &[Sight], there: &[Sight]) {
    for sight in here {
        if let Some(moved) = there.iter().find(|moved| moved.satellite == sight.satellite) {
            epoch.lengthen(sight.satellite, moved.range_m - sight.range_m);
        }
    }
}

/// Returns the satellites of one system, in the order of their numbers.
pub(super) fn of_system(epoch: &MeasuredEpoch, constellation: Constellation) -> Vec<SatelliteId> {
    let mut satellites = epoch.satellites();
    satellites.retain(|id| id.constellation() == constellation);
    satellites.sort_unstable();
    satellites
}

/// Keeps the first `count` satellites of one system, in the order of their numbers, and drops all
/// others.
pub(super) fn keep_first(epoch: &mut MeasuredEpoch, constellation: Constellation, count: usize) {
    let mut kept = of_system(epoch, constellation);
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
