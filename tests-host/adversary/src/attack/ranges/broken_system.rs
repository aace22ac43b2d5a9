//! One system of three is broken: more of its satellites are wrong than an exclusion may take.
//!
//! ```text
//! orbits   every BeiDou range is off by a constant of its own, 50 m to 1 km
//! jumps    every second BeiDou range is 1,875 m too long, in half of the epochs
//! ```
//!
//! GPS and Galileo are right and agree. The position must be promised as often as without `BeiDou`,
//! and never beyond its level.

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "broken-system",
    about: "every BeiDou range off by 50 m to 1 km, or every second one by 1,875 m in half of the epochs, beside GPS and Galileo that agree; AUTO, BAARDA, SEPARATION",
    branch: Branch::Several,
    before: "without the exclusion of a system `AUTO` and `BAARDA` promise 0 and 31 % of the epochs",
    note: "as many promised as without BeiDou",
    run,
};

/// Kind of the fault.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    Absent,
    Orbits,
    Jumps,
}

/// Size of a jump, m.
const JUMP_M: f64 = 1875.0;

/// Epochs of a run.
const EPOCHS: u32 = 120;

/// Least share of the epochs promised without `BeiDou` that must be promised with it.
const KEPT: f64 = 0.97;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for method in ["AUTO", "BAARDA", "ARAIM"] {
        let all = |fault: Fault| -> Result<Tally> {
            (0..effort.pick(6, 60)).together(|seed| attempt(method, fault, seed)).collect()
        };
        let without = all(Fault::Absent)?;
        figures.push(Figure::plain(format!("{method}: promised without BeiDou"), without.promised()));
        for fault in [Fault::Orbits, Fault::Jumps] {
            let tally = all(fault)?;
            let share = tally.promised() / without.outcomes.promised.max(1) as f64;
            figures.push(Figure::at_least(format!("{fault:?}: share of it"), share, KEPT));
            figures.push(Figure::at_most("beyond their level", tally.misleading(), 0.0));
            figures.push(Figure::plain("alerts", tally.alerts()));
        }
    }
    Ok(figures)
}

fn attempt(method: &str, fault: Fault, seed: u64) -> Result<Tally> {
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let start_s = 600.0 + 3600.0 * (seed % 24) as f64;
    let simulation =
        Simulation { satellites: satellites(THREE.1), ..Simulation::above_xian(start_s, EPOCHS, seed) };
    let letters = if fault == Fault::Absent { "GE" } else { "GEC" };
    let sky = Sky::with(&simulation, letters, Frequency::Dual)?;
    let mut errors_m = Vec::new();
    let mut is_jumping = false;
    let bytes = sky.bytes(|_, epoch| {
        is_jumping ^= chance.random_bool(0.15);
        for (index, satellite) in of_system(epoch, Constellation::Beidou).into_iter().enumerate() {
            let error_m = match fault {
                Fault::Orbits => constant_of(satellite, &mut errors_m, &mut chance),
                Fault::Jumps if is_jumping && index.is_multiple_of(2) => JUMP_M,
                Fault::Absent | Fault::Jumps => 0.0,
            };
            epoch.lengthen(satellite, error_m);
        }
    })?;
    Victim::new(&[&format!("METHOD,{method}")], 1.0)?.judge(&bytes, sky.truth)
}

/// Returns the error of a satellite's orbit along the line of sight, m, drawn once.
fn constant_of(
    satellite: SatelliteId,
    errors_m: &mut Vec<(SatelliteId, f64)>,
    chance: &mut ChaCha8Rng,
) -> f64 {
    if let Some((_, error_m)) = errors_m.iter().find(|(known, _)| *known == satellite) {
        return *error_m;
    }
    let error_m = signed_size(50.0..1000.0, chance);
    errors_m.push((satellite, error_m));
    error_m
}
