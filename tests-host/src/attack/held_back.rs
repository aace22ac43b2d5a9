//! Epochs that are held back: a relay, a logger or a line that is too slow delivers a second of signals in more than a second.
//!
//! The signals are healthy and their tags are theirs. Only the module's own clock tells that they are old.

use anyhow::Result;

use super::forgery::Sky;
use super::victim::Victim;
use super::{Attack, Effort, Figure};

/// The attack.
pub(super) const ATTACK: Attack = Attack {
    name: "held-back",
    about: "each second of signals comes in 1.05 to 9 s of the module's own: how old is what is still promised?",
    run,
};

/// Time to alert of the settings at start, s.
const TIME_TO_ALERT_S: f64 = 10.0;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let epochs = effort.pick(600, 3600);
    let sky = Sky::quiet(epochs, 1)?;
    let bytes = sky.bytes(|_, _| {})?;
    let mut figures = Vec::new();
    for own_s in [1.0, 1.05, 2.0, 9.0] {
        let (mut victim, mut oldest_s, mut promised) = (Victim::new(&[], own_s)?, 0.0_f64, 0);
        for (index, bytes) in bytes.iter().enumerate() {
            for seen in victim.hear(bytes, sky.truth)? {
                if seen.said.state.is_protected() {
                    oldest_s = oldest_s.max(index as f64 * (own_s - 1.0));
                    promised += 1;
                }
            }
        }
        // One percent of the time may be the own clock's.
        let slack = own_s / (own_s - 1.0) / 100.0;
        let bound_s = if own_s > 1.0 { TIME_TO_ALERT_S / (1.0 - slack) } else { 0.0 };
        figures.push(Figure::at_most(format!("oldest promised at {own_s} s an epoch, s"), oldest_s, bound_s));
        if own_s > 1.0 {
            continue;
        }
        figures.push(Figure::at_least("promised at 1 s an epoch", f64::from(promised), f64::from(epochs)));
    }
    Ok(figures)
}
