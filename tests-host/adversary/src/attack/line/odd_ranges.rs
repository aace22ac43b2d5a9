//! Messages of ranges that are valid but unusual: empty and ahead of their time, a millisecond
//! apart, of another week.

use rtcm_rs::Message;
use rtcm_rs::msg::{Msg1077Data, Msg1077T};

use crate::attack::forgery::{of_week, read, write};
use crate::attack::prelude::*;
use crate::soak::noise::frames;

pub(super) const AHEAD: Attack = Attack {
    name: "empty-ahead",
    about: "before each epoch an empty message of ranges, tagged an hour ahead",
    branch: Branch::Time,
    before: "no epoch protected",
    note: "",
    run: |_| run(KEPT, |_, frame| [empty_ahead(frame, 3_600_000, 1), frame.to_vec()].concat()),
};

pub(super) const NEXT: Attack = Attack {
    name: "empty-next",
    about: "an empty message of ranges, tagged 5 ms to 1 s ahead, before, between and behind the others, the last of its epoch or not",
    branch: Branch::Time,
    before: "nothing beyond",
    note: "",
    run: |_| next(),
};

pub(super) const APART: Attack = Attack {
    name: "systems-apart",
    about: "GPS and BeiDou of one epoch tagged 1 ms apart, as receivers with a drifting clock do",
    branch: Branch::Time,
    before: "120 halves judged",
    note: "",
    run: |_| run(KEPT, |_, frame| apart(frame)),
};

pub(super) const WEEK: Attack = Attack {
    name: "wrong-week",
    about: "GPS ephemerides of another week beside right ones of BeiDou",
    branch: Branch::Time,
    before: "nothing beyond",
    note: "",
    run: |_| run(OTHERS, |index, frame| if index == 0 { of_week(frame, 3) } else { frame.to_vec() }),
};

/// Epochs sent.
const EPOCHS: u32 = 60;

/// Smallest share of the epochs that must be judged, with nearly all satellites.
const KEPT: f64 = 0.95;

/// The same share if the ephemerides of one system are unusable.
const OTHERS: f64 = 0.4;

/// Sends a healthy sky whose frames `change` alters on the way. Nearly every epoch must still be
/// judged.
fn run(share: f64, change: impl Fn(usize, &[u8]) -> Vec<u8>) -> Result<Vec<Figure>> {
    let sky = Sky::quiet(EPOCHS, 3)?;
    let bytes = sky.unchanged()?;
    let changed = bytes.iter().enumerate().map(|(index, bytes)| -> Vec<u8> {
        frames(bytes).into_iter().flat_map(|frame| change(index, frame)).collect()
    });
    let tally = Victim::new(&[], 1.0)?.judge(changed, sky.truth)?;
    let wanted = Victim::new(&[], 1.0)?.judge(&bytes, sky.truth)?.used;
    let mut figures = tally.figures(0.0);
    figures.push(Figure::at_least("epochs protected", tally.promised(), KEPT * f64::from(EPOCHS)));
    figures.push(Figure::at_least(
        "satellites used, all epochs added",
        f64::from(tally.used),
        (share * f64::from(wanted)).round(),
    ));
    figures.push(Figure::at_most("epochs judged", tally.epochs(), f64::from(EPOCHS)));
    Ok(figures)
}

/// Adds every empty message to a healthy sky. No wrong position may be promised, and nearly every
/// epoch must still be judged with all its satellites, whichever message states the end of it.
fn next() -> Result<Vec<Figure>> {
    let sky = Sky::quiet(EPOCHS, 3)?;
    let (mut all, mut least) = (Tally::default(), usize::MAX);
    for ahead_ms in [5, 20, 500, 1000] {
        for more_follow in [1, 0] {
            for place in 0..3 {
                let (mut victim, mut tally) = (Victim::new(&[], 1.0)?, Tally::default());
                for bytes in sky.unchanged()? {
                    let changed = frames(&bytes).into_iter().flat_map(|frame| {
                        let empty = empty_ahead(frame, ahead_ms, more_follow);
                        let is_of_others = matches!(read(frame), Some(Message::Msg1127(_)));
                        match place {
                            0 => [empty, frame.to_vec()].concat(),
                            1 => [frame.to_vec(), empty].concat(),
                            // The message follows all others.
                            _ if is_of_others => {
                                let last = frames(&bytes)
                                    .into_iter()
                                    .map(|frame| empty_ahead(frame, ahead_ms, more_follow));
                                [frame.to_vec(), last.collect::<Vec<_>>().concat()].concat()
                            }
                            _ => frame.to_vec(),
                        }
                    });
                    let changed: Vec<u8> = changed.collect();
                    tally.add_all(&victim.receive(&changed, sky.truth)?);
                }
                least = least.min(tally.outcomes.promised);
                all += &tally;
            }
        }
    }
    let mut figures = all.figures(0.0);
    figures.push(Figure::at_least("fewest protected of 60", least as f64, KEPT * f64::from(EPOCHS)));
    Ok(figures)
}

/// Returns an empty message `ahead_ms` later for a frame of GPS ranges, and no bytes for other
/// frames.
fn empty_ahead(frame: &[u8], ahead_ms: u32, more_follow: u8) -> Vec<u8> {
    let Some(Message::Msg1077(ranges)) = read(frame) else { return Vec::new() };
    let empty = Msg1077T {
        gps_epoch_time_ms: (ranges.gps_epoch_time_ms + ahead_ms) % 604_800_000,
        msm_multiple_message_flag: more_follow,
        data_segment: Msg1077Data::default(),
        ..ranges
    };
    write(&Message::Msg1077(empty)).unwrap_or_default()
}

/// Returns `BeiDou` ranges one millisecond later.
fn apart(frame: &[u8]) -> Vec<u8> {
    match read(frame) {
        Some(Message::Msg1127(mut ranges)) => {
            ranges.bds_epoch_time_ms = (ranges.bds_epoch_time_ms + 1) % 604_800_000;
            write(&Message::Msg1127(ranges)).unwrap_or_default()
        }
        _ => frame.to_vec(),
    }
}
