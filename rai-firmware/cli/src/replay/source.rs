//! Source of the lumps that the command `replay` plays.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail, ensure};
use raim_core::satellite::SatelliteId;
use raim_firmware::input::{Input, NOT_BEFORE_WEEK};

use super::Truth;
use super::arguments::{Arguments, selection, systems};
use crate::signal::advice::{Form, Found, counted, system_name};
use crate::signal::capture::{self, Bytes, Cut, Lumps, Orbits};
use crate::signal::encode::{Encoder, Frequency, Selection};
use crate::signal::fault::Fault;
use crate::signal::lump::Lump;
use crate::signal::lumps::{Broadcast, Encoding, Window};
use crate::signal::measurement::MeasuredEpoch;
use crate::signal::recording::{Epochs, Recording};
use crate::signal::sample;
use crate::signal::skipped::Skipped;

/// Inputs beside the recording or the capture.
pub(super) struct Question {
    pub(super) truth: Option<Truth>,
    pub(super) faults: Vec<Fault>,
    window: Window,
}

/// Lumps that are read on demand.
pub(super) enum Source {
    Recording(Box<Observed>),
    Capture(Box<Lumps<Bytes>>, Cut),
}

/// A recording: its observations, read epoch by epoch, and its navigation files.
pub(super) struct Observed {
    lumps: Encoding<Epochs>,
    navigation: Recording,
    files: Vec<PathBuf>,
    /// Letters of the systems that take part.
    systems: String,
}

impl Iterator for Source {
    type Item = Result<Lump>;

    fn next(&mut self) -> Option<Result<Lump>> {
        match self {
            Self::Recording(observed) => observed.lumps.next().or_else(|| observed.check().err().map(Err)),
            Self::Capture(lumps, _) => lumps.next(),
        }
    }
}

impl Observed {
    /// Returns the satellites with ranges of which the module refuses ephemerides, with their
    /// number.
    fn refused(&self) -> BTreeMap<SatelliteId, u32> {
        let ranged = self.lumps.satellites();
        let mut input = Input::new();
        let mut refused = BTreeMap::new();
        let Ok(selection) = Selection::new(&self.systems, Frequency::Single) else { return refused };
        let sets = self.navigation.ephemerides.iter().filter(|set| ranged.contains(&set.satellite));
        for set in sets.filter(|set| selection.has(set.satellite)) {
            let before = input.counters().ephemerides_invalid;
            let epoch = MeasuredEpoch { time: set.toe, satellites: Vec::new() };
            let bytes = Encoder::new(std::slice::from_ref(set), selection.clone()).epoch(&epoch);
            // The encoder itself says in the replay what no message has room for.
            input.feed(&bytes.unwrap_or_default(), 0, |_| ());
            if input.counters().ephemerides_invalid > before {
                *refused.entry(set.satellite).or_default() += 1;
            }
        }
        refused
    }

    /// Returns what the files hold, after all of them were read.
    fn found(&self) -> Found {
        let ranged = self.lumps.satellites().clone();
        let refused = self.refused();
        let sets = || self.navigation.ephemerides.iter().map(|set| set.satellite);
        let is_refused = |satellite: &SatelliteId| {
            let count = sets().filter(|other| other == satellite).count();
            refused.get(satellite).is_some_and(|refused| *refused as usize == count)
        };
        let mut known: BTreeSet<SatelliteId> = sets().collect();
        known.retain(|satellite| !is_refused(satellite));
        let is_left_out = |satellite: &&SatelliteId| !self.systems.contains(satellite.name().0);
        let others: BTreeSet<SatelliteId> = ranged.iter().filter(is_left_out).copied().collect();
        let mut unread = Vec::new();
        if !others.is_empty() && others.len() == ranged.len() {
            unread.push(format!("{}, because --systems does not name them", counted(&others)));
        }
        Found {
            form: Form::Rinex,
            came: format!("ranges of {} and orbits of {}", counted(&ranged), counted(&known)),
            unread,
            systems: self.systems.clone(),
            ranged,
            known,
            refused,
            ..Found::default()
        }
    }

    /// Checks at the end of the observations that some ephemeris is of their time.
    fn check(&self) -> Result<()> {
        let (first, last) = self.lumps.span().context("the observation files hold no epoch")?;
        self.navigation.check_time(&self.files, first, last)
    }
}

impl Source {
    /// Returns the coefficients of the ionosphere for the module.
    pub(super) fn klobuchar(&self) -> Option<[f64; 8]> {
        match self {
            Self::Recording(observed) => observed.navigation.klobuchar,
            Self::Capture(lumps, _) => lumps.klobuchar(),
        }
    }

    /// Returns the GPS week of the first epoch if the module needs it from a command.
    pub(super) fn week(&self) -> Option<u16> {
        match self {
            // The module takes no earlier week by itself.
            Self::Recording(observed) => {
                let first = observed.lumps.span().map(|(first, _)| first.week);
                first.filter(|week| *week < NOT_BEFORE_WEEK)
            }
            Self::Capture(lumps, _) => lumps.week(),
        }
    }

    /// Returns the records that were skipped.
    pub(super) fn skipped(&self) -> Skipped {
        match self {
            Self::Recording(observed) => {
                let mut skipped = observed.lumps.epochs().skipped();
                skipped.add(&observed.navigation.skipped);
                skipped
            }
            Self::Capture(..) => Skipped::default(),
        }
    }

    /// Returns what came, what of it is not read, and what is missing; `None` if there is neither of
    /// the last two.
    pub(super) fn advice(&self) -> Option<String> {
        match self {
            Self::Recording(observed) => observed.found().advice(),
            Self::Capture(lumps, _) => lumps.advice(),
        }
    }

    /// Returns the satellites of which ephemerides were refused, with their number.
    pub(super) fn refused(&self) -> BTreeMap<SatelliteId, u32> {
        match self {
            Self::Recording(observed) => observed.refused(),
            Self::Capture(lumps, _) => lumps.content().refused().clone(),
        }
    }

    /// Returns what is to be said of files that are cut off; `None` if all are whole.
    pub(super) fn cut(&self) -> Option<String> {
        match self {
            // Of these the records that the end cuts are counted.
            Self::Recording(_) => None,
            Self::Capture(_, cut) => cut.words(),
        }
    }

    /// Returns what came, in words.
    pub(super) fn content(&self) -> String {
        match self {
            Self::Recording(observed) => observed.found().came,
            Self::Capture(lumps, _) => lumps.content().to_string(),
        }
    }
}

/// Reads the inputs beside the recording or the capture.
pub(super) fn question(arguments: &Arguments) -> Result<Question> {
    let truth = match (&arguments.truth, &arguments.truth_csv) {
        (Some(text), _) => Some(Truth::of(text).context("--truth")?),
        (None, Some(path)) => Some(Truth::from_file(path).context("--truth-csv")?),
        (None, None) => None,
    };
    let steps = arguments.inject.iter().map(|text| Fault::parse_inject(text));
    let ramps = arguments.ramp.iter().map(|text| Fault::parse_ramp(text));
    let faults: Vec<Fault> = steps.chain(ramps).collect::<Result<_, _>>()?;
    let off = faults.iter().find_map(|fault| Some((fault, off(fault, &systems(arguments))?)));
    if let Some((fault, letter)) = off {
        bail!(
            "--inject {}: {} does not take part, so that the fault changes nothing: add --systems {}{letter}",
            fault.target,
            system_name(letter),
            systems(arguments)
        );
    }
    let window = Window { from_s: arguments.from, to_s: arguments.to, every_s: arguments.every };
    let has_files = !arguments.obs.is_empty() && !arguments.nav.is_empty();
    ensure!(
        !arguments.capture.is_empty() || arguments.sample || has_files,
        "give a CAPTURE of a receiver, or both --obs FILE and --nav FILE, or --sample"
    );
    Ok(Question { truth, faults, window })
}

/// Returns the letter of a fault's system if that is not among the systems that take part.
fn off(fault: &Fault, systems: &str) -> Option<char> {
    fault.system().filter(|letter| !systems.to_uppercase().contains(*letter))
}

/// Opens RINEX files, which are encoded as RTCM.
pub(super) fn of_recording(arguments: &Arguments, question: &mut Question) -> Result<Source> {
    if arguments.sample {
        let sample = sample::fetch(Path::new("target"))?;
        question.truth = question.truth.take().or(Some(Truth::Fixed(sample.truth)));
        return observed(arguments, &[sample.observations], vec![sample.navigation], question);
    }
    observed(arguments, &arguments.obs, arguments.nav.clone(), question).map_err(|error| match capture_among(
        arguments,
    ) {
        Some(path) => anyhow!("{path} is a capture of a receiver and no RINEX: give it alone, replay {path}"),
        None => error,
    })
}

fn observed(
    arguments: &Arguments,
    observations: &[PathBuf],
    files: Vec<PathBuf>,
    question: &Question,
) -> Result<Source> {
    let systems = systems(arguments);
    let selection = selection(arguments, &systems)?;
    let epochs = Epochs::open(observations)?;
    let navigation = Recording::of_navigation(&files)?;
    let broadcast = Broadcast {
        ephemerides: &navigation.ephemerides,
        klobuchar: navigation.klobuchar,
        leap_s: navigation.leap_s,
        approximate_position: epochs.approximate_position(),
    };
    let lumps = Encoding::of(epochs, &broadcast, &selection, &question.faults, &question.window)?;
    Ok(Source::Recording(Box::new(Observed { lumps, navigation, files, systems })))
}

/// Opens the bytes of a receiver, as they came.
pub(super) fn of_capture(arguments: &Arguments, question: &Question) -> Result<Source> {
    let systems = systems(arguments);
    let orbits = match arguments.nav.as_slice() {
        [] => None,
        files => Some(Orbits::load(files, &selection(arguments, &systems)?)?),
    };
    let (first, bytes) = match arguments.capture.as_slice() {
        [name] => {
            if !Path::new(name).is_file() && arguments.to.is_finite() {
                eprintln!("taking {} s from {name}", arguments.to);
            }
            (name.clone(), Bytes::open(name, arguments.to)?)
        }
        names => {
            let names = capture::in_order(names, orbits.as_ref())?;
            eprintln!("reading {} in the order of their time", names.join(", "));
            (names.first().cloned().unwrap_or_default(), Bytes::of_files(&names)?)
        }
    };
    let week = match arguments.week {
        Some(week) => Some(week),
        None => capture::week_of(&first, orbits.as_ref())?,
    };
    let cut = bytes.cut();
    let lumps = Lumps::of(bytes, orbits, &question.faults, &question.window)?;
    Ok(Source::Capture(Box::new(lumps.in_week(week).selecting(&systems)), cut))
}

/// Returns the first of the RINEX files that is a capture.
fn capture_among(arguments: &Arguments) -> Option<String> {
    let mut files = arguments.obs.iter().chain(&arguments.nav);
    files.find(|path| capture::is_capture(path)).map(|path| path.display().to_string())
}
