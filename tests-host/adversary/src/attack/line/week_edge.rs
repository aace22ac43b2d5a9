//! A receiver that starts shortly before a week ends and dates sets with the week of their
//! transmission.
//!
//! GPS sets then have reference times in the next week, and appear to be of the beginning of this
//! one. Ranges agree with orbits that are all dated a week early as well as with the right ones.

use raim::signal::sky::Satellite;
use rtcm_rs::Message;

use crate::attack::forgery::{read, write};
use crate::attack::prelude::*;
use crate::soak::noise::frames;

pub(super) const ATTACK: Attack = Attack {
    name: "week-edge",
    about: "GPS sets in the last 20 min of a week, dated with the week of their transmission; the next week must be promised",
    branch: Branch::Time,
    before: "a date a week early, then `EPHEMERIS` until a restart: 262 of 420 epochs promised",
    note: "",
    run,
};

pub(super) const CYCLE: Attack = Attack {
    name: "cycle-edge",
    about: "the week of GPS returns to 0: from ten minutes before, and a start in the hour after; GPS, with BeiDou, with Galileo",
    branch: Branch::Time,
    before: "nothing beyond",
    note: "",
    run: cycle,
};

/// Time between epochs, s.
const STEP_S: u32 = 60;

/// Time from the first epoch to the end of the week, s.
const BEFORE_S: u32 = 1200;

/// Clock of the simulation at the end of a week, s.
const WEEK_END_S: u32 = 604_800 - 86_400;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let hours = effort.pick(8, 40);
    let mut figures = Vec::new();
    for systems in ["G", "GC", "GEC"] {
        let tally = after_an_hour(systems, hours)?;
        // Once the week is known, the earlier sets belong to another one until they are sent again,
        // after an hour of the simulation.
        let least = f64::from((hours - 2) * 3600 / STEP_S);
        figures.push(Figure::at_least(format!("{systems}: promised"), tally.promised(), least));
        figures.push(Figure::at_most(format!("{systems}: beyond a level"), tally.misleading(), 0.0));
    }
    Ok(figures)
}

/// Last week of a cycle, which ends in November 2038.
const LAST_WEEK: u16 = 3071;

fn cycle(effort: Effort) -> Result<Vec<Figure>> {
    let epochs = effort.pick(40, 240);
    let mut figures = Vec::new();
    for systems in ["G", "GC", "GEC"] {
        for (name, before_s) in [("over the end", 600.0), ("after it", -1800.0)] {
            let mut simulation = Simulation {
                satellites: fleets(systems),
                step_s: f64::from(STEP_S),
                ..Simulation::above_xian(f64::from(WEEK_END_S) - before_s, epochs, 6)
            };
            simulation.origin.week = LAST_WEEK;
            let recording = simulation.record();
            let mut encoder = Encoder::new(&recording.ephemerides, Selection::new(systems, Frequency::Dual)?);
            let mut victim = Victim::new(&["PHASE,CUSTOM", "TTA,200"], f64::from(STEP_S))?;
            let mut tally = Tally::default();
            for epoch in &recording.epochs {
                tally.add_all(&victim.receive(&encoder.epoch(epoch)?, simulation.site.position)?);
            }
            let quantity = format!("{systems} {name}: promised of {epochs}");
            figures.push(Figure::at_least(quantity, tally.promised(), f64::from(epochs - 2)));
            figures.push(Figure::at_most("beyond a level", tally.misleading(), 0.0));
        }
    }
    Ok(figures)
}

fn fleets(systems: &str) -> Vec<Satellite> {
    let fleets = [('G', Fleet::Gps31), ('E', Fleet::Galileo24), ('C', Fleet::BeidouGlobal)];
    let satellites = fleets.into_iter().filter(|(letter, _)| systems.contains(*letter));
    satellites.flat_map(|(_, fleet)| fleet.satellites()).collect()
}

/// Counts the epochs after the first hour.
fn after_an_hour(systems: &str, hours: u32) -> Result<Tally> {
    let simulation = Simulation {
        satellites: fleets(systems),
        step_s: f64::from(STEP_S),
        ..Simulation::above_xian(f64::from(WEEK_END_S - BEFORE_S), hours * 3600 / STEP_S, 5)
    };
    let recording = simulation.record();
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new(systems, Frequency::Dual)?);
    let mut victim = Victim::new(&["PHASE,CUSTOM", "TTA,200"], f64::from(STEP_S))?;
    let mut tally = Tally::default();
    for (index, epoch) in (0..).zip(&recording.epochs) {
        let mut bytes = Vec::new();
        for frame in frames(&encoder.epoch(epoch)?) {
            match read(frame) {
                Some(Message::Msg1019(mut set)) => {
                    set.gps_week_number = epoch.time.week % 1024;
                    bytes.extend(write(&Message::Msg1019(set)).unwrap_or_default());
                }
                _ => bytes.extend_from_slice(frame),
            }
        }
        let seen = victim.receive(&bytes, simulation.site.position)?;
        if index >= 3600 / STEP_S {
            tally.add_all(&seen);
        }
    }
    Ok(tally)
}
