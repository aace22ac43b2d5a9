//! Epochs that are old when they arrive. A relay, a logger or a slow line takes more than a second
//! to deliver a second of signals, or somebody replays a recording.
//!
//! The signals are healthy and carry their own tags. Only the module's own clock reveals their age.

use raim_firmware::receiver::Boot;

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "held-back",
    about: "each second of signals takes 1.05, 2 or 9 s of the module's clock; old epochs must not be promised",
    branch: Branch::Late,
    before: "promised at any age: 4,792 s old after ten minutes of signals",
    note: "`STALE` thereafter",
    run: hold_back,
};

pub(super) const AGAIN: Attack = Attack {
    name: "sent-again",
    about: "after minutes of signals the same bytes are replayed; none of them may be promised",
    branch: Branch::Line,
    before: "196 of 200 promised",
    note: "",
    run: send_again,
};

pub(super) const WEEK_OLD: Attack = Attack {
    name: "week-old",
    about: "a recording of a week ago from 5.5 km away, at the same second of the week, with its ephemerides",
    branch: Branch::Line,
    before: "269 of 300 beyond, 5.5 km",
    note: "",
    run: week_old,
};

/// Time to alert of the settings at start, s.
const TIME_TO_ALERT_S: f64 = 10.0;

fn hold_back(effort: Effort) -> Result<Vec<Figure>> {
    let epochs = effort.pick(600, 3600);
    let sky = Sky::quiet(epochs, 1)?;
    let bytes = sky.unchanged()?;
    let mut figures = Vec::new();
    for own_s in [1.0, 1.05, 2.0, 9.0] {
        let (mut victim, mut oldest_s, mut promised) = (Victim::new(&[], own_s)?, 0.0_f64, 0);
        for (index, bytes) in bytes.iter().enumerate() {
            victim.receive(bytes, sky.truth)?;
            // At the end of the step the signals are one step older.
            if victim.is_promised() {
                oldest_s = oldest_s.max(index as f64 * (own_s - 1.0));
                promised += 1;
            }
        }
        // The own clock's tolerance may account for this share of the time.
        let slack = own_s / (own_s - 1.0) * f64::from(Boot::CRYSTAL_PPM) * 1e-6;
        let bound_s = if own_s > 1.0 { TIME_TO_ALERT_S / (1.0 - slack) } else { 0.0 };
        figures.push(Figure::at_most(format!("oldest promised at {own_s} s an epoch, s"), oldest_s, bound_s));
        if own_s > 1.0 {
            continue;
        }
        figures.push(Figure::at_least("promised at 1 s an epoch", f64::from(promised), f64::from(epochs)));
    }
    Ok(figures)
}

fn send_again(effort: Effort) -> Result<Vec<Figure>> {
    let sky = Sky::quiet(effort.pick(200, 1200), 2)?;
    let bytes = sky.unchanged()?;
    let mut victim = Victim::new(&[], 1.0)?;
    let promised = |victim: &mut Victim| -> Result<f64> {
        let mut promised = 0.0;
        for bytes in &bytes {
            let seen = victim.receive(bytes, sky.truth)?;
            promised += seen.iter().filter(|seen| seen.reported.state.is_protected()).count() as f64;
        }
        Ok(promised)
    };
    let live = promised(&mut victim)?;
    let again = promised(&mut victim)?;
    // A host that replays on purpose sends `FORGET`.
    victim.obey("FORGET")?;
    let meant = promised(&mut victim)?;
    Ok(vec![
        Figure::at_least("promised live", live, bytes.len() as f64),
        Figure::at_most("promised when sent again", again, 0.0),
        Figure::at_least("promised after FORGET", meant, bytes.len() as f64 - 20.0),
    ])
}

fn week_old(_: Effort) -> Result<Vec<Figure>> {
    const LIVE: u32 = 200;
    let honest = Simulation::above_xian(3600.0, LIVE, 1);
    // The sky repeats with its own time. Two hours later by that time is the same second of the
    // week.
    let tow_ms = honest.origin.tow_ms - 7_200_000;
    let origin = GpsTime { week: honest.origin.week - 1, tow_ms };
    let old = Simulation { origin, ..Simulation::above_xian(3600.0 + 7200.0 + f64::from(LIVE), 300, 2) };
    let (honest, old) =
        (Sky::of(&honest, Frequency::Dual)?, Sky::of(&elsewhere(&old, 0.05), Frequency::Dual)?);
    let (mut victim, mut after) = (Victim::new(&[], 1.0)?, Tally::default());
    let before = victim.judge(honest.unchanged()?, honest.truth)?;
    let bytes = old.unchanged()?;
    for (index, own) in bytes.iter().enumerate() {
        // The ephemerides come twice.
        let again: &[u8] = if index == 30 { &bytes[0] } else { &[] };
        after.add_all(&victim.receive(&[own, again].concat(), honest.truth)?);
    }
    let mut figures = after.figures(0.0);
    figures.push(Figure::at_least("protected before", before.promised(), f64::from(LIVE)));
    figures.push(Figure::at_most("protected with what is a week old", after.promised(), 0.0));
    Ok(figures)
}
