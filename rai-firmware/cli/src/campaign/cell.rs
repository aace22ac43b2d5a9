//! One place under one sky: every fault, every judge, every instant.

use raim_core::epoch::Epoch;
use raim_core::frame::Enu;
use raim_core::monitor::Search;
use raim_core::report::Report;
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation;
use raim_firmware::settings::Configuration;
use raim_single::{CAPACITY, Monitor, MonitorMemory};
use rand::RngExt as _;
use rand::SeedableRng as _;
use rand::rngs::ChaCha8Rng;

use super::errors::{ErrorModel, Reported, Seen, epoch, seen};
use super::place::Place;
use super::sky::Heaven;
use super::spec::FaultSpec;
use super::statistics::CellStatistics;
use crate::signal::sky::{Noise, Site};

/// A method under its policy and its levels.
#[derive(Clone, Debug)]
pub struct Judge {
    /// Method, policy and levels as the commands name them; `-` if one has no meaning.
    pub words: [String; 3],
    /// Configuration after the commands.
    pub configuration: Configuration,
    monitor: Monitor,
}

impl Judge {
    /// Returns a judge that has processed no epoch.
    ///
    /// # Errors
    /// If the requirements cannot be met.
    pub fn new(
        words: [String; 3],
        configuration: Configuration,
    ) -> Result<Self, raim_core::monitor::MonitorError> {
        let mut monitor = Monitor::new(configuration.requirements())?;
        // No word of a configuration sets a method that this build lacks.
        let _ = monitor.set_strategy(configuration.strategy());
        monitor.disable_continuity();
        Ok(Self { words, configuration, monitor })
    }
}

/// A judge at work in one cell. It learns from no epoch: each is judged as if it were the only one.
struct Seat {
    monitor: Monitor,
    reported: Reported,
    required: Requirements,
    memory: Box<MonitorMemory>,
}

impl Seat {
    fn of(judge: &Judge, model: ErrorModel) -> Self {
        let Judge { configuration, monitor, .. } = judge;
        let mut monitor = monitor.clone();
        monitor.set_ism(model.promises(configuration.promises.ism()));
        let memory = Box::new(MonitorMemory::new());
        Self {
            monitor,
            reported: model.said_to(configuration),
            required: configuration.requirements(),
            memory,
        }
    }

    fn report(&mut self, epoch: &Epoch<CAPACITY>, site: &Site) -> &Report<CAPACITY> {
        &raim_single::judge(&self.monitor, epoch, site.position, Search::Anew, None, &mut self.memory).report
    }
}

/// Inputs of a cell.
pub struct Bench<'b> {
    /// Instants, s, each with the satellites of the sky.
    pub instants: &'b [(f64, Heaven)],
    /// Place of the antenna.
    pub place: &'b Place,
    /// Elevation mask, degrees.
    pub mask_deg: f64,
    /// Error model of the ranges.
    pub model: ErrorModel,
    /// Ratio of the drawn noise to the expected sigma.
    pub noise: f64,
    /// Seed of this place.
    pub seed: u64,
}

impl Bench<'_> {
    /// Returns the statistics of each fault and judge, in this order.
    pub fn judge(&self, faults: &[FaultSpec], judges: &[Judge]) -> Vec<CellStatistics> {
        let site = self.place.site();
        let noise = Noise::new(self.seed);
        let mut seats: Vec<Seat> = judges.iter().map(|judge| Seat::of(judge, self.model)).collect();
        let mut statistics = vec![CellStatistics::default(); faults.len() * judges.len()];
        for (index, (time_s, heaven)) in (0_u64..).zip(self.instants) {
            if self.place.time_s.is_some_and(|only_s| only_s.to_bits() != time_s.to_bits()) {
                continue;
            }
            let seen = seen(heaven, &site, self.mask_deg, self.model, (&noise, self.noise, index));
            let rows = statistics.chunks_exact_mut(judges.len());
            for (number, (fault, statistics)) in (0_u64..).zip(faults.iter().zip(rows)) {
                for befallen in befallen(fault, &seen, self.seed, index << 8 | number) {
                    for (seat, of_judge) in seats.iter_mut().zip(&mut *statistics) {
                        let epoch = epoch(&seen, &seat.reported, *time_s, |one| befallen.adds_m(one));
                        let required = seat.required;
                        let report = seat.report(&epoch, &site);
                        of_judge.add(report, error(&site, report), &required);
                    }
                }
            }
        }
        statistics
    }
}

fn error(site: &Site, report: &Report<CAPACITY>) -> Option<Enu> {
    let solution = report.solution.as_ref()?;
    Some(site.frame.rotate(solution.position - site.position))
}

/// Effect of a fault in an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Befallen {
    Nobody,
    One { index: usize, bias_m: f64 },
    All { constellation: Constellation, shift_m: [f64; 3] },
}

impl Befallen {
    /// Returns the fault's contribution to a range, m.
    fn adds_m(&self, one: &Seen) -> f64 {
        match *self {
            Self::Nobody => 0.0,
            Self::One { index, bias_m } => {
                if one.index == index {
                    bias_m
                } else {
                    0.0
                }
            }
            Self::All { constellation, shift_m: [east, north, up] } => {
                if one.observation.satellite.constellation() == constellation {
                    let towards = one.line_of_sight;
                    -(east * towards.east + north * towards.north + up * towards.up)
                } else {
                    0.0
                }
            }
        }
    }
}

/// Returns all effects of a fault in an epoch.
fn befallen(fault: &FaultSpec, seen: &[Seen], seed: u64, draw: u64) -> Vec<Befallen> {
    match *fault {
        FaultSpec::None => vec![Befallen::Nobody],
        FaultSpec::Drawn { bias_m: [least, largest] } => {
            if seen.is_empty() {
                return vec![Befallen::Nobody];
            }
            let mut chance = ChaCha8Rng::seed_from_u64(seed ^ u64::MAX);
            chance.set_stream(draw);
            let size_m = chance.random_range(least..largest);
            let bias_m = if chance.random() { size_m } else { -size_m };
            vec![Befallen::One { index: chance.random_range(0..seen.len()), bias_m }]
        }
        FaultSpec::EverySatellite { bias_m } => {
            (0..seen.len()).map(|index| Befallen::One { index, bias_m }).collect()
        }
        FaultSpec::Constellation { shift_m } => {
            let mut systems: Vec<Constellation> =
                seen.iter().map(|one| one.observation.satellite.constellation()).collect();
            systems.sort_unstable();
            systems.dedup();
            systems.into_iter().map(|constellation| Befallen::All { constellation, shift_m }).collect()
        }
    }
}
