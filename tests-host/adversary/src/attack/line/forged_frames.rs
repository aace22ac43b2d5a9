//! Forged frames among a receiver's own. They may cost an epoch or two, and nothing else.
//!
//! A frame has a checksum and no signature. Anyone who can put one on the line, and any relay that
//! mixes up two receivers, can change the time, the week, the leap seconds or the place of the
//! start.

use raim::signal::encode::ubx;
use rig::stations::STATIC_BASE;
use rtcm_rs::Message;

use crate::attack::forgery::{of_week, read, write};
use crate::attack::nature::recordings::skipped;
use crate::attack::prelude::*;
use crate::soak::noise::frames;

pub(super) const MOVED: Attack = Attack {
    name: "moved-week",
    about: "ranges of one satellite tagged 280,000 s ahead, twice, so that the receiver's own appear to be of the next week",
    branch: Branch::Time,
    before: "nothing promised for the remaining 80 s",
    note: "",
    run: moved,
};

pub(super) const NEAR: Attack = Attack {
    name: "near-ahead",
    about: "before every fifth epoch the range of one satellite, tagged 59 s ahead",
    branch: Branch::Time,
    before: "27 of 120 promised",
    note: "",
    run: near,
};

pub(super) const LATER: Attack = Attack {
    name: "once-later",
    about: "one epoch of the place itself, tagged five minutes ahead, in the middle and before all others",
    branch: Branch::Time,
    before: "41 of 121 and 5 of 120 promised",
    note: "",
    run: once_later,
};

pub(super) const CYCLE: Attack = Attack {
    name: "other-cycle",
    about: "the first ephemeris is one of BeiDou, 1,024 weeks ahead, which dates the weeks of GPS",
    branch: Branch::Time,
    before: "BeiDou lost until a restart",
    note: "BeiDou is used from the second time on that its ephemerides come",
    run: other_cycle,
};

pub(super) const OUTVOTED: Attack = Attack {
    name: "outvoted-week",
    about: "four ephemerides of the next week, of one system or of two; ten of each",
    branch: Branch::Time,
    before: "nothing promised for the remaining 80 s",
    note: "",
    run: outvoted,
};

pub(super) const FIRST: Attack = Attack {
    name: "first-elsewhere",
    about: "one epoch from 6,000 km away before all others",
    branch: Branch::Line,
    before: "`JUMP` for 3.4 h",
    note: "promised from the eleventh epoch on",
    run: first,
};

pub(super) const LEAP_SECONDS: Attack = Attack {
    name: "leap-seconds",
    about: "one message with 28 leap seconds among those of a receiver that uses GLONASS",
    branch: Branch::Time,
    before: "GLONASS lost until a restart",
    note: "GLONASS is used as without it",
    run: leap_seconds,
};

/// Epochs sent.
const EPOCHS: u32 = 120;

/// Index of the epoch that the forgery precedes.
const FORGED_AT: usize = 40;

/// Largest number of epochs that the forgery may cost.
const COSTS: f64 = 5.0;

/// Sends a healthy sky with `forged` before one epoch.
fn run(sky: &Sky, forged: &[u8]) -> Result<Tally> {
    let mut bytes = sky.unchanged()?;
    bytes[FORGED_AT].splice(..0, forged.iter().copied());
    Victim::new(&[], 1.0)?.judge(bytes, sky.truth)
}

fn figures(name: &str, tally: &Tally) -> Vec<Figure> {
    let least = f64::from(EPOCHS) - COSTS;
    vec![
        Figure::at_least(format!("{name}: promised"), tally.promised(), least),
        Figure::at_most(format!("{name}: beyond a level"), tally.misleading(), 0.0),
    ]
}

fn moved(_: Effort) -> Result<Vec<Figure>> {
    /// Leap of time, s: less than half a week.
    const LEAP_S: u32 = 280_000;
    let sky = Sky::quiet(EPOCHS, 3)?;
    let mut one = sky.recording.epochs[FORGED_AT].clone();
    one.satellites.retain(|seen| seen.satellite.constellation() == Constellation::Gps);
    one.satellites.truncate(1);
    let ranges = sky.ranges(&one)?;
    let ahead =
        |leaps: u32| frames(&ranges).into_iter().flat_map(|frame| later(frame, leaps * LEAP_S)).collect();
    let twice: Vec<u8> = (1..=2).flat_map(|leaps| -> Vec<u8> { ahead(leaps) }).collect();
    // Frames that agree follow each leap, so that it does not look like a single error.
    let followed: Vec<u8> = (1..=2)
        .flat_map(|leaps| (0..8).map(move |second| leaps * LEAP_S + second))
        .flat_map(|ahead_s| frames(&ranges).into_iter().flat_map(move |frame| later(frame, ahead_s)))
        .collect();
    let mut all = figures("two frames", &run(&sky, &twice)?);
    all.extend(figures("sixteen frames", &run(&sky, &followed)?));
    Ok(all)
}

fn near(_: Effort) -> Result<Vec<Figure>> {
    let sky = Sky::quiet(EPOCHS, 3)?;
    let (mut victim, mut tally) = (Victim::new(&[], 1.0)?, Tally::default());
    for (index, (bytes, epoch)) in sky.unchanged()?.iter().zip(&sky.recording.epochs).enumerate() {
        let mut one = epoch.clone();
        one.satellites.retain(|seen| seen.satellite.constellation() == Constellation::Gps);
        one.satellites.truncate(1);
        let ahead = if index % 5 == 4 { later(&sky.ranges(&one)?, 59) } else { Vec::new() };
        tally.add_all(&victim.receive(&[&ahead[..], bytes].concat(), sky.truth)?);
    }
    Ok(figures("every fifth", &tally))
}

fn once_later(_: Effort) -> Result<Vec<Figure>> {
    /// Epochs lost at most: five until the time goes back, and ten on another line, with ten
    /// seconds between the first and the last.
    const OUTLASTS: f64 = 16.0;
    let sky = Sky::quiet(EPOCHS, 3)?;
    let of_later = |start_s: f64| Sky::of(&Simulation::above_xian(start_s + 300.0, 1, 4), Frequency::Dual);
    let middle = of_later(3600.0 + FORGED_AT as f64)?;
    let mut all = figures("in the middle", &run(&sky, &middle.ranges(&middle.recording.epochs[0])?)?);
    let mut victim = Victim::new(&[], 1.0)?;
    victim.judge(of_later(3599.0)?.unchanged()?, sky.truth)?;
    let tally = victim.judge(sky.unchanged()?, sky.truth)?;
    all.push(Figure::at_least("before all others: promised", tally.promised(), f64::from(EPOCHS) - OUTLASTS));
    Ok(all)
}

fn other_cycle(_: Effort) -> Result<Vec<Figure>> {
    let sky = Sky::quiet(EPOCHS, 3)?;
    let used_of = |bytes: &[Vec<u8>]| -> Result<f64> {
        Ok(Victim::new(&[], 1.0)?.judge(bytes, sky.truth)?.used.into())
    };
    let mut bytes = sky.unchanged()?;
    let wanted = used_of(&bytes)?;
    let is_beidou = |frame: &&[u8]| read(frame).is_some_and(|message| message.number() == Some(1042));
    let forged = frames(&bytes[0]).into_iter().find(is_beidou).map(|frame| of_week(frame, 1024));
    let forged = forged.context("the sky must have an ephemeris of BeiDou")?;
    // The receiver repeats its ephemerides.
    let sets = bytes[0].clone();
    bytes[20].splice(..0, sets);
    bytes[0].splice(..0, forged);
    Ok(vec![Figure::at_least("satellites used, all epochs added", used_of(&bytes)?, (0.8 * wanted).round())])
}

/// Returns the same GPS ranges, tagged `by_s` seconds later.
fn later(frame: &[u8], by_s: u32) -> Vec<u8> {
    match read(frame) {
        Some(Message::Msg1077(mut ranges)) => {
            ranges.gps_epoch_time_ms = (ranges.gps_epoch_time_ms + 1000 * by_s) % 604_800_000;
            write(&Message::Msg1077(ranges)).unwrap_or_default()
        }
        _ => Vec::new(),
    }
}

fn outvoted(_: Effort) -> Result<Vec<Figure>> {
    let sky = Sky::quiet(EPOCHS, 3)?;
    let bytes = sky.unchanged()?;
    let of = |number: u16| -> Vec<&[u8]> {
        let is_set = |frame: &&[u8]| read(frame).is_some_and(|message| message.number() == Some(number));
        frames(&bytes[0]).into_iter().filter(is_set).collect()
    };
    let (gps, beidou) = (of(1019), of(1042));
    let mut all = Vec::new();
    for many in 0..=4 {
        let sets = gps.iter().take(many).chain(beidou.iter().take(4 - many));
        let forged: Vec<u8> = sets.flat_map(|frame| of_week(frame, 1)).collect();
        let name = format!("{many} of GPS, {} of BeiDou", 4 - many);
        all.extend(figures(&name, &run(&sky, &forged)?));
    }
    let each = gps.iter().cycle().take(10).chain(beidou.iter().cycle().take(10));
    let forged: Vec<u8> = each.flat_map(|frame| of_week(frame, 1)).collect();
    all.extend(figures("10 of each", &run(&sky, &forged)?));
    Ok(all)
}

fn first(_: Effort) -> Result<Vec<Figure>> {
    /// Distance towards the equator, degrees, and the epochs lost until consistent ranges outlast
    /// the single forged epoch.
    const AWAY_DEG: f64 = -54.0;
    const OUTLASTS: f64 = 12.0;
    let here = Simulation::above_xian(3600.0, EPOCHS, 1);
    let away = Sky::of(&elsewhere(&Simulation::above_xian(3599.0, 1, 2), AWAY_DEG), Frequency::Dual)?;
    let here = Sky::of(&here, Frequency::Dual)?;
    let mut victim = Victim::new(&[], 1.0)?;
    victim.judge(away.unchanged()?, away.truth)?;
    let tally = victim.judge(here.unchanged()?, here.truth)?;
    Ok(vec![
        Figure::at_least("promised", tally.promised(), f64::from(EPOCHS) - OUTLASTS),
        Figure::at_most("beyond a level", tally.misleading(), 0.0),
    ])
}

fn leap_seconds(_: Effort) -> Result<Vec<Figure>> {
    if shared::path("data").is_none() {
        return Ok(skipped());
    }
    let Some(recording) = STATIC_BASE.load() else { return Ok(skipped()) };
    let selection = Selection::new("GCER", Frequency::Dual)?;
    let reported = ubx::IonosphereAndUtc {
        klobuchar: recording.klobuchar.unwrap_or_default(),
        leap_s: (18, 18),
        change: (1929, 7),
    };
    let forged = ubx::IonosphereAndUtc { leap_s: (28, 28), ..reported };
    let galileo = SatelliteId::new(Constellation::Galileo, 1).context("Galileo must have a satellite 1")?;
    let (mut figures, mut wanted) = (Vec::new(), 0.0);
    for words in [0, 1, 3] {
        let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection.clone(), Some(reported));
        let (mut victim, mut tally) = (Victim::new(&["SYSTEMS,GCER"], 1.0)?, Tally::default());
        for (index, epoch) in recording.epochs.iter().take(EPOCHS as usize).enumerate() {
            let mut bytes = encoder.epoch(epoch)?;
            for _ in 0..if index == FORGED_AT { words } else { 0 } {
                bytes.extend(ubx::utc(galileo, &forged)?);
            }
            tally.add_all(&victim.receive(&bytes, STATIC_BASE.truth)?);
        }
        if words == 0 {
            wanted = f64::from(tally.used);
            continue;
        }
        let least = f64::from(EPOCHS) - COSTS;
        figures.push(Figure::at_least(format!("{words} words: promised"), tally.promised(), least));
        let quantity = format!("{words} words: satellites used, all epochs added");
        figures.push(Figure::at_least(quantity, tally.used.into(), wanted));
    }
    Ok(figures)
}
