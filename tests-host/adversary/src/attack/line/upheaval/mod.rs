//! Random stress: leaps of the place, leaps of time in both directions, a line that delays, cuts
//! and repeats, wrong ranges, and commands of the host meanwhile.
//!
//! ```text
//! seed ─► scenes ─► bytes ─► module ─► reports ─► oracle ─► findings
//! ```
//!
//! Other attacks try known ideas; this one looks for unknown ones. A run ([`mod@run`]) has about a
//! dozen [`scenes`] drawn from its seed, some quiet ones at the end, then `FORGET` and some more.
//! The truth is not simulated a second time. Instead the [`oracle`] checks the sentences against
//! the promises of the product, and reports each finding with its seed and second.

mod oracle;
mod run;
mod scenes;

use self::oracle::{Finding, Oracle};
use self::run::Run;
use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "upheaval",
    about: "random events: the place jumps by up to 1,000 km, tags go ahead and back, the line is silent, cuts, delays and repeats, ranges are wrong, the host sends commands",
    branch: Branch::Settings,
    before: "at length 12 jumps of up to 930 km promised, after a longer `RECOVER` was set; 116 runs with `RECOVERING` until a restart, with epochs farther apart than the time to alert",
    note: "at length 2,000 runs with epochs 1, 5 and 30 s apart",
    run,
};

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let play = |seed| Run::of(seed, asked_for().is_some())?.play();
    let oracles: Vec<Oracle> = seeds(effort).together(play).collect::<Result<_>>()?;
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

/// Seeds with which a longer `RECOVER`, set after a leap, once made the leap the truth.
const LED_AWAY: [u64; 2] = [290, 1413];

/// Returns the seeds to run. If `RAI_UPHEAVAL` is set, only that seed runs, and the run prints its
/// events.
fn seeds(effort: Effort) -> Vec<u64> {
    match asked_for() {
        Some(seed) => vec![seed],
        None => (0..effort.pick(40, 2000)).chain(effort.pick(&LED_AWAY[..], &[]).iter().copied()).collect(),
    }
}

fn asked_for() -> Option<u64> {
    std::env::var("RAI_UPHEAVAL").ok()?.parse().ok()
}
