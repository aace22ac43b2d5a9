//! A building on one side: the receiver tracks the reflection of every low satellite in one sector
//! of the sky, and its range is late.
//!
//! ```text
//! δρ_i = s u_i      azimuth within the sector, elevation below the roof, u_i in [0.5, 1]
//! ```
//!
//! Levels bound one fault. Several late ranges on one side resemble a shift of the place more than
//! any others do, and nothing in the ranges separates the two. The signal strength is the same as
//! without the building, so it reveals nothing either. The rate of promised epochs above their
//! level is therefore bounded, but not zero.

use super::several_faults::by_every_method;
use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "reflections",
    about: "all satellites below 50° in a sector of 60° are 5 to 80 m late, each by half of that or more; one to three systems, on one frequency and two, every method",
    branch: Branch::Several,
    before: "7 of 701 on two frequencies, at length 83 of 8,987, before the rest after an exclusion counted; on one none",
    note: "",
    run: |effort| run(effort.pick(8, 100)),
};

const SYSTEMS: [Systems; 3] = [GPS, GPS_BEIDOU, THREE];

/// Largest delay, m.
const SIZES_M: [f64; 5] = [5.0, 10.0, 20.0, 40.0, 80.0];

/// Half the width of the sector, and the height of the roof, rad.
const HALF_WIDTH_RAD: f64 = 30.0 * RAD_PER_DEG;
const ROOF_RAD: f64 = 50.0 * RAD_PER_DEG;
const RAD_PER_DEG: f64 = std::f64::consts::PI / 180.0;

/// Largest share of the epochs that may be promised above their level, as with two faults, on two
/// frequencies, whose sigmas do not account for reflections.
const BEYOND: f64 = 0.01;

fn run(seeds: u64) -> Result<Vec<Figure>> {
    let mut trials = Vec::new();
    for systems in SYSTEMS {
        for size_m in SIZES_M {
            for frequency in [Frequency::Single, Frequency::Dual] {
                trials.extend((0..seeds).map(|seed| (systems, frequency, size_m, seed)));
            }
        }
    }
    let tallies: Vec<(Frequency, Tally)> = trials
        .iter()
        .together(|&(systems, frequency, size_m, seed)| {
            Ok((frequency, attempt(systems, frequency, size_m, seed)?))
        })
        .collect::<Result<_>>()?;
    let all: Tally = tallies.iter().map(|(_, tally)| tally).collect();
    let on_one = tallies.iter().filter(|(frequency, _)| matches!(frequency, Frequency::Single));
    let on_one: Tally = on_one.map(|(_, tally)| tally).collect();
    let mut figures = all.figures(f64::INFINITY);
    figures.push(Figure::at_most("on one frequency", on_one.misleading(), 0.0));
    figures.push(Figure::at_most("their rate is above", all.least_rate(), BEYOND));
    Ok(figures)
}

/// Sends one epoch under every method.
fn attempt(systems: Systems, frequency: Frequency, size_m: f64, seed: u64) -> Result<Tally> {
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let start_s = start_s(&mut chance);
    let towards_rad = chance.random_range(0.0..std::f64::consts::TAU);
    let (letters, fleets) = systems;
    let simulation =
        Simulation { satellites: satellites(fleets), ..Simulation::above_xian(start_s, 1, seed) };
    let behind = |sight: &Sight| {
        let los = sight.line_of_sight;
        let aside_rad = (los.east.atan2(los.north) - towards_rad).rem_euclid(std::f64::consts::TAU);
        aside_rad.min(std::f64::consts::TAU - aside_rad) < HALF_WIDTH_RAD && sight.elevation_rad() < ROOF_RAD
    };
    let late: Vec<(SatelliteId, f64)> = simulation
        .sights_at(0)
        .iter()
        .filter(|sight| behind(sight))
        .map(|sight| (sight.satellite, size_m * chance.random_range(0.5..1.0)))
        .collect();
    let sky = Sky::with(&simulation, letters, frequency)?;
    let bytes = sky.bytes(|_, epoch| {
        for &(satellite, late_m) in &late {
            epoch.lengthen(satellite, late_m);
        }
    })?;
    by_every_method(&bytes.concat(), sky.truth)
}
