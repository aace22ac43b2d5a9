//! Header of a RINEX file, which describes the records after it.
//!
//! A header line has values in columns 0 to 59 and its label from column 60 on. Labels of RINEX 2,
//! 3 and 4 are read alike; those that do not concern ranges or orbits are skipped. References:
//! [RINEX-2.11] tables A1 and A3, [RINEX-3.05] tables A2 and A5, [RINEX-4.01].
//!
//! [RINEX-2.11]: crate#references
//! [RINEX-3.05]: crate#references
//! [RINEX-4.01]: crate#references

use std::collections::HashMap;

use anyhow::{Context, Result, anyhow, bail, ensure};
use raim_core::frame::Ecef;

use super::text::{Lines, columns, label, number};
use crate::signal::calendar::TimeSystem;
use crate::signal::skipped::{Flaw, Skipped};

/// Label of the first line.
const FIRST: &str = "RINEX VERSION / TYPE";

/// Kind of the records that follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Observations,
    Navigation,
}

/// Content of the lines before `END OF HEADER`.
#[derive(Clone, Debug)]
pub(super) struct Header {
    /// Version times 100: 211, 302, 400.
    pub(super) version: u16,
    pub(super) kind: Kind,
    /// Letter of the only system, or `M`. Some files claim one and have many, so that it only
    /// applies to unnamed satellites.
    pub(super) system: char,
    pub(super) time_system: TimeSystem,
    /// GPS time minus UTC that the file states, s.
    pub(super) leap_s: Option<u8>,
    pub(super) codes: ObservationCodes,
    pub(super) approximate_position: Option<Ecef>,
    pub(super) klobuchar: Klobuchar,
}

impl Header {
    /// Reads up to and including `END OF HEADER`. Unreadable fields that RAI does not need are
    /// counted.
    pub(super) fn read(lines: &mut Lines, skipped: &mut Skipped) -> Result<Self> {
        let mut header = Self::begin(lines.next().unwrap_or(""))?;
        let mut time_system = String::new();
        loop {
            let Some(line) = lines.next() else {
                let failure = lines.failure();
                return Err(failure.unwrap_or_else(|| anyhow!("END OF HEADER is missing")));
            };
            let codes = header.codes.read(line);
            let is_read = match label(line) {
                "TIME OF FIRST OBS" => {
                    columns(line, 48, 51).clone_into(&mut time_system);
                    true
                }
                "SYS / SCALE FACTOR" => bail!("scaled observations (SYS / SCALE FACTOR) are not supported"),
                "END OF HEADER" => break,
                _ => header.optional(line).is_ok(),
            };
            let number = lines.number();
            codes.with_context(|| format!("line {number} of the header"))?;
            if !is_read {
                skipped.note(Flaw::HeaderField, number);
            }
        }
        header.time_system = match (time_system.as_str(), header.system) {
            ("BDT", _) | ("", 'C') => TimeSystem::Beidou,
            ("GLO" | "UTC", _) | ("", 'R') => TimeSystem::Utc { stated_s: header.leap_s },
            _ => TimeSystem::Gps,
        };
        Ok(header)
    }

    /// Takes a field that RAI does not need.
    fn optional(&mut self, line: &str) -> Result<()> {
        match label(line) {
            "APPROX POSITION XYZ" => self.approximate_position = position(line)?,
            "LEAP SECONDS" => {
                let seconds: u8 = columns(line, 0, 6).parse()?;
                // Some files count since the beginning of BeiDou's time, when there were 14.
                let before_s = if columns(line, 24, 27) == "BDS" { 14 } else { 0 };
                self.leap_s = Some(seconds.saturating_add(before_s)).filter(|seconds| *seconds > 0);
            }
            _ => self.klobuchar.read(line)?,
        }
        Ok(())
    }

    /// Returns the version times 100 that a line states if it is the first line of a header.
    pub(super) fn version(line: &str) -> Option<u16> {
        let version = number(columns(line, 0, 9)).ok().flatten()?;
        (label(line) == FIRST && (2.0..5.0).contains(&version)).then_some((version * 100.0).round() as u16)
    }

    /// Reads the first line: version, kind and system.
    fn begin(line: &str) -> Result<Self> {
        ensure!(label(line) == FIRST, "is not RINEX: line 1 does not say RINEX VERSION / TYPE");
        let version = number(columns(line, 0, 9))?.context("line 1: the version is missing")?;
        ensure!((2.0..5.0).contains(&version), "line 1: RINEX {version} is not supported, only 2, 3 and 4");
        let named = columns(line, 40, 41).chars().next().unwrap_or('G');
        // RINEX 2 has its own type for the navigation of GLONASS.
        let (kind, system) = match columns(line, 20, 21) {
            "O" => (Kind::Observations, named),
            "N" => (Kind::Navigation, named),
            "G" if version < 3.0 => (Kind::Navigation, 'R'),
            other => bail!(
                "line 1: a RINEX file of type `{other}`, neither observations nor navigation of GPS, GLONASS or mixed"
            ),
        };
        Ok(Self {
            version: (version * 100.0).round() as u16,
            kind,
            system,
            time_system: TimeSystem::Gps,
            leap_s: None,
            codes: ObservationCodes::default(),
            approximate_position: None,
            klobuchar: Klobuchar::default(),
        })
    }
}

/// Reads three coordinates; the centre of the earth means unknown.
fn position(line: &str) -> Result<Option<Ecef>> {
    let coordinate = |index: usize| number(columns(line, 14 * index, 14 * index + 14));
    let (x_m, y_m, z_m) = (coordinate(0)?, coordinate(1)?, coordinate(2)?);
    let position = Ecef::new(x_m.unwrap_or(0.0), y_m.unwrap_or(0.0), z_m.unwrap_or(0.0));
    Ok((position.radius_m() > 0.0).then_some(position))
}

/// Observation in each field, by the letter of the system.
#[derive(Clone, Debug, Default)]
pub(super) struct ObservationCodes {
    by_system: HashMap<char, Vec<String>>,
    /// System whose list a continuation line continues.
    open: char,
}

impl ObservationCodes {
    /// Key of the one list that RINEX 2 has for all systems.
    const ALL: char = '*';

    /// Takes a header line if it lists observations.
    pub(super) fn read(&mut self, line: &str) -> Result<()> {
        match label(line) {
            "SYS / # / OBS TYPES" => {
                self.extend(columns(line, 0, 1).chars().next(), columns(line, 3, 6), columns(line, 6, 60))
            }
            "# / TYPES OF OBSERV" => {
                let count = columns(line, 0, 6);
                self.extend((!count.is_empty()).then_some(Self::ALL), count, columns(line, 6, 60))
            }
            _ => Ok(()),
        }
    }

    /// Begins a list if a system is named, and continues it if none is.
    fn extend(&mut self, system: Option<char>, count: &str, words: &str) -> Result<()> {
        if let Some(system) = system {
            count
                .parse::<usize>()
                .with_context(|| format!("`{count}` is not a number of observation types"))?;
            self.by_system.insert(system, Vec::new());
            self.open = system;
        }
        let codes = self
            .by_system
            .get_mut(&self.open)
            .context("a list of observation types goes on before it begins")?;
        codes.extend(words.split_ascii_whitespace().map(str::to_owned));
        Ok(())
    }

    /// Returns the codes of a system's observations in the order of the fields; `None` if the
    /// header lists none.
    pub(super) fn of(&self, system: char) -> Option<&[String]> {
        let codes = self.by_system.get(&system).or_else(|| self.by_system.get(&Self::ALL));
        codes.map(Vec::as_slice)
    }
}

/// GPS coefficients of the single-frequency ionosphere model, in header lines of one half each.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Klobuchar {
    alpha: Option<[f64; 4]>,
    beta: Option<[f64; 4]>,
}

impl Klobuchar {
    /// Takes a header line if it has one half. Lines of other systems, repeated for each satellite,
    /// do not count.
    fn read(&mut self, line: &str) -> Result<()> {
        match (label(line), columns(line, 0, 4)) {
            ("ION ALPHA", _) => self.alpha = Some(quadruple(line, 2)?),
            ("ION BETA", _) => self.beta = Some(quadruple(line, 2)?),
            ("IONOSPHERIC CORR", "GPSA") => self.alpha = Some(quadruple(line, 5)?),
            ("IONOSPHERIC CORR", "GPSB") => self.beta = Some(quadruple(line, 5)?),
            _ => {}
        }
        Ok(())
    }

    /// Returns `α0…α3` (s, s/semicircle, …) and `β0…β3`.
    pub(super) fn coefficients(self) -> Option<[f64; 8]> {
        let (alpha, beta) = (self.alpha?, self.beta?);
        std::array::from_fn(|index| if index < 4 { alpha[index] } else { beta[index - 4] }).into()
    }
}

fn quadruple(line: &str, from: usize) -> Result<[f64; 4]> {
    let mut values = [0.0; 4];
    for (index, value) in values.iter_mut().enumerate() {
        let column = from + 12 * index;
        *value =
            number(columns(line, column, column + 12))?.context("an ionosphere coefficient is missing")?;
    }
    Ok(values)
}
