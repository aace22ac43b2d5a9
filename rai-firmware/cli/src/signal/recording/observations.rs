//! Observation records, converted to epochs one at a time: RINEX 2 in one layout, RINEX 3 and 4 in
//! another.
//!
//! | | RINEX 2 | RINEX 3, 4 |
//! |---|---|---|
//! | satellites | named in the epoch line, twelve to a line | each before its own line |
//! | fields (14 columns of value, 2 of flags) | five to a line | all in one line |
//! | codes | `C1`, `P2`: band only | `C1C`, `C2W`: band and attribute |
//! | a line is missing or one too many | costs the epoch, because lines carry no names | costs its satellite |
//!
//! The reader keeps the systems that RAI supports, and their satellites with a pseudorange. Epochs
//! of events (new site, header lines, cycle slips) have no ranges; header lines inside and outside
//! them are obeyed. References: [RINEX-2.11] table A2, [RINEX-3.05] table A3.
//!
//! [RINEX-2.11]: crate#references
//! [RINEX-3.05]: crate#references

use std::io::BufRead;
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};
use raim_core::frame::Ecef;
use raim_firmware::time::GpsTime;

use super::file;
use super::header::{Header, Kind};
use super::signals::{Fields, Read, satellite};
use super::text::{Lines, columns, is_labelled};
use crate::signal::calendar::{self, TimeSystem};
use crate::signal::measurement::{MeasuredEpoch, MeasuredSatellite};
use crate::signal::skipped::{Flaw, Skipped};

/// Columns of a field, and of the value in it.
const FIELD: usize = 16;
const VALUE: usize = 14;

/// Epochs of one observation file, read one at a time.
///
/// Unreadable records are skipped and counted. The last item is an error if the file cannot be read
/// to its end, or if more than a tenth of its lines was lost.
pub struct Observations {
    name: String,
    header: Header,
    fields: Fields,
    lines: Lines,
    skipped: Skipped,
    /// Number of the line with which the last epoch begins.
    begin: u64,
    has_ended: bool,
}

/// Beginning of an epoch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Opening {
    /// Event flag: 0 and 1 are ranges, 6 are cycle slips in the form of ranges, others are header
    /// lines.
    flag: u8,
    /// Time of the epoch; `None` for an event without one.
    time: Option<GpsTime>,
    /// Number of satellites or header lines.
    count: usize,
}

impl Opening {
    const CYCLE_SLIPS: u8 = 6;

    fn has_ranges(self) -> bool {
        matches!(self.flag, 0 | 1 | Self::CYCLE_SLIPS)
    }
}

impl Observations {
    /// Opens a file: plain, gzip, compact, or compact in gzip.
    ///
    /// # Errors
    /// The file is missing, packed in another format, or not RINEX observations, or its header
    /// cannot be read.
    pub fn open(path: &Path) -> Result<Self> {
        let name = path.display().to_string();
        let place = || format!("observation file {name}");
        let opened = file::open(path).and_then(|lines| Self::read(&name, lines));
        opened.with_context(place)
    }

    /// Opens the bytes of such a file, whose name in errors is `name`.
    ///
    /// # Errors
    /// As for [`Observations::open`].
    pub fn of(name: &str, input: impl BufRead + Send + 'static) -> Result<Self> {
        let opened = file::lines(input, name).and_then(|lines| Self::read(name, lines));
        opened.with_context(|| format!("observation file {name}"))
    }

    fn read(name: &str, mut lines: Lines) -> Result<Self> {
        let mut skipped = Skipped::default();
        let header = Header::read(&mut lines, &mut skipped)?;
        if header.kind == Kind::Navigation {
            bail!("holds ephemerides: give it as navigation file");
        }
        let fields = Fields::of(&header);
        Ok(Self { name: name.to_owned(), header, fields, lines, skipped, begin: 0, has_ended: false })
    }

    /// Returns the antenna's position in the header; in some files it is wrong by hundreds of
    /// metres.
    pub fn approximate_position(&self) -> Option<Ecef> {
        self.header.approximate_position
    }

    /// Returns the records skipped so far.
    pub fn skipped(&self) -> Skipped {
        let mut skipped = self.skipped.clone();
        skipped.add(&self.lines.skipped());
        skipped.named(&self.name)
    }

    /// Counts an epoch that is not later than the one before.
    pub(super) fn discard(&mut self, line: u64, epoch: &MeasuredEpoch) {
        self.skipped.lose(Flaw::OutOfOrder, line, 1 + epoch.satellites.len() as u64);
    }

    /// Returns the number of the line that the last epoch begins with.
    pub(super) fn line(&self) -> u64 {
        self.begin
    }

    /// Checks at the end that the whole file was read, and that not too much was lost.
    fn end(&mut self) -> Option<Result<MeasuredEpoch>> {
        if std::mem::replace(&mut self.has_ended, true) {
            return None;
        }
        let name = &self.name;
        let failed = self.lines.failure();
        let skipped = self.skipped();
        let lines = self.lines.count() + self.lines.skipped().lost_lines;
        let checked = failed.map_or_else(|| skipped.check(lines), Err);
        checked.with_context(|| format!("observation file {name}")).err().map(Err)
    }

    /// Takes a line that begins no record: a blank, comment or header line, or a damaged one.
    fn stray(&mut self) {
        let (begin, is_version_2) = (self.lines.number(), self.header.version < 300);
        let time_system = self.header.time_system;
        let mut lost = 1;
        while self.lines.next_if(|line| !begins(line, is_version_2, time_system)).is_some() {
            lost += 1;
        }
        self.skipped.lose(Flaw::Damaged, begin, lost);
    }

    /// Skips comments and header lines, and obeys them. A header of another version ends the file,
    /// because the lines after it have another layout.
    fn skip_labelled(&mut self) {
        while let Some(line) = self.lines.next_if(is_labelled) {
            let version = Header::version(line);
            let is_list = self.header.codes.read(line);
            let number = self.lines.number();
            self.skipped.note(if is_list.is_ok() { Flaw::Comment } else { Flaw::Damaged }, number);
            self.fields = Fields::of(&self.header);
            if version.is_some_and(|version| version != self.header.version) {
                self.lines.fail(anyhow!("line {number}: a header of another version: split the file there"));
            }
        }
    }

    /// Takes the header lines of an event.
    fn event(&mut self, count: usize) {
        let (is_version_2, time_system) = (self.header.version < 300, self.header.time_system);
        for _ in 0..count {
            let Some(line) = self.lines.next_if(|line| !begins_epoch(line, is_version_2, time_system)) else {
                let flaw = if self.lines.peek().is_some() { Flaw::Damaged } else { Flaw::Cut };
                self.skipped.note(flaw, self.lines.number());
                break;
            };
            let is_header = has_label(line) && self.header.codes.read(line).is_ok();
            if !is_header {
                self.skipped.lose(Flaw::Damaged, self.lines.number(), 1);
            }
        }
        self.fields = Fields::of(&self.header);
    }

    /// Returns the satellites of an epoch of RINEX 3 and 4; `None` if the file ends inside it.
    fn satellites_3(&mut self, count: usize) -> Option<Vec<MeasuredSatellite>> {
        let begin = self.lines.number();
        let mut satellites = Vec::with_capacity(count.min(100));
        for read in 0..count {
            self.skip_labelled();
            match self.lines.peek() {
                None => return self.cut(begin),
                Some(line) if line.starts_with('>') => {
                    self.skipped.lose(Flaw::Damaged, begin, (count - read) as u64);
                    break;
                }
                Some(_) => {}
            }
            if self.lines.is_cut(3, FIELD, VALUE) {
                return self.cut(begin);
            }
            let Some(line) = self.lines.next() else { break };
            let (name, values) = (columns(line, 0, 3), line.get(3..).unwrap_or(""));
            let read = satellite(name, values, &self.header, &self.fields);
            self.keep(read, 1, &mut satellites);
        }
        Some(satellites)
    }

    /// Counts an epoch that the end of the file cuts, and takes the rest of it.
    fn cut<T>(&mut self, line: u64) -> Option<T> {
        while self.lines.next().is_some() {}
        self.skipped.note(Flaw::Cut, line);
        None
    }

    /// Keeps a satellite, or counts the reason for which it is dropped.
    fn keep(&mut self, read: Read, lines: u64, satellites: &mut Vec<MeasuredSatellite>) {
        let number = self.lines.number();
        match read {
            Read::Satellite(measured, damaged) => {
                (0..damaged).for_each(|_| self.skipped.note(Flaw::Damaged, number));
                if satellites.iter().any(|other| other.satellite == measured.satellite) {
                    self.skipped.lose(Flaw::Damaged, number, lines);
                } else if !measured.signals.is_empty() {
                    satellites.push(measured);
                }
            }
            Read::OtherSystem | Read::Unlisted => self.skipped.other_kinds += 1,
            Read::Unknown => self.skipped.lose(Flaw::UnknownSatellite, number, lines),
            Read::Damaged => self.skipped.lose(Flaw::Damaged, number, lines),
        }
    }

    /// Returns the satellites of an epoch of RINEX 2; `None` if the file ends inside it or its
    /// lines do not fit.
    fn satellites_2(&mut self, count: usize) -> Option<Vec<MeasuredSatellite>> {
        let (begin, counted) = (self.lines.number(), self.lines.count());
        let names = self.names_2(count)?;
        let height = self.header.codes.of('G').map_or(0, <[String]>::len).div_ceil(5);
        let time_system = self.header.time_system;
        let mut satellites = Vec::with_capacity(count.min(100));
        let mut flaws = Skipped::default();
        std::mem::swap(&mut flaws, &mut self.skipped);
        let mut is_whole = true;
        for name in names {
            let mut values = String::with_capacity(80 * height);
            for _ in 0..height {
                if self.lines.peek().is_none() || self.lines.is_cut(0, FIELD, VALUE) {
                    self.skipped = flaws;
                    return self.cut(begin);
                }
                let Some(line) = self.lines.next_if(|line| !begins_epoch(line, true, time_system)) else {
                    is_whole = false;
                    break;
                };
                // Five fields of 16 columns; trailing blanks may have been cut.
                let line = line.get(..80).unwrap_or(line);
                values.push_str(line);
                values.extend(std::iter::repeat_n(' ', 80 - line.len()));
            }
            if !is_whole {
                break;
            }
            let read = satellite(&name, &values, &self.header, &self.fields);
            self.keep(read, height as u64, &mut satellites);
        }
        is_whole = is_whole && self.lines.peek().is_none_or(|line| begins(line, true, time_system));
        std::mem::swap(&mut flaws, &mut self.skipped);
        if is_whole {
            self.skipped.add(&flaws);
            return Some(satellites);
        }
        // The names come first. If a line is missing or one too many, satellites would get their
        // neighbours' ranges.
        self.skipped.lose(Flaw::Damaged, begin, 1 + self.lines.count() - counted);
        None
    }

    /// Returns the names in the epoch line and its continuations.
    fn names_2(&mut self, count: usize) -> Option<Vec<String>> {
        let begin = self.lines.number();
        let mut line = self.lines.current().to_owned();
        let mut names = Vec::with_capacity(count.min(100));
        for index in 0..count {
            if index > 0 && index % 12 == 0 {
                let Some(next) = self.lines.next_if(|line| columns(line, 0, 32).is_empty()) else {
                    if self.lines.peek().is_none() {
                        return self.cut(begin);
                    }
                    self.stray();
                    return None;
                };
                next.clone_into(&mut line);
            }
            let column = 32 + 3 * (index % 12);
            names.push(line.get(column..(column + 3).min(line.len())).unwrap_or("").to_owned());
        }
        Some(names)
    }
}

impl Iterator for Observations {
    type Item = Result<MeasuredEpoch>;

    fn next(&mut self) -> Option<Self::Item> {
        let (is_version_2, time_system) = (self.header.version < 300, self.header.time_system);
        loop {
            self.skip_labelled();
            let Some(line) = self.lines.next() else { return self.end() };
            if line.trim().is_empty() {
                continue;
            }
            let Some(opening) = opening(line, is_version_2, time_system) else {
                self.stray();
                continue;
            };
            let Some(time) = opening.time.filter(|_| opening.has_ranges()) else {
                self.event(opening.count);
                continue;
            };
            self.begin = self.lines.number();
            let satellites = if is_version_2 {
                self.satellites_2(opening.count)
            } else {
                self.satellites_3(opening.count)
            };
            if opening.flag == Opening::CYCLE_SLIPS {
                self.skipped.other_kinds += 1 + satellites.map_or(0, |satellites| satellites.len() as u64);
                continue;
            }
            if let Some(satellites) = satellites {
                return Some(Ok(MeasuredEpoch { time, satellites }));
            }
        }
    }
}

/// Returns true for lines with letters where a header line has its label, known or not; data lines
/// have none there.
fn has_label(line: &str) -> bool {
    columns(line, 60, 80).contains(|letter: char| letter.is_ascii_alphabetic())
}

/// Returns true for lines that may follow a record.
fn begins(line: &str, is_version_2: bool, time_system: TimeSystem) -> bool {
    line.trim().is_empty() || is_labelled(line) || begins_epoch(line, is_version_2, time_system)
}

/// Returns true for lines that begin an epoch, in RINEX 3 by their first character, damaged or not.
fn begins_epoch(line: &str, is_version_2: bool, time_system: TimeSystem) -> bool {
    if is_version_2 { opening(line, true, time_system).is_some() } else { line.starts_with('>') }
}

/// Returns the content of an epoch line; `None` for another line.
fn opening(line: &str, is_version_2: bool, time_system: TimeSystem) -> Option<Opening> {
    if line.starts_with('>') == is_version_2 {
        return None;
    }
    let (date, column) = if is_version_2 { (0..26, 28) } else { (1..29, 31) };
    let digit = columns(line, column, column + 1);
    let flag = if digit.is_empty() { 0 } else { digit.parse().ok().filter(|flag| *flag <= 6)? };
    let count = columns(line, column + 1, column + 4).parse().ok()?;
    let date = columns(line, date.start, date.end);
    let time = calendar::instant(date, time_system);
    let opening = Opening { flag, time, count };
    let is_dated = time.is_some() || (date.is_empty() && !opening.has_ranges());
    is_dated.then_some(opening)
}
