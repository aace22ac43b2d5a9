//! Incidents that change the ranges, one after another, with quiet in between.
//!
//! | incident | share | size |
//! |---|---|---|
//! | one satellite, a step | 0.30 | 15 to 2000 m, uniform in its logarithm |
//! | one satellite, a ramp | 0.15 | the same, reached half-way through |
//! | two satellites, steps | 0.12 | the same, each its own |
//! | three satellites, steps | 0.08 | the same, each its own |
//! | one constellation, a step | 0.10 | the same, one for all |
//! | one constellation, an outage | 0.05 | |
//! | one satellite, an outage | 0.08 | |
//! | every satellite, as with false tracking | 0.05 | the same, each its own |
//! | the receiver's clock, a jump | 0.07 | up to 300 km, a millisecond |
//!
//! An incident and the quiet after it last 8 to 40 epochs each.

use raim::signal::fault::{Fault, Kind, Target};
use raim::signal::measurement::MeasuredEpoch;
use raim_core::satellite::{Constellation, SatelliteId};
use rand::rngs::ChaCha8Rng;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};

/// Length of an incident, and of the quiet after it, epochs.
const LENGTH_EPOCHS: std::ops::RangeInclusive<u32> = 8..=40;

/// Sizes of false ranges, m.
const BIAS_M: (f64, f64) = (15.0, 2000.0);

/// Largest jump of the receiver's clock, m: a millisecond.
const CLOCK_JUMP_M: f64 = 300e3;

/// Satellites whose ranges are false in an epoch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falsified {
    /// This many satellites, each with its own error.
    Satellites(usize),
    /// All satellites of a constellation, with the same error.
    Constellation,
}

impl Falsified {
    /// Returns true if the module's promise covers the epoch, because protection levels bound one
    /// faulty satellite.
    pub const fn is_within_promise(self) -> bool {
        matches!(self, Self::Satellites(0 | 1))
    }

    /// Returns true if any range is false.
    pub const fn is_any(self) -> bool {
        !matches!(self, Self::Satellites(0))
    }
}

/// The incidents of a run.
#[derive(Debug)]
pub struct Incidents {
    rng: ChaCha8Rng,
    step_s: f64,
    faults: Vec<Fault>,
    quiet_until_s: f64,
}

impl Incidents {
    /// Returns the incidents of a stream with epochs `step_s` apart. The first incident may come at
    /// once.
    pub fn new(step_s: f64, seed: u64) -> Self {
        Self { rng: ChaCha8Rng::seed_from_u64(seed), step_s, faults: Vec::new(), quiet_until_s: 0.0 }
    }

    /// Applies the incidents that are active `elapsed_s` after the first epoch.
    pub fn befall(&mut self, epoch: &mut MeasuredEpoch, elapsed_s: f64) -> Falsified {
        if elapsed_s >= self.quiet_until_s && !epoch.satellites.is_empty() {
            self.begin(epoch, elapsed_s);
        }
        let falsified = self.falsified(epoch, elapsed_s);
        self.faults.iter().for_each(|fault| fault.apply(epoch, elapsed_s));
        falsified
    }

    fn falsified(&self, epoch: &MeasuredEpoch, elapsed_s: f64) -> Falsified {
        let is_seen = |satellite| epoch.satellites.iter().any(|seen| seen.satellite == satellite);
        let mut satellites = 0;
        for fault in self.faults.iter().filter(|fault| fault.bias_m(elapsed_s) != 0.0) {
            match fault.target {
                Target::Satellite(satellite) => satellites += usize::from(is_seen(satellite)),
                Target::Constellation(_) => return Falsified::Constellation,
                Target::Receiver => {}
            }
        }
        Falsified::Satellites(satellites)
    }

    fn begin(&mut self, epoch: &MeasuredEpoch, start_s: f64) {
        let satellites: Vec<SatelliteId> = epoch.satellites.iter().map(|seen| seen.satellite).collect();
        let mut span = || f64::from(self.rng.random_range(LENGTH_EPOCHS)) * self.step_s;
        let (length_s, quiet_s) = (span(), span());
        self.quiet_until_s = start_s + length_s + quiet_s;
        let fault = |(target, kind)| Fault { target, kind, start_s, end_s: start_s + length_s };
        self.faults = self.choose(&satellites, length_s).into_iter().map(fault).collect();
    }

    fn choose(&mut self, satellites: &[SatelliteId], length_s: f64) -> Vec<(Target, Kind)> {
        match self.rng.random_range(0..100) {
            0..30 => self.steps(satellites, 1),
            30..45 => {
                let steps = self.steps(satellites, 1).into_iter();
                steps.map(|(target, step)| (target, grown(step, length_s))).collect()
            }
            45..57 => self.steps(satellites, 2),
            57..65 => self.steps(satellites, 3),
            65..75 => vec![(self.constellation(satellites), self.step())],
            75..80 => vec![(self.constellation(satellites), Kind::Outage)],
            80..88 => self.some(satellites, 1).into_iter().map(|target| (target, Kind::Outage)).collect(),
            88..93 => self.steps(satellites, satellites.len()),
            _ => {
                let bias_m = self.rng.random_range(-CLOCK_JUMP_M..CLOCK_JUMP_M);
                vec![(Target::Receiver, Kind::Step { bias_m })]
            }
        }
    }

    fn steps(&mut self, satellites: &[SatelliteId], many: usize) -> Vec<(Target, Kind)> {
        self.some(satellites, many).into_iter().map(|target| (target, self.step())).collect()
    }

    fn some(&mut self, satellites: &[SatelliteId], many: usize) -> Vec<Target> {
        satellites.sample(&mut self.rng, many).copied().map(Target::Satellite).collect()
    }

    fn constellation(&mut self, satellites: &[SatelliteId]) -> Target {
        let one = satellites.choose(&mut self.rng).map(|satellite| satellite.constellation());
        Target::Constellation(one.unwrap_or(Constellation::Gps))
    }

    fn step(&mut self) -> Kind {
        let size_m = self.rng.random_range(BIAS_M.0.ln()..BIAS_M.1.ln()).exp();
        Kind::Step { bias_m: if self.rng.random() { size_m } else { -size_m } }
    }
}

/// Returns the ramp that reaches a step's bias half-way through.
fn grown(step: Kind, length_s: f64) -> Kind {
    match step {
        Kind::Step { bias_m } => Kind::Ramp { rate_m_s: bias_m / (length_s / 2.0), limit_m: bias_m.abs() },
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use raim::signal::sky::raw::Simulation;

    fn sky() -> Vec<MeasuredEpoch> {
        Simulation::above_xian(0.0, 40, 3).record().epochs
    }

    #[test]
    fn every_kind_of_incident_comes_and_quiet_too() {
        let (sky, mut incidents) = (sky(), Incidents::new(1.0, 1));
        let mut seen: BTreeMap<String, u32> = BTreeMap::new();
        for turn in 0..20_000_u32 {
            let mut epoch = sky[turn as usize % sky.len()].clone();
            let falsified = incidents.befall(&mut epoch, f64::from(turn));
            let name = match falsified {
                Falsified::Satellites(4..) => "false tracking".to_owned(),
                few => format!("{few:?}"),
            };
            *seen.entry(name).or_default() += 1;
        }
        let names: Vec<&str> = seen.keys().map(String::as_str).collect();
        assert_eq!(
            names,
            [
                "Constellation",
                "Satellites(0)",
                "Satellites(1)",
                "Satellites(2)",
                "Satellites(3)",
                "false tracking"
            ],
            "{seen:?}"
        );
        // Half of the time is quiet, and a quarter of the rest falsifies no satellite by itself.
        assert!((0.5..0.8).contains(&(f64::from(seen["Satellites(0)"]) / 20_000.0)), "{seen:?}");
    }

    #[test]
    fn what_is_called_falsified_is_what_differs() {
        let (sky, mut incidents) = (sky(), Incidents::new(1.0, 5));
        for turn in 0..4000_u32 {
            let whole = &sky[turn as usize % sky.len()];
            let mut epoch = whole.clone();
            let Falsified::Satellites(reported) = incidents.befall(&mut epoch, f64::from(turn)) else {
                continue;
            };
            let by_m = |satellite: &raim::signal::measurement::MeasuredSatellite| {
                let before =
                    whole.satellites.iter().find(|before| before.satellite == satellite.satellite)?;
                Some(satellite.signals[0].pseudorange_m - before.signals[0].pseudorange_m)
            };
            let moved: Vec<f64> =
                epoch.satellites.iter().filter_map(by_m).filter(|by_m| *by_m != 0.0).collect();
            let is_jump = moved.len() == epoch.satellites.len();
            assert!(
                moved.len() == reported || is_jump && reported == 0,
                "turn {turn}: {reported} said, {moved:?}"
            );
        }
    }
}
