//! Two to four satellites wrong at once.
//!
//! Levels bound one fault. Most sets of several faults are found. Every method misses some, and the
//! rate depends on the method and on the number of satellites; [`table`] measures it. No method can
//! distinguish some pairs from other pairs. They are chosen so that leaving out healthy satellites
//! explains the ranges as well as leaving out the faulty ones does:
//!
//! ```text
//! u·H = 0 on the rows kept (two of them faulty, one redundant)          u₁ b₁ + u₂ b₂ = 0
//! ```
//!
//! For these the module must report that it cannot decide.

use nalgebra::{DMatrix, SymmetricEigen};
use raim::outcomes::Outcomes;
use serde::Serialize;

use crate::attack::prelude::*;

pub(super) const PAIRS: Attack = Attack {
    name: "two-faults",
    about: "two of 7 to 12 satellites wrong by 20 m to 2 km, more than a level bounds, the method at start",
    branch: Branch::Several,
    before: "6 of 137; at length 10 of 1,178",
    note: "",
    run: pairs,
};

pub(super) const CHOSEN: Attack = Attack {
    name: "chosen-pairs",
    about: "two of seven satellites wrong so that leaving out two healthy ones explains the ranges as well, every method",
    branch: Branch::Several,
    before: "15 of 18",
    note: "one healthy satellite explains both faults of the pair that is beyond its level",
    run: chosen,
};

/// Methods of the module, by their words in the command.
pub const METHODS: [&str; 7] =
    ["BAARDA", "SIMULTANEOUS", "SEQUENTIAL", "HYBRID", "GROUPING", "RANSAC", "AUTO"];
/// Numbers of faulty satellites in [`table`].
const FAULTS: [usize; 3] = [2, 3, 4];
/// Numbers of satellites in [`table`].
const SATELLITES: [usize; 6] = [7, 8, 10, 12, 15, 18];

/// Sends the bytes to a fresh module under each method, and counts the reports.
pub(in crate::attack) fn by_every_method(bytes: &[u8], truth: Ecef) -> Result<Tally> {
    METHODS
        .iter()
        .map(|method| Victim::new(&[&format!("METHOD,{method}")], 1.0)?.judge([bytes], truth))
        .collect()
}

/// Sizes of faults, m, drawn uniformly in their logarithm.
const SIZES_M: std::ops::Range<f64> = 20.0..2000.0;

/// Largest share of the epochs with two faults that may be promised above their level, under the
/// method at start.
const PAIRS_BEYOND: f64 = 0.01;

/// Rate at which several faults pass undetected.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Passing {
    /// Name of the method.
    pub method: &'static str,
    /// Number of satellites.
    pub satellites: usize,
    /// Number of faulty satellites.
    pub faults: usize,
    /// Number of epochs.
    pub epochs: usize,
    /// Number of promised epochs.
    pub promised: usize,
    /// Number of promised epochs with an error above their level.
    pub misleading: usize,
    /// Number of promised epochs with an error above the limit of 556 m.
    pub hazardous: usize,
}

/// Measures how often two to four faults pass, by method and number of satellites.
///
/// # Errors
/// If an epoch cannot be encoded or the module cannot start.
pub fn table(epochs: u64) -> Result<Vec<Passing>> {
    let mut cells = Vec::new();
    for method in METHODS {
        for faults in FAULTS {
            for satellites in SATELLITES {
                cells.push((method, faults, satellites));
            }
        }
    }
    cells
        .iter()
        .together(|&(method, faults, satellites)| {
            let outcomes = random(&[&format!("METHOD,{method}")], satellites, faults, epochs)?.outcomes;
            let Outcomes { promised, misleading, hazardous, .. } = outcomes;
            let epochs = outcomes.epochs();
            Ok(Passing { method, satellites, faults, epochs, promised, misleading, hazardous })
        })
        .collect()
}

fn pairs(effort: Effort) -> Result<Vec<Figure>> {
    let mut all = Tally::default();
    let mut figures = Vec::new();
    for satellites in 7..=12 {
        let tally = random(&[], satellites, 2, effort.pick(40, 400))?;
        figures.push(Figure::plain(format!("beyond with {satellites}"), tally.misleading()));
        all += &tally;
    }
    figures.insert(0, Figure::plain("epochs", all.epochs()));
    figures.insert(1, Figure::plain("protected", all.promised()));
    figures.insert(2, Figure::at_most("rate beyond the level is above", all.least_rate(), PAIRS_BEYOND));
    Ok(figures)
}

/// Sends epochs with random satellites and random faults.
fn random(commands: &[&str], satellites: usize, faults: usize, epochs: u64) -> Result<Tally> {
    let mut tally = Tally::default();
    for run in 0..epochs {
        let mut chance = ChaCha8Rng::seed_from_u64(run << 16 | (satellites << 8 | faults) as u64);
        let sky = Sky::of(&Simulation::above_xian(start_s(&mut chance), 1, run), Frequency::Dual)?;
        let seen = sky.recording.epochs[0].satellites();
        let kept: Vec<SatelliteId> = seen.sample(&mut chance, satellites).copied().collect();
        let bytes = sky.bytes(|_, epoch| {
            epoch.satellites.retain(|raw| kept.contains(&raw.satellite));
            for faulty in kept.iter().take(faults) {
                epoch.lengthen(*faulty, signed_size(SIZES_M, &mut chance));
            }
        })?;
        tally.add_all(&Victim::new(commands, 1.0)?.receive(&bytes.concat(), sky.truth)?);
    }
    Ok(tally)
}

fn chosen(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for method in METHODS {
        let tally = of_chosen(&format!("METHOD,{method}"), effort.pick(8, 120))?;
        figures.push(Figure::plain(format!("{method} protected"), tally.promised()));
        // If one healthy satellite explains both faults, nothing separates the two sets. The
        // smaller set is taken, and the level bounds one fault.
        figures.push(Figure::plain("beyond its level", tally.misleading()));
        figures.push(Figure::at_most("of these with several left out", tally.misled_by_several as f64, 0.0));
        figures.push(Figure::at_most("beyond 556 m", tally.outcomes.hazardous as f64, 0.0));
    }
    Ok(figures)
}

/// Faults of the first satellite, m.
const LARGE_M: [f64; 4] = [300.0, -600.0, 1000.0, 2000.0];

fn of_chosen(command: &str, geometries: u32) -> Result<Tally> {
    let mut tally = Tally::default();
    for geometry in 0..geometries {
        let start_s = f64::from(geometry) * 660.0;
        let simulation = Simulation::above_xian(start_s, 1, u64::from(geometry));
        let sky = Sky::of(&simulation, Frequency::Dual)?;
        // Satellites above the module's elevation mask.
        let sights: Vec<Sight> = simulation
            .sights_at(0)
            .into_iter()
            .filter(|sight| sight.satellite.constellation() == Constellation::Gps)
            .filter(|sight| sight.elevation_rad() > 12_f64.to_radians())
            .take(7)
            .collect();
        if sights.len() < 7 {
            continue;
        }
        let Some((first, second, ratio)) = deception(&sights) else { continue };
        let bias_m = LARGE_M[geometry as usize % LARGE_M.len()];
        let bytes = sky.bytes(|_, epoch| {
            epoch.satellites.retain(|raw| sights.iter().any(|sight| sight.satellite == raw.satellite));
            epoch.lengthen(first, bias_m);
            epoch.lengthen(second, bias_m * ratio);
        })?;
        tally.add_all(&Victim::new(&[command], 1.0)?.receive(&bytes.concat(), sky.truth)?);
    }
    Ok(tally)
}

/// Returns two satellites and the ratio of faults on them that five of the seven, including both,
/// do not show. Of all such pairs it takes the one whose faults are most similar in size.
fn deception(sights: &[Sight]) -> Option<(SatelliteId, SatelliteId, f64)> {
    let mut best: Option<(f64, (SatelliteId, SatelliteId, f64))> = None;
    for without in 0..sights.len() {
        for besides in without + 1..sights.len() {
            let kept: Vec<&Sight> = sights
                .iter()
                .enumerate()
                .filter(|(index, _)| *index != without && *index != besides)
                .map(|(_, sight)| sight)
                .collect();
            let blind = null_vector(&kept);
            for (i, j) in (0..kept.len()).flat_map(|i| (i + 1..kept.len()).map(move |j| (i, j))) {
                let ratio = -blind[i] / blind[j];
                let unlike = ratio.abs().ln().abs();
                if ratio.is_finite() && best.as_ref().is_none_or(|(least, _)| unlike < *least) {
                    best = Some((unlike, (kept[i].satellite, kept[j].satellite, ratio)));
                }
            }
        }
    }
    best.map(|(_, pair)| pair)
}

/// Returns the combination of rows in which position and clock cancel: the eigenvector of `H Hᵀ`
/// for the eigenvalue 0.
fn null_vector(sights: &[&Sight]) -> Vec<f64> {
    let rows = DMatrix::from_fn(sights.len(), 4, |row, column| {
        let los = sights[row].line_of_sight;
        [los.east, los.north, los.up, 1.0][column]
    });
    let eigen = SymmetricEigen::new(&rows * rows.transpose());
    let least = eigen.eigenvalues.imin();
    eigen.eigenvectors.column(least).iter().copied().collect()
}
