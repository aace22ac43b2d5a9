//! False sets of orbits with a right checksum, as anybody can send them who writes to the line of the
//! receiver or owns its caster.
//!
//! One set cannot tell whether it is true. A series of sets, each of them near the one before, can
//! carry all satellites away together, so that all ranges agree on another place.

use super::early_ephemeris::{frame, strangers};
use super::faulty_orbit::move_ahead;
use crate::attack::prelude::*;

pub(super) const TURNED: Attack = Attack {
    name: "turned-orbits",
    about: "new sets of all satellites every second or half minute, turned together so that the place moves at 0.5 to 50 m/s",
    branch: Branch::Orbits,
    before: "1,768 of 1,860 promised epochs beyond, up to 4.5 km, no alert",
    note: "nothing is promised after some metres",
    run: turned,
};

pub(super) const CLOCKS: Attack = Attack {
    name: "stepping-clocks",
    about: "new sets of all satellites every 7 s, whose clocks step so that the place moves by 2 to 30 m",
    branch: Branch::Orbits,
    before: "605 of 612 promised epochs beyond, up to 898 m",
    note: "",
    run: clocks,
};

pub(super) const FIRST: Attack = Attack {
    name: "false-first-sets",
    about: "sets turned by 5 km are the first to come; or come after true ones and 96 of absent satellites",
    branch: Branch::Orbits,
    before: "not tried",
    note: "beyond until a true set comes, if false ones came first",
    run: first,
};

pub(super) const LEAP: Attack = Attack {
    name: "leaping-orbits",
    about: "two new sets of every satellite, turned by 50 m to 5 km, a minute apart, again and again",
    branch: Branch::Orbits,
    before: "nothing promised",
    note: "without true sets nothing is promised for 9 to 17 minutes, then up to 5 km off",
    run: leap,
};

pub(super) const ONE: Attack = Attack {
    name: "one-false-set",
    about: "one set of one satellite, 50 m to 50 km away, once, between epochs of six and of all satellites",
    branch: Branch::Orbits,
    before: "0 beyond",
    note: "",
    run: one,
};

/// Start of the sky, s: no set changes for an hour.
const START_S: f64 = 3700.0;

/// Epochs before the attack, and under attack.
const BEFORE: u32 = 60;
const DURING: u32 = 900;

/// Distance of the place from the earth's axis, m.
const FROM_AXIS_M: f64 = 5.28e6;

/// Changes a set by what has happened since the attack began, s.
type Change<'a> = &'a dyn Fn(&mut TimedEphemeris, f64);

fn turned(effort: Effort) -> Result<Vec<Figure>> {
    let mut tally = Tally::default();
    let speeds: &[f64] = effort.pick(&[0.5, 5.0], &[0.5, 1.0, 2.0, 5.0, 10.0, 50.0]);
    for &speed_m_s in speeds {
        for every_s in [1, 30] {
            tally += &attempt(every_s, &|set, since_s| turn(set, speed_m_s * since_s))?;
        }
    }
    Ok(figures(&tally))
}

fn clocks(effort: Effort) -> Result<Vec<Figure>> {
    let mut tally = Tally::default();
    let steps: &[f64] = effort.pick(&[10.0], &[2.0, 5.0, 10.0, 30.0]);
    let (here, there) = (simulation(1), elsewhere(&simulation(1), 1e-3));
    let (here, there) = (here.sights_at(0), there.sights_at(0));
    // Change of the range of a satellite if the place moves by a metre.
    let per_metre = |satellite: SatelliteId| {
        let range_m = |sights: &[Sight]| {
            sights.iter().find(|sight| sight.satellite == satellite).map(|sight| sight.range_m)
        };
        range_m(&there).zip(range_m(&here)).map_or(0.0, |(there_m, here_m)| (there_m - here_m) / 111.0)
    };
    for &step_m in steps {
        let change = |set: &mut TimedEphemeris, since_s: f64| {
            let by_m = step_m * (1.0 + (since_s / 7.0).floor()) * per_metre(set.satellite);
            step_clock(set, by_m / SPEED_OF_LIGHT_M_S);
        };
        tally += &attempt(7, &change)?;
    }
    Ok(figures(&tally))
}

fn leap(effort: Effort) -> Result<Vec<Figure>> {
    let away: &[f64] = effort.pick(&[200.0, 5000.0], &[50.0, 200.0, 1000.0, 5000.0]);
    let mut figures = Vec::new();
    for is_truth_sent in [true, false] {
        let mut tally = Tally::default();
        for &away_m in away {
            // A set that differs in nothing is a copy of the one before.
            let change = |set: &mut TimedEphemeris, since_s: f64| turn(set, away_m + since_s * 1e-3);
            tally += &attempt_beside(60, &change, is_truth_sent, 2400)?;
        }
        let (name, most) = if is_truth_sent {
            ("beside true sets every 30 s", 0.0)
        } else {
            ("without true sets", f64::INFINITY)
        };
        figures.push(Figure::plain(format!("{name}, protected"), tally.promised()));
        figures.push(Figure::at_most("beyond their level", tally.misleading(), most));
    }
    Ok(figures)
}

fn figures(tally: &Tally) -> Vec<Figure> {
    let mut figures = tally.figures(0.0);
    figures.push(Figure::at_most("alerts", tally.alerts(), 0.0));
    figures
}

fn simulation(epochs: u32) -> Simulation {
    Simulation::above_xian(START_S, epochs, 3)
}

/// Returns a sky without geostationary satellites, whose orbits do not turn about the earth's axis with
/// their node.
fn sky(simulation: &Simulation) -> Result<Sky> {
    let mut sky = Sky::of(simulation, Frequency::Dual)?;
    let is_geostationary = |satellite: SatelliteId| {
        satellite.constellation() == Constellation::Beidou && satellite.number() <= 5
    };
    for epoch in &mut sky.recording.epochs {
        epoch.satellites.retain(|raw| !is_geostationary(raw.satellite));
    }
    Ok(sky)
}

/// Sends a true sky with true sets, and from [`BEFORE`] on a false set of each satellite in view
/// every `every_s` seconds, each another edition.
fn attempt(every_s: u32, change: Change<'_>) -> Result<Tally> {
    attempt_beside(every_s, change, false, DURING)
}

/// Works like [`attempt`], with or without true sets every 30 s.
fn attempt_beside(every_s: u32, change: Change<'_>, is_truth_sent: bool, during: u32) -> Result<Tally> {
    let sky = sky(&simulation(BEFORE + during))?;
    let (mut victim, mut tally) = (Victim::new(&[], 1.0)?, Tally::default());
    let sets = in_view(&sky);
    for (index, bytes) in (0_u32..).zip(sky.unchanged()?) {
        let Some(since_s) = index.checked_sub(BEFORE) else {
            let _ = victim.receive(&bytes, sky.truth)?;
            continue;
        };
        let mut sent = Vec::new();
        if since_s.is_multiple_of(every_s) {
            for mut set in sets.clone() {
                change(&mut set, f64::from(since_s));
                edit(&mut set, since_s / every_s);
                sent.extend(frame(&set)?);
            }
        }
        if is_truth_sent && (since_s as usize).is_multiple_of(TRUE_EVERY) {
            for set in &sets {
                sent.extend(frame(set)?);
            }
        }
        sent.extend(bytes);
        tally.add_all(&victim.receive(&sent, sky.truth)?);
    }
    Ok(tally)
}

fn first(_: Effort) -> Result<Vec<Figure>> {
    let simulation = simulation(300);
    let sky = sky(&simulation)?;
    let sets = in_view(&sky);
    let is_absent = |satellite| sets.iter().all(|set| set.satellite != satellite);
    let absent = strangers(&simulation, START_S, is_absent)?.concat();
    let mut falsified = sets.clone();
    for set in &mut falsified {
        turn(set, 5000.0);
        edit(set, 1);
    }
    let encoded = |sets: &[TimedEphemeris]| sets.iter().map(frame).collect::<Result<Vec<_>>>();
    let (truth, falsified) = (encoded(&sets)?.concat(), encoded(&falsified)?.concat());
    let mut figures = Vec::new();
    for (name, before) in [
        ("after true ones and a flood", [truth.clone(), absent, falsified.clone()].concat()),
        ("before any", falsified),
    ] {
        let mut victim = Victim::new(&[], 1.0)?;
        let _ = victim.receive(&before, sky.truth)?;
        let (mut alone, mut after) = (Tally::default(), Tally::default());
        for (index, epoch) in sky.recording.epochs.iter().enumerate() {
            let sent = if index % TRUE_EVERY == TRUE_EVERY - 1 { truth.clone() } else { Vec::new() };
            let seen = victim.receive(&[sent, sky.ranges(epoch)?].concat(), sky.truth)?;
            let tally = if index < TRUE_EVERY - 1 { &mut alone } else { &mut after };
            tally.add_all(&seen);
        }
        let until = format!("false sets {name}, until a true one, promised");
        figures.push(Figure::plain(until, alone.promised()));
        figures.push(Figure::plain("beyond", alone.misleading()));
        figures.push(Figure::at_most("and after it", after.misleading(), 0.0));
    }
    Ok(figures)
}

/// Epochs between two transmissions of all true sets.
const TRUE_EVERY: usize = 30;

fn one(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let sky = sky(&simulation(BEFORE + 60))?;
    let sets = in_view(&sky);
    let away: &[f64] = effort.pick(&[50.0, 5000.0], &[12.0, 20.0, 50.0, 300.0, 5000.0, 50_000.0]);
    for (name, count, least) in [("six others", 7, 0.0), ("all others", usize::MAX, 1.0)] {
        let mut tally = Tally::default();
        for &away_m in away {
            for mut set in sets.clone() {
                move_ahead(&mut set, away_m);
                edit(&mut set, 1);
                let own = std::iter::once(&set).chain(&sets).map(|set| set.satellite);
                let kept: Vec<SatelliteId> = own.take(count).collect();
                let mut bytes =
                    sky.bytes(|_, epoch| epoch.satellites.retain(|raw| kept.contains(&raw.satellite)))?;
                bytes[BEFORE as usize].splice(..0, frame(&set)?);
                let mut victim = Victim::new(&[], 1.0)?;
                victim.judge(&bytes[..BEFORE as usize], sky.truth)?;
                tally += &victim.judge(&bytes[BEFORE as usize..], sky.truth)?;
            }
        }
        figures.push(Figure::at_most(format!("beyond, with {name}"), tally.misleading(), 0.0));
        figures.push(Figure::at_least(format!("promised, with {name}, share"), tally.share(), least));
    }
    Ok(figures)
}

/// Returns one set of each satellite in view.
fn in_view(sky: &Sky) -> Vec<TimedEphemeris> {
    let seen = sky.recording.epochs[0].satellites();
    let set_of = |satellite: &SatelliteId| {
        sky.recording.ephemerides.iter().find(|set| set.satellite == *satellite).cloned()
    };
    seen.iter().filter_map(set_of).collect()
}

/// Turns an orbit about the earth's axis, so that the place on the ground moves by `by_m` metres.
fn turn(set: &mut TimedEphemeris, by_m: f64) {
    let turned_sc = by_m / FROM_AXIS_M / std::f64::consts::PI;
    match &mut set.message {
        Ephemeris::Gps(message) => message.omega0_sc += turned_sc,
        Ephemeris::Beidou(message) => message.omega0_sc += turned_sc,
        _ => {}
    }
}

/// Moves the clock of a satellite.
fn step_clock(set: &mut TimedEphemeris, by_s: f64) {
    match &mut set.message {
        Ephemeris::Gps(message) => message.af0_s += by_s,
        Ephemeris::Beidou(message) => message.a0_s += by_s,
        _ => {}
    }
}

/// Gives a set the number of another edition.
fn edit(set: &mut TimedEphemeris, edition: u32) {
    let number = 100 + (edition % 100) as u8;
    match &mut set.message {
        Ephemeris::Gps(message) => (message.iode, message.iodc) = (number, number.into()),
        Ephemeris::Beidou(message) => (message.aode, message.aodc) = (number % 24, number % 24),
        _ => {}
    }
}
