//! Two to four satellites wrong at once.
//!
//! Levels bound one fault. Of several, most are found; the rest are the price of any method, and how dear it is depends on
//! the method and on how many satellites there are. [`table`] is that price. Besides there are pairs that no
//! method can tell from other pairs, chosen so that leaving out healthy satellites explains the ranges as well as leaving
//! out the faulty ones does:
//!
//! ```text
//! u·H = 0 on the rows kept (two of them faulty, one redundant)          u₁ b₁ + u₂ b₂ = 0
//! ```
//!
//! There a module has to say that it cannot tell.

use anyhow::Result;
use nalgebra::{DMatrix, SymmetricEigen};
use rai_core::frame::Ecef;
use rai_core::satellite::{Constellation, SatelliteId};
use rand::seq::IndexedRandom as _;
use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::Serialize;

use super::forgery::Sky;
use super::tally::{Tally, least_rate};
use super::victim::Victim;
use super::{Attack, Effort, Figure};
use crate::encode::Frequency;
use crate::fault::Measured as _;
use crate::sky::Sight;
use crate::sky::raw::Simulation;

/// Pairs of satellites, at random.
pub(super) const PAIRS: Attack = Attack {
    name: "two-faults",
    about: "two of 7 to 12 satellites wrong by 20 m to 2 km, the method at start",
    run: pairs,
};

/// Pairs that look like others.
pub(super) const CHOSEN: Attack = Attack {
    name: "chosen-pairs",
    about: "two of seven satellites wrong so that leaving out two healthy ones explains it as well, every method",
    run: chosen,
};

/// Methods of the module by the name of the command.
pub const METHODS: [&str; 7] =
    ["BAARDA", "SIMULTANEOUS", "SEQUENTIAL", "HYBRID", "GROUPING", "RANSAC", "AUTO"];

/// What comes of some bytes by each of these, the module having just begun.
pub(super) fn by_every_method(bytes: &[u8], truth: Ecef) -> Result<Tally> {
    let mut tally = Tally::default();
    for method in METHODS {
        let mut victim = Victim::new(&[&format!("METHOD,{method}")], 1.0)?;
        tally.add_all(&victim.hear(bytes, truth)?);
    }
    Ok(tally)
}

/// Sizes of faults, m, each decade as likely.
const SIZES_M: std::ops::Range<f64> = 20.0..2000.0;

/// How many of the epochs with two faults may be promised beyond their level: what is asked of the method at start.
const PAIRS_BEYOND: f64 = 0.01;

/// How often several faults pass.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Passing {
    /// Name of the method.
    pub method: &'static str,
    /// Satellites.
    pub satellites: usize,
    /// Of these, faulty.
    pub faults: usize,
    /// Epochs.
    pub epochs: usize,
    /// Of these, promised.
    pub promised: usize,
    /// Of these, beyond their level.
    pub misleading: usize,
    /// Of these, beyond the limit of 556 m.
    pub hazardous: usize,
}

/// How often two to four faults pass, by method and number of satellites.
///
/// # Errors
/// What could not be tried.
pub fn table(epochs: u64) -> Result<Vec<Passing>> {
    let mut cells = Vec::new();
    for method in METHODS {
        for faults in 2..=4 {
            for satellites in [7, 8, 10, 12, 15, 18] {
                cells.push((method, faults, satellites));
            }
        }
    }
    cells
        .par_iter()
        .map(|&(method, faults, satellites)| {
            let tally = random(&[&format!("METHOD,{method}")], satellites, faults, epochs)?;
            let Tally { epochs, promised, misleading, hazardous, .. } = tally;
            Ok(Passing { method, satellites, faults, epochs, promised, misleading, hazardous })
        })
        .collect()
}

fn pairs(effort: Effort) -> Result<Vec<Figure>> {
    let mut all = Tally::default();
    let mut figures = Vec::new();
    for satellites in 7..=12 {
        let tally = random(&[], satellites, 2, effort.pick(40, 400))?;
        figures.push(Figure::plain(format!("beyond with {satellites}"), tally.misleading as f64));
        all = all.with(&tally);
    }
    let rate = least_rate(all.misleading, all.epochs);
    figures.insert(0, Figure::plain("epochs", all.epochs as f64));
    figures.insert(1, Figure::plain("protected", all.promised as f64));
    figures.insert(2, Figure::at_most("rate beyond the level is above", rate, PAIRS_BEYOND));
    Ok(figures)
}

/// Epochs of their own, each with satellites and faults of its own.
fn random(commands: &[&str], satellites: usize, faults: usize, epochs: u64) -> Result<Tally> {
    let mut tally = Tally::default();
    for run in 0..epochs {
        let mut chance = ChaCha8Rng::seed_from_u64(run << 16 | (satellites << 8 | faults) as u64);
        // A time of day of its own, on the full minute.
        let start_s = f64::from(chance.random_range(0..1440_u32)) * 60.0;
        let sky = Sky::of(&Simulation::above_xian(start_s, 1, run), Frequency::Dual)?;
        let seen = sky.recording.epochs[0].satellites();
        let kept: Vec<SatelliteId> = seen.choose_multiple(&mut chance, satellites).copied().collect();
        let bytes = sky.bytes(|_, epoch| {
            epoch.satellites.retain(|raw| kept.contains(&raw.satellite));
            for faulty in kept.iter().take(faults) {
                let size_m = chance.random_range(SIZES_M.start.ln()..SIZES_M.end.ln()).exp();
                epoch.lengthen(*faulty, if chance.random() { size_m } else { -size_m });
            }
        })?;
        tally.add_all(&Victim::new(commands, 1.0)?.hear(&bytes.concat(), sky.truth)?);
    }
    Ok(tally)
}

fn chosen(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for method in METHODS {
        let tally = of_chosen(&format!("METHOD,{method}"), effort.pick(8, 120))?;
        figures.push(Figure::plain(format!("{method} protected"), tally.promised as f64));
        // Where one healthy satellite explains both faults, nobody can tell: a level is of one fault, and so is the
        // smaller set.
        figures.push(Figure::plain("beyond its level", tally.misleading as f64));
        figures.push(Figure::at_most("of these with several left out", tally.misled_by_several as f64, 0.0));
        figures.push(Figure::at_most("beyond 556 m", tally.hazardous as f64, 0.0));
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
        // High enough for the module's mask.
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
        tally.add_all(&Victim::new(&[command], 1.0)?.hear(&bytes.concat(), sky.truth)?);
    }
    Ok(tally)
}

/// Two satellites, and the ratio of their faults that five of the seven, these two among them, do not show: of all
/// such pairs the one with faults most alike in size.
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

/// The combination of the rows in which position and clock cancel: the eigenvector of `H Hᵀ` with the eigenvalue 0.
fn null_vector(sights: &[&Sight]) -> Vec<f64> {
    let rows = DMatrix::from_fn(sights.len(), 4, |row, column| {
        let los = sights[row].line_of_sight;
        [los.east, los.north, los.up, 1.0][column]
    });
    let eigen = SymmetricEigen::new(&rows * rows.transpose());
    let least = eigen.eigenvalues.imin();
    eigen.eigenvectors.column(least).iter().copied().collect()
}
