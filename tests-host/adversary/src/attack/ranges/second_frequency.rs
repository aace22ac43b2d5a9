//! The second frequency of a third of one system wrong by tens of metres.
//!
//! ```text
//! δP_2 = e        δρ = (1 − k) e = −1.55 e on L1 and L2
//! ```
//!
//! Several satellites are wrong at once, which a level does not bound. Their differences `P_2 −
//! P_1` are unlike those of their system, before any position is known.

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "second-frequency",
    about: "the second frequency of a third of GPS 40 to 60 m too long or too short, AUTO and SEPARATION",
    branch: Branch::Several,
    before: "25 of 76 beyond",
    note: "",
    run,
};

/// Largest share of the epochs that may be promised above their level, as with two faults. Of
/// ranges that are too long on the second frequency, 40 to 45 m look like the ionosphere of a low
/// satellite behind the equatorial crest.
const BEYOND: [(f64, f64); 2] = [(-1.0, 0.01), (1.0, 0.06)];

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for method in ["METHOD,AUTO", "METHOD,SEPARATION"] {
        for (sign, beyond) in BEYOND {
            let (mut tally, mut apart) = (Tally::default(), 0);
            for seed in 0..effort.pick(150, 1500) {
                let (one, counted) = attempt(seed, method, sign)?;
                tally += &one;
                apart += counted;
            }
            figures.extend(tally.figures(beyond * tally.epochs()));
            figures.push(Figure::plain("left out for their bands", f64::from(apart)));
        }
    }
    Ok(figures)
}

fn attempt(seed: u64, method: &str, sign: f64) -> Result<(Tally, u32)> {
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let sky = Sky::with(&Simulation::above_xian(start_s(&mut chance), 1, seed), "G", Frequency::Dual)?;
    let of_gps = of_system(&sky.recording.epochs[0], Constellation::Gps);
    let wrong: Vec<SatelliteId> = of_gps.sample(&mut chance, of_gps.len() / 3).copied().collect();
    let size_m = sign * chance.random_range(40.0..60.0);
    let bytes = sky.bytes(|_, epoch| {
        for raw in epoch.satellites.iter_mut().filter(|raw| wrong.contains(&raw.satellite)) {
            for signal in raw.signals.iter_mut().filter(|signal| signal.band == 2) {
                signal.pseudorange_m += size_m;
            }
        }
    })?;
    let mut victim = Victim::new(&[method], 1.0)?;
    let tally = victim.judge(bytes, sky.truth)?;
    Ok((tally, victim.counter("bands_apart")?))
}
