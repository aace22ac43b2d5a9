//! Decoder of compact RINEX: the inverse of the Hatanaka compression.
//!
//! Every line is coded against the one before it in the same role:
//!
//! - epoch line and quality flags: character differences. A blank keeps the old character, `&`
//!   means a blank now, anything else replaces.
//! - observations: integers of 0.001, differenced in time up to order `m ≤ 9`. `m&v` begins an arc
//!   of order `m` at the value `v`; a bare number is the newest difference; nothing means no
//!   observation and ends the arc.
//!
//! Versions 1 (RINEX 2) and 3 (RINEX 3 and 4). Receiver clock offsets on the second line of an
//! epoch are skipped.
//!
//! Damage in a satellite's line costs that satellite until each of its arcs begins again. A line
//! that is missing or one too many would give each following satellite the ranges of its neighbour.
//! The decoder therefore checks every epoch line. If the line is no epoch after the one before, it
//! discards the epoch before, too, and everything up to the next epoch line that is given in full.
//! References: [Hatanaka2008].
//!
//! [Hatanaka2008]: crate#references

use std::collections::{HashMap, VecDeque};

use anyhow::{Context, Result, bail, ensure};
use raim_firmware::time::GpsTime;

use super::arcs::{Satellite, integer, update};
use super::header::ObservationCodes;
use super::text::{Source, columns, label};
use crate::signal::calendar::{self, TimeSystem};
use crate::signal::skipped::{Flaw, Skipped};

/// Label of the first line of a compact file.
pub(super) const MARK: &str = "CRINEX VERS   / TYPE";

/// Columns of an epoch line.
struct Layout {
    /// First character of an epoch line that is given in full.
    mark: char,
    /// First character of every RINEX epoch line.
    begins: char,
    /// Columns of the date.
    date: std::ops::Range<usize>,
    /// Column of the event flag; the number of satellites follows in three columns.
    flag: usize,
    /// Column of the first satellite's name; all of them are on this one line.
    satellites: usize,
    /// Observations in a line of the output; `None` for all.
    per_line: Option<usize>,
}

impl Layout {
    const RINEX_2: Self =
        Self { mark: '&', begins: ' ', date: 0..26, flag: 28, satellites: 32, per_line: Some(5) };
    const RINEX_3: Self =
        Self { mark: '>', begins: '>', date: 1..29, flag: 31, satellites: 41, per_line: None };
}

/// Source of RINEX lines from compact ones.
pub(super) struct Compact {
    source: Box<dyn Source>,
    /// Last line read, and its number.
    line: String,
    number: u64,
    state: State,
    is_header: bool,
    /// True if lines are skipped up to the next epoch line in full.
    is_lost: bool,
    /// Last epoch, held until the line after it proves to be an epoch line.
    held: Held,
    ready: VecDeque<(u64, String)>,
    skipped: Skipped,
}

/// RINEX lines of an epoch, and the number of compact lines that they come from.
#[derive(Default)]
struct Held {
    begin: u64,
    compact_lines: u64,
    output: Vec<(u64, String)>,
}

/// State that the next line is coded against.
struct State {
    layout: &'static Layout,
    codes: ObservationCodes,
    epoch: String,
    time: Option<GpsTime>,
    satellites: HashMap<String, Satellite>,
}

/// Checked epoch line.
enum Opening {
    /// Ranges of these satellites follow.
    Ranges(Vec<String>),
    /// This number of header lines follows.
    Event(usize),
}

impl Compact {
    /// Returns a decoder behind the first line, which names the version.
    pub(super) fn new(source: Box<dyn Source>, first: &str) -> Result<Self> {
        let version = columns(first, 0, 20);
        let layout = match version.chars().next() {
            Some('1') => &Layout::RINEX_2,
            Some('3') => &Layout::RINEX_3,
            _ => bail!("line 1: compact RINEX `{version}` is not supported, only versions 1 and 3"),
        };
        let state = State {
            layout,
            codes: ObservationCodes::default(),
            epoch: String::new(),
            time: None,
            satellites: HashMap::new(),
        };
        let mut compact = Self {
            source,
            line: String::new(),
            number: 1,
            state,
            is_header: true,
            is_lost: false,
            held: Held::default(),
            ready: VecDeque::new(),
            skipped: Skipped::default(),
        };
        // The second line names the program.
        compact.next()?;
        Ok(compact)
    }

    /// Reads the next compact line; false at the end.
    fn next(&mut self) -> Result<bool> {
        let number = self.source.read(&mut self.line)?;
        self.number = number.unwrap_or(self.number);
        Ok(number.is_some())
    }

    /// Decodes one more epoch, and releases the one before; false at the end.
    fn advance(&mut self) -> Result<bool> {
        if !self.next()? {
            return Ok(self.release());
        }
        let is_full = self.line.starts_with(self.state.layout.mark);
        if self.is_lost && !is_full {
            self.skipped.lost_lines += 1;
            return Ok(true);
        }
        if self.line.trim().is_empty() && !is_full {
            return self.blank();
        }
        let Some(opening) = self.state.open(&self.line, is_full) else {
            self.lose(1);
            return Ok(true);
        };
        self.release();
        self.is_lost = false;
        self.held = Held { begin: self.number, compact_lines: 1, output: Vec::new() };
        match opening {
            Opening::Event(count) => self.event(count)?,
            Opening::Ranges(names) => self.ranges(&names)?,
        }
        Ok(true)
    }

    /// Accepts blank lines at the end of the file and nowhere else.
    fn blank(&mut self) -> Result<bool> {
        let begin = self.number;
        while self.next()? {
            if !self.line.trim().is_empty() {
                self.lose(self.number - begin + 1);
                return Ok(true);
            }
        }
        Ok(self.release())
    }

    /// Makes the last epoch's lines ready; false if there are none.
    fn release(&mut self) -> bool {
        let held = std::mem::take(&mut self.held);
        self.ready.extend(held.output);
        !self.ready.is_empty()
    }

    /// Discards the last epoch and this number of lines more, and begins to search for an epoch
    /// line in full.
    fn lose(&mut self, lines: u64) {
        let held = std::mem::take(&mut self.held);
        let begin = if held.compact_lines > 0 { held.begin } else { self.number };
        self.skipped.lose(Flaw::Damaged, begin, held.compact_lines + lines);
        self.is_lost = true;
    }

    /// Discards an epoch that the file's end cuts.
    fn cut(&mut self) {
        let held = std::mem::take(&mut self.held);
        self.skipped.note(Flaw::Cut, held.begin);
    }

    /// Copies the header lines of an event, which are not coded.
    fn event(&mut self, count: usize) -> Result<()> {
        self.held.output.push((self.number, self.state.epoch.trim_end().to_owned()));
        for _ in 0..count {
            if !self.next()? {
                self.cut();
                return Ok(());
            }
            self.held.compact_lines += 1;
            // The reader of the RINEX lines reports their errors.
            let _ = self.state.codes.read(&self.line);
            self.held.output.push((self.number, self.line.clone()));
        }
        Ok(())
    }

    /// Decodes the clock's line and that of each satellite.
    fn ranges(&mut self, names: &[String]) -> Result<()> {
        let mut known = Vec::with_capacity(names.len());
        let (mut output, mut seen) = (Vec::with_capacity(names.len()), HashMap::with_capacity(names.len()));
        if !self.within()? {
            return Ok(());
        }
        if !is_clock(&self.line) {
            self.lose(0);
            return Ok(());
        }
        for name in names {
            if !self.within()? {
                return Ok(());
            }
            let mut satellite = self.state.satellites.remove(name).unwrap_or_default();
            let kinds = self.state.codes.of(name.chars().next().unwrap_or(' ')).unwrap_or_default();
            let flaws = satellite.update(&self.line, kinds.len());
            if flaws > 0 {
                self.skipped.note(Flaw::Damaged, self.number);
            }
            if flaws > 0 && !satellite.has_range(kinds) {
                self.skipped.lost_lines += 1;
            } else {
                known.push(name.as_str());
                satellite.write(name, self.state.layout.per_line, self.number, &mut output);
            }
            seen.insert(name.clone(), satellite);
        }
        self.held.output.extend(self.state.epoch_lines(self.held.begin, &known));
        self.held.output.append(&mut output);
        // An arc ends if its satellite is missing for an epoch.
        self.state.satellites = seen;
        Ok(())
    }

    /// Reads a line of an epoch. If the file ends, or the line may be cut, the epoch is discarded.
    fn within(&mut self) -> Result<bool> {
        let is_whole = self.next()? && !self.source.is_open();
        if is_whole {
            self.held.compact_lines += 1;
        } else {
            self.cut();
        }
        Ok(is_whole)
    }

    /// Copies a line of the header, which is not coded.
    fn header(&mut self) -> Result<()> {
        ensure!(self.next()?, "END OF HEADER is missing");
        self.state.codes.read(&self.line).with_context(|| format!("line {}", self.number))?;
        self.is_header = label(&self.line) != "END OF HEADER";
        self.ready.push_back((self.number, self.line.clone()));
        Ok(())
    }
}

impl Source for Compact {
    fn read(&mut self, line: &mut String) -> Result<Option<u64>> {
        loop {
            if let Some((number, text)) = self.ready.pop_front() {
                *line = text;
                return Ok(Some(number));
            }
            if self.is_header {
                self.header()?;
            } else if !self.advance()? {
                return Ok(None);
            }
        }
    }

    /// Returns false, because an epoch whose last line may be cut is discarded here.
    fn is_open(&self) -> bool {
        false
    }

    fn skipped(&self) -> Skipped {
        let mut skipped = self.skipped.clone();
        skipped.add(&self.source.skipped());
        skipped
    }
}

/// Returns true for a valid line of the receiver's clock offset: one coded number, or nothing.
fn is_clock(line: &str) -> bool {
    let word = line.trim();
    let is_part = |part: &str| part.is_empty() || integer(part).is_some();
    word.split('&').count() <= 2 && word.split('&').all(is_part)
}

impl State {
    /// Applies an epoch line; `None` if the result is not an epoch that may follow the last one.
    fn open(&mut self, line: &str, is_full: bool) -> Option<Opening> {
        if is_full {
            self.epoch.clear();
            self.satellites.clear();
        }
        update(&mut self.epoch, line);
        let field = |from: usize, to: usize| columns(&self.epoch, from, to);
        let flag = self.layout.flag;
        let count: usize = field(flag + 1, flag + 4).parse().ok()?;
        if !self.epoch.starts_with(self.layout.begins) {
            return None;
        }
        match field(flag, flag + 1) {
            "2" | "3" | "4" | "5" => return Some(Opening::Event(count)),
            "0" | "1" | "6" | "" => {}
            _ => return None,
        }
        let date = field(self.layout.date.start, self.layout.date.end);
        let time = calendar::instant(date, TimeSystem::Gps)?;
        let is_later = self.time.is_none_or(|last| time > last);
        if !is_later && !is_full {
            return None;
        }
        let names = self.names(count)?;
        self.time = Some(time);
        Some(Opening::Ranges(names))
    }

    /// Returns the names of the satellites; `None` if there are more or fewer than announced.
    fn names(&self, count: usize) -> Option<Vec<String>> {
        let name = |index: usize| {
            let from = self.layout.satellites + 3 * index;
            self.epoch.get(from..from + 3).filter(|name| is_name(name)).map(str::to_owned)
        };
        let end = self.layout.satellites + 3 * count;
        let rest = self.epoch.get(end..)?;
        (0..count).map(name).collect::<Option<_>>().filter(|_| rest.trim().is_empty())
    }

    /// Returns the epoch line in RINEX, with the known satellites.
    fn epoch_lines(&self, number: u64, names: &[&str]) -> Vec<(u64, String)> {
        let flag = self.layout.flag;
        let count = format!("{:3}", names.len());
        let epoch = self.epoch.get(..self.layout.satellites).unwrap_or(&self.epoch);
        let parts = (epoch.get(..=flag), epoch.get(flag + 4..));
        let start = parts.0.unwrap_or(epoch).to_owned() + &count + parts.1.unwrap_or("");
        if self.layout.per_line.is_none() {
            return vec![(number, start.trim_end().to_owned())];
        }
        // RINEX 2 names the satellites here, twelve to a line.
        let mut lines = Vec::new();
        let mut start = start.as_str();
        for chunk in names.chunks(12) {
            lines.push((number, format!("{start:32}{}", chunk.concat())));
            start = "";
        }
        if names.is_empty() {
            lines.push((number, start.to_owned()));
        }
        lines
    }
}

/// Returns true for a letter and two digits, of which the first may be blank; RINEX 2 may leave out
/// the letter.
fn is_name(name: &str) -> bool {
    let mut letters = name.chars();
    letters.next().is_some_and(|letter| letter.is_ascii_uppercase() || letter == ' ')
        && letters.next().is_some_and(|tens| tens.is_ascii_digit() || tens == ' ')
        && letters.next().is_some_and(|ones| ones.is_ascii_digit())
}
