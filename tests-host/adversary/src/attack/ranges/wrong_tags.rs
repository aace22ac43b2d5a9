//! Ranges that a relay on the way tags with another time, because it dates what it forwards by its
//! own clock.
//!
//! ```text
//! δρ_i = ṙ_i δ        every satellite is wrong by so much of its range rate, up to 800 m/s
//! ```
//!
//! An offset of 10 ms hides in the noise; 20 ms to 200 ms do not. Of satellites that are all wrong,
//! though, a few can always be left out so that the others agree. Tags are first right, then wrong
//! by `δ`, then right again; or wrong from the start.

use crate::attack::prelude::*;

pub(super) const BRIEFLY: Attack = Attack {
    name: "wrong-tags",
    about: "time tags wrong by 5 ms to 200 ms, ahead and behind, for ten epochs or from the start; four sets of systems, twelve settings",
    branch: Branch::Time,
    before: "192 of 6,055 beyond, up to 114 m; 1,302 satellites excluded; at length 4,329 of 97,313, then 120 of 57,704 by 15 or 20 ms, while levels bounded satellite faults only",
    note: "",
    run: briefly,
};

pub(super) const LEARNED: Attack = Attack {
    name: "wrong-tags-learned",
    about: "time tags wrong by 20 ms to 200 ms for four minutes, while NOISE,AUTO learns",
    branch: Branch::Time,
    before: "21 of 2,325 beyond, up to 64 m; at length 925 of 12,422, then 14",
    note: "",
    run: while_learning,
};

/// Offsets of the tags, ms, applied ahead and behind.
const OFFSETS_MS: [i64; 8] = [5, 10, 15, 20, 30, 50, 100, 200];

const SYSTEMS: [Systems; 4] = [GPS, GPS_BEIDOU, GPS_GALILEO, THREE];

/// Settings of the module.
const SETTINGS: [&[&str]; 12] = [
    &["METHOD,AUTO"],
    &["METHOD,BAARDA"],
    &["METHOD,SIMULTANEOUS"],
    &["METHOD,SEQUENTIAL"],
    &["METHOD,HYBRID"],
    &["METHOD,GROUPING"],
    &["METHOD,RANSAC"],
    &["METHOD,SEPARATION"],
    &["METHOD,SEPARATION", "PHASE,LPV200"],
    &["CLOCKAID,ON"],
    &["POLICY,T2", "HAL,60"],
    &["POLICY,TOP", "HAL,60"],
];

/// Epochs with right tags, with wrong tags, and with right tags again, at whose end the position
/// must be promised.
const RIGHT: u32 = 5;
const WRONG: u32 = 10;
const AGAIN: u32 = 10;

/// Epochs with wrong tags while sigmas learn: several times what learning needs.
const LONG: u32 = 240;

/// State of the pin at the end: after wrong tags, and of a module that had right tags only.
type InTheEnd = (bool, bool);

/// Parameters of one attempt.
#[derive(Clone, Copy)]
struct Trial {
    systems: Systems,
    commands: &'static [&'static str],
    offset_ms: i64,
    right: u32,
    wrong: u32,
    seed: u64,
}

fn briefly(effort: Effort) -> Result<Vec<Figure>> {
    let mut trials = Vec::new();
    for systems in SYSTEMS {
        for commands in SETTINGS {
            for offset_ms in OFFSETS_MS {
                for seed in 0..effort.pick(4, 60) {
                    let (offset_ms, right) = of_seed(seed, offset_ms);
                    trials.push(Trial { systems, commands, offset_ms, right, wrong: WRONG, seed });
                }
            }
        }
    }
    let (wrong, again) = attempt_all(&trials)?;
    let mut figures = told(&trials, &wrong);
    let promised = again.iter().filter(|(ended_well, _)| *ended_well).count();
    let healthy = again.iter().filter(|(_, reference)| *reference).count();
    let share = 100.0 * promised as f64 / healthy.max(1) as f64;
    figures.push(Figure::at_least("% promised once tags are right again", share, 99.0));
    Ok(figures)
}

fn while_learning(effort: Effort) -> Result<Vec<Figure>> {
    let mut trials = Vec::new();
    for systems in SYSTEMS {
        for commands in [&["NOISE,AUTO"] as &[&str], &["NOISE,AUTO", "METHOD,BAARDA"]] {
            for offset_ms in [20, 50, 200] {
                for seed in 0..effort.pick(2, 12) {
                    let (offset_ms, right) = of_seed(seed, offset_ms);
                    trials.push(Trial { systems, commands, offset_ms, right, wrong: LONG, seed });
                }
            }
        }
    }
    let (wrong, _) = attempt_all(&trials)?;
    Ok(told(&trials, &wrong))
}

/// Returns the signed offset and the number of right epochs before it. Every four seeds cover all
/// combinations.
fn of_seed(seed: u64, offset_ms: i64) -> (i64, u32) {
    let (is_ahead, is_right_first) = (seed & 1 == 0, seed & 2 == 0);
    (if is_ahead { offset_ms } else { -offset_ms }, if is_right_first { RIGHT } else { 0 })
}

/// Runs the trials; returns the tallies and the states at the end.
fn attempt_all(trials: &[Trial]) -> Result<(Vec<Tally>, Vec<InTheEnd>)> {
    let seen: Vec<(Tally, InTheEnd)> = trials.iter().together(attempt).collect::<Result<_>>()?;
    Ok(seen.into_iter().unzip())
}

fn told(trials: &[Trial], tallies: &[Tally]) -> Vec<Figure> {
    let all: Tally = tallies.iter().collect();
    let mut figures = all.figures_by_rate(MISSED);
    figures.push(Figure::plain("of satellites left out in promised epochs", all.left_out as f64));
    figures.push(Figure::plain("`TIME`", all.of_reason("TIME") as f64));
    figures.push(Figure::plain("other alerts", (all.outcomes.alerts - all.of_reason("TIME")) as f64));
    let of = |is_of: &dyn Fn(&Trial) -> bool| -> Tally {
        let these = trials.iter().zip(tallies).filter(|(trial, _)| is_of(trial));
        these.map(|(_, tally)| tally).collect()
    };
    let mut beyond = |what: String, tally: &Tally| {
        if tally.outcomes.misleading > 0 {
            let quantity = format!("beyond {what} of {} promised", tally.outcomes.promised);
            figures.push(Figure::plain(quantity, tally.misleading()));
        }
    };
    for offset_ms in OFFSETS_MS {
        beyond(format!("by {offset_ms} ms"), &of(&|trial| trial.offset_ms.abs() == offset_ms));
    }
    for (name, _) in SYSTEMS {
        beyond(format!("with {name}"), &of(&|trial| trial.systems.0 == name));
    }
    for commands in SETTINGS {
        beyond(commands.join(" "), &of(&|trial| trial.commands == commands));
    }
    figures
}

fn attempt(trial: &Trial) -> Result<(Tally, InTheEnd)> {
    let Trial { systems: (letters, fleets), commands, offset_ms, right, wrong, seed } = *trial;
    // Each seed has its own sky, between two changes of ephemerides.
    let start_s = 600.0 + 7200.0 * (seed % 12) as f64 + 130.0 * (seed / 12) as f64;
    let simulation = Simulation {
        satellites: satellites(fleets),
        ..Simulation::above_xian(start_s, right + wrong + AGAIN, seed)
    };
    let sky = Sky::with(&simulation, letters, Frequency::Dual)?;
    let wrong = right as usize..(right + wrong) as usize;
    let bytes = sky.bytes(|index, epoch| {
        if wrong.contains(&index) {
            epoch.time = GpsTime::from_ms(epoch.time.to_ms().wrapping_add_signed(offset_ms));
        }
    })?;
    let mut victim = Victim::new(commands, 1.0)?;
    victim.judge(&bytes[..wrong.start], sky.truth)?;
    let tally = victim.judge(&bytes[wrong.clone()], sky.truth)?;
    victim.judge(&bytes[wrong.end..], sky.truth)?;
    let ended_well = victim.is_promised();
    // With limits close to the levels, a healthy module may promise nothing either.
    let mut reference = Victim::new(commands, 1.0)?;
    reference.judge(sky.unchanged()?, sky.truth)?;
    Ok((tally, (ended_well, reference.is_promised())))
}
