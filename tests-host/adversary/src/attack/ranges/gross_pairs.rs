//! Several grossly wrong satellites at once, or one beside a small fault.
//!
//! A gross fault bends the linearised ranges, so that every test that compares sums of squares
//! about one point may be wrong (rule of curvature of `raim_core::internals::least_squares`). Levels of a
//! method hold for its promises here as elsewhere, because gross faults contradict each other.

use crate::attack::prelude::*;

/// Attack with several gross faults.
pub(super) const ATTACK: Attack = Attack {
    name: "gross-pairs",
    about: "two or three satellites of one system wrong by 1 km to 10,000 km, equal, opposite or drawn; one of each of two systems; one beside one of 20 to 100 m; from the first epoch and after a quiet minute, SEPARATION and AUTO",
    branch: Branch::Several,
    before: "not tried",
    note: "",
    run,
};

/// Choice of the faulty satellites and of their errors.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Faults {
    /// Two of one system, wrong by the same.
    Equal,
    /// Two of one system, wrong by the same with opposite signs.
    Opposite,
    /// Two of one system, each wrong by its own error.
    Drawn,
    /// Three of one system.
    Three,
    /// One of each system.
    OneEach,
    /// One, and another one wrong by 20 to 100 m.
    BesideSmall,
}

const ALL: [Faults; 6] =
    [Faults::Equal, Faults::Opposite, Faults::Drawn, Faults::Three, Faults::OneEach, Faults::BesideSmall];

/// Gross errors and small ones, m, drawn uniformly in their logarithm.
const GROSS_M: std::ops::Range<f64> = 1e3..1e7;
const SMALL_M: std::ops::Range<f64> = 20.0..100.0;

/// Healthy epochs before, if there are any, and the faulty ones.
const HEALTHY: usize = 60;
const FAULTY: usize = 30;

/// Probability of missed detection at start.
const MISSED: f64 = 1e-3;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for method in ["SEPARATION", "AUTO"] {
        for faults in ALL {
            let runs: Vec<(u64, usize)> =
                (0..effort.pick(6, 60)).flat_map(|seed| [(seed, 0), (seed, HEALTHY)]).collect();
            let tallies: Vec<Tally> = runs
                .iter()
                .together(|&(seed, healthy)| attempt(method, faults, seed, healthy))
                .collect::<Result<_>>()?;
            let tally = tallies.iter().fold(Tally::default(), Tally::with);
            let share = 100.0 * tally.outcomes.promised as f64 / tally.outcomes.epochs().max(1) as f64;
            figures.push(Figure::plain(format!("{method} {faults:?}: % promised"), share));
            let beyond = if faults == Faults::BesideSmall {
                let rate = least_rate(tally.outcomes.misleading, tally.outcomes.epochs());
                figures.push(Figure::at_most("rate beyond is above", rate, MISSED));
                f64::INFINITY
            } else {
                0.0
            };
            figures.push(Figure::at_most("beyond their level", tally.outcomes.misleading as f64, beyond));
        }
    }
    Ok(figures)
}

fn attempt(method: &str, faults: Faults, seed: u64, healthy: usize) -> Result<Tally> {
    let simulation =
        Simulation::above_xian(2000.0 + 3300.0 * (seed % 24) as f64, (healthy + FAULTY) as u32, seed);
    let sky = Sky::of(&simulation, Frequency::Dual)?;
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let errors = draw(&sky.recording.epochs[0].satellites(), faults, &mut chance);
    let bytes = sky.bytes(|index, epoch| {
        if index >= healthy {
            for &(satellite, error_m) in &errors {
                epoch.lengthen(satellite, error_m);
            }
        }
    })?;
    let (mut victim, mut tally) = (Victim::new(&[&format!("METHOD,{method}")], 1.0)?, Tally::default());
    for (index, bytes) in bytes.iter().enumerate() {
        let seen = victim.receive(bytes, sky.truth)?;
        if index >= healthy {
            tally.add_all(&seen);
        }
    }
    Ok(tally)
}

/// Draws the faulty satellites with their errors, m.
fn draw(seen: &[SatelliteId], faults: Faults, chance: &mut ChaCha8Rng) -> Vec<(SatelliteId, f64)> {
    let systems = [Constellation::Gps, Constellation::Beidou];
    let of = |system: Constellation| -> Vec<SatelliteId> {
        seen.iter().copied().filter(|satellite| satellite.constellation() == system).collect()
    };
    let system = systems[usize::from(chance.random_bool(0.5))];
    let error_m = size_m(GROSS_M, chance);
    let own: Vec<SatelliteId> = of(system).sample(chance, 3).copied().collect();
    let pair = |other_m: f64| own.iter().copied().zip([error_m, other_m]).collect();
    match faults {
        Faults::Equal => pair(error_m),
        Faults::Opposite => pair(-error_m),
        Faults::Drawn => pair(size_m(GROSS_M, chance)),
        Faults::BesideSmall => pair(size_m(SMALL_M, chance)),
        Faults::Three => own.into_iter().map(|satellite| (satellite, size_m(GROSS_M, chance))).collect(),
        Faults::OneEach => {
            let mut one = |system| Some((*of(system).choose(chance)?, size_m(GROSS_M, chance)));
            systems.into_iter().filter_map(&mut one).collect()
        }
    }
}

/// Draws a size with either sign.
fn size_m(sizes_m: std::ops::Range<f64>, chance: &mut ChaCha8Rng) -> f64 {
    let size_m = chance.random_range(sizes_m.start.ln()..sizes_m.end.ln()).exp();
    if chance.random() { size_m } else { -size_m }
}
