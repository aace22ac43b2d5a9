//! The worst-case epoch, found by a search: what the pin may have to wait for.
//!
//! A setting or a circumstance at a time is varied over all of its values and left at the dearest, round after round, until
//! none makes the epoch dearer. That finds a summit, not surely the highest: circumstances that only together are dear
//! may be missed. It starts from every method, so that at least these are all looked at.
//!
//! | varied | over |
//! |---|---|
//! | method, policy, levels | all |
//! | clock aiding, choice of frequencies | all |
//! | satellites in view | 20 to 40 |
//! | faulty ones among them | none to thirty |
//! | size of the faults | some tens of metres to hundreds of kilometres |
//!
//! Figures are instructions of one epoch from its first byte to its last sentence, in the midst of a stream, or the first of
//! one, which brings the ephemerides and knows no position.

use anyhow::{Context, Result};

use super::figure::Figure;
use super::stages::{METHODS, whole};
use super::workload::{Stream, Wrong};
use crate::laboratory::profile::Profile;
use crate::laboratory::{Bench, Scalar, Stage};

/// Values of each circumstance, by its name.
const CIRCUMSTANCES: [(&str, &[&str]); 8] = [
    ("METHOD", &METHODS),
    ("POLICY", &["T1", "T2", "TOP"]),
    ("LEVELS", &["BOUND", "SLOPE"]),
    ("CLOCKAID", &["OFF", "ON"]),
    ("FREQ", &["AUTO", "DUAL", "SINGLE"]),
    (SATELLITES, &["20", "25", "30", "35", "40"]),
    (FAULTS, &["0", "1", "2", "3", "4", "10", "20", "30"]),
    (SCALE, &["0.3", "1", "10", "100", "1000"]),
];

const SATELLITES: &str = "satellites";
const FAULTS: &str = "faults";
/// Of the faults, in units of some hundred metres.
const SCALE: &str = "scale";

/// Rounds after which the search ends, whatever it finds.
const ROUNDS: usize = 4;

/// Circumstances by the number of their values.
type Point = [usize; CIRCUMSTANCES.len()];

/// Where every search begins: the full sky with three faults, as the module is at start.
const START: Point = [0, 0, 0, 0, 0, 4, 3, 1];

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

/// Finds the worst-case epoch; its name says what it was.
///
/// # Errors
/// Where the measuring image does not come to its end.
pub fn search(place: Place, target: u64) -> Result<Figure> {
    let mut point = START;
    let mut dearest = 0;
    for _ in 0..ROUNDS {
        let before = dearest;
        for (axis, (_, values)) in CIRCUMSTANCES.iter().enumerate() {
            let along: Vec<Point> = (0..values.len()).map(|value| with(point, axis, value)).collect();
            let costs = measure(place, &along)?;
            let best = costs.into_iter().zip(along).max_by_key(|(cost, _)| *cost).context("no values")?;
            if best.0 > dearest {
                (dearest, point) = best;
            }
        }
        if dearest == before {
            break;
        }
    }
    let name = format!("{}: {}", place.words(), name(&point));
    Ok(Figure { name, value: dearest, target: Some(target) })
}

/// Where the instructions of an epoch go that a search has found, by the name of its figure; `None` where it is no such.
///
/// # Errors
/// As [`search`].
pub fn profile(figure: &str) -> Result<Option<Profile>> {
    let places = [Place::Later, Place::First];
    let Some((place, said)) =
        places.iter().find_map(|place| Some((*place, figure.strip_prefix(place.words())?)))
    else {
        return Ok(None);
    };
    let mut point = START;
    for (slot, (name, values)) in point.iter_mut().zip(CIRCUMSTANCES) {
        let value = said.split([':', ',']).find_map(|word| word.trim().strip_prefix(name)?.strip_prefix(' '));
        let value = value.with_context(|| format!("`{figure}` says no {name}"))?;
        *slot = values.iter().position(|known| *known == value).context("no such value")?;
    }
    let mut bench = Bench::default();
    bench.request(Stage::Whole, Scalar::Single, &input(place, &point)?);
    bench.profile(0).map(Some)
}

fn with(mut point: Point, axis: usize, value: usize) -> Point {
    if let Some(slot) = point.get_mut(axis) {
        *slot = value;
    }
    point
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
    let stream = Stream::with(epochs, count.parse()?, wrong)?;
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

fn name(point: &Point) -> String {
    words(point).map(|(name, value)| format!("{name} {value}")).collect::<Vec<_>>().join(", ")
}
