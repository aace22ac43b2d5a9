//! The module's own signs where nothing is wrong: alarms that no fault explains.
//!
//! Every recording of the reference folder, on two frequencies and on one, and simulated clocks
//! that drift, are steered, or jump by a millisecond. An alarm is a change of the reason to a sign.
//! A count of satellites left out by a sign is one alarm each.
//!
//! A car between tall buildings is counted apart, because its ranges are wrong by up to 118 m: an
//! alarm is justified there if the position is farther off than [`JUSTIFIED_M`].

use raim::replay::Truth;

use super::recordings::{STATIONS, at, car, load, skipped, tell_ionosphere};
use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "false-signs",
    about: "no fault: alarms of the module's own signs an hour, in seven recordings under an open sky on two frequencies and on one, and with simulated clocks; a car beside",
    branch: Branch::Sigmas,
    before: "",
    note: "[the table](#the-modules-own-signs-without-a-fault)",
    run,
};

/// Reasons of own signs.
const REASONS: [&str; 8] = ["SIGMAS", "CLOCK", "TRACK", "JUMP", "PLACE", "TIME", "SOURCE", "SPOOFED"];

/// Counters of satellites that a sign leaves out, and of a sign that withdraws nothing alone.
const COUNTERS: [&str; 3] = ["satellite_twice", "bands_apart", "strengths_alike"];

/// Largest number of false alarms of a sign in an hour.
const FALSE_AN_HOUR: f64 = 0.1;

/// Position error beyond which ranges contradict the sigmas between buildings, m: three sigmas of a
/// single-frequency position under an open sky, by the recorded `static1hz` (2.9 m rms).
const JUSTIFIED_M: f64 = 8.7;

/// Longest run, s: a day.
const LONGEST_S: f64 = 86_400.0;

/// Speed of light times a millisecond, m.
const MILLISECOND_M: f64 = 299_792.458;

/// Signs of one recording.
#[derive(Clone, Debug, Default)]
struct Signs {
    hours: f64,
    epochs: usize,
    promised: usize,
    /// Alarms and epochs of each reason.
    alarms: [usize; REASONS.len()],
    lasting: [usize; REASONS.len()],
    counts: [usize; COUNTERS.len()],
    /// Epochs of each reason with a truth, and those of them with an error beyond the bound.
    known: [usize; REASONS.len()],
    justified: [usize; REASONS.len()],
    /// The same of promised epochs.
    promised_known: usize,
    promised_far: usize,
    last: String,
}

impl Signs {
    fn add(&mut self, seen: &Seen, is_known: bool) {
        let state = &seen.reported.state;
        if !state.has_epoch() {
            return;
        }
        self.epochs += 1;
        self.promised += usize::from(seen.is_promised);
        let is_far = seen.horizontal_error_m.max(seen.vertical_error_m) > JUSTIFIED_M;
        for (index, reason) in REASONS.iter().enumerate().filter(|(_, reason)| **reason == state.reason) {
            self.lasting[index] += 1;
            self.alarms[index] += usize::from(self.last != *reason);
            self.known[index] += usize::from(is_known);
            self.justified[index] += usize::from(is_known && is_far);
        }
        if seen.is_promised && is_known {
            self.promised_known += 1;
            self.promised_far += usize::from(is_far);
        }
        self.last.clone_from(&state.reason);
    }

    fn with(mut self, other: &Self) -> Self {
        self.hours += other.hours;
        self.epochs += other.epochs;
        self.promised += other.promised;
        self.alarms.iter_mut().zip(other.alarms).for_each(|(sum, more)| *sum += more);
        self.lasting.iter_mut().zip(other.lasting).for_each(|(sum, more)| *sum += more);
        self.counts.iter_mut().zip(other.counts).for_each(|(sum, more)| *sum += more);
        self
    }

    /// Returns hours, promises, and every sign that was seen.
    fn figures(&self, name: &str) -> Vec<Figure> {
        let mut figures = vec![
            Figure::plain(format!("{name}: h"), self.hours),
            Figure::plain("epochs", self.epochs as f64),
            Figure::plain("promised", self.promised as f64),
        ];
        for ((reason, alarms), lasting) in REASONS.iter().zip(self.alarms).zip(self.lasting) {
            if alarms > 0 {
                figures.push(Figure::plain(format!("{reason} alarms"), alarms as f64));
                figures.push(Figure::plain("their epochs", lasting as f64));
            }
        }
        let counted = COUNTERS.iter().zip(self.counts).filter(|(_, count)| *count > 0);
        figures.extend(counted.map(|(name, count)| Figure::plain(*name, count as f64)));
        figures
    }

    /// Returns the epochs of each sign with a truth, and those that the position's error justifies.
    fn justified(&self) -> Vec<Figure> {
        let mut figures = Vec::new();
        let reasons = REASONS.iter().zip(self.known).zip(self.justified);
        for ((reason, known), justified) in reasons.filter(|((_, known), _)| *known > 0) {
            figures.push(Figure::plain(format!("{reason} epochs with a truth"), known as f64));
            figures.push(Figure::plain("of these justified", justified as f64));
        }
        figures.push(Figure::plain("promised with a truth", self.promised_known as f64));
        figures.push(Figure::plain("of these as far off", self.promised_far as f64));
        figures
    }

    /// Returns the alarms an hour of every sign, bounded.
    fn rates(&self) -> Vec<Figure> {
        let alarms = REASONS.iter().zip(self.alarms).chain(COUNTERS.iter().zip(self.counts));
        alarms
            .map(|(sign, count)| {
                Figure::at_most(format!("{sign} an hour"), count as f64 / self.hours, FALSE_AN_HOUR)
            })
            .collect()
    }
}

/// Change of all ranges in an epoch, m, by its index.
type Offset<'o> = &'o (dyn Fn(usize) -> f64 + Sync);

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut all = Signs::default();
    let mut figures = Vec::new();
    let mut report = |name: &str, signs: Signs| {
        figures.extend(signs.figures(name));
        all = std::mem::take(&mut all).with(&signs);
    };
    let (quartz, oven) = (Oscillator::temperature_compensated(), Oscillator::oven_controlled());
    // A receiver keeps its clock within a millisecond, so that its ranges stay within bounds. This one does not, and
    // has no offset that would add up over a day.
    let centred = Oscillator { frequency_offset: 0.0, ..quartz };
    let steered = |index: usize| 15.0 * (2.4 * index as f64).sin();
    // A receiver jumps so that its clock stays within a millisecond.
    let jumping = |index: usize| MILLISECOND_M * (index / 400 % 2) as f64;
    let clocks: [(&str, Oscillator, f64, Offset<'_>); 5] = [
        ("quartz at 1 Hz", quartz, 1.0, &|_| 0.0),
        ("quartz at 30 s", centred, 30.0, &|_| 0.0),
        ("oven at 1 Hz", oven, 1.0, &|_| 0.0),
        ("steered quartz at 1 Hz", quartz, 1.0, &steered),
        ("quartz with jumps of a millisecond", quartz, 1.0, &jumping),
    ];
    for (name, oscillator, step_s, offset_m) in clocks {
        let epochs = effort.pick(1800, 14_400).min((LONGEST_S / step_s) as u32);
        let runs =
            (0..effort.pick(2, 8)).together(|seed| simulated(seed, epochs, oscillator, step_s, offset_m));
        let runs: Vec<Signs> = runs.collect::<Result<_>>()?;
        report(name, runs.iter().fold(Signs::default(), Signs::with));
    }
    if let Some(folder) = shared::path("data") {
        for frequency in [Frequency::Dual, Frequency::Single] {
            for (name, recording, systems) in open_skies(&folder)? {
                let signs = recorded(&recording, systems, frequency, None)?;
                report(&format!("{name} {frequency:?}"), signs);
            }
        }
    }
    figures.extend(all.figures("all"));
    figures.extend(all.rates());
    match shared::path("data/urban") {
        Some(folder) => {
            let truth = Truth::from_file(&folder.join("truth.csv"))?;
            let signs = recorded(&car(&folder)?, "GC", Frequency::Single, Some(&truth))?;
            figures.extend(signs.figures("a car between buildings"));
            figures.extend(signs.justified());
        }
        None => figures.extend(skipped()),
    }
    Ok(figures)
}

/// Returns the recordings under an open sky, with the systems to send.
fn open_skies(data: &std::path::Path) -> Result<Vec<(&'static str, Recording, &'static str)>> {
    let mut all = Vec::new();
    for (station, systems) in STATIONS {
        all.push((station.folder, load(station)?, systems));
    }
    let read = |observations: &str, navigation: &str| {
        Recording::load(&[data.join(observations)], &[data.join(navigation)])
    };
    all.push(("static1hz rover", read("static1hz/rover.obs.gz", "static1hz/base.nav.gz")?, "GCE"));
    all.push(("cres", read("sbas/cres.obs.gz", "sbas/cres.nav.gz")?, "G"));
    Ok(all)
}

fn simulated(
    seed: u64,
    epochs: u32,
    oscillator: Oscillator,
    step_s: f64,
    offset_m: Offset<'_>,
) -> Result<Signs> {
    let start_s = 3700.0 + 7200.0 * (seed % 12) as f64;
    let simulation = Simulation { oscillator, step_s, ..Simulation::above_xian(start_s, epochs, seed) };
    let sky = Sky::of(&simulation, Frequency::Dual)?;
    let bytes = sky.bytes(|index, epoch| lengthen_all(epoch, offset_m(index)))?;
    let (mut victim, mut signs) = (Victim::new(&[], step_s)?, Signs::default());
    for bytes in &bytes {
        for seen in victim.receive(bytes, sky.truth)? {
            signs.add(&seen, true);
        }
    }
    finished(signs, &mut victim, step_s)
}

fn recorded(
    recording: &Recording,
    systems: &str,
    frequency: Frequency,
    truth: Option<&Truth>,
) -> Result<Signs> {
    let step_s = step_s(recording);
    let (mut victim, mut signs) = (Victim::new(&[], step_s)?, Signs::default());
    tell_ionosphere(recording, &mut victim)?;
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new(systems, frequency)?);
    for epoch in &recording.epochs {
        let point = truth.and_then(|truth| at(truth, epoch.time));
        let seen = victim.receive(&encoder.epoch(epoch)?, point.unwrap_or(Ecef::CENTRE))?;
        for seen in &seen {
            signs.add(seen, point.is_some());
        }
    }
    finished(signs, &mut victim, step_s)
}

fn finished(mut signs: Signs, victim: &mut Victim, step_s: f64) -> Result<Signs> {
    signs.hours = signs.epochs as f64 * step_s / 3600.0;
    for (count, counter) in signs.counts.iter_mut().zip(COUNTERS) {
        *count = victim.counter(counter)? as usize;
    }
    Ok(signs)
}
