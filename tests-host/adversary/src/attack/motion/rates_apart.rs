//! Ranges that move while their rates say that nothing does, and a counterfeit sky after a silence.
//!
//! All ranges of an epoch agree, so that no test of one epoch sees the attack. The range rates are
//! those of the true receiver, at rest with its true clock.

use crate::attack::prelude::*;

pub(super) const WALK: Attack = Attack {
    name: "walk-off",
    about: "ranges of a place that walks off at 1 to 500 m/s, and range rates at rest",
    branch: Branch::Counterfeit,
    before: "700 of 700 promised, up to 319 km off",
    note: "",
    run: walk,
};

pub(super) const DRAG: Attack = Attack {
    name: "drag-off",
    about: "all ranges longer by 0.5 to 500 m/s, and true range rates",
    branch: Branch::All,
    before: "all promised; nothing compared the clock",
    note: "",
    run: drag,
};

pub(super) const SILENCE: Attack = Attack {
    name: "after-silence",
    about: "a counterfeit sky 300 km away after ten minutes without satellites",
    branch: Branch::Counterfeit,
    before: "promised in its first epoch",
    note: "",
    run: silence,
};

/// Speeds of a place, m/s. Height makes its noise larger than that of a clock, so that 0.5 m/s is
/// not seen under every sky.
const SPEEDS_M_S: [f64; 4] = [1.0, 10.0, 100.0, 500.0];

/// Drifts of a clock, m/s.
const DRIFTS_M_S: [f64; 5] = [0.5, 1.0, 10.0, 100.0, 500.0];

/// Healthy epochs before; a spread is known after three minutes.
const BEFORE: u32 = 240;

/// Attacked epochs.
const DURING: u32 = 120;

/// Longest time to the alert, s.
const LATE_S: f64 = 60.0;

/// Metres of a degree of latitude.
const DEGREE_M: f64 = 111_132.0;

/// Distance of the counterfeit sky after a silence, degrees of latitude: 300 km.
const AWAY_DEG: f64 = 2.7;

fn walk(effort: Effort) -> Result<Vec<Figure>> {
    attempts(effort, "TRACK", &SPEEDS_M_S, &|sky, seconds, speed_m_s, epoch| {
        let there = elsewhere(sky, speed_m_s * seconds / DEGREE_M);
        let index = BEFORE + seconds as u32;
        move_ranges(epoch, &sky.sights_at(index), &there.sights_at(index));
    })
}

fn drag(effort: Effort) -> Result<Vec<Figure>> {
    attempts(effort, "CLOCK", &DRIFTS_M_S, &|_, seconds, speed_m_s, epoch| {
        lengthen_all(epoch, speed_m_s * seconds);
    })
}

/// Change of an attacked epoch: the sky, seconds since the attack began, speed in m/s.
type Change<'a> = &'a dyn Fn(&Simulation, f64, f64, &mut MeasuredEpoch);

fn attempts(effort: Effort, reason: &str, speeds_m_s: &[f64], change: Change<'_>) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for &speed_m_s in speeds_m_s {
        let runs = (0..effort.pick(1, 12)).map(|seed| attempt(seed, speed_m_s, change));
        let runs = runs.collect::<Result<Vec<_>>>()?;
        let latest_s = runs.iter().map(|run| run.alert_s).fold(0.0, f64::max);
        let after = runs.iter().map(|run| run.after.outcomes.misleading).sum::<usize>();
        let before = runs.iter().map(|run| run.before.outcomes.alerts).sum::<usize>();
        let of_reason: usize = runs.iter().map(|run| run.after.of_reason(reason)).sum();
        figures.push(Figure::at_most(format!("s to the alert at {speed_m_s} m/s"), latest_s, LATE_S));
        figures.push(Figure::at_most("beyond a level after it", after as f64, 0.0));
        figures.push(Figure::at_least(format!("{reason} after it"), of_reason as f64, 1.0));
        figures.push(Figure::at_most("alerts before", before as f64, 0.0));
    }
    Ok(figures)
}

/// Outcome of one sky.
struct Run {
    before: Tally,
    /// Epochs from the first alert on.
    after: Tally,
    /// Time from the first attacked epoch to the alert, s; infinite without one.
    alert_s: f64,
}

fn attempt(seed: u64, speed_m_s: f64, change: Change<'_>) -> Result<Run> {
    let start_s = 3700.0 + 7200.0 * seed as f64;
    let simulation =
        Simulation { has_range_rates: true, ..Simulation::above_xian(start_s, BEFORE + DURING, seed) };
    let sky = Sky::of(&simulation, Frequency::Dual)?;
    let bytes = sky.bytes(|index, epoch| {
        if let Some(seconds) = (index as u32).checked_sub(BEFORE) {
            change(&simulation, f64::from(seconds), speed_m_s, epoch);
        }
    })?;
    let mut victim = Victim::new(&[], 1.0)?;
    let before = victim.judge(&bytes[..BEFORE as usize], sky.truth)?;
    let (mut after, mut alert_s) = (Tally::default(), f64::INFINITY);
    for (seconds, bytes) in (0_u32..).zip(&bytes[BEFORE as usize..]) {
        let seen = victim.receive(bytes, sky.truth)?;
        if seen.iter().any(|seen| seen.reported.state.state == 'A') {
            alert_s = alert_s.min(f64::from(seconds));
        }
        if alert_s.is_finite() {
            after.add_all(&seen);
        }
    }
    Ok(Run { before, after, alert_s })
}

fn silence(effort: Effort) -> Result<Vec<Figure>> {
    const SILENT_S: f64 = 600.0;
    let start_s = 3600.0;
    let honest = Simulation::above_xian(start_s, 60, 1);
    let forged_s = start_s + 60.0 + SILENT_S;
    let forged = Simulation::above_xian(forged_s, effort.pick(120, 500), 2);
    let (honest, forged) =
        (Sky::of(&honest, Frequency::Dual)?, Sky::of(&elsewhere(&forged, AWAY_DEG), Frequency::Dual)?);
    let mut victim = Victim::new(&[], 1.0)?;
    let before = victim.judge(honest.unchanged()?, honest.truth)?;
    let _ = victim.silence(SILENT_S, honest.truth)?;
    let after = victim.judge(forged.unchanged()?, honest.truth)?;
    let mut figures = after.figures(0.0);
    figures.push(Figure::at_least("protected before", before.promised(), 60.0));
    Ok(figures)
}
