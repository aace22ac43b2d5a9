//! All satellites of one system wrong at once: orbits in a wrong frame, which agree with each other
//! on a place beside the true one.
//!
//! ```text
//! δρ_i = −LOS_i · d        every satellite of the system, and no other
//! ```
//!
//! The shifted system is in view with all its satellites, or with four or fewer, which agree on
//! some place and clock whatever their ranges are.
//!
//! Levels bound one fault. A detected shift must not be blamed on the few satellites whose
//! exclusion leaves others that agree by chance. No method detects small shifts that leave no
//! residual; only ARAIM bounds them, by their prior probability.

use super::several_faults::by_every_method;
use crate::attack::prelude::*;

pub(super) const WHOLE: Attack = Attack {
    name: "shifted-system",
    about: "all satellites of one of two or three systems agree on a place 20 to 300 m beside the true one, every method",
    branch: Branch::Several,
    before: "95 of 581; at length 1,032 of 7,387, up to 299 m, 648 with several satellites excluded",
    note: "five satellites of that system do not reveal where it stands",
    run: |effort| run(&[None], effort.pick(8, 100), BEYOND),
};

pub(super) const FEW: Attack = Attack {
    name: "few-shifted",
    about: "the same for a system with two to four satellites in view, and five or seven of others",
    branch: Branch::Several,
    before: "at length 86 of 10,186, up to 408 m, 20 with several satellites excluded",
    note: "",
    run: |effort| run(&FEW_IN_VIEW.map(Some), effort.pick(2, 25), BEYOND_OF_FEW),
};

/// Satellites in view of the shifted system, and of others.
const FEW_IN_VIEW: [(usize, usize); 5] = [(2, 7), (3, 5), (3, 7), (4, 5), (4, 7)];

const SYSTEMS: [Systems; 3] = [GPS_BEIDOU, GPS_GALILEO, THREE];

/// Distance from the true place, m.
const SIZES_M: [f64; 4] = [20.0, 50.0, 100.0, 300.0];

/// Largest share of the epochs that may be promised above their level, as with two faults.
const BEYOND: f64 = 0.01;

/// The same share if few satellites of the system are in view.
const BEYOND_OF_FEW: f64 = 0.002;

fn run(in_view: &[Option<(usize, usize)>], seeds: u64, beyond: f64) -> Result<Vec<Figure>> {
    let mut trials = Vec::new();
    for systems in SYSTEMS {
        for shifted in systems.0.chars() {
            for size_m in SIZES_M {
                for &in_view in in_view {
                    trials.extend((0..seeds).map(|seed| (systems, shifted, size_m, in_view, seed)));
                }
            }
        }
    }
    let all: Tally = trials
        .iter()
        .together(|&(systems, shifted, size_m, in_view, seed)| {
            attempt(systems, shifted, size_m, in_view, seed)
        })
        .collect::<Result<_>>()?;
    let mut figures = all.figures_by_rate(beyond);
    figures.push(Figure::at_most("of these with several left out", all.misled_by_several as f64, 0.0));
    Ok(figures)
}

/// Sends one epoch under every method.
fn attempt(
    systems: Systems,
    shifted: char,
    size_m: f64,
    in_view: Option<(usize, usize)>,
    seed: u64,
) -> Result<Tally> {
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let start_s = start_s(&mut chance);
    let azimuth = chance.random_range(0.0..std::f64::consts::TAU);
    let elevation = chance.random_range(-1.5..1.5_f64);
    let away = Enu {
        east: size_m * elevation.cos() * azimuth.sin(),
        north: size_m * elevation.cos() * azimuth.cos(),
        up: size_m * elevation.sin(),
    };
    let (letters, fleets) = systems;
    let simulation =
        Simulation { satellites: satellites(fleets), ..Simulation::above_xian(start_s, 1, seed) };
    let of_system = |satellite: SatelliteId| satellite.constellation().letter() == shifted;
    let sights = simulation.sights_at(0);
    let sky = Sky::with(&simulation, letters, Frequency::Dual)?;
    let seen = sky.recording.epochs[0].satellites();
    let (of_it, of_others): (Vec<SatelliteId>, Vec<SatelliteId>) =
        seen.into_iter().partition(|&satellite| of_system(satellite));
    let (mine, others) = in_view.unwrap_or((of_it.len(), of_others.len()));
    let kept = [of_it.sample(&mut chance, mine), of_others.sample(&mut chance, others)];
    let kept: Vec<SatelliteId> = kept.into_iter().flatten().copied().collect();
    let bytes = sky.bytes(|_, epoch| {
        epoch.satellites.retain(|raw| kept.contains(&raw.satellite));
        for sight in sights.iter().filter(|sight| of_system(sight.satellite)) {
            let los = sight.line_of_sight;
            let along_m = los.east * away.east + los.north * away.north + los.up * away.up;
            epoch.lengthen(sight.satellite, -along_m);
        }
    })?;
    by_every_method(&bytes.concat(), sky.truth)
}
