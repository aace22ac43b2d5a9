//! Plans: the epochs of a soak, their pace, and the rate of incidents.

use anyhow::Result;
use raim::signal::encode::{Frequency, Selection};
use raim::signal::recording::Recording;
use raim::signal::sky::raw::Simulation;
use raim_core::frame::Ecef;
use rig::stations::ESBC;

use super::early;
use super::scenario::{Passage, Tempo};

/// Time from the simulated sky's first midnight to the end of the week, s.
const WEEK_END_S: f64 = 6.0 * 86_400.0;

/// Number of epochs of a simulated sky that are computed together.
const SKY_EPOCHS: u32 = 1800;

/// Pace of the recording.
const RECORDING: Tempo = Tempo {
    step_s: 30.0,
    interval_ms: 30_000,
    time_to_alert_s: 75.0,
    alert_limits_m: [25, 20, 40, 556],
    calm_epochs: 40,
    disturbance: 0.03,
    repeated_ephemerides: 6,
};

/// Source and length of a soak.
pub struct Plan {
    /// Name for the table.
    pub name: &'static str,
    /// Pace of the soak.
    pub tempo: Tempo,
    /// Seed of all random choices.
    pub seed: u64,
    /// Number of epochs taken from the source.
    pub epochs: u32,
    source: Source,
}

enum Source {
    /// Stretches of a simulated sky: start, s, and number of epochs.
    Sky(Vec<(f64, u32)>),
    /// A recording, and the place of its antenna.
    Recording(Box<Recording>, Ecef),
}

impl Plan {
    /// Returns `hours` hours of GPS and `BeiDou` at 1 Hz, with the end of the week in the middle.
    pub fn sky(hours: f64, seed: u64) -> Self {
        let epochs = (hours * 3600.0) as u32;
        let start_s = WEEK_END_S - (f64::from(epochs) / 2.0).floor();
        let stretches = (0..epochs).step_by(SKY_EPOCHS as usize);
        let stretch = |first: u32| (start_s + f64::from(first), SKY_EPOCHS.min(epochs - first));
        Self::of_sky(stretches.map(stretch).collect(), (240, 0.03), seed)
    }

    /// Returns a few minutes of the same: the end of the week, and the change of all ephemerides
    /// half an hour later.
    pub fn short_sky(seed: u64) -> Self {
        Self::of_sky(vec![(WEEK_END_S - 60.0, 120), (WEEK_END_S + 1740.0, 120)], (40, 0.05), seed)
    }

    fn of_sky(stretches: Vec<(f64, u32)>, (calm_epochs, disturbance): (u32, f64), seed: u64) -> Self {
        let tempo = Tempo {
            step_s: 1.0,
            interval_ms: 1000,
            time_to_alert_s: 10.0,
            alert_limits_m: [30, 20, 50, 556],
            calm_epochs,
            disturbance,
            repeated_ephemerides: 2,
        };
        let epochs = stretches.iter().map(|(_, epochs)| epochs).sum();
        Self { name: "simulated sky", tempo, seed, epochs, source: Source::Sky(stretches) }
    }

    /// Returns `hours` hours of the recording `esbc`, 24 at most, one epoch in 30 s; `None` if the
    /// recording is missing.
    pub fn recording(hours: f64, seed: u64) -> Option<Self> {
        Self::of_recording((hours * 120.0) as usize, RECORDING, seed)
    }

    /// Returns an hour of the same in minutes: its epochs are sent 2 s apart.
    pub fn short_recording(seed: u64) -> Option<Self> {
        let tempo = Tempo {
            interval_ms: 2000,
            time_to_alert_s: 10.0,
            calm_epochs: 25,
            disturbance: 0.05,
            ..RECORDING
        };
        Self::of_recording(120, tempo, seed)
    }

    fn of_recording(epochs: usize, tempo: Tempo, seed: u64) -> Option<Self> {
        let mut recording = ESBC.load()?;
        recording.epochs.truncate(epochs);
        let epochs = recording.epochs.len() as u32;
        let source = Source::Recording(Box::new(recording), ESBC.truth);
        Some(Self { name: "recording esbc", tempo, seed, epochs, source })
    }

    /// Returns the passages of the source in order.
    pub(super) fn passages(self) -> Box<dyn Iterator<Item = Result<Passage>>> {
        let dual = |letters| Selection::new(letters, Frequency::Dual);
        match self.source {
            // Each stretch has its own noise.
            Source::Sky(stretches) => Box::new((self.seed..).zip(stretches).map(move |(seed, stretch)| {
                let simulation = Simulation::above_xian(stretch.0, stretch.1, seed);
                let truth = simulation.site.position;
                let (recording, early) = (simulation.record(), early::of_sky(&simulation));
                Ok(Passage { recording, early, selection: dual("GC")?, truth })
            })),
            Source::Recording(recording, truth) => Box::new(std::iter::once_with(move || {
                // Each of the recording's ephemerides is early once.
                let early = recording.ephemerides.clone();
                Ok(Passage { recording: *recording, early, selection: dual("GCE")?, truth })
            })),
        }
    }
}
