//! \[Parity\]: isolation in parity space, and RAIM of early `BeiDou`, GPS and both.
//!
//! | part | file | free in the paper |
//! |---|---|---|
//! | table 1 | `isolation` | geometry, sigma |
//! | figures 4 and 5 | `curves` | `BeiDou` constellation, sigma, place |
//! | table 2 | `availability` | `BeiDou` constellation, sigma |
//!
//! Everything runs the core in `f32`, as on the target. Detection rates and availability are exact
//! for their geometries; isolation rates come from runs with random noise.

mod availability;
mod curves;
mod isolation;

use anyhow::Result;
use indicatif::ProgressBar;
use raim::signal::sky::{Fleet, Satellite, Sight};
use raim_core::internals::integrity::raim::detection::threshold::{ThresholdError, Thresholds};
use raim_core::internals::integrity::raim::isolation::parity::SearchLimits;
use raim_core::internals::numeric::probability::Probability;
use raim_core::satellite::Constellation;

use super::{Effort, Experiment, Outcome};

/// Entry for the command line.
pub(super) const EXPERIMENT: Experiment =
    Experiment { name: "parity", about: "isolation in parity space; RAIM of GPS, BeiDou and both", run };

/// Size of the faults of table 1, m.
const BIAS_M: f64 = 500.0;
/// Elevation mask, rad.
const MASK_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// Probabilities of false alarm of the isolation experiments, and of the availability.
const FALSE_ALARM: Probability = probability(5e-3);
const AVAILABILITY: Probability = probability(1e-3);
/// Largest number of rows of any sky.
const MOST_ROWS: usize = 40;

const fn probability(tail: f64) -> Probability {
    match Probability::new(tail) {
        Some(tail) => tail,
        None => unreachable!(),
    }
}

/// Returns the thresholds of the isolation experiments, which do not use the probability of missed
/// detection.
fn thresholds() -> Result<Thresholds<'static>, ThresholdError> {
    Thresholds::from_tables(FALSE_ALARM, AVAILABILITY)
}

/// Returns the limits of the searches: at most two satellites are isolated, as in the paper.
fn limits() -> SearchLimits {
    SearchLimits { rows: 2, ..SearchLimits::published() }
}

/// Satellites of a sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sky {
    /// 24 slots.
    Gps,
    /// Geostationary satellites at 110.5, 140 and 160° E, three in inclined and four in medium
    /// orbits: `BeiDou` on its way to the regional system.
    Early,
    /// All 14 satellites of the regional system.
    Regional,
    /// GPS with [`Self::Early`].
    Both,
}

impl Sky {
    const ALL: [Self; 4] = [Self::Gps, Self::Early, Self::Regional, Self::Both];

    /// Returns all satellites of any sky.
    fn satellites() -> Vec<Satellite> {
        [Fleet::Gps24, Fleet::BeidouRegional].into_iter().flat_map(Fleet::satellites).collect()
    }

    /// Returns true if a satellite belongs to this sky.
    fn has(self, sight: &Sight) -> bool {
        let (satellite, number) = (sight.satellite, sight.satellite.number());
        if satellite.constellation() == Constellation::Gps {
            return matches!(self, Self::Gps | Self::Both);
        }
        match self {
            Self::Gps => false,
            Self::Early | Self::Both => matches!(number, 3..=8 | 11..=14),
            Self::Regional => true,
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Gps => "GPS, 24 satellites",
            Self::Early => "BeiDou, 3 GEO + 3 IGSO + 4 MEO",
            Self::Regional => "BeiDou, 5 GEO + 5 IGSO + 4 MEO",
            Self::Both => "both",
        }
    }
}

fn run(effort: Effort, bar: &ProgressBar) -> Result<Outcome> {
    bar.set_length(isolation::STEPS + curves::steps(effort) + availability::steps(effort));
    let (mut sections, table_1) = isolation::table(bar)?;
    let (figures, mut pictures) = curves::figures(effort, bar)?;
    sections.extend(figures);
    pictures.insert(0, table_1);
    let (table_2, picture) = availability::table(effort, bar)?;
    sections.push(table_2);
    pictures.push(picture);
    Ok(Outcome {
        name: "parity",
        title: "BeiDou RAIM by parity vectors with isolation by grouping [Parity]".to_owned(),
        setup: format!(
            "Faults of {BIAS_M} m, Pfa 0.005, alpha 0.01, at most two satellites left out, f32. Table 1: 8 satellites \
             of one constellation, sigma 6 m, {} runs. Figures 4 and 5: 25.1 N 121.6 E, mask 5°, 12 h at {} s, satellite \
             3 faulty. Table 2: {} points within 24.1 … 26.1 N, 120.6 … 122.6 E, HAL 500 m, Pfa = Pmd = 0.001, 9 h at 60 s \
             on three days, and a week at 600 s. Fixed seeds.",
            isolation::RUNS,
            curves::step_s(effort),
            availability::points(effort),
        ),
        sections,
        pictures,
    })
}
