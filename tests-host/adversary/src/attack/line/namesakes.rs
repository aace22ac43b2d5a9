//! Two receivers with one station number on one line: nothing in their messages tells which of them
//! is the module's own.
//!
//! The other comes first in each second and announces more messages than it sends, so that both
//! become one epoch; or it comes half a second later, as an epoch of its own. In the end the own
//! receiver falls silent and the other continues. In the third form the other one is heard only
//! after the own one has fallen silent.

use rtcm_rs::Message;

use crate::attack::forgery::{read, write};
use crate::attack::prelude::*;
use crate::soak::noise::frames;

pub(super) const JOINED: Attack = Attack {
    name: "namesake-first",
    about: "from the start a second receiver with the same station number, 55 m to 11 km away, comes first and announces more",
    branch: Branch::Line,
    before: "480 of 480 epochs promised there, up to 11 km off",
    note: "",
    run: joined,
};

pub(super) const IN_TURN: Attack = Attack {
    name: "namesake-between",
    about: "a second receiver of the same number sends half a second later, and continues alone when the own one is silent",
    branch: Branch::Line,
    before: "all promised at 30 to 250 m, and after the silence",
    note: "none promised in the silence",
    run: in_turn,
};

pub(super) const TAKEN_OVER: Attack = Attack {
    name: "namesake-later",
    about: "the own receiver falls silent; 1.5 to 60.5 s later a second one of the same number continues half a second apart, 670 m and 11 km away, without range rates",
    branch: Branch::Line,
    before: "1,344 of 1,440 epochs beyond, up to 11 km",
    note: "`JUMP`. The second receiver is promised 670 m away after 60.5 s, where a vehicle can be expected",
    run: taken_over,
};

/// Distances north of the receiver, degrees: 33 m to 11 km.
const AWAY_DEG: [f64; 3] = [0.0003, 0.002, 0.1];

/// Epochs of each receiver.
const EPOCHS: u32 = 120;

/// Epoch at which the own receiver falls silent.
const SILENT_FROM: usize = 80;

/// Epochs of the second receiver that may be promised: its first one, which has nothing to be
/// compared with.
const UNSEEN: f64 = 1.0;

fn joined(_: Effort) -> Result<Vec<Figure>> {
    let receiver = Simulation::above_xian(3600.0, EPOCHS, 5);
    let mut tally = Tally::default();
    for away_deg in AWAY_DEG {
        let other = Sky::of(&elsewhere(&receiver, away_deg), Frequency::Dual)?;
        let own = Sky::of(&receiver, Frequency::Dual)?;
        let mut victim = Victim::new(&[], 1.0)?;
        for (own_bytes, of_other) in own.unchanged()?.into_iter().zip(&other.recording.epochs) {
            let of_other = announcing(&other.ranges(of_other)?);
            let (sets, ranges) = parted(&own_bytes);
            tally.add_all(&victim.receive(&[sets, of_other, ranges].concat(), own.truth)?);
        }
    }
    Ok(tally.figures(0.0))
}

fn in_turn(_: Effort) -> Result<Vec<Figure>> {
    let receiver = Simulation::above_xian(3600.0, EPOCHS, 5);
    let later = Simulation { start_s: 3600.5, ..receiver.clone() };
    let (mut both, mut alone) = (Tally::default(), Tally::default());
    for away_deg in AWAY_DEG {
        let other = Sky::of(&elsewhere(&later, away_deg), Frequency::Dual)?;
        let own = Sky::of(&receiver, Frequency::Dual)?;
        let mut victim = Victim::new(&[], 0.5)?;
        let epochs = own.unchanged()?.into_iter().zip(&other.recording.epochs);
        for (index, (own_bytes, of_other)) in epochs.enumerate() {
            let own_bytes = if index < SILENT_FROM { own_bytes } else { Vec::new() };
            let tally = if index < SILENT_FROM { &mut both } else { &mut alone };
            tally.add_all(&victim.receive(&own_bytes, own.truth)?);
            tally.add_all(&victim.receive(&other.ranges(of_other)?, own.truth)?);
        }
    }
    let mut figures = both.figures(UNSEEN * AWAY_DEG.len() as f64);
    figures.push(Figure::at_most("beyond, the own receiver silent", alone.misleading(), 0.0));
    Ok(figures)
}

/// Epochs of the own receiver before it falls silent, and of either receiver after the silence.
const OWN: u32 = 60;
const LATER: u32 = 180;

/// Silences, s, and distances of the second receiver, degrees: 670 m and 11 km.
const SILENCES_S: [f64; 4] = [1.0, 5.0, 21.0, 60.0];
const FAR_DEG: [f64; 2] = [0.006, 0.1];

/// Speed at which any receiver can be expected to have moved, m/s.
const EXPECTED_M_S: f64 = 10.0;

/// Both levels and the speed of a receiver at rest by its positions add this to it, m.
const LEVELS_M: f64 = 200.0;

/// Metres of a degree of latitude.
const DEGREE_M: f64 = 111_132.0;

/// Time between the epochs of the two receivers, s.
const APART_S: f64 = 0.5;

fn taken_over(effort: Effort) -> Result<Vec<Figure>> {
    let (mut alien, mut near) = (Tally::default(), Tally::default());
    let (mut own, mut restarted) = (Tally::default(), Tally::default());
    for seed in 0..effort.pick(1, 12) {
        for silence_s in SILENCES_S {
            for away_deg in FAR_DEG {
                let is_near = away_deg * DEGREE_M < EXPECTED_M_S * (silence_s + APART_S) + LEVELS_M;
                let tally = if is_near { &mut near } else { &mut alien };
                *tally += &continued(seed, silence_s, APART_S, away_deg)?;
            }
            own += &continued(seed, silence_s, 0.0, 0.0)?;
            restarted += &continued(seed, silence_s, APART_S, 0.0)?;
        }
    }
    let mut figures = alien.figures(0.0);
    figures.push(Figure::plain("beyond, at less than 10 m/s", near.misleading()));
    for (who, tally) in [("the own one returns", own), ("it returns half a second apart", restarted)] {
        figures.push(Figure::at_least(format!("promised, {who}, share"), tally.share(), RETURNED));
    }
    Ok(figures)
}

/// Smallest share of promised epochs after the silence of a receiver that returns.
const RETURNED: f64 = 0.95;

/// Returns the epochs of a receiver that continues for another one after a silence.
fn continued(seed: u64, silence_s: f64, apart_s: f64, away_deg: f64) -> Result<Tally> {
    let first = Simulation::above_xian(3600.0 + 7200.0 * seed as f64, OWN, seed);
    let start_s = first.start_s + f64::from(OWN) + silence_s + apart_s;
    // Another seed is another receiver clock.
    let second = Simulation { start_s, epochs: LATER, seed: seed + 100, ..first.clone() };
    let own = Sky::of(&first, Frequency::Dual)?;
    let other = Sky::of(&elsewhere(&second, away_deg), Frequency::Dual)?;
    let mut victim = Victim::new(&[], 1.0)?;
    victim.judge(own.unchanged()?, own.truth)?;
    let _ = victim.silence(silence_s + apart_s, own.truth)?;
    victim.judge(other.unchanged()?, own.truth)
}

/// Returns the ephemerides and the ranges of an epoch.
fn parted(bytes: &[u8]) -> (Vec<u8>, Vec<u8>) {
    let is_set = |frame: &&[u8]| !matches!(read(frame), Some(Message::Msg1077(_) | Message::Msg1127(_)));
    let (sets, ranges): (Vec<&[u8]>, Vec<&[u8]>) = frames(bytes).into_iter().partition(is_set);
    (sets.concat(), ranges.concat())
}

/// Returns the same messages of ranges, each of which announces another one.
fn announcing(bytes: &[u8]) -> Vec<u8> {
    let announcing = |frame: &[u8]| match read(frame) {
        Some(Message::Msg1127(mut ranges)) => {
            ranges.msm_multiple_message_flag = 1;
            write(&Message::Msg1127(ranges)).unwrap_or_default()
        }
        _ => frame.to_vec(),
    };
    frames(bytes).into_iter().flat_map(announcing).collect()
}
