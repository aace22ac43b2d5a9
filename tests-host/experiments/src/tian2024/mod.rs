//! [Tian2024]: range consensus with chosen subsets, beside parity space and all minimal subsets.
//!
//! | part | file |
//! |---|---|
//! | the methods, and the definition of a correct answer | `method` |
//! | tables 2 and 3, figure 2: a day at a station | `jfng` |
//! | tables 6 to 8, figure 6: a flight | `flight` |
//! | table 9: the work of each method | `flight` |
//! | the station's experiment on a real recording | `station` |
//!
//! The core runs in `f32`, as on the target. The traditional method, which needs every minimal
//! subset, is [`ransac_traditional`](raim::second_opinion::ransac_traditional); if there are too
//! many subsets a random sample of them votes.

mod flight;
mod jfng;
mod method;
mod station;

use anyhow::Result;
use indicatif::ProgressBar;
use raim::signal::sky::{Fleet, Satellite};
use raim_core::satellite::{Constellation, SatelliteId};

use super::{Effort, Experiment, Outcome};

/// Entry for the command line.
pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "tian2024",
    about: "range consensus with chosen subsets, simulated and recorded",
    run,
};

/// Size of every fault, m.
const BIAS_M: f64 = 150.0;
/// Elevation mask, rad.
const MASK_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// Receiver clocks, m; they have no influence.
const CLOCKS_M: [f64; Constellation::COUNT] = [310.0, -140.0, 0.0, 0.0];

/// Systems of a sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sky {
    Gps,
    Beidou,
    Both,
}

impl Sky {
    const ALL: [Self; 3] = [Self::Gps, Self::Beidou, Self::Both];

    fn has(self, satellite: SatelliteId) -> bool {
        match self {
            Self::Gps => satellite.constellation() == Constellation::Gps,
            Self::Beidou => satellite.constellation() == Constellation::Beidou,
            Self::Both => true,
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Gps => "GPS",
            Self::Beidou => "BeiDou",
            Self::Both => "GPS + BeiDou",
        }
    }
}

/// Returns 31 satellites of GPS and 44 of `BeiDou`.
fn fleets() -> Vec<Satellite> {
    [Fleet::Gps31, Fleet::Beidou44].into_iter().flat_map(Fleet::satellites).collect()
}

/// Returns the largest number of subsets that vote in the traditional method.
fn most_subsets(effort: Effort) -> usize {
    effort.pick(2_000, 20_000)
}

/// Returns the number of faults in words.
const fn faults_in_words(count: usize) -> &'static str {
    match count {
        0 => "no fault",
        1 => "one fault",
        2 => "two faults",
        _ => "three faults",
    }
}

fn run(effort: Effort, bar: &ProgressBar) -> Result<Outcome> {
    bar.set_length(jfng::epochs(effort) + flight::epochs(effort) + station::epochs(effort));
    let (mut sections, mut pictures) = jfng::day(effort, bar)?;
    let (flight, figures) = flight::flight(effort, bar)?;
    let (recorded, figure) = station::recorded(effort, bar)?;
    sections.extend(flight);
    sections.push(recorded);
    pictures.extend(figures);
    pictures.extend(figure);
    Ok(Outcome {
        name: "tian2024",
        title: "Tian Binpeng et al. 2024, improved RANSAC RAIM".to_owned(),
        setup: format!(
            "GPS of 31 and BeiDou of 44 satellites, mask 5°, faults of {BIAS_M} m on satellites drawn anew in every epoch, \
             Pfa 0.0001, up to three satellites left out, f32. JFNG: {} epochs of a day, sigma0 / sin(elevation). \
             Flight Beijing to Shanghai: {} epochs, sigma 10.5 m. The traditional method votes with at most {} \
             subsets, in some of the epochs. Fixed seeds.",
            jfng::epochs(effort),
            flight::epochs(effort),
            most_subsets(effort),
        ),
        sections,
        pictures,
    })
}
