//! Several grossly wrong satellites at once, or one beside a small fault.
//!
//! A gross fault bends the linearised ranges, so that every test that compares sums of squares
//! about one point may be wrong (rule of curvature of `raim_core::internals::least_squares`). Levels of a
//! method hold for its promises here as elsewhere, because gross faults contradict each other.

use crate::attack::prelude::*;

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

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for method in ["SEPARATION", "AUTO"] {
        for faults in ALL {
            let runs = (0..effort.pick(6, 60)).flat_map(|seed| [(seed, 0), (seed, HEALTHY)]);
            let runs = runs.together(|(seed, healthy)| attempt(method, faults, seed, healthy));
            let tally: Tally = runs.collect::<Result<_>>()?;
            figures.push(Figure::plain(format!("{method} {faults:?}: % promised"), tally.percent()));
            let beyond = if faults == Faults::BesideSmall {
                figures.push(Figure::at_most("rate beyond is above", tally.least_rate(), MISSED));
                f64::INFINITY
            } else {
                0.0
            };
            figures.push(Figure::at_most("beyond their level", tally.misleading(), beyond));
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
    let mut victim = Victim::new(&[&format!("METHOD,{method}")], 1.0)?;
    victim.judge(&bytes[..healthy], sky.truth)?;
    victim.judge(&bytes[healthy..], sky.truth)
}

/// Draws the faulty satellites with their errors, m.
fn draw(seen: &[SatelliteId], faults: Faults, chance: &mut ChaCha8Rng) -> Vec<(SatelliteId, f64)> {
    let systems = [Constellation::Gps, Constellation::Beidou];
    let of = |system: Constellation| -> Vec<SatelliteId> {
        seen.iter().copied().filter(|satellite| satellite.constellation() == system).collect()
    };
    let system = systems[usize::from(chance.random_bool(0.5))];
    let error_m = signed_size(GROSS_M, chance);
    let own: Vec<SatelliteId> = of(system).sample(chance, 3).copied().collect();
    let pair = |other_m: f64| own.iter().copied().zip([error_m, other_m]).collect();
    match faults {
        Faults::Equal => pair(error_m),
        Faults::Opposite => pair(-error_m),
        Faults::Drawn => pair(signed_size(GROSS_M, chance)),
        Faults::BesideSmall => pair(signed_size(SMALL_M, chance)),
        Faults::Three => own.into_iter().map(|satellite| (satellite, signed_size(GROSS_M, chance))).collect(),
        Faults::OneEach => {
            let mut one = |system| Some((*of(system).choose(chance)?, signed_size(GROSS_M, chance)));
            systems.into_iter().filter_map(&mut one).collect()
        }
    }
}
