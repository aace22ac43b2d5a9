//! Messages of ranges that are allowed, and odd: empty and ahead of their time, apart by a millisecond, of another week.

use anyhow::Result;
use rtcm_rs::Message;
use rtcm_rs::msg::{Msg1077Data, Msg1077T};

use super::forgery::{Sky, of_week, read, write};
use super::tally::Tally;
use super::victim::Victim;
use super::{Attack, Figure};
use crate::soak::noise::frames;

/// Empty messages from the future.
pub(super) const AHEAD: Attack = Attack {
    name: "empty-ahead",
    about: "before each epoch an empty message of ranges, tagged an hour ahead",
    run: |_| run(KEPT, |_, frame| [empty_ahead(frame), frame.to_vec()].concat()),
};

/// Systems a millisecond apart.
pub(super) const APART: Attack = Attack {
    name: "systems-apart",
    about: "GPS and BeiDou of one epoch tagged 1 ms apart, as receivers with a drifting clock do",
    run: |_| run(KEPT, |_, frame| apart(frame)),
};

/// Another week.
pub(super) const WEEK: Attack = Attack {
    name: "wrong-week",
    about: "GPS ephemerides of another week beside right ones of BeiDou",
    run: |_| run(OTHERS, |index, frame| if index == 0 { of_week(frame, 3) } else { frame.to_vec() }),
};

/// Epochs sent.
const EPOCHS: u32 = 60;

/// Share of the epochs that has to be judged, of nearly all satellites.
const KEPT: f64 = 0.95;

/// The share where a system's ephemerides are of no use.
const OTHERS: f64 = 0.4;

/// Sends a healthy sky whose frames are changed on the way; hardly an epoch may be lost by it.
fn run(share: f64, change: impl Fn(usize, &[u8]) -> Vec<u8>) -> Result<Vec<Figure>> {
    let sky = Sky::quiet(EPOCHS, 3)?;
    let (mut victim, mut reference) = (Victim::new(&[], 1.0)?, Victim::new(&[], 1.0)?);
    let (mut tally, mut used, mut wanted) = (Tally::default(), 0, 0);
    for (index, bytes) in sky.bytes(|_, _| {})?.iter().enumerate() {
        let changed: Vec<u8> = frames(bytes).into_iter().flat_map(|frame| change(index, frame)).collect();
        let seen = victim.hear(&changed, sky.truth)?;
        tally.add_all(&seen);
        used += seen.iter().map(|seen| seen.said.state.used).sum::<u32>();
        wanted += reference.hear(bytes, sky.truth)?.iter().map(|seen| seen.said.state.used).sum::<u32>();
    }
    let mut figures = tally.figures(0.0);
    figures.push(Figure::at_least("epochs protected", tally.promised as f64, KEPT * f64::from(EPOCHS)));
    figures.push(Figure::at_least(
        "satellites used, all epochs added",
        f64::from(used),
        (share * f64::from(wanted)).round(),
    ));
    figures.push(Figure::at_most("epochs judged", tally.epochs as f64, f64::from(EPOCHS)));
    Ok(figures)
}

/// For ranges of GPS an empty message of an hour later; nothing for other frames.
fn empty_ahead(frame: &[u8]) -> Vec<u8> {
    let Some(Message::Msg1077(ranges)) = read(frame) else { return Vec::new() };
    let empty = Msg1077T {
        gps_epoch_time_ms: (ranges.gps_epoch_time_ms + 3_600_000) % 604_800_000,
        msm_multiple_message_flag: 1,
        data_segment: Msg1077Data::default(),
        ..ranges
    };
    write(&Message::Msg1077(empty)).unwrap_or_default()
}

/// Ranges of `BeiDou` a millisecond later.
fn apart(frame: &[u8]) -> Vec<u8> {
    match read(frame) {
        Some(Message::Msg1127(mut ranges)) => {
            ranges.bds_epoch_time_ms = (ranges.bds_epoch_time_ms + 1) % 604_800_000;
            write(&Message::Msg1127(ranges)).unwrap_or_default()
        }
        _ => frame.to_vec(),
    }
}
