//! A satellite that is not where it broadcasts: a manoeuvre that its ephemeris does not describe.
//!
//! The broadcast orbit is ahead of the satellite by a distance, or moves ahead of it. All broadcast
//! values agree with each other.

use std::f64::consts::PI;

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "orbit",
    about: "a satellite 10 m to 30 km away from its broadcast orbit",
    branch: Branch::Orbits,
    before: "0 of 239",
    note: "",
    run,
};

/// Distances along the orbit, m, drawn uniformly in their logarithm.
const SIZES_M: std::ops::Range<f64> = 10.0..30_000.0;

/// Epochs of a run.
const EPOCHS: u32 = 40;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let tally: Tally = (0..effort.pick(8, 400)).together(attempt).collect::<Result<_>>()?;
    Ok(tally.figures_by_rate(MISSED))
}

fn attempt(seed: u64) -> Result<Tally> {
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let mut sky = Sky::quiet(EPOCHS, seed)?;
    let (kept, astray) = sky.draw(&mut chance);
    let along_m = size(SIZES_M, &mut chance);
    let own = sky.recording.ephemerides.iter_mut().filter(|set| set.satellite == astray);
    own.for_each(|set| move_ahead(set, along_m));
    Victim::new(&["HAL,60"], 1.0)?
        .judge(sky.bytes(|_, epoch| epoch.satellites.retain(|raw| kept.contains(&raw.satellite)))?, sky.truth)
}

/// Moves a satellite along its orbit.
pub(in crate::attack) fn move_ahead(ephemeris: &mut TimedEphemeris, along_m: f64) {
    let turned_sc = |sqrt_a_sqrt_m: f64| along_m / (sqrt_a_sqrt_m * sqrt_a_sqrt_m * PI);
    match &mut ephemeris.message {
        Ephemeris::Gps(message) => message.m0_sc = wrapped(message.m0_sc + turned_sc(message.sqrt_a_sqrt_m)),
        Ephemeris::Beidou(message) => {
            message.m0_sc = wrapped(message.m0_sc + turned_sc(message.sqrt_a_sqrt_m));
        }
        _ => {}
    }
}

/// Wraps an angle to between −1 and 1 semicircle.
fn wrapped(angle_sc: f64) -> f64 {
    (angle_sc + 1.0).rem_euclid(2.0) - 1.0
}
