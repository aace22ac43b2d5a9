//! The worst-case epoch, found by a search: what the pin may have to wait for.
//!
//! A setting or a circumstance at a time is varied over all of its values and left at the highest, round after round, until
//! none makes the epoch dearer. That finds a summit, not surely the highest: circumstances that only together are dear
//! may be missed. It starts from every method, so that at least these are all looked at.
//!
//! | varied | over |
//! |---|---|
//! | method, policy, levels | all |
//! | clock aiding, choice of frequencies | all |
//! | systems | GPS and `BeiDou`, with Galileo or without |
//! | satellites in view | 20 to 40 |
//! | faulty ones among them | none to thirty |
//! | size of the faults | some tens of metres to hundreds of kilometres |
//!
//! Figures are instructions of one epoch from its first byte to its last sentence, in the midst of a stream, or the first of
//! one, which brings the ephemerides and knows no position.

use std::collections::BTreeMap;

use anyhow::{Context, Result};

use super::figure::Figure;
use super::stages::{METHODS, whole};
use super::workload::{Stream, Wrong};
use crate::laboratory::profile::Profile;
use crate::laboratory::{Bench, Scalar, Stage};

/// Values of each circumstance, by its name.
const CIRCUMSTANCES: [(&str, &[&str]); 9] = [
    ("METHOD", &METHODS),
    ("POLICY", &["T1", "T2", "TOP"]),
    ("LEVELS", &["BOUND", "SLOPE"]),
    ("CLOCKAID", &["OFF", "ON"]),
    ("FREQ", &["AUTO", "DUAL", "SINGLE"]),
    (SYSTEMS, &["GC", "GCE"]),
    (SATELLITES, &["20", "25", "30", "35", "40"]),
    (FAULTS, &["0", "1", "2", "3", "4", "10", "20", "30"]),
    (SCALE, &["0.3", "1", "10", "100", "1000"]),
];

/// Their letters; GLONASS is not simulated.
const SYSTEMS: &str = "systems";
const SATELLITES: &str = "satellites";
const FAULTS: &str = "faults";
/// Of the faults, in units of some hundred metres.
const SCALE: &str = "scale";

/// Rounds after which the search ends, whatever it finds.
const ROUNDS: usize = 4;

/// Circumstances by the number of their values.
type Point = [usize; CIRCUMSTANCES.len()];

/// Where every search begins: the full sky with three faults, as the module is at start.
const START: Point = [0, 0, 0, 0, 0, 0, 4, 3, 1];

/// Which epoch is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// One in the midst of a stream.
    Later,
    /// The first one.
    First,
}

impl Place {
    fn words(self) -> &'static str {
        match self {
            Self::Later => "worst-case epoch of a stream",
            Self::First => "worst-case first epoch",
        }
    }
}

/// An epoch that a search has found.
#[derive(Clone, Debug)]
pub struct Found {
    place: Place,
    point: Point,
    instructions: u64,
}

impl Found {
    /// What it cost, under a name that does not depend on what it was.
    pub fn figure(&self, target: u64) -> Figure {
        Figure { name: self.place.words().to_owned(), value: self.instructions, target: Some(target) }
    }

    /// What it was.
    pub fn circumstances(&self) -> String {
        let each = words(&self.point).map(|(name, value)| format!("{name} {value}"));
        format!("{}: {}", self.place.words(), each.collect::<Vec<_>>().join(", "))
    }
}

/// Finds the worst-case epoch.
///
/// # Errors
/// Where the measuring image does not come to its end.
pub fn search(place: Place) -> Result<Found> {
    let mut point = START;
    let mut highest = 0;
    let mut known = BTreeMap::new();
    for _ in 0..ROUNDS {
        let before = highest;
        for (axis, (_, values)) in CIRCUMSTANCES.iter().enumerate() {
            let along: Vec<Point> = (0..values.len()).map(|value| with(point, axis, value)).collect();
            let costs = known_or_measured(place, &along, &mut known)?;
            let best = costs.into_iter().zip(along).max_by_key(|(cost, _)| *cost).context("no values")?;
            if best.0 > highest {
                (highest, point) = best;
            }
        }
        if highest == before {
            break;
        }
    }
    Ok(Found { place, point, instructions: highest })
}

/// Where the instructions of the worst-case epoch go whose name has these words in it, which is searched for first; `None` where
/// it is neither.
///
/// # Errors
/// As [`search`].
pub fn profile(wanted: &str) -> Result<Option<(String, Profile)>> {
    let places = [Place::Later, Place::First];
    let Some(place) = places.into_iter().find(|place| place.words().contains(wanted)) else {
        return Ok(None);
    };
    let found = search(place)?;
    let mut bench = Bench::default();
    bench.request(Stage::Whole, Scalar::Single, &input(place, &found.point)?);
    Ok(Some((found.circumstances(), bench.profile(0)?)))
}

fn with(mut point: Point, axis: usize, value: usize) -> Point {
    if let Some(slot) = point.get_mut(axis) {
        *slot = value;
    }
    point
}

/// What each point costs. What is known is not measured again: a search that has come to its summit looks around once more, at
/// points most of which it has been to.
fn known_or_measured(place: Place, points: &[Point], known: &mut BTreeMap<Point, u64>) -> Result<Vec<u64>> {
    let new: Vec<Point> = points.iter().filter(|point| !known.contains_key(*point)).copied().collect();
    if !new.is_empty() {
        known.extend(new.iter().copied().zip(measure(place, &new)?));
    }
    points.iter().map(|point| known.get(point).copied().context("a point without an answer")).collect()
}

/// What each point costs, all of them in one go of the emulator.
fn measure(place: Place, points: &[Point]) -> Result<Vec<u64>> {
    let mut bench = Bench::default();
    for point in points {
        bench.request(Stage::Whole, Scalar::Single, &input(place, point)?);
    }
    Ok(bench.run()?.into_iter().map(|answer| answer.instructions).collect())
}

fn input(place: Place, point: &Point) -> Result<Vec<u8>> {
    let (count, faults, scale) = (value(point, SATELLITES)?, value(point, FAULTS)?, value(point, SCALE)?);
    let (epochs, from_s) = match place {
        Place::Later => (3, 2.0),
        Place::First => (1, 0.0),
    };
    let wrong = Wrong { faults: faults.parse()?, scale: scale.parse()?, from_s };
    let stream = Stream::of_systems(value(point, SYSTEMS)?, epochs, count.parse()?, wrong)?;
    let (before, last) = stream.split()?;
    let is_command = |name: &str| name.chars().all(char::is_uppercase);
    let commands = words(point).filter(|(name, _)| is_command(name));
    let commands: Vec<String> = commands.map(|(name, value)| format!("{name},{value}")).collect();
    Ok(whole(&commands, &before, last))
}

fn words(point: &Point) -> impl Iterator<Item = (&'static str, &'static str)> {
    CIRCUMSTANCES.iter().zip(*point).filter_map(|(&(name, values), value)| Some((name, *values.get(value)?)))
}

fn value(point: &Point, wanted: &str) -> Result<&'static str> {
    words(point).find(|(name, _)| *name == wanted).map(|(_, value)| value).context("no such circumstance")
}
