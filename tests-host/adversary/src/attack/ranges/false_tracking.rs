//! Signals that are lost and tracked falsely: every range is kilometres wrong, and sometimes a few
//! agree.
//!
//! Six satellites of one system leave two degrees of freedom, and one after an exclusion. In every
//! epoch each range has its own error, up to [`SPREAD_M`]. A third of the epochs have one satellite
//! more or less. The receiver reports good signal strengths, so that only the disagreement of the
//! ranges reveals the fault.

use crate::attack::forgery::keep_first;
use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "false-tracking",
    about: "every range wrong by up to 3 km, independently in each epoch, so that some sets agree by chance",
    branch: Branch::Sigmas,
    before: "43 of 43 protected epochs beyond, up to 11.5 km",
    note: "",
    run,
};

pub(super) const AFTERWARDS: Attack = Attack {
    name: "false-tracking-afterwards",
    about: "the same in the first epoch after a minute of silence, or after FORGET, without earlier epochs; five and six satellites",
    branch: Branch::Sigmas,
    before: "12 of 1,200",
    note: "",
    run: afterwards,
};

/// Largest error of a range, m.
const SPREAD_M: f64 = 3000.0;

/// Epochs of a run, and the healthy ones at its start.
const EPOCHS: u32 = 960;
const HEALTHY: usize = 20;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let tally: Tally = (0..effort.pick(2, 40)).map(attempt).collect::<Result<_>>()?;
    let mut figures = tally.figures(0.0);
    figures.push(Figure::plain("alerts", tally.alerts()));
    Ok(figures)
}

/// Length of the silence, s.
const SILENCE_S: usize = 60;

fn afterwards(effort: Effort) -> Result<Vec<Figure>> {
    let sky = Sky::quiet((HEALTHY + SILENCE_S + 1) as u32, 1)?;
    let healthy = sky.unchanged()?;
    let draws: u32 = effort.pick(300, 3000);
    let (mut silent, mut forgotten) = (Tally::default(), Tally::default());
    for (seed, count) in (0..u64::from(draws)).flat_map(|seed| [(seed, 5), (seed, 6)]) {
        let mut chance = ChaCha8Rng::seed_from_u64(seed);
        let mut falsely = |which: usize| {
            let mut epoch = sky.recording.epochs[which].clone();
            keep_first(&mut epoch, Constellation::Gps, count);
            for satellite in epoch.satellites() {
                epoch.lengthen(satellite, chance.random_range(-SPREAD_M..SPREAD_M));
            }
            sky.ranges(&epoch)
        };
        for (tally, gap_s) in [(&mut silent, SILENCE_S), (&mut forgotten, 0)] {
            let mut victim = Victim::new(&[], 1.0)?;
            victim.judge(&healthy[..HEALTHY], sky.truth)?;
            if gap_s == 0 {
                victim.obey("FORGET")?;
            } else {
                let _ = victim.silence(gap_s as f64, sky.truth)?;
            }
            tally.add_all(&victim.receive(&falsely(HEALTHY + gap_s)?, sky.truth)?);
        }
    }
    let figure =
        |what: &str, tally: &Tally| Figure::at_most(format!("promised {what}"), tally.promised(), 0.0);
    let epochs = Figure::at_least(
        "epochs",
        (silent.outcomes.epochs() + forgotten.outcomes.epochs()) as f64,
        f64::from(4 * draws),
    );
    Ok(vec![figure("after a silence", &silent), figure("after FORGET", &forgotten), epochs])
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
    let mut victim = Victim::new(&[], 1.0)?;
    victim.judge(&bytes[..HEALTHY], sky.truth)?;
    victim.judge(&bytes[HEALTHY..], sky.truth)
}
