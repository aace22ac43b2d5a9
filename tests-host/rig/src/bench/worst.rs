//! Worst-case epoch, found by a search: the longest time that the pin may have to wait.
//!
//! The search varies one setting or circumstance at a time over all its values and keeps the most
//! expensive one, round after round, until none raises the cost. That finds a local maximum, not
//! surely the global one: it can miss circumstances that are expensive only together. It starts
//! twice, from a few faults and from thirty gross ones on one frequency, because each is a maximum
//! beside the other.
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
//! Figures are instructions of one epoch from its first byte to its last sentence. The epoch is
//! either in the midst of a stream, or the first of one, which includes the ephemerides and starts
//! without a position.

use std::collections::BTreeMap;

use anyhow::{Context, Result};

use super::figure::Figure;
use super::stages::{METHODS, whole};
use super::workload::{Stream, Wrong};
use crate::laboratory::cycles::Cycles;
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

/// Name of the systems, whose values are letters. GLONASS is not simulated.
const SYSTEMS: &str = "systems";
const SATELLITES: &str = "satellites";
const FAULTS: &str = "faults";
/// Name of the scale of the faults, in units of some hundred metres.
const SCALE: &str = "scale";

/// Largest number of rounds of a search.
const ROUNDS: usize = 4;

/// Index of the value of each circumstance.
type Point = [usize; CIRCUMSTANCES.len()];

/// Starts of every search: the full sky with three faults and the settings at start; and the full
/// sky of three systems with thirty faults of hundreds of kilometres, on one frequency.
const STARTS: [Point; 2] = [[0, 0, 0, 0, 0, 0, 4, 3, 1], [0, 0, 0, 0, 2, 1, 4, 7, 4]];

/// Position of the epoch in its stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// An epoch in the midst of a stream.
    Later,
    /// The first epoch of a stream.
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

/// Epoch that a search has found.
#[derive(Clone, Debug)]
pub struct Found {
    place: Place,
    point: Point,
    instructions: u64,
}

impl Found {
    /// Returns the cost under a name that does not depend on the circumstances.
    pub fn figure(&self, target: u64) -> Figure {
        Figure { name: self.place.words().to_owned(), value: self.instructions, target: Some(target) }
    }

    /// Bounds the cycles of the epoch under the same name.
    ///
    /// # Errors
    /// As [`search`].
    pub fn cycles(&self) -> Result<(String, Cycles)> {
        Ok((self.place.words().to_owned(), self.bench()?.cycles(0)?))
    }

    fn bench(&self) -> Result<Bench> {
        let mut bench = Bench::default();
        bench.request(Stage::Whole, Scalar::Single, &input(self.place, &self.point)?);
        Ok(bench)
    }

    /// Returns the circumstances as text.
    pub fn circumstances(&self) -> String {
        let each = words(&self.point).map(|(name, value)| format!("{name} {value}"));
        format!("{}: {}", self.place.words(), each.collect::<Vec<_>>().join(", "))
    }
}

/// Searches for the worst-case epoch.
///
/// # Errors
/// If the measuring image does not finish.
pub fn search(place: Place) -> Result<Found> {
    let mut known = BTreeMap::new();
    let found: Result<Vec<Found>> =
        STARTS.into_iter().map(|start| search_from(place, start, &mut known)).collect();
    found?.into_iter().max_by_key(|found| found.instructions).context("a search needs a start")
}

fn search_from(place: Place, start: Point, known: &mut BTreeMap<Point, u64>) -> Result<Found> {
    let (mut point, mut highest) = (start, 0);
    for _ in 0..ROUNDS {
        let before = highest;
        for (axis, (_, values)) in CIRCUMSTANCES.iter().enumerate() {
            let along: Vec<Point> = (0..values.len()).map(|value| with(point, axis, value)).collect();
            let costs = known_or_measured(place, &along, known)?;
            let best = costs
                .into_iter()
                .zip(along)
                .max_by_key(|(cost, _)| *cost)
                .context("a circumstance has no values")?;
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

/// Profiles the worst-case epoch whose name contains `wanted`, after searching for it; `None` if
/// neither name does.
///
/// # Errors
/// As [`search`].
pub fn profile(wanted: &str) -> Result<Option<(String, Profile)>> {
    let places = [Place::Later, Place::First];
    let Some(place) = places.into_iter().find(|place| place.words().contains(wanted)) else {
        return Ok(None);
    };
    let found = search(place)?;
    Ok(Some((found.circumstances(), found.bench()?.profile(0)?)))
}

fn with(mut point: Point, axis: usize, value: usize) -> Point {
    if let Some(slot) = point.get_mut(axis) {
        *slot = value;
    }
    point
}

/// Returns the cost of each point. Known points are not measured again, because a search at its
/// maximum tries its surroundings once more, most of which it has measured.
fn known_or_measured(place: Place, points: &[Point], known: &mut BTreeMap<Point, u64>) -> Result<Vec<u64>> {
    let new: Vec<Point> = points.iter().filter(|point| !known.contains_key(*point)).copied().collect();
    if !new.is_empty() {
        known.extend(new.iter().copied().zip(measure(place, &new)?));
    }
    points.iter().map(|point| known.get(point).copied().context("a point has no answer")).collect()
}

/// Measures all points in one run of the emulator.
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
