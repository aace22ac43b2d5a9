//! A counterfeit sky 400 km away, consistent in itself, from one second to the next.
//!
//! Nothing within an epoch reveals it. The second form also moves the time tag ahead, by so much
//! that the new place is reachable. Only the module's own clock then shows that the time has not
//! passed.

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "leap",
    about: "a counterfeit sky 400 km away, from one second to the next",
    branch: Branch::Counterfeit,
    before: "120 of 120 epochs protected there",
    note: "",
    run: |effort| run(effort, 0.0),
};

pub(super) const WITH_TIME: Attack = Attack {
    name: "leap-of-time",
    about: "the same with a time tag that leaps ahead by 20 minutes",
    branch: Branch::Counterfeit,
    before: "120 of 120",
    note: "",
    run: |effort| run(effort, 1200.0),
};

/// Distance north of the true place, degrees: 400 km.
const AWAY_DEG: f64 = 3.6;

/// Healthy epochs before.
const BEFORE: u32 = 30;

/// Counterfeit epochs within which the new place is out of reach: 400 km at 515 m/s take 776 s.
const WITHIN: u32 = 760;

fn run(effort: Effort, leap_s: f64) -> Result<Vec<Figure>> {
    let within = effort.pick(120, WITHIN);
    let start_s = 3600.0;
    let honest = Simulation::above_xian(start_s, BEFORE, 1);
    let forged_s = start_s + f64::from(BEFORE) + leap_s;
    let forged = elsewhere(&Simulation::above_xian(forged_s, within, 2), AWAY_DEG);
    let (honest, forged) = (Sky::of(&honest, Frequency::Dual)?, Sky::of(&forged, Frequency::Dual)?);

    let mut victim = Victim::new(&[], 1.0)?;
    let before = victim.judge(honest.unchanged()?, honest.truth)?;
    let after = victim.judge(forged.unchanged()?, honest.truth)?;
    let mut figures = after.figures(0.0);
    figures.push(Figure::at_least("protected before", before.promised(), f64::from(BEFORE)));
    Ok(figures)
}
