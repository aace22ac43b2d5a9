//! One frequency: a step of 60 m on each satellite in turn is noticed, and levels stay small.
//!
//! The ionosphere's model misses some metres in all ranges alike. A test that takes them for noise
//! of each range is nearly blind, and a level that counts them in the noise and again as a shared
//! error is several times too large. Real recordings and simulated skies show both: the share of
//! steps that the module notices, and the median of its horizontal levels without a step.
//!
//! Each epoch with a step follows on seven without one. It counts if the module promised the epoch
//! before it. The step is noticed if the module leaves a satellite out or promises nothing.

use anyhow::ensure;
use raim::replay;
use raim::replay::{Lump, Window};
use rig::stations::{DGAR, ESBC, KMS3, STATIC_BASE, Station, TLSE};

use crate::attack::nature::recordings::{load, skipped, tell_ionosphere};
use crate::attack::prelude::*;

pub(super) const RECORDED: Attack = Attack {
    name: "one-frequency-recorded",
    about: "five real recordings on one frequency, a step of 60 m on each satellite in turn",
    branch: Branch::OneSatellite,
    before: "0 % of the steps noticed at `esbc`, `dgar` and `kms3`, 27 % at `static1hz`, 32 % at `tlse`; median HPL 41, 124, 37, 24 and 31 m",
    note: "at length 7,389 steps",
    run: recorded,
};

pub(super) const SIMULATED: Attack = Attack {
    name: "one-frequency-simulated",
    about: "GPS and Galileo at 5°, 34° and 62° of latitude on one frequency, 20 TECU, a step of 60 m on each satellite in turn",
    branch: Branch::OneSatellite,
    before: "0, 54 and 37 % noticed; median HPL 71, 55 and 36 m",
    note: "",
    run: simulated,
};

/// Step, m.
const STEP_M: f64 = 60.0;

/// Smallest share of the steps that must be noticed, %.
const NOTICED: f64 = 95.0;

/// Epochs from one step to the next.
const PERIOD: usize = 8;

/// Elevation mask at start, rad.
const MASK_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// Stations, systems sent of each, and half of the median level of the time when the ionosphere
/// counted as noise, m.
const STATIONS: [(&Station, &str, f64); 5] = [
    (&ESBC, "GCE", 20.4),
    (&DGAR, "G", 61.9),
    (&STATIC_BASE, "GCE", 11.7),
    (&TLSE, "GCE", 15.3),
    (&KMS3, "GCE", 18.5),
];

/// Latitudes, degrees, and half of the median level of that time, m.
const LATITUDES: [(f64, f64); 3] = [(5.0, 35.7), (34.17, 27.3), (62.0, 18.1)];

/// Broadcast coefficients of a calm day.
const CALM: [f64; 8] =
    [4.6566e-9, 1.4901e-8, -5.9605e-8, -5.9605e-8, 79_872.0, 65_536.0, -65_536.0, -393_216.0];

/// A course of epochs, and what the module receives of it.
struct Course {
    recording: Recording,
    selection: Selection,
    truth: Ecef,
    step_s: f64,
    /// Satellites in use of each epoch that share their clock with another one.
    tested: Vec<Vec<SatelliteId>>,
}

/// Outcome of a course.
#[derive(Default)]
struct Sighting {
    steps: usize,
    noticed: usize,
    /// Horizontal levels of promised epochs without a step, m.
    levels_m: Vec<f64>,
    all: Tally,
}

impl Course {
    fn of(mut recording: Recording, systems: &str, truth: Ecef, most: usize) -> Result<Self> {
        recording.epochs.truncate(most);
        let selection = Selection::new(systems, Frequency::Single)?;
        let step_s = step_s(&recording);
        let lumps = replay::encode(&recording, &selection, &[], &Window::ALL)?;
        let tested = lumps_tested(&lumps, truth, recording.klobuchar);
        ensure!(tested.len() == recording.epochs.len(), "every epoch must be corrected");
        Ok(Self { recording, selection, truth, step_s, tested })
    }

    /// Drives a module through the course. Runs differ by the epochs and the satellites of the
    /// steps.
    fn drive(&self, run: usize) -> Result<Sighting> {
        let mut victim = Victim::new(&[], self.step_s)?;
        tell_ionosphere(&self.recording, &mut victim)?;
        let mut encoder = Encoder::new(&self.recording.ephemerides, self.selection.clone());
        let (mut sighting, mut was_promised) = (Sighting::default(), false);
        for (index, (epoch, tested)) in self.recording.epochs.iter().zip(&self.tested).enumerate() {
            let mut epoch = epoch.clone();
            let turn = index + run;
            let wrong = tested.get((turn / PERIOD + run * PERIOD) % tested.len().max(1));
            let wrong = wrong.filter(|_| turn % PERIOD == PERIOD - 1);
            if let Some(&satellite) = wrong {
                epoch.lengthen(satellite, STEP_M);
            }
            let seen = victim.receive(&encoder.epoch(&epoch)?, self.truth)?;
            sighting.all.add_all(&seen);
            let Some(last) = seen.iter().find(|seen| seen.reported.state.has_epoch()) else { continue };
            let is_noticed = !last.is_promised || !last.reported.excluded.is_empty();
            if wrong.is_some() && was_promised {
                sighting.steps += 1;
                sighting.noticed += usize::from(is_noticed);
            } else if wrong.is_none() && !is_noticed {
                sighting.levels_m.extend(last.reported.state.hpl_m);
            }
            was_promised = last.is_promised;
        }
        Ok(sighting)
    }

    fn figures(&self, name: &str, runs: usize, most_m: f64) -> Result<Vec<Figure>> {
        let runs: Vec<Sighting> = (0..runs).together(|run| self.drive(run)).collect::<Result<_>>()?;
        let mut all = Sighting::default();
        for run in runs {
            all.steps += run.steps;
            all.noticed += run.noticed;
            all.levels_m.extend(run.levels_m);
            all.all += &run.all;
        }
        all.levels_m.sort_by(f64::total_cmp);
        let median_m = all.levels_m.get(all.levels_m.len() / 2).copied().unwrap_or(f64::INFINITY);
        let noticed = 100.0 * all.noticed as f64 / all.steps.max(1) as f64;
        Ok(vec![
            Figure::plain(format!("{name} steps"), all.steps as f64),
            Figure::at_least("noticed, %", noticed, NOTICED),
            Figure::at_most("median HPL, m", median_m, most_m),
            Figure::at_most("beyond their level", all.all.misleading(), 0.0),
        ])
    }
}

/// Returns the satellites of each epoch that share their clock with another one.
fn lumps_tested(lumps: &[Lump], truth: Ecef, klobuchar: Option<[f64; 8]>) -> Vec<Vec<SatelliteId>> {
    let of_epoch = |seen: &[SatelliteId]| -> Vec<SatelliteId> {
        let has_company = |one: &&SatelliteId| {
            seen.iter().filter(|other| other.constellation() == one.constellation()).count() > 1
        };
        seen.iter().filter(has_company).copied().collect()
    };
    let epochs = replay::corrected(lumps, truth, MASK_RAD, klobuchar);
    let seen = epochs.iter().map(|epoch| epoch.observations().iter().map(|one| one.satellite).collect());
    seen.map(|seen: Vec<SatelliteId>| of_epoch(&seen)).collect()
}

fn recorded(effort: Effort) -> Result<Vec<Figure>> {
    if shared::path("data").is_none() {
        return Ok(skipped());
    }
    let (most, runs) = (effort.pick(480, usize::MAX), effort.pick(2, 8));
    let mut figures = Vec::new();
    for (station, systems, most_m) in STATIONS {
        let name = station.folder;
        let recording = load(station)?;
        // A short recording is sent more often, so that every satellite has its turn.
        let runs = runs * (480 / recording.epochs.len().min(480)).min(24);
        figures.extend(Course::of(recording, systems, station.truth, most)?.figures(name, runs, most_m)?);
    }
    Ok(figures)
}

fn simulated(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for (latitude_deg, most_m) in LATITUDES {
        let simulation = Simulation {
            satellites: satellites(GPS_GALILEO.1),
            site: Site::geodetic(latitude_deg, 108.57, 400.0),
            step_s: 30.0,
            ..Simulation::above_xian(3600.0, effort.pick(240, 2880), 11)
        };
        let recording = Recording { klobuchar: Some(CALM), ..simulation.record() };
        let course = Course::of(recording, "GE", simulation.site.position, usize::MAX)?;
        figures.extend(course.figures(&format!("{latitude_deg:.0}°"), effort.pick(4, 8), most_m)?);
    }
    Ok(figures)
}
