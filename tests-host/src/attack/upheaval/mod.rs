//! Everything at once, by chance: the place leaps, time goes ahead and back, the line holds back, cuts and repeats, ranges are
//! wrong, and the host gives commands meanwhile.
//!
//! ```text
//! seed ─► scenes ─► bytes ─► module ─► what it says ─► oracle ─► what it should not have said
//! ```
//!
//! Other attacks try what somebody thought of; this one tries what nobody did. A run ([`mod@run`]) is a dozen scenes ([`scenes`]) that follow
//! from its seed, some quiet ones at the end, and after these `FORGET` and some more. What is right is not simulated a second time: the
//! [`oracle`] holds to the sentences what is promised of them, and what it finds it says with the seed and the second.

mod oracle;
mod run;
mod scenes;

use anyhow::Result;
use rayon::prelude::*;

use self::oracle::{Finding, Oracle};
use self::run::Run;
use super::{Attack, Effort, Figure};

/// The attack.
pub(super) const ATTACK: Attack = Attack {
    name: "upheaval",
    about: "place and time leap, the line fails, ranges are wrong and the host commands, all by chance",
    run,
};

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let seeds = seeds(effort);
    let oracles: Vec<Oracle> = seeds
        .into_par_iter()
        .map(|seed| Run::of(seed, is_told()).and_then(Run::play))
        .collect::<Result<_>>()?;
    let count = |number: fn(&Oracle) -> usize| oracles.iter().map(number).sum::<usize>() as f64;
    let mut figures = vec![
        Figure::plain("epochs", count(|oracle| oracle.epochs)),
        Figure::plain("promised", count(|oracle| oracle.promised)),
        Figure::plain("alerts", count(|oracle| oracle.alerts)),
    ];
    for (finding, what) in Finding::ALL {
        let found: Vec<&str> = oracles.iter().flat_map(|oracle| oracle.found(finding)).collect();
        let first = found.first().map_or(String::new(), |first| format!(", first {first}"));
        figures.push(Figure::at_most(format!("{what}{first}:"), found.len() as f64, 0.0));
    }
    Ok(figures)
}

/// Runs in which a longer `RECOVER`, set after a leap, made the leap the truth.
const LED_AWAY: [u64; 2] = [290, 1413];

/// Which runs; one, which then tells what happens, where `RAI_UPHEAVAL` is its seed.
fn seeds(effort: Effort) -> Vec<u64> {
    match asked_for() {
        Some(seed) => vec![seed],
        None => (0..effort.pick(40, 2000)).chain(effort.pick(&LED_AWAY[..], &[]).iter().copied()).collect(),
    }
}

fn is_told() -> bool {
    asked_for().is_some()
}

fn asked_for() -> Option<u64> {
    std::env::var("RAI_UPHEAVAL").ok()?.parse().ok()
}
