//! Two receivers with one station number on one line, from the start: nothing tells which of them
//! is the module's own.
//!
//! The other comes first in each second and announces more messages than it sends, so that both
//! become one epoch; or it comes half a second later, as an epoch of its own. In the end the own
//! receiver falls silent and the other continues.

use anyhow::Result;
use rtcm_rs::Message;

use super::forgery::{Sky, elsewhere, read, write};
use super::tally::Tally;
use super::victim::Victim;
use super::{Attack, Effort, Figure};
use crate::soak::noise::frames;
use raim::signal::encode::Frequency;
use raim::signal::sky::raw::Simulation;

/// Attack with a receiver whose messages join those of the own one.
pub(super) const JOINED: Attack = Attack {
    name: "namesake-first",
    about: "from the start, the ranges of a second receiver of the same number come first and announce more",
    run: joined,
};

/// Attack with a receiver whose epochs lie between those of the own one.
pub(super) const IN_TURN: Attack = Attack {
    name: "namesake-between",
    about: "a second receiver of the same number sends half a second later, and continues when the own one is silent",
    run: in_turn,
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
        for (own_bytes, of_other) in own.bytes(|_, _| {})?.into_iter().zip(&other.recording.epochs) {
            let of_other = announcing(&other.ranges(of_other)?);
            let (sets, ranges) = parted(&own_bytes);
            tally.add_all(&victim.hear(&[sets, of_other, ranges].concat(), own.truth)?);
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
        let epochs = own.bytes(|_, _| {})?.into_iter().zip(&other.recording.epochs);
        for (index, (own_bytes, of_other)) in epochs.enumerate() {
            let own_bytes = if index < SILENT_FROM { own_bytes } else { Vec::new() };
            let tally = if index < SILENT_FROM { &mut both } else { &mut alone };
            tally.add_all(&victim.hear(&own_bytes, own.truth)?);
            tally.add_all(&victim.hear(&other.ranges(of_other)?, own.truth)?);
        }
    }
    let mut figures = both.figures(UNSEEN * AWAY_DEG.len() as f64);
    figures.push(Figure::at_most("beyond, the own receiver silent", alone.outcomes.misleading as f64, 0.0));
    Ok(figures)
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
