//! Nature as the adversary: real recordings, nominal ones and one between tall buildings.
//!
//! A nominal recording has no fault, so every epoch without a promise is a lost one and no promised
//! epoch may exceed its level. Between tall buildings reflections make up to five satellites wrong
//! at once, which a level does not bound. Promises there may exceed their level in few epochs only.
//!
//! Without the reference folder nothing is attempted, and the figures report it.

use std::path::Path;

use anyhow::ensure;
use raim::replay::Truth;
use rig::stations::{DGAR, ESBC, KMS3, STATIC_BASE, Station, TLSE};

use crate::attack::prelude::*;
use crate::attack::ranges::several_faults::METHODS;

pub(super) const NOMINAL: Attack = Attack {
    name: "nominal-recordings",
    about: "no fault: five real recordings on two frequencies, non-precision approach and LPV-200",
    branch: Branch::All,
    before: "",
    note: "quick the first three hours of `esbc` and `dgar`; `dgar` is of GPS alone, whose share with `LPV200` is the smallest",
    run: nominal,
};

pub(super) const URBAN: Attack = Attack {
    name: "urban",
    about: "a car between tall buildings, up to five satellites wrong at once, one frequency, every method",
    branch: Branch::Several,
    before: "18 of 248, up to 378 m",
    note: "",
    run: urban,
};

/// Smallest share of the epochs of a nominal recording that must be protected in non-precision
/// approach.
const AVAILABLE: f64 = 0.999;

/// Largest share of the promised epochs between buildings that may exceed a level.
const URBAN_BEYOND: f64 = 0.01;

/// Stations, and the systems sent of each.
pub(in crate::attack) const STATIONS: [(&Station, &str); 5] =
    [(&ESBC, "GCE"), (&DGAR, "G"), (&STATIC_BASE, "GCE"), (&TLSE, "GCE"), (&KMS3, "GCE")];

/// Returns the recording of a station.
pub(in crate::attack) fn load(station: &Station) -> Result<Recording> {
    station.load().with_context(|| format!("recording {} is missing", station.folder))
}

/// Returns the recording of a car between tall buildings, from its folder.
pub(in crate::attack) fn car(folder: &Path) -> Result<Recording> {
    let navigation = ["gps.nav.gz", "beidou.nav.gz"].map(|name| folder.join(name));
    Recording::load(&[folder.join("car.obs.gz")], &navigation)
}

/// Tells a module the ionosphere of a recording, if it is known.
pub(in crate::attack) fn tell_ionosphere(recording: &Recording, victim: &mut Victim) -> Result<()> {
    let Some(coefficients) = recording.klobuchar else { return Ok(()) };
    let numbers = coefficients.map(|number| format!("{number:e}"));
    let answer = victim.obey(&format!("IONO,{}", numbers.join(",")))?;
    ensure!(answer.contains(",OK"), "coefficients are refused: {answer}");
    Ok(())
}

/// Returns the figure that reports missing recordings.
pub(in crate::attack) fn skipped() -> Vec<Figure> {
    vec![Figure::plain("skipped, the reference folder is missing", 1.0)]
}

fn nominal(effort: Effort) -> Result<Vec<Figure>> {
    if shared::path("data").is_none() {
        return Ok(skipped());
    }
    // The quick effort sends the first hours only.
    let most = effort.pick(360, usize::MAX);
    let figures = STATIONS.into_iter().together(|(station, systems)| of_station(station, systems, most));
    Ok(figures.collect::<Result<Vec<_>>>()?.concat())
}

fn of_station(station: &Station, systems: &str, most: usize) -> Result<Vec<Figure>> {
    let recording = load(station)?;
    let name = station.folder;
    let truth = Truth::Fixed(station.truth);
    let mut figures = Vec::new();
    for (phase, is_held) in [("NPA", true), ("LPV200", false)] {
        let (tally, apart) =
            play(&recording, systems, Frequency::Dual, &[&format!("PHASE,{phase}")], &truth, most)?;
        figures.push(Figure::at_most(format!("{name} {phase} bands apart"), f64::from(apart), 0.0));
        figures.push(Figure::at_most(format!("{name} {phase} beyond"), tally.misleading(), 0.0));
        let quantity = format!("{name} {phase} protected, %");
        let value = 100.0 * tally.share();
        // In a short recording the few epochs lost at the start are more than a hundredth.
        let bound = if recording.epochs.len() > 1000 { 100.0 * AVAILABLE } else { 0.0 };
        figures.push(if is_held {
            Figure::at_least(quantity, value, bound)
        } else {
            Figure::plain(quantity, value)
        });
    }
    Ok(figures)
}

fn urban(effort: Effort) -> Result<Vec<Figure>> {
    let Some(folder) = shared::path("data/urban") else { return Ok(skipped()) };
    let recording = car(&folder)?;
    let truth = Truth::from_file(&folder.join("truth.csv"))?;
    let methods = effort.pick(&METHODS[..1], &METHODS[..]);
    let limits: [&[&str]; 2] = [&["PHASE,NPA"], &["HAL,50", "VAL,100"]];
    let runs: Vec<(&str, &[&str])> =
        methods.iter().flat_map(|method| limits.map(|limits| (*method, limits))).collect();
    let played: Vec<(Tally, u32)> = runs
        .iter()
        .together(|(method, limits)| {
            let method = format!("METHOD,{method}");
            let mut commands = vec![method.as_str()];
            commands.extend(*limits);
            play(&recording, "GC", Frequency::Single, &commands, &truth, usize::MAX)
        })
        .collect::<Result<_>>()?;
    let mut figures = Vec::new();
    for ((method, limits), (tally, _)) in runs.iter().zip(&played) {
        let what = format!("{method} {}", limits.join(" "));
        figures.push(Figure::plain(format!("{what} protected of {}", tally.epochs()), tally.promised()));
        figures.push(Figure::at_most("beyond their level, share", tally.beyond(), URBAN_BEYOND));
        figures.push(Figure::plain("largest error, m", tally.worst_m()));
        if limits.len() > 1 {
            figures.push(Figure::at_most("beyond the limits", tally.outcomes.hazardous as f64, 0.0));
        }
    }
    Ok(figures)
}

/// Sends a recording, and counts the epochs with a known truth, and satellites left out because
/// their bands differ too much.
fn play(
    recording: &Recording,
    systems: &str,
    frequency: Frequency,
    commands: &[&str],
    truth: &Truth,
    most: usize,
) -> Result<(Tally, u32)> {
    let mut victim = Victim::new(commands, step_s(recording))?;
    tell_ionosphere(recording, &mut victim)?;
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new(systems, frequency)?);
    let mut tally = Tally::default();
    for epoch in recording.epochs.iter().take(most) {
        let point = at(truth, epoch.time);
        let seen = victim.receive(&encoder.epoch(epoch)?, point.unwrap_or(Ecef::CENTRE))?;
        if point.is_some() {
            tally.add_all(&seen);
        }
    }
    Ok((tally, victim.counter("bands_apart")?))
}

/// Returns the place of the antenna at a time. A receiver's time tag may differ from the full
/// second of the truth by some milliseconds.
pub(in crate::attack) fn at(truth: &Truth, time: GpsTime) -> Option<Ecef> {
    const BESIDE_MS: u64 = 50;
    match truth {
        Truth::Fixed(point) => Some(*point),
        Truth::Moving(points) => {
            let nearest = points.iter().min_by_key(|(known, _)| known.since_ms(time).unsigned_abs())?;
            (nearest.0.since_ms(time).unsigned_abs() <= BESIDE_MS).then_some(nearest.1)
        }
    }
}
