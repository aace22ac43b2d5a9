//! Parsing of one input line.
//!
//! A missing field or one of the wrong kind is an error that names the field. A number out of range
//! is left to the core and to [`Line::probabilities`], and becomes a status.

use nalgebra::Vector3;
use raim_core::internals::numeric::probability::Probability;
use raim_core::report::MAX_EXCLUDED;
use raim_core::satellite::Constellation;
use serde_json::{Map, Value};

use super::number::Number;
use super::{MAX_ROWS, Scalar};
use crate::second_opinion::dense::Range;

/// A linearised epoch and its requirements.
#[derive(Debug)]
pub(super) struct Line {
    pub(super) satellites: Vec<Satellite>,
    pub(super) clock: Option<Clock>,
    pub(super) pfa: f64,
    pub(super) pmd: f64,
    pub(super) hal_m: f64,
    pub(super) guard_fraction: f64,
    pub(super) isolation: Isolation,
    pub(super) scalar: Scalar,
}

/// Parameters of isolation; all optional, with the defaults of the papers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Isolation {
    pub(super) alpha: f64,
    pub(super) kmax: usize,
    pub(super) tr_pfa: f64,
    pub(super) chi_pfa: f64,
}

/// One satellite's row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Satellite {
    pub(super) constellation: Constellation,
    pub(super) line_of_sight: Vector3<f64>,
    pub(super) residual_m: f64,
    pub(super) sigma_m: f64,
}

/// A predicted receiver clock.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    pub(super) constellation: Constellation,
    pub(super) value_m: f64,
    pub(super) sigma_m: f64,
}

impl Line {
    /// Reads a line from its JSON value.
    pub(super) fn read(value: &Value) -> Result<Self, String> {
        let object = value.as_object().ok_or("not a JSON object")?;
        let line = Self {
            satellites: satellites(object)?,
            clock: object.get("clock").filter(|clock| !clock.is_null()).map(clock).transpose()?,
            pfa: number(object, "pfa")?,
            pmd: number(object, "pmd")?,
            hal_m: number(object, "hal")?,
            guard_fraction: number(object, "f")?,
            isolation: isolation(object)?,
            scalar: scalar(object)?,
        };
        if line.rows() > MAX_ROWS {
            return Err(format!("los_enu: {} rows, clock included, but at most {MAX_ROWS} fit", line.rows()));
        }
        Ok(line)
    }

    /// Returns the number of rows of the least-squares problem: satellites, then the clock.
    pub(super) fn rows(&self) -> usize {
        self.satellites.len() + usize::from(self.clock.is_some())
    }

    /// Returns the number of unknowns: the position, and a clock for each constellation that
    /// occurs.
    pub(super) fn unknowns(&self) -> usize {
        let occurs = |constellation: &Constellation| {
            self.satellites.iter().any(|satellite| satellite.constellation == *constellation)
                || self.clock.is_some_and(|clock| clock.constellation == *constellation)
        };
        3 + Constellation::ALL.iter().filter(|constellation| occurs(constellation)).count()
    }

    /// Returns the two probabilities and checks the other requirements; an error names the field.
    pub(super) fn probabilities(&self) -> Result<(Probability, Probability), String> {
        // In this form a NaN fails.
        if !(self.hal_m > 0.0) {
            return Err(format!("hal: {} not above 0", self.hal_m));
        }
        if !(self.guard_fraction > 0.0 && self.guard_fraction <= 1.0) {
            return Err(format!("f: {} outside (0, 1]", self.guard_fraction));
        }
        Ok((probability("pfa", self.pfa)?, probability("pmd", self.pmd)?))
    }

    /// Returns the ranges alone, for methods outside the core.
    pub(super) fn ranges(&self) -> Vec<Range> {
        let range = |satellite: &Satellite| Range {
            line_of_sight: satellite.line_of_sight.into(),
            constellation: satellite.constellation,
            residual_m: satellite.residual_m,
            sigma_m: satellite.sigma_m,
        };
        self.satellites.iter().map(range).collect()
    }
}

fn isolation(object: &Map<String, Value>) -> Result<Isolation, String> {
    let optional = |name: &str, published: f64| {
        if object.contains_key(name) { number(object, name) } else { Ok(published) }
    };
    let wanted = optional("kmax", 2.0)?;
    let is_wanted = |&rows: &usize| (rows as f64).total_cmp(&wanted).is_eq();
    let kmax = (1..=MAX_EXCLUDED).find(is_wanted);
    Ok(Isolation {
        alpha: optional("alpha", 0.01)?,
        kmax: kmax.ok_or_else(|| format!("kmax: {wanted} is not 1 to {MAX_EXCLUDED}"))?,
        tr_pfa: optional("tr_pfa", 1e-3)?,
        chi_pfa: optional("chi_pfa", 1e-4)?,
    })
}

/// Checks a tail probability; an error names the field.
pub(super) fn probability(name: &str, tail: f64) -> Result<Probability, String> {
    Probability::new(tail).ok_or_else(|| format!("{name}: {tail} outside (0, 0.5)"))
}

/// Returns the scalar type that the line requests.
pub(super) fn scalar(object: &Map<String, Value>) -> Result<Scalar, String> {
    match object.get("scalar") {
        Some(word) => {
            word.as_str().ok_or("scalar: not a word")?.parse().map_err(|why| format!("scalar: {why}"))
        }
        None => Ok(Scalar::F64),
    }
}

pub(super) fn satellites(object: &Map<String, Value>) -> Result<Vec<Satellite>, String> {
    let directions = array(object, "los_enu")?;
    let constellations = array(object, "con")?;
    let sigmas = numbers(array(object, "sigma")?, "sigma")?;
    let residuals = numbers(array(object, "y")?, "y")?;
    let count = directions.len();
    let lengths = [("con", constellations.len()), ("sigma", sigmas.len()), ("y", residuals.len())];
    if let Some((name, length)) = lengths.into_iter().find(|&(_, length)| length != count) {
        return Err(format!("{name}: {length} entries, but los_enu has {count}"));
    }
    let rows = directions.iter().zip(constellations).zip(sigmas.into_iter().zip(residuals)).enumerate();
    rows.map(|(index, ((direction, id), (sigma_m, residual_m)))| {
        let constellation = constellation(id).map_err(|why| format!("con[{index}]: {why}"))?;
        let line_of_sight =
            direction_of(direction).ok_or_else(|| format!("los_enu[{index}]: not three numbers"))?;
        Ok(Satellite { constellation, line_of_sight, residual_m, sigma_m })
    })
    .collect()
}

fn clock(value: &Value) -> Result<Clock, String> {
    let object = value.as_object().ok_or("clock: not an object")?;
    let named = |why: String| format!("clock.{why}");
    let id = object.get("con").ok_or("clock.con: missing")?;
    Ok(Clock {
        constellation: constellation(id).map_err(|why| format!("clock.con: {why}"))?,
        value_m: number(object, "value_m").map_err(named)?,
        sigma_m: number(object, "sigma_m").map_err(named)?,
    })
}

pub(super) fn array<'v>(object: &'v Map<String, Value>, name: &str) -> Result<&'v Vec<Value>, String> {
    let value = object.get(name).ok_or_else(|| format!("{name}: missing"))?;
    value.as_array().ok_or_else(|| format!("{name}: not an array"))
}

pub(super) fn number(object: &Map<String, Value>, name: &str) -> Result<f64, String> {
    let value = object.get(name).ok_or_else(|| format!("{name}: missing"))?;
    Number::read(value).ok_or_else(|| format!("{name}: not a number"))
}

pub(super) fn numbers(values: &[Value], name: &str) -> Result<Vec<f64>, String> {
    let read = |(index, value)| Number::read(value).ok_or_else(|| format!("{name}[{index}]: not a number"));
    values.iter().enumerate().map(read).collect()
}

pub(super) fn direction_of(value: &Value) -> Option<Vector3<f64>> {
    let [east, north, up] = value.as_array()?.as_slice() else { return None };
    Some(Vector3::new(Number::read(east)?, Number::read(north)?, Number::read(up)?))
}

fn constellation(id: &Value) -> Result<Constellation, String> {
    let known = |constellation: &Constellation| id.as_u64() == Some(*constellation as u64);
    Constellation::ALL.into_iter().find(known).ok_or_else(|| format!("no constellation {id}"))
}
