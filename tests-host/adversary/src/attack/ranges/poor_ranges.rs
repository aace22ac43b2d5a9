//! Ranges that the error model does not describe, all satellites alike: no single fault, and
//! nothing to exclude.
//!
//! | attack | error of every satellite |
//! |---|---|
//! | noise | new in every epoch, four times the standard deviation of a pair of frequencies |
//! | orbits | 7 to 15 m along the orbit, constant |
//! | rounding | each range to the next multiple of 100 m |
//!
//! Levels assume the standard deviations. The global test sees larger errors only by chance in any
//! one epoch, so that some epochs are promised beyond their level. The bounds are the rates of
//! today and not a promise of the product.

use rand_distr::StandardNormal;

use crate::attack::orbits::faulty_orbit::move_ahead;
use crate::attack::prelude::*;

pub(super) const NOISE: Attack = Attack {
    name: "noise-four-times",
    about: "ranges of all satellites four times as noisy as their standard deviations, ARAIM and the method at start",
    branch: Branch::Sigmas,
    before: "without the evidence of the last minute `AUTO` 3 of 32 and `SEPARATION` 0 of 230 beyond; another program's skies 26 of 116",
    note: "",
    run: |effort| run(effort, Poor::Noise, [0.0, 0.05]),
};

pub(super) const ORBITS: Attack = Attack {
    name: "orbits-astray",
    about: "all satellites 7 to 15 m from their broadcast orbits, ARAIM and the method at start",
    branch: Branch::Orbits,
    before: "0 of 960 beyond by each; another program's skies up to 11 of 21",
    note: "",
    run: |effort| run(effort, Poor::Orbits, [0.0, 0.0]),
};

pub(super) const ROUNDED: Attack = Attack {
    name: "rounded-ranges",
    about: "all ranges rounded to 100 m, ARAIM and the method at start",
    branch: Branch::Sigmas,
    before: "nothing promised; another program's skies 25 of 52",
    note: "",
    run: |effort| run(effort, Poor::Rounded, [0.0, 0.0]),
};

/// Error of all ranges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Poor {
    Noise,
    Orbits,
    Rounded,
}

/// Epochs of a run.
const EPOCHS: u32 = 20;

/// Factor of the noise.
const TIMES: f64 = 4.0;

/// Standard deviation of a broadcast orbit and clock, m.
const ORBIT_M: f64 = 1.2;

/// Code noise and multipath of a pair at the zenith, m; three times that of one frequency.
const PAIR_M: f64 = 0.9;

/// Distances along the orbit, m.
const ASTRAY_M: std::ops::Range<f64> = 7.0..15.0;

/// Unit of rounded ranges, m.
const UNIT_M: f64 = 100.0;

/// Measures ARAIM and the method at start, with the largest share of promised epochs that may be
/// beyond a level.
fn run(effort: Effort, poor: Poor, bounds: [f64; 2]) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for (method, bound) in ["ARAIM", "AUTO"].into_iter().zip(bounds) {
        let all: Tally =
            (0..effort.pick(48, 480)).together(|seed| attempt(method, poor, seed)).collect::<Result<_>>()?;
        figures.push(Figure::plain(format!("{method}: epochs"), all.epochs()));
        figures.push(Figure::plain("protected", all.promised()));
        figures.push(Figure::plain("beyond their level", all.misleading()));
        figures.push(Figure::at_most("their share", all.beyond(), bound));
    }
    Ok(figures)
}

/// Sends one sky with such ranges to a module with this method.
fn attempt(method: &str, poor: Poor, seed: u64) -> Result<Tally> {
    let start_s = 600.0 + 1800.0 * (seed % 48) as f64;
    let simulation = Simulation::above_xian(start_s, EPOCHS, seed);
    let mut sky = Sky::of(&simulation, Frequency::Dual)?;
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    if poor == Poor::Orbits {
        for satellite in sky.recording.epochs[0].satellites() {
            let along_m = chance.random_range(ASTRAY_M) * if chance.random() { 1.0 } else { -1.0 };
            let own = sky.recording.ephemerides.iter_mut().filter(|set| set.satellite == satellite);
            own.for_each(|set| move_ahead(set, along_m));
        }
    }
    let bytes = sky.bytes(|index, epoch| match poor {
        Poor::Noise => {
            for sight in simulation.sights_at(index as u32) {
                let sine = sight.line_of_sight.up.max(0.05);
                let sigma_m = ORBIT_M.hypot(PAIR_M * 1.0_f64.hypot(1.0 / sine));
                epoch.lengthen(sight.satellite, TIMES * sigma_m * chance.sample::<f64, _>(StandardNormal));
            }
        }
        Poor::Orbits => {}
        Poor::Rounded => {
            for signal in epoch.satellites.iter_mut().flat_map(|raw| &mut raw.signals) {
                signal.pseudorange_m = (signal.pseudorange_m / UNIT_M).round() * UNIT_M;
            }
        }
    })?;
    Victim::new(&[&format!("METHOD,{method}")], 1.0)?.judge(&bytes, sky.truth)
}
