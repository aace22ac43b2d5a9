//! A receiver that detects counterfeit signals, and messages that could make the module discard
//! that warning.
//!
//! The messages are: one of another kind with less knowledge; one of the same kind from a receiver
//! that has restarted and does not know; and a single denial without a later one.
//!
//! A warning that suspects spoofing, and nothing more, is no reason to withdraw anything: a
//! receiver at rest repeated it in a clean sky for ten minutes.
//!
//! The sky itself is healthy, so only the receiver's warning contradicts the promise.

use raim::signal::encode::ubx;
use raim_firmware::input::Suspicion;

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "suspicion-denied",
    about: "the receiver is sure of counterfeit signals (SEC-SIG), then NAV-STATUS or SEC-SIG itself reports unknown; one report of none, then silence",
    branch: Branch::Counterfeit,
    before: "all 20 epochs promised, and 17 of 20; the first epoch after the end as well; `1` until a restart",
    note: "`SPOOFED`, also if the levels are beyond the limits; promised again after it with 10 s and `RECOVER`",
    run,
};

/// Epochs before the warning, during it, and after the receiver withdraws it.
const EPOCHS: [usize; 3] = [10, 20, 20];

/// Epochs for which the satellites must agree after an alert, at start.
const RECOVER: f64 = 3.0;

/// Epochs after a certainty for which nothing is promised.
const AFTER: f64 = 10.0;

/// Returns SEC-SIG, version 2: jamming detection on, without jamming; spoofing detection on, in the
/// given state.
pub(in crate::attack) fn of_both(spoofing: u8) -> Vec<u8> {
    ubx::frame([0x27, 0x09], &[2, 0b0000_1011 | spoofing << 4, 0, 0])
}

/// Returns NAV-STATUS with an unknown spoofing state.
fn of_spoofing_unknown() -> Vec<u8> {
    ubx::frame([0x01, 0x03], &[0; 16])
}

fn run(_: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    // With levels above the limits, too, the state must be an alert, because the position must not
    // be used.
    for commands in [&[][..], &["HAL,5"]] {
        let (mut before, mut sure, mut after) = (Tally::default(), Tally::default(), Tally::default());
        let (mut alerts, mut until_promised) = (0, 0);
        let sky = Sky::quiet(EPOCHS.iter().sum::<usize>() as u32, 1)?;
        let mut victim = Victim::new(commands, 1.0)?;
        for (index, bytes) in sky.unchanged()?.iter().enumerate() {
            let reported = match index.checked_sub(EPOCHS[0]) {
                None => Vec::new(),
                Some(since) if since < EPOCHS[1] => [of_both(3), of_spoofing_unknown()].concat(),
                Some(_) => of_both(1),
            };
            let seen = victim.receive(&[&reported[..], bytes].concat(), sky.truth)?;
            match index.checked_sub(EPOCHS[0]) {
                None => before.add_all(&seen),
                Some(since) if since < EPOCHS[1] => {
                    sure.add_all(&seen);
                    alerts += seen.iter().filter(|seen| is_spoofed(seen)).count();
                }
                Some(_) => {
                    after.add_all(&seen);
                    until_promised += usize::from(after.outcomes.promised == 0);
                }
            }
        }
        let name = if commands.is_empty() { "" } else { " with HAL 5 m" };
        figures.push(Figure::at_most(format!("promised while it is sure{name}"), sure.promised(), 0.0));
        figures.push(Figure::at_least(format!("`SPOOFED` then{name}"), alerts as f64, EPOCHS[1] as f64));
        if commands.is_empty() {
            figures.push(Figure::at_least("promised before", before.promised(), EPOCHS[0] as f64));
            figures.push(Figure::at_least("epochs to recover after", until_promised as f64, AFTER + RECOVER));
            figures.push(Figure::at_least("promised after", after.promised(), 1.0));
        }
    }
    let (promised, alerts) = begun_anew()?;
    figures.push(Figure::at_most("promised once it does not know any more", promised, 0.0));
    figures.push(Figure::at_least("`SPOOFED` then", alerts, 20.0));
    figures.push(Figure::at_most("s for which one word of none holds", word_of_none_s()?, 4.0));
    let least = 20.0 - RECOVER;
    figures.push(Figure::at_least("promised after one word of it and `FORGET`", forgotten()?, least));
    // It suspects spoofing and jamming.
    let suspects = ubx::frame([0x27, 0x09], &[2, 0b0010_1101, 0, 0]);
    let promised = promised_during(&[], &suspects)?;
    figures.push(Figure::at_least("promised of 30 while it suspects", promised, 30.0));
    let promised = promised_during(&["SPOOFFLAG,SAY"], &of_both(3))?;
    figures.push(Figure::at_least("promised of 30 with `SPOOFFLAG,SAY` while it is sure", promised, 30.0));
    Ok(figures)
}

/// Returns the promised epochs of thirty with a message before each of them.
fn promised_during(commands: &[&str], message: &[u8]) -> Result<f64> {
    let sky = Sky::quiet(30, 1)?;
    let steps = sky.unchanged()?.into_iter().map(|bytes| [message, &bytes].concat());
    Ok(Victim::new(commands, 1.0)?.judge(steps, sky.truth)?.promised())
}

/// Returns promised epochs and alerts of twenty in which SEC-SIG has spoofing detection off, after
/// ten with a warning.
fn begun_anew() -> Result<(f64, f64)> {
    let sky = Sky::quiet(40, 1)?;
    let (mut victim, mut after, mut alerts) = (Victim::new(&[], 1.0)?, Tally::default(), 0);
    for (index, bytes) in sky.unchanged()?.iter().enumerate() {
        let reported = match index {
            0..10 => of_both(1),
            10..20 => of_both(3),
            _ => ubx::frame([0x27, 0x09], &[2, 0b0000_0011, 0, 0]),
        };
        let seen = victim.receive(&[&reported[..], bytes].concat(), sky.truth)?;
        if index >= 20 {
            after.add_all(&seen);
            alerts += seen.iter().filter(|seen| is_spoofed(seen)).count();
        }
    }
    Ok((after.promised(), alerts as f64))
}

/// Returns the time for which the module reports no counterfeit signals after one denial, s.
fn word_of_none_s() -> Result<f64> {
    let sky = Sky::quiet(120, 1)?;
    let (mut victim, mut bytes, mut holds_s) = (Victim::new(&[], 1.0)?, sky.unchanged()?, 0.0);
    bytes[10].splice(..0, of_both(1));
    for bytes in bytes {
        victim.receive(&bytes, sky.truth)?;
        holds_s += f64::from(u8::from(victim.module.spoofing() == Suspicion::None));
    }
    Ok(holds_s)
}

/// Returns the promised epochs of the twenty after `FORGET`, on the line of a receiver that sends
/// no SEC-SIG, after a single forged one.
fn forgotten() -> Result<f64> {
    let sky = Sky::quiet(40, 1)?;
    let (mut victim, mut bytes) = (Victim::new(&[], 1.0)?, sky.unchanged()?);
    bytes[10].splice(..0, of_both(3));
    victim.judge(&bytes[..20], sky.truth)?;
    victim.obey("FORGET")?;
    Ok(victim.judge(&bytes[20..], sky.truth)?.promised())
}

/// Returns true for a spoofing alert without a protection level.
fn is_spoofed(seen: &Seen) -> bool {
    let state = &seen.reported.state;
    state.reason == "SPOOFED" && state.hpl_m.is_none()
}
