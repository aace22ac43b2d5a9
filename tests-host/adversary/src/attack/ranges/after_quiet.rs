//! What begins after quiet minutes: a slow ramp of one satellite, a street, and silence after a
//! suspicion that was true once.
//!
//! In quiet minutes `NOISE,AUTO` lowers the receiver's part of the variances, to a ninth at the
//! least. The past says nothing about the next second, so a level must hold from the first epoch of
//! what comes. A ramp also raises the residuals, by which the module raises the variances: the
//! scale must not hide the ramp from the level.

use raim::signal::fault::Kind;

use crate::attack::line::suspicions::of_both;
use crate::attack::nature::streets;
use crate::attack::nature::streets::Streets;
use crate::attack::prelude::*;

pub(super) const RAMP: Attack = Attack {
    name: "ramp-after-quiet",
    about: "one satellite of seven or more drifts by 0.01 to 1 m/s for ten minutes, after twelve quiet ones in which NOISE,AUTO lowered the variances",
    branch: Branch::Several,
    before: "not tried",
    note: "levels grow with the errors",
    run: ramps,
};

pub(super) const STREET: Attack = Attack {
    name: "street-after-quiet",
    about: "walls that block or reflect after twelve quiet minutes of NOISE,AUTO",
    branch: Branch::Several,
    before: "not tried",
    note: "",
    run: street,
};

pub(super) const SUSPICION: Attack = Attack {
    name: "suspicion-once",
    about: "a receiver that is sure of counterfeit signals for five seconds, and denies them from then on",
    branch: Branch::Counterfeit,
    before: "not tried",
    note: "",
    run: suspicion,
};

/// Quiet epochs before it begins, one a second: more than the ten minutes of learning.
const QUIET: u32 = 720;

/// Growth of the error of a range, m/s, and its largest error, m.
const RATES_M_S: [f64; 5] = [0.01, 0.03, 0.1, 0.3, 1.0];
const LIMIT_M: f64 = 600.0;

/// Epochs of a ramp.
const DRIFTING: u32 = 600;

fn ramps(effort: Effort) -> Result<Vec<Figure>> {
    let runs: Vec<(f64, u64)> = RATES_M_S
        .into_iter()
        .flat_map(|rate_m_s| (0..effort.pick(2, 40)).map(move |seed| (rate_m_s, seed)))
        .collect();
    let tallies: Vec<Tally> =
        runs.iter().together(|&(rate_m_s, seed)| ramp(rate_m_s, seed)).collect::<Result<_>>()?;
    let all: Tally = tallies.iter().collect();
    let mut figures = all.figures_by_rate(MISSED);
    for rate_m_s in RATES_M_S {
        let of_rate = runs.iter().zip(&tallies).filter(|((of, _), _)| of.to_bits() == rate_m_s.to_bits());
        let tally: Tally = of_rate.map(|(_, tally)| tally).collect();
        figures.push(Figure::plain(format!("% protected at {rate_m_s} m/s"), tally.percent()));
    }
    Ok(figures)
}

/// Lets one satellite of a sky drift, of which seven satellites to all are received from the start.
fn ramp(rate_m_s: f64, seed: u64) -> Result<Tally> {
    let sky = Sky::quiet(QUIET + DRIFTING, seed)?;
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let (kept, faulty) = sky.draw(&mut chance);
    let rate_m_s = if chance.random() { rate_m_s } else { -rate_m_s };
    let fault = lasting(faulty, Kind::Ramp { rate_m_s, limit_m: LIMIT_M }, QUIET);
    let bytes = sky.bytes(|index, epoch| {
        epoch.satellites.retain(|raw| kept.contains(&raw.satellite));
        fault.apply(epoch, index as f64);
    })?;
    let mut victim = Victim::new(&[], 1.0)?;
    victim.judge(&bytes[..QUIET as usize], sky.truth)?;
    victim.judge(&bytes[QUIET as usize..], sky.truth)
}

/// Epochs of a street.
const STREET_EPOCHS: u32 = 300;

fn street(effort: Effort) -> Result<Vec<Figure>> {
    let drives: Vec<Streets> = (0..effort.pick(8, 160)).together(drive_after_quiet).collect::<Result<_>>()?;
    let all: Tally = drives.iter().map(|drive| &drive.all).collect();
    let beyond = format!("{} beyond, share", all.misleading());
    Ok(vec![
        Figure::plain("share protected", all.share()),
        Figure::at_most(beyond, all.beyond(), streets::BEYOND),
    ])
}

fn drive_after_quiet(seed: u64) -> Result<Streets> {
    let simulation = Simulation::above_xian(3600.0, QUIET + STREET_EPOCHS, seed);
    let sky = Sky::with(&simulation, "GCE", Frequency::Dual)?;
    let selection = Selection::new("GCE", Frequency::Dual)?;
    let directions = streets::directions(&sky.recording, &selection, sky.truth, usize::MAX)?;
    streets::drive(&sky.recording, &selection, &directions, sky.truth, (QUIET as usize, seed))
}

/// Seconds in which the receiver is sure, and epochs until all must be promised again.
const SURE: usize = 5;
const AGAIN: usize = 60;

fn suspicion(effort: Effort) -> Result<Vec<Figure>> {
    let epochs = effort.pick(400, 3600);
    let sky = Sky::quiet(epochs, 1)?;
    let (mut victim, mut after) = (Victim::new(&[], 1.0)?, Tally::default());
    for (index, bytes) in sky.unchanged()?.iter().enumerate() {
        let reported = of_both(if (100..100 + SURE).contains(&index) { 3 } else { 1 });
        let seen = victim.receive(&[&reported[..], bytes].concat(), sky.truth)?;
        if index >= 100 + SURE + AGAIN {
            after.add_all(&seen);
        }
    }
    let lost = after.outcomes.epochs() - after.outcomes.promised;
    Ok(vec![Figure::at_most("epochs not promised a minute after it", lost as f64, 0.0)])
}
