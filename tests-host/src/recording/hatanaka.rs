//! Compact RINEX back to RINEX: the inverse of the Hatanaka compression.
//!
//! Every line is coded against the one before it in the same role:
//!
//! - epoch line and quality flags: character differences. A blank keeps the old character, `&` means a blank now,
//!   anything else replaces.
//! - observations: integers of 0.001, differenced in time up to order `m ≤ 9`. `m&v` begins an arc of order `m` at
//!   the value `v`; a bare number is the newest difference; nothing means no observation and ends the arc.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `m` | `Arc::order` | — |
//! | `Δ⁰…Δᵐ` | `Arc::differences` | 0.001 of the observation's unit |
//!
//! Versions 1 (RINEX 2) and 3 (RINEX 3 and 4). Receiver clock offsets on the second line of an epoch are skipped.
//! References: [Hatanaka2008].
//!
//! [Hatanaka2008]: crate#references

use std::collections::HashMap;
use std::fmt::Write as _;

use anyhow::{Context, Result, bail};

use super::header::ObservationCodes;
use super::text::{Lines, columns};

/// The label of the first line of a compact file.
pub(super) const MARK: &str = "CRINEX VERS   / TYPE";

/// Highest order of differences the format allows.
const ORDER_LIMIT: usize = 9;

/// The RINEX text of a compact one.
pub(super) fn decompress(text: &str) -> Result<String> {
    let mut lines = Lines::of(text);
    let version = columns(lines.next().unwrap_or(""), 0, 20);
    let layout = match version.chars().next() {
        Some('1') => Layout::RINEX_2,
        Some('3') => Layout::RINEX_3,
        _ => bail!("line 1: compact RINEX `{version}` is not supported, only versions 1 and 3"),
    };
    let mut state = State { layout, ..State::default() };
    let mut output = String::with_capacity(text.len() * 4);
    lines.next();
    state.header(&mut lines, &mut output)?;
    while let Some(line) = lines.next() {
        let begin = lines.number();
        let epoch = state.epoch(line, &mut lines, &mut output);
        epoch.with_context(|| format!("line {}, epoch from line {begin}", lines.number()))?;
    }
    Ok(output)
}

/// Where things stand in an epoch line.
#[derive(Default)]
struct Layout {
    /// First character of an epoch line that is given in full.
    mark: char,
    /// Column of the event flag; the number of satellites follows in three columns.
    flag: usize,
    /// Column of the first satellite's name; all of them are on this one line.
    satellites: usize,
    /// Observations in a line of the output; none means all.
    per_line: Option<usize>,
}

impl Layout {
    const RINEX_2: Self = Self { mark: '&', flag: 28, satellites: 32, per_line: Some(5) };
    const RINEX_3: Self = Self { mark: '>', flag: 31, satellites: 41, per_line: None };
}

/// What the next line is coded against.
#[derive(Default)]
struct State {
    layout: Layout,
    codes: ObservationCodes,
    epoch: String,
    satellites: HashMap<String, Satellite>,
}

/// The running arcs of one satellite.
#[derive(Clone, Default)]
struct Satellite {
    arcs: Vec<Option<Arc>>,
    flags: String,
}

/// One observation's differences in time.
#[derive(Clone, Debug)]
struct Arc {
    order: usize,
    /// How many differences are known by now.
    known: usize,
    differences: [i64; ORDER_LIMIT + 1],
}

impl Arc {
    fn begin(order: usize, value: i64) -> Self {
        let mut differences = [0; ORDER_LIMIT + 1];
        differences[0] = value;
        Self { order, known: 0, differences }
    }

    /// Takes the newest difference and integrates it up to the value.
    fn extend(&mut self, difference: i64) {
        self.known = (self.known + 1).min(self.order);
        self.differences[self.known] = difference;
        for order in (0..self.known).rev() {
            self.differences[order] = self.differences[order].wrapping_add(self.differences[order + 1]);
        }
    }
}

impl State {
    /// The header is not coded.
    fn header(&mut self, lines: &mut Lines<'_>, output: &mut String) -> Result<()> {
        loop {
            let line = lines.within("the header")?;
            self.codes.read(line)?;
            let _ = writeln!(output, "{line}");
            if columns(line, 60, 80) == "END OF HEADER" {
                return Ok(());
            }
        }
    }

    /// One epoch: its line was read, the others follow.
    fn epoch(&mut self, line: &str, lines: &mut Lines<'_>, output: &mut String) -> Result<()> {
        if line.starts_with(self.layout.mark) {
            self.epoch.clear();
            self.satellites.clear();
        }
        update(&mut self.epoch, line);
        let field = |from: usize, to: usize| self.epoch.get(from..to).unwrap_or("").trim();
        let flag = field(self.layout.flag, self.layout.flag + 1);
        let count = field(self.layout.flag + 1, self.layout.flag + 4);
        let count: usize =
            count.parse().with_context(|| format!("`{count}` is not a number of satellites"))?;
        if !matches!(flag, "0" | "1" | "") {
            return self.event(count, lines, output);
        }
        let names = self.names(count)?;
        self.write_epoch_line(&names, output);
        // The receiver's clock offset.
        lines.within("an epoch")?;
        let mut seen = HashMap::with_capacity(count);
        for name in names {
            let line = lines.within("an epoch")?;
            let mut satellite = self.satellites.remove(&name).unwrap_or_default();
            let kinds = self.codes.of(name.chars().next().unwrap_or(' '))?.len();
            satellite.update(line, kinds).with_context(|| format!("satellite {name}"))?;
            satellite.write(&name, &self.layout, output);
            seen.insert(name, satellite);
        }
        // An arc ends where its satellite is missing for an epoch.
        self.satellites = seen;
        Ok(())
    }

    /// An event carries header lines, which are not coded.
    fn event(&mut self, count: usize, lines: &mut Lines<'_>, output: &mut String) -> Result<()> {
        let _ = writeln!(output, "{}", self.epoch.trim_end());
        for _ in 0..count {
            let line = lines.within("an event")?;
            self.codes.read(line)?;
            let _ = writeln!(output, "{line}");
        }
        Ok(())
    }

    fn names(&self, count: usize) -> Result<Vec<String>> {
        let name = |index: usize| {
            let from = self.layout.satellites + 3 * index;
            self.epoch.get(from..from + 3).map(str::to_owned)
        };
        (0..count)
            .map(|index| name(index).with_context(|| format!("{count} satellites announced, {index} named")))
            .collect()
    }

    fn write_epoch_line(&self, names: &[String], output: &mut String) {
        let start = self.epoch.get(..self.layout.satellites).unwrap_or(&self.epoch);
        if self.layout.per_line.is_none() {
            let _ = writeln!(output, "{}", start.trim_end());
            return;
        }
        // RINEX 2 names the satellites here, twelve to a line.
        let mut start = start.to_owned();
        for chunk in names.chunks(12) {
            let _ = writeln!(output, "{start:32}{}", chunk.concat());
            start.clear();
        }
    }
}

impl Satellite {
    /// Takes one coded line: as many observations as there are kinds, then the differences of their flags.
    fn update(&mut self, line: &str, kinds: usize) -> Result<()> {
        self.arcs.resize(kinds, None);
        let mut rest = line;
        for arc in &mut self.arcs {
            let (word, tail) = rest.split_once(' ').unwrap_or((rest, ""));
            *arc = next_arc(arc.take(), word)?;
            rest = tail;
        }
        update(&mut self.flags, rest);
        Ok(())
    }

    /// The RINEX lines of the satellite.
    fn write(&self, name: &str, layout: &Layout, output: &mut String) {
        let per_line = layout.per_line.unwrap_or(self.arcs.len()).max(1);
        if layout.per_line.is_none() {
            output.push_str(name);
        }
        for (index, arc) in self.arcs.iter().enumerate() {
            if index > 0 && index % per_line == 0 {
                output.push('\n');
            }
            let flags = self.flags.get(2 * index..).unwrap_or("");
            let flags = flags.get(..2).unwrap_or(flags);
            match arc {
                Some(arc) => {
                    let value = arc.differences[0];
                    let (sign, size) = (if value < 0 { "-" } else { "" }, value.unsigned_abs());
                    let number = format!("{sign}{}.{:03}", size / 1000, size % 1000);
                    let _ = write!(output, "{number:>14}{flags:<2}");
                }
                None => output.push_str("                "),
            }
        }
        output.push('\n');
    }
}

/// What an arc becomes by the word of the next epoch.
fn next_arc(arc: Option<Arc>, word: &str) -> Result<Option<Arc>> {
    if word.is_empty() {
        return Ok(None);
    }
    if let Some((order, value)) = word.split_once('&') {
        let order = order.parse().ok().filter(|order| *order <= ORDER_LIMIT);
        let order =
            order.with_context(|| format!("`{word}` does not begin with an order of 0 to {ORDER_LIMIT}"))?;
        return Ok(Some(Arc::begin(order, integer(value)?)));
    }
    let mut arc = arc.with_context(|| format!("`{word}` continues an observation that never began"))?;
    arc.extend(integer(word)?);
    Ok(Some(arc))
}

fn integer(word: &str) -> Result<i64> {
    word.parse().with_context(|| format!("`{word}` is not an integer"))
}

/// Applies character differences.
fn update(text: &mut String, differences: &str) {
    let old = std::mem::take(text);
    let mut old = old.chars();
    for difference in differences.chars() {
        let kept = old.next().unwrap_or(' ');
        text.push(match difference {
            ' ' => kept,
            '&' => ' ',
            new => new,
        });
    }
    text.extend(old);
}
