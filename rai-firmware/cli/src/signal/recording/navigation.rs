//! Navigation records of RINEX 2, 3 and 4, converted to broadcast ephemerides.
//!
//! A record is a line that names satellite and time of clock, followed by indented lines. What
//! their rows hold depends on the system: Kepler elements ([`kepler`](super::kepler)) or, for
//! GLONASS, a state vector ([`glonass`]), in RINEX 2 in a file of its own.
//!
//! An unreadable record is counted and skipped, and so is one with a number that does not fit its
//! message. Unread kinds are counted separately: the modernised messages of RINEX 4 (CNAV and its
//! kin), and other systems. References: [RINEX-2.11] table A4, [RINEX-3.05] tables A6, A8, A10,
//! A14, [RINEX-4.01] tables A8 to A18.
//!
//! [RINEX-2.11]: crate#references
//! [RINEX-3.05]: crate#references
//! [RINEX-4.01]: crate#references

use anyhow::{Context, Result, bail, ensure};
use raim_core::satellite::{Constellation, SatelliteId};

use super::glonass;
use super::header::Header;
use super::kepler::Record;
use super::text::{Lines, columns, is_labelled, number};
use crate::signal::calendar::{self, TimeSystem};
use crate::signal::measurement::TimedEphemeris;
use crate::signal::skipped::{Flaw, Skipped};

/// Number of lines of a record of Kepler elements.
const FULL: usize = 8;

/// Orbits and the ionosphere in a navigation file.
pub(super) struct Navigation {
    pub(super) ephemerides: Vec<TimedEphemeris>,
    pub(super) klobuchar: Option<[f64; 8]>,
    pub(super) skipped: Skipped,
}

/// Reads all records after the header; `skipped` has the flaws of the header.
///
/// # Errors
/// The file cannot be read to its end, or more than a tenth of it is lost.
pub(super) fn read(header: &Header, lines: &mut Lines, skipped: Skipped) -> Result<Navigation> {
    let klobuchar = header.klobuchar.coefficients();
    let mut navigation = Navigation { ephemerides: Vec::new(), klobuchar, skipped };
    while let Some(rows) = Rows::next(header, lines, &mut navigation.skipped) {
        navigation.take(header, &rows, lines);
    }
    lines.failure().map_or(Ok(()), Err)?;
    navigation.skipped.check(lines.count())?;
    Ok(navigation)
}

impl Navigation {
    fn take(&mut self, header: &Header, rows: &Rows, lines: &mut Lines) {
        let size = rows.size();
        match rows.read(header) {
            Ok(Content::Ephemeris(_)) if rows.is_cut => self.skipped.note(Flaw::Cut, rows.begin),
            Ok(Content::Ephemeris(ephemeris)) => self.ephemerides.push(*ephemeris),
            Ok(Content::Ionosphere(coefficients)) => self.klobuchar = Some(coefficients),
            Ok(Content::Other) => self.skipped.other_kinds += 1,
            Ok(Content::Unknown) => self.skipped.lose(Flaw::UnknownSatellite, rows.begin, size),
            Err(_) if lines.has_ended() && (rows.is_cut || rows.lines.len() < FULL) => {
                self.skipped.note(Flaw::Cut, rows.begin);
            }
            Err(_) => self.skipped.lose(Flaw::Damaged, rows.begin, size),
        }
    }
}

/// Lines of a record.
struct Rows {
    /// Number of the first line.
    begin: u64,
    /// Announcement of RINEX 4, such as `> EPH G05 LNAV`.
    announcement: Option<String>,
    lines: Vec<String>,
    /// True if the file ends inside a value of the last line.
    is_cut: bool,
}

/// Content of a record.
enum Content {
    Ephemeris(Box<TimedEphemeris>),
    /// GPS coefficients of the ionosphere.
    Ionosphere([f64; 8]),
    /// Kind or system that is not read.
    Other,
    /// Satellite that its system does not have.
    Unknown,
}

/// Columns of the satellite's name, of the date, and the first column of the rows that follow.
struct Layout {
    name: usize,
    date: usize,
    indent: usize,
}

impl Layout {
    /// Returns the layout of a version. RINEX 2 has the number alone and indents one column less.
    const fn of(header: &Header) -> Self {
        if header.version < 300 {
            Self { name: 2, date: 22, indent: 3 }
        } else {
            Self { name: 3, date: 23, indent: 4 }
        }
    }
}

impl Rows {
    /// Reads the lines of the next record; `None` at the end of the file.
    fn next(header: &Header, lines: &mut Lines, skipped: &mut Skipped) -> Option<Self> {
        let first = loop {
            let line = lines.next()?.to_owned();
            match () {
                () if line.trim().is_empty() => {}
                () if is_labelled(&line) => skipped.note(Flaw::Comment, lines.number()),
                () => break line,
            }
        };
        let Layout { name, indent, .. } = Layout::of(header);
        let mut rows = Self { begin: lines.number(), announcement: None, lines: Vec::new(), is_cut: false };
        let is_announced = first.starts_with('>');
        if is_announced {
            rows.announcement = Some(first);
        } else {
            rows.lines.push(first);
        }
        loop {
            let is_first = rows.lines.is_empty();
            let is_cut = lines.is_cut(indent, 19, 19);
            let belongs = |line: &str| {
                let is_row = columns(line, 0, name).is_empty() && !line.trim().is_empty();
                !line.starts_with('>') && (is_row || is_first) && !is_labelled(line)
            };
            if let Some(line) = lines.next_if(belongs) {
                rows.lines.push(line.to_owned());
                rows.is_cut = is_cut;
            } else if lines.next_if(is_labelled).is_some() {
                skipped.note(Flaw::Comment, lines.number());
            } else {
                while lines.next_if(|line| line.trim().is_empty()).is_some() {}
                return Some(rows);
            }
        }
    }

    /// Returns the number of lines of the record.
    fn size(&self) -> u64 {
        self.lines.len() as u64 + u64::from(self.announcement.is_some())
    }

    fn read(&self, header: &Header) -> Result<Content> {
        let mut words = self.announcement.as_deref().unwrap_or("> EPH - LNAV").split_ascii_whitespace();
        match (words.nth(1), words.next(), words.next()) {
            (Some("EPH"), _, Some("LNAV" | "INAV" | "FNAV" | "D1" | "D2" | "D1D2" | "FDMA")) => {
                self.ephemeris(header)
            }
            (Some("ION"), Some(name), Some("LNAV")) if name.starts_with('G') => self.ionosphere(),
            _ => Ok(Content::Other),
        }
    }

    /// Reads the coefficients of a RINEX 4 record: a date and three numbers, then rows of four.
    fn ionosphere(&self) -> Result<Content> {
        let rows =
            self.lines.iter().enumerate().map(|(row, line)| (line.as_str(), if row == 0 { 23 } else { 4 }));
        let values = values(rows)?;
        let coefficients = values.get(..8).and_then(|values| values.try_into().ok());
        coefficients.map(Content::Ionosphere).context("fewer than eight coefficients")
    }

    /// Reads the ephemeris in the lines.
    fn ephemeris(&self, header: &Header) -> Result<Content> {
        let Layout { name, date, indent } = Layout::of(header);
        let line = self.lines.first().map_or("", String::as_str);
        let label = columns(line, 0, name);
        let letter = match label.chars().next().context("no satellite")? {
            letter if letter.is_ascii_uppercase() => letter,
            // RINEX 2 files are of GPS unless their header names another system.
            '0'..='9' if header.version < 300 => {
                if header.system == 'R' {
                    'R'
                } else {
                    'G'
                }
            }
            _ => bail!("`{label}` is not a satellite"),
        };
        let number = label.trim_start_matches(letter).trim().parse()?;
        if !"GCERJ".contains(letter) {
            return Ok(Content::Other);
        }
        let Some(satellite) = SatelliteId::from_name(letter, number) else { return Ok(Content::Unknown) };
        let (system, sizes) = match satellite.constellation() {
            Constellation::Beidou => (TimeSystem::Beidou, FULL..=FULL),
            Constellation::Glonass => (TimeSystem::Utc { stated_s: header.leap_s }, 4..=5),
            _ => (TimeSystem::Gps, FULL..=FULL),
        };
        let size = self.lines.len();
        ensure!(sizes.contains(&size), "{satellite}: {size} lines, an ephemeris has {sizes:?}");
        let text = columns(line, name, date);
        let toc =
            calendar::instant(text, system).with_context(|| format!("`{text}` is not a date after 1980"))?;
        let rows = self.lines.iter().enumerate();
        let values = values(rows.map(|(row, line)| (line.as_str(), if row == 0 { date } else { indent })))?;
        let ephemeris = if letter == 'R' {
            glonass::check(&values).with_context(|| format!("{satellite}"))?;
            glonass::ephemeris(satellite, toc, calendar::leap_seconds(toc, header.leap_s), &values)
        } else {
            Record { satellite, toc, system, values }.timed()?
        };
        Ok(Content::Ephemeris(Box::new(ephemeris)))
    }
}

/// Returns the numbers of all rows, each from its column on; blank is zero.
fn values<'a>(rows: impl Iterator<Item = (&'a str, usize)>) -> Result<Vec<f64>> {
    let mut values = Vec::with_capacity(31);
    for (row, indent) in rows {
        let per_row = if values.is_empty() { 3 } else { 4 };
        for index in 0..per_row {
            let column = indent + 19 * index;
            values.push(number(columns(row, column, column + 19))?.unwrap_or(0.0));
        }
    }
    Ok(values)
}
