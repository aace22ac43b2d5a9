//! Signals that are lost and tracked falsely: every range is kilometres wrong, and now and then some agree.
//!
//! Six satellites of one system leave two degrees of freedom, and one after an exclusion. Each range is wrong by a number of
//! its own in every epoch, up to [`SPREAD_M`]; a third of the epochs have one satellite more or less. The strength of
//! the signals is said as good, so that nothing but their disagreement tells.

use anyhow::Result;
use rai_core::satellite::Constellation;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::forgery::{Sky, keep_first};
use super::tally::Tally;
use super::victim::Victim;
use super::{Attack, Effort, Figure};
use crate::fault::Measured as _;

/// The attack.
pub(super) const ATTACK: Attack = Attack {
    name: "false-tracking",
    about: "every range wrong by up to 3 km, anew in each epoch: some sets agree by chance",
    run,
};

/// Errors are up to this, m.
const SPREAD_M: f64 = 3000.0;

/// Epochs of a run; the first of them are healthy.
const EPOCHS: u32 = 960;
const HEALTHY: usize = 20;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut tally = Tally::default();
    for seed in 0..effort.pick(2, 40) {
        tally = tally.with(&attempt(seed)?);
    }
    let mut figures = tally.figures(0.0);
    figures.push(Figure::plain("alerts", tally.alerts as f64));
    Ok(figures)
}

fn attempt(seed: u64) -> Result<Tally> {
    let sky = Sky::quiet(EPOCHS, seed)?;
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let bytes = sky.bytes(|index, epoch| {
        if index < HEALTHY {
            return;
        }
        let count = [6, 6, 5, 6, 6, 7][chance.random_range(0..6)];
        keep_first(epoch, Constellation::Gps, count);
        for satellite in epoch.satellites() {
            epoch.lengthen(satellite, chance.random_range(-SPREAD_M..SPREAD_M));
        }
    })?;
    let (mut victim, mut tally) = (Victim::new(&[], 1.0)?, Tally::default());
    for (index, bytes) in bytes.iter().enumerate() {
        let seen = victim.hear(bytes, sky.truth)?;
        if index >= HEALTHY {
            tally.add_all(&seen);
        }
    }
    Ok(tally)
}
