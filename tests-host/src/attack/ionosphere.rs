//! One frequency under a dense ionosphere.
//!
//! The delay is common to all satellites in a sense, and grows towards the horizon: it goes into height and clock and
//! leaves little in the residuals. A level that takes it for independent noise is too small.
//!
//! ```text
//! I = 40.3·10¹⁶ TEC m(E) / f²          TEC(φ) = TEC₀ (1 + g Δφ)
//! ```
//!
//! | symbol | meaning | value |
//! |---|---|---|
//! | `TEC₀` | electrons above the antenna | 60 to 150 TECU |
//! | `Δφ` | latitude of the pierce point minus that of the antenna, degrees | |
//! | `g` | slope to the south, as at the edge of the equatorial anomaly | 0, 0.06 a degree |

use anyhow::Result;
use rayon::prelude::*;

use super::forgery::Sky;
use super::tally::Tally;
use super::victim::Victim;
use super::{Attack, Effort, Figure};
use crate::encode::Frequency;
use crate::fault::Measured as _;
use crate::sky::Site;
use crate::sky::atmosphere::ionosphere_m;
use crate::sky::raw::Simulation;

/// The same electrons everywhere.
pub(super) const EVEN: Attack = Attack {
    name: "ionosphere",
    about: "one frequency, 60 to 150 TECU, three latitudes, no coefficients",
    run: |effort| run(effort, 0.0, None),
};

/// More of them to the south.
pub(super) const SLOPED: Attack = Attack {
    name: "ionosphere-slope",
    about: "the same with 6 % more or less of it for each degree of latitude",
    run: |effort| run(effort, -0.06, None),
};

/// Coefficients of zero.
pub(super) const ZEROS: Attack = Attack {
    name: "ionosphere-zeros",
    about: "the same with broadcast coefficients that are all zero, if they are taken",
    run: |effort| run(effort, 0.0, Some("IONO,0,0,0,0,0,0,0,0")),
};

/// Electrons above, TECU.
const ELECTRONS_TECU: [f64; 4] = [60.0, 90.0, 120.0, 150.0];

/// Latitudes of the antenna, degrees.
const LATITUDES_DEG: [f64; 3] = [5.0, 34.17, 62.0];

/// L1, Hz.
const L1_HZ: f64 = 1_575.42e6;

/// B1I, Hz: the slope is that of L1 on both, 2 % less than right for `BeiDou`.
const STEP_S: f64 = 600.0;

/// Degrees of latitude between the antenna and the point where the signal comes through the electrons, for a
/// satellite at the horizon to the north.
const FARTHEST_DEG: f64 = 14.0;

fn run(effort: Effort, slope_per_deg: f64, command: Option<&'static str>) -> Result<Vec<Figure>> {
    let skies: Vec<(f64, f64)> = LATITUDES_DEG
        .into_iter()
        .flat_map(|latitude_deg| ELECTRONS_TECU.map(|electrons_tecu| (latitude_deg, electrons_tecu)))
        .collect();
    let tallies: Vec<Tally> = skies
        .par_iter()
        .map(|&(latitude_deg, electrons_tecu)| {
            attempt(effort.pick(24, 144), latitude_deg, electrons_tecu, slope_per_deg, command)
        })
        .collect::<Result<_>>()?;
    let all = tallies.iter().fold(Tally::default(), Tally::with);
    let mut figures = all.figures(0.0);
    for ((latitude_deg, electrons_tecu), tally) in skies.iter().zip(&tallies) {
        if tally.misleading > 0 {
            let what = format!("of these at {latitude_deg:.0}° under {electrons_tecu} TECU");
            figures.push(Figure::plain(what, tally.misleading as f64));
        }
    }
    Ok(figures)
}

fn attempt(
    epochs: u32,
    latitude_deg: f64,
    electrons_tecu: f64,
    slope_per_deg: f64,
    command: Option<&str>,
) -> Result<Tally> {
    let simulation = Simulation {
        site: Site::geodetic(latitude_deg, 108.57, 400.0),
        step_s: STEP_S,
        electrons_tecu,
        ..Simulation::above_xian(0.0, epochs, 9)
    };
    let sky = Sky::of(&simulation, Frequency::Single)?;
    let bytes = sky.bytes(|index, epoch| {
        for sight in simulation.sights_at(index as u32) {
            let sin_elevation = sight.line_of_sight.up;
            let cos_elevation = (1.0 - sin_elevation * sin_elevation).max(0.0).sqrt();
            // The pierce point wanders off as the cotangent does, and no farther than the shell is seen.
            let off_deg = (3.2 * cos_elevation / sin_elevation.max(0.05)).min(FARTHEST_DEG);
            let north_deg = off_deg * sight.line_of_sight.north / cos_elevation.max(1e-6);
            let more_m =
                ionosphere_m(sin_elevation, L1_HZ, electrons_tecu) * (slope_per_deg * north_deg).max(-1.0);
            epoch.lengthen(sight.satellite, more_m);
        }
    })?;
    let (mut victim, mut tally) = (Victim::new(&["PHASE,ENROUTE", "TTA,60"], STEP_S)?, Tally::default());
    if let Some(command) = command {
        // Refused or taken: what counts is what is promised afterwards.
        let _ = victim.obey(command)?;
    }
    for bytes in bytes {
        tally.add_all(&victim.hear(&bytes, sky.truth)?);
    }
    Ok(tally)
}
