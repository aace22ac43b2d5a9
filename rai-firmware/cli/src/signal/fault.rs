//! Faults on demand: steps, ramps, outages, a whole constellation, a jumping receiver clock.
//!
//! [`Injector`] wraps any source of epochs, a recording as well as a simulated sky. A fault of the
//! range applies to every signal of the satellite equally, so that combining frequencies neither
//! hides nor multiplies it.
//!
//! ```text
//! step   Δρ = b                     ramp   Δρ = r (t − t₀), at most b           outage   no measurement
//! shift  Δρ = −LOS · d
//! ```
//!
//! A shift moves by `d` the place on which the satellites of a constellation agree. Orbits in a
//! wrong frame have this effect, and so has a clock upload that all satellites share. Each range is
//! plausible by itself; only a comparison of constellations reveals the shift. In contrast, a step
//! of a whole constellation is its clock, which the receiver estimates.
//!
//! | text | meaning |
//! |---|---|
//! | `G05:+80@600..1200` | G05 is 80 m long from 600 s to 1200 s after the first epoch, the end excluded |
//! | `C:-12@600..` | every BeiDou satellite is 12 m short from 600 s on |
//! | `*:+300` | every range is 300 m long: the receiver's clock has jumped by 1 µs |
//! | `E31:lost@..60` | E31 is not received during the first minute |
//! | `E:shift=60,0,-45@600..` | all Galileo satellites agree on a place 60 m to the east and 45 m below from 600 s on |
//! | `G05:0.5@600..` as a ramp | G05 drifts off by 0.5 m each second from 600 s on |

use std::fmt;

use raim_core::frame::Enu;
use raim_core::satellite::{Constellation, SatelliteId};

use crate::signal::measurement::MeasuredEpoch;

/// Satellites that a fault affects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// One satellite.
    Satellite(SatelliteId),
    /// All satellites of one system.
    Constellation(Constellation),
    /// All ranges equally: the receiver's own clock.
    Receiver,
}

impl Target {
    /// Returns true if the fault affects this satellite.
    pub fn covers(self, satellite: SatelliteId) -> bool {
        match self {
            Self::Satellite(target) => target == satellite,
            Self::Constellation(target) => target == satellite.constellation(),
            Self::Receiver => true,
        }
    }
}

/// Kind of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// The range is wrong by a constant, m.
    Step {
        /// Added to the range, m.
        bias_m: f64,
    },
    /// The range drifts off.
    Ramp {
        /// Growth of the error, m/s.
        rate_m_s: f64,
        /// Largest error, m; infinite if the drift does not stop.
        limit_m: f64,
    },
    /// The ranges fit a place with this error, m.
    Shift(Enu),
    /// The satellite is not measured.
    Outage,
}

/// One fault, from `start_s` to before `end_s` after the first epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// Satellites that the fault affects.
    pub target: Target,
    /// Kind of the fault.
    pub kind: Kind,
    /// First instant, s.
    pub start_s: f64,
    /// First instant after it, s; infinite if it does not end.
    pub end_s: f64,
}

/// Epoch whose ranges can be falsified.
pub trait Measured {
    /// Returns the time in s of any continuous scale.
    fn time_s(&self) -> f64;
    /// Returns the measured satellites.
    fn satellites(&self) -> Vec<SatelliteId>;
    /// Lengthens all pseudoranges of a satellite, m.
    fn lengthen(&mut self, satellite: SatelliteId, by_m: f64);
    /// Removes a satellite.
    fn lose(&mut self, satellite: SatelliteId);
}

impl Measured for MeasuredEpoch {
    fn time_s(&self) -> f64 {
        self.time.to_s()
    }

    fn satellites(&self) -> Vec<SatelliteId> {
        self.satellites.iter().map(|raw| raw.satellite).collect()
    }

    fn lengthen(&mut self, satellite: SatelliteId, by_m: f64) {
        let of_satellite = self.satellites.iter_mut().filter(|raw| raw.satellite == satellite);
        for signal in of_satellite.flat_map(|raw| &mut raw.signals) {
            signal.pseudorange_m += by_m;
        }
    }

    fn lose(&mut self, satellite: SatelliteId) {
        self.satellites.retain(|raw| raw.satellite != satellite);
    }
}

impl Fault {
    /// Returns true if the fault is active `elapsed_s` after the first epoch.
    pub fn is_active(&self, elapsed_s: f64) -> bool {
        (self.start_s..self.end_s).contains(&elapsed_s)
    }

    /// Returns the fault's contribution to a range `elapsed_s` after the first epoch, m; 0 during
    /// an outage. For a shift it is the largest contribution to any range.
    pub fn bias_m(&self, elapsed_s: f64) -> f64 {
        match self.kind {
            _ if !self.is_active(elapsed_s) => 0.0,
            Kind::Step { bias_m } => bias_m,
            Kind::Shift(Enu { east, north, up }) => libm::hypot(libm::hypot(east, north), up),
            Kind::Ramp { rate_m_s, limit_m } => {
                (rate_m_s * (elapsed_s - self.start_s)).clamp(-limit_m.abs(), limit_m.abs())
            }
            Kind::Outage => 0.0,
        }
    }

    /// Returns the fault's contribution to the range of a satellite in this direction, m.
    pub fn bias_towards_m(&self, line_of_sight: Enu, elapsed_s: f64) -> f64 {
        match self.kind {
            Kind::Shift(Enu { east, north, up }) if self.is_active(elapsed_s) => {
                -(east * line_of_sight.east + north * line_of_sight.north + up * line_of_sight.up)
            }
            _ => self.bias_m(elapsed_s),
        }
    }

    /// Returns the letter of the system whose satellites the fault affects; `None` if it is that of
    /// the receiver.
    pub fn system(&self) -> Option<char> {
        match self.target {
            Target::Satellite(satellite) => Some(satellite.name().0),
            Target::Constellation(constellation) => Some(constellation.letter()),
            Target::Receiver => None,
        }
    }

    /// Returns true if the fault depends on the directions of satellites.
    pub fn needs_directions(&self) -> bool {
        matches!(self.kind, Kind::Shift(_))
    }

    /// Falsifies one epoch. A shift needs [`Self::apply_towards`]; without directions its
    /// satellites are lost.
    pub fn apply(&self, epoch: &mut impl Measured, elapsed_s: f64) {
        self.apply_towards(epoch, elapsed_s, |_| None);
    }

    /// Falsifies one epoch whose satellites have these directions.
    ///
    /// A satellite of a shift whose direction is unknown is lost, because a constellation of which
    /// only half moves would be another fault than the requested one.
    pub fn apply_towards(
        &self,
        epoch: &mut impl Measured,
        elapsed_s: f64,
        direction: impl Fn(SatelliteId) -> Option<Enu>,
    ) {
        if !self.is_active(elapsed_s) {
            return;
        }
        for satellite in epoch.satellites().into_iter().filter(|&satellite| self.target.covers(satellite)) {
            match self.kind {
                Kind::Outage => epoch.lose(satellite),
                Kind::Step { .. } | Kind::Ramp { .. } => epoch.lengthen(satellite, self.bias_m(elapsed_s)),
                Kind::Shift(_) => match direction(satellite) {
                    Some(towards) => epoch.lengthen(satellite, self.bias_towards_m(towards, elapsed_s)),
                    None => epoch.lose(satellite),
                },
            }
        }
    }

    /// Parses a step, a shift or an outage: `G05:+80@600..1200`, `E:shift=60,0,-45@600..`,
    /// `G05:lost@600..`.
    ///
    /// # Errors
    /// If the text has another form; the error names the part and the expected form.
    pub fn parse_inject(text: &str) -> Result<Self, FaultError> {
        Self::parse(text, INJECT_EXAMPLE, |what, at| match (what, what.strip_prefix("shift=")) {
            ("lost", _) => Ok(Kind::Outage),
            (_, Some(metres)) => shift(text, metres, at + "shift=".len()),
            _ => number(text, what, at, "a number of metres, `shift=` or `lost`", INJECT_EXAMPLE)
                .map(|bias_m| Kind::Step { bias_m }),
        })
    }

    /// Parses a ramp: `G05:0.5@600..`, in metres per second.
    ///
    /// # Errors
    /// If the text has another form; the error names the part and the expected form.
    pub fn parse_ramp(text: &str) -> Result<Self, FaultError> {
        Self::parse(text, RAMP_EXAMPLE, |what, at| {
            number(text, what, at, "a number of metres per second", RAMP_EXAMPLE)
                .map(|rate_m_s| Kind::Ramp { rate_m_s, limit_m: f64::INFINITY })
        })
    }

    fn parse(
        text: &str,
        example: &'static str,
        kind: impl FnOnce(&str, usize) -> Result<Kind, FaultError>,
    ) -> Result<Self, FaultError> {
        let error = |at, part: &str, want| FaultError::syntax(text, at, part, want, example);
        let Some((name, rest)) = text.split_once(':') else {
            return Err(error(0, text, "a satellite and, after a colon, a fault"));
        };
        let Some(target) = target(name) else {
            return Err(error(0, name, "a satellite (G05), a constellation (G, C, E, R) or * for all"));
        };
        let (what, window) = rest.split_once('@').unwrap_or((rest, ".."));
        let kind_at = name.len() + 1;
        let window_at = kind_at + what.len() + 1;
        let kind = kind(what, kind_at)?;
        let Some((start, end)) = window.split_once("..") else {
            return Err(error(window_at, window, "a span of seconds start..end"));
        };
        let bound = |text_of_bound: &str, at, otherwise| match text_of_bound {
            "" => Ok(otherwise),
            _ => number(text, text_of_bound, at, "a number of seconds", example),
        };
        let start_s = bound(start, window_at, 0.0)?;
        let end_s = bound(end, window_at + start.len() + 2, f64::INFINITY)?;
        if end_s <= start_s {
            return Err(error(window_at, window, "a span that ends after it starts"));
        }
        Ok(Self { target, kind, start_s, end_s })
    }

    /// Checks that the fault affects at least one of a source's satellites.
    ///
    /// # Errors
    /// If it affects none; the [`FaultError`] names the satellites of the source.
    pub fn check_against(&self, satellites: &[SatelliteId]) -> Result<(), FaultError> {
        if satellites.iter().any(|&satellite| self.target.covers(satellite)) {
            return Ok(());
        }
        let known: Vec<String> = satellites.iter().map(ToString::to_string).collect();
        Err(FaultError {
            message: format!("{} is never received; the satellites are {}", self.target, known.join(" ")),
        })
    }
}

const INJECT_EXAMPLE: &str = "G05:+80@600..1200";
const SHIFT_EXAMPLE: &str = "E:shift=60,0,-45@600..";
const RAMP_EXAMPLE: &str = "G05:0.5@600..";

/// Parses a satellite's name as in RINEX, with one digit or two.
pub fn satellite(name: &str) -> Option<SatelliteId> {
    let mut letters = name.chars();
    let letter = letters.next()?.to_ascii_uppercase();
    let digits = letters.as_str();
    let plain = (1..=2).contains(&digits.len()) && digits.bytes().all(|digit| digit.is_ascii_digit());
    if plain { SatelliteId::from_name(letter, digits.parse().ok()?) } else { None }
}

fn target(name: &str) -> Option<Target> {
    let mut letters = name.chars();
    match (letters.next(), letters.next()) {
        (Some('*'), None) => Some(Target::Receiver),
        (Some(letter), None) => {
            Constellation::from_letter(letter.to_ascii_uppercase()).map(Target::Constellation)
        }
        _ => satellite(name).map(Target::Satellite),
    }
}

/// Parses east, north and up, m.
fn shift(text: &str, metres: &str, at: usize) -> Result<Kind, FaultError> {
    let parts: Vec<&str> = metres.split(',').collect();
    let &[east, north, up] = parts.as_slice() else {
        return Err(FaultError::syntax(text, at, metres, "three numbers east,north,up", SHIFT_EXAMPLE));
    };
    let read = |part, at| number(text, part, at, "a number of metres", SHIFT_EXAMPLE);
    let north_at = at + east.len() + 1;
    Ok(Kind::Shift(Enu {
        east: read(east, at)?,
        north: read(north, north_at)?,
        up: read(up, north_at + north.len() + 1)?,
    }))
}

fn number(
    text: &str,
    part: &str,
    at: usize,
    want: &'static str,
    example: &'static str,
) -> Result<f64, FaultError> {
    let finite = part.parse().ok().filter(|number: &f64| number.is_finite());
    finite.ok_or_else(|| FaultError::syntax(text, at, part, want, example))
}

/// Error of a text that is not a fault, or of a fault that affects no satellite.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultError {
    message: String,
}

impl FaultError {
    fn syntax(text: &str, at: usize, part: &str, want: &str, example: &str) -> Self {
        let position = at + 1;
        Self {
            message: format!(
                "fault `{text}`: `{part}` at character {position} is not {want}; write it like {example}"
            ),
        }
    }
}

impl fmt::Display for FaultError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl std::error::Error for FaultError {}

impl fmt::Display for Target {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Satellite(satellite) => write!(formatter, "{satellite}"),
            Self::Constellation(constellation) => write!(formatter, "{}", constellation.letter()),
            Self::Receiver => formatter.write_str("*"),
        }
    }
}

/// Directions of satellites in the sky of a source: by time, as unit vectors from the receiver.
#[derive(Clone, Debug, Default)]
pub struct Directions {
    epochs: Vec<(f64, Vec<(SatelliteId, Enu)>)>,
}

impl Directions {
    /// Returns the directions of epochs in the order of time, s.
    pub const fn new(epochs: Vec<(f64, Vec<(SatelliteId, Enu)>)>) -> Self {
        Self { epochs }
    }

    /// Returns the direction of a satellite at the epoch of this time.
    fn of(&self, time_s: f64, satellite: SatelliteId) -> Option<Enu> {
        // Time tags are whole milliseconds.
        const SAME_S: f64 = 5e-4;
        let next = self.epochs.partition_point(|(other_s, _)| *other_s < time_s - SAME_S);
        let (_, seen) = self.epochs.get(next).filter(|(other_s, _)| *other_s < time_s + SAME_S)?;
        seen.iter().find(|(other, _)| *other == satellite).map(|(_, direction)| *direction)
    }
}

/// A source of epochs with faults.
#[derive(Clone, Debug)]
pub struct Injector<I> {
    source: I,
    faults: Vec<Fault>,
    directions: Directions,
    start_s: Option<f64>,
}

impl<I> Injector<I> {
    /// Wraps a source; the faults' clock starts with its first epoch.
    pub fn new(source: I, faults: Vec<Fault>) -> Self {
        Self { source, faults, directions: Directions::default(), start_s: None }
    }

    /// Adds the directions that a shift needs.
    #[must_use]
    pub fn towards(self, directions: Directions) -> Self {
        Self { directions, ..self }
    }
}

impl<I> Iterator for Injector<I>
where
    I: Iterator,
    I::Item: Measured,
{
    type Item = I::Item;

    fn next(&mut self) -> Option<I::Item> {
        let mut epoch = self.source.next()?;
        let time_s = epoch.time_s();
        let elapsed_s = time_s - *self.start_s.get_or_insert(time_s);
        for fault in &self.faults {
            fault.apply_towards(&mut epoch, elapsed_s, |satellite| self.directions.of(time_s, satellite));
        }
        Some(epoch)
    }
}
