//! Lines of a file one at a time, with their numbers, and the text in their columns.

use std::io::{BufRead, ErrorKind, Read as _};

use anyhow::{Context, Error, Result, ensure};

use crate::signal::skipped::{Flaw, Skipped};

/// Longest line of a text file, bytes.
const LINE_LIMIT: u64 = 1 << 16;

/// Source of lines.
pub(super) trait Source: Send {
    /// Replaces `line` by the next line and returns its number in the file from 1; `None` at the
    /// end.
    fn read(&mut self, line: &mut String) -> Result<Option<u64>>;

    /// Returns true if the line that was read last has no line end, so that it may be cut.
    fn is_open(&self) -> bool;

    /// Returns the records that the source itself skipped so far.
    fn skipped(&self) -> Skipped;
}

/// Lines of a byte stream as they are.
///
/// Bytes outside ASCII (names in comments) become `?`, so that every column stays in place. A byte
/// order mark before the first line is dropped.
pub(super) struct Plain<R> {
    input: R,
    /// The error if the input cannot be read.
    failure: &'static str,
    number: u64,
    is_open: bool,
    skipped: Skipped,
}

impl<R: BufRead + Send> Plain<R> {
    pub(super) fn new(input: R, failure: &'static str) -> Self {
        Self { input, failure, number: 0, is_open: false, skipped: Skipped::default() }
    }
}

impl<R: BufRead + Send> Source for Plain<R> {
    fn read(&mut self, line: &mut String) -> Result<Option<u64>> {
        const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";
        let mut bytes = std::mem::take(line).into_bytes();
        bytes.clear();
        let read = self.input.by_ref().take(LINE_LIMIT).read_until(b'\n', &mut bytes);
        match read {
            // A gzip file that is cut off: its last line is there as far as it goes.
            Err(error) if error.kind() == ErrorKind::UnexpectedEof && self.number > 0 => {
                self.skipped.note(Flaw::Cut, self.number + 1);
            }
            read => drop(read.context(self.failure)?),
        }
        if bytes.is_empty() {
            return Ok(None);
        }
        self.number += 1;
        self.is_open = bytes.last() != Some(&b'\n');
        ensure!(
            !self.is_open || (bytes.len() as u64) < LINE_LIMIT,
            "line {} has {LINE_LIMIT} bytes or more, which no RINEX line has",
            self.number
        );
        if self.number == 1 && bytes.starts_with(BYTE_ORDER_MARK) {
            self.skipped.note(Flaw::HeaderField, self.number);
            bytes.drain(..BYTE_ORDER_MARK.len());
        }
        bytes.pop_if(|last| *last == b'\n');
        bytes.pop_if(|last| *last == b'\r');
        if !bytes.is_ascii() {
            bytes.iter_mut().filter(|byte| !byte.is_ascii()).for_each(|byte| *byte = b'?');
        }
        *line = String::from_utf8(bytes)?;
        Ok(Some(self.number))
    }

    fn is_open(&self) -> bool {
        self.is_open
    }

    fn skipped(&self) -> Skipped {
        self.skipped.clone()
    }
}

/// A line and its number.
#[derive(Default)]
struct Line {
    text: String,
    number: u64,
}

/// Lines of a source, with one line of look-ahead.
///
/// An error of the source ends the lines; [`Lines::failure`] returns it.
pub(super) struct Lines {
    source: Box<dyn Source>,
    current: Line,
    ahead: Line,
    has_ahead: bool,
    has_ended: bool,
    failure: Option<Error>,
    count: u64,
}

impl Lines {
    /// Returns lines that begin with one that was read before, and its number.
    pub(super) fn new(source: Box<dyn Source>, first: String, number: u64) -> Self {
        Self {
            source,
            current: Line::default(),
            ahead: Line { text: first, number },
            has_ahead: true,
            has_ended: false,
            failure: None,
            count: 0,
        }
    }

    /// Returns the number of the current line in the file, from 1.
    pub(super) fn number(&self) -> u64 {
        self.current.number
    }

    /// Returns the number of lines that [`Lines::next`] returned.
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Returns the records that the source skipped so far.
    pub(super) fn skipped(&self) -> Skipped {
        self.source.skipped()
    }

    /// Returns the next line; `None` at the end.
    pub(super) fn next(&mut self) -> Option<&str> {
        self.look();
        if !self.has_ahead {
            return None;
        }
        std::mem::swap(&mut self.current, &mut self.ahead);
        self.has_ahead = false;
        self.count += 1;
        Some(&self.current.text)
    }

    /// Returns the next line without taking it.
    pub(super) fn peek(&mut self) -> Option<&str> {
        self.look();
        self.has_ahead.then_some(self.ahead.text.as_str())
    }

    /// Takes the next line if it belongs to the record.
    pub(super) fn next_if(&mut self, belongs: impl Fn(&str) -> bool) -> Option<&str> {
        self.peek().filter(|line| belongs(line))?;
        self.next()
    }

    /// Returns the current line.
    pub(super) fn current(&self) -> &str {
        &self.current.text
    }

    /// Returns true if the file ends inside a value of the next line, or behind the name that stands
    /// before its values. The fields begin at column `from`; each is `width` columns wide, of which
    /// the value takes the first `of_value`.
    pub(super) fn is_cut(&mut self, from: usize, width: usize, of_value: usize) -> bool {
        if self.peek().is_none() || !self.source.is_open() {
            return false;
        }
        let used = self.ahead.text.trim_end().len();
        from > 0 && used <= from || (1..of_value).contains(&((used - from) % width))
    }

    /// Returns true if every line was returned.
    pub(super) fn has_ended(&mut self) -> bool {
        self.look();
        !self.has_ahead
    }

    /// Returns the error that ended the lines, once.
    pub(super) fn failure(&mut self) -> Option<Error> {
        self.failure.take()
    }

    /// Ends the lines with an error.
    pub(super) fn fail(&mut self, error: Error) {
        (self.failure, self.has_ended, self.has_ahead) = (Some(error), true, false);
    }

    fn look(&mut self) {
        if self.has_ahead || self.has_ended {
            return;
        }
        match self.source.read(&mut self.ahead.text) {
            Ok(Some(number)) => (self.ahead.number, self.has_ahead) = (number, true),
            Ok(None) => self.has_ended = true,
            Err(error) => (self.failure, self.has_ended) = (Some(error), true),
        }
    }
}

/// Returns columns `from..to` without the blanks around; empty beyond the end of the line.
pub(super) fn columns(line: &str, from: usize, to: usize) -> &str {
    line.get(from.min(line.len())..to.min(line.len())).unwrap_or("").trim_ascii()
}

/// Returns the label of a header line.
pub(super) fn label(line: &str) -> &str {
    columns(line, 60, 80)
}

/// Labels of header lines without a slash that stand between records where files were spliced.
const LABELS: [&str; 24] = [
    "ANTENNA: B.SIGHT XYZ",
    "ANTENNA: DELTA H/E/N",
    "ANTENNA: DELTA X/Y/Z",
    "ANTENNA: PHASECENTER",
    "ANTENNA: ZERODIR AZI",
    "ANTENNA: ZERODIR XYZ",
    "APPROX POSITION XYZ",
    "CENTER OF MASS: XYZ",
    "COMMENT",
    "CORR TO SYSTEM TIME",
    "DELTA-UTC: A0,A1,T,W",
    "DOI",
    "END OF HEADER",
    "GLONASS COD/PHS/BIS",
    "INTERVAL",
    "ION ALPHA",
    "ION BETA",
    "IONOSPHERIC CORR",
    "LEAP SECONDS",
    "MARKER NAME",
    "MARKER NUMBER",
    "MARKER TYPE",
    "SIGNAL STRENGTH UNIT",
    "TIME SYSTEM CORR",
];

/// Returns true for lines with a label of a header.
pub(super) fn is_labelled(line: &str) -> bool {
    const OTHERS: [&str; 3] = ["TIME OF ", "RCV CLOCK ", "# OF "];
    let label = if line.len() > 60 { label(line) } else { "" };
    // Values, of which most lines consist, are told apart by one byte.
    let may_be_known = label.starts_with(|first: char| first.is_ascii_uppercase() || first == '#');
    let is_known = || LABELS.contains(&label) || OTHERS.iter().any(|other| label.starts_with(other));
    label.contains(" / ") || may_be_known && is_known()
}

/// Reads the usual form of a field of 14 columns as [`any_decimal`] does, in a fifth of the time:
/// blanks, at least two digits, a point and three digits. The first eight columns are one word.
fn usual(columns: &[u8]) -> Option<f64> {
    const ONES: u64 = 0x0101_0101_0101_0101;
    let &[a, b, c, d, e, f, g, h, i, j, b'.', k, l, m] = columns.first_chunk::<14>()? else { return None };
    let word = u64::from_le_bytes([a, b, c, d, e, f, g, h]);
    // A blank lacks the bit that makes it a zero. Blanks come first, and have no other bits.
    let blanks = !word >> 4 & ONES;
    let (filled, lower) = (word | (0x10 * ONES), 0x0F * ONES);
    let are_first = blanks & !(blanks << 8 | 1) == 0 && word & (blanks * 0x0F) == 0;
    let are_digits = filled & !lower == 0x30 * ONES && ((filled & lower) + 0x06 * ONES) & !lower == 0;
    if columns.len() != 14 || !are_first || !are_digits {
        return None;
    }
    // Neighbours are joined: digits to pairs, pairs to fours, fours to eight.
    let pairs = (filled & lower).wrapping_mul(10 << 8 | 1) >> 8 & 0x00FF_00FF_00FF_00FF;
    let fours = pairs.wrapping_mul(100 << 16 | 1) >> 16 & 0x0000_FFFF_0000_FFFF;
    let mut integer = fours.wrapping_mul(10_000 << 32 | 1) >> 32;
    for digit in &[i, j, k, l, m] {
        let digit = digit.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        integer = 10 * integer + u64::from(digit);
    }
    Some(integer as f64 / 1e3)
}

/// Reads a number in plain decimals as [`number`] does, in a fraction of the time; `None` for blank
/// columns and every other form.
///
/// An integer below 2⁵³ and a power of ten up to 10²² are exact in double precision. Their quotient
/// is therefore the double nearest to the number.
pub(super) fn decimal(columns: &[u8]) -> Option<f64> {
    usual(columns).or_else(|| any_decimal(columns))
}

/// Reads all forms of [`decimal`], digit by digit.
fn any_decimal(columns: &[u8]) -> Option<f64> {
    const POWERS: [f64; 15] =
        [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14];
    let text = columns.trim_ascii();
    let (is_negative, digits) = match text {
        [b'-', digits @ ..] => (true, digits),
        digits => (false, digits),
    };
    let (mut integer, mut decimals) = (0_u64, None);
    // Fifteen digits and a point.
    if !(2..=16).contains(&digits.len()) {
        return None;
    }
    for (index, byte) in digits.iter().enumerate() {
        match byte {
            b'0'..=b'9' => integer = 10 * integer + u64::from(byte - b'0'),
            b'.' if decimals.is_none() => decimals = Some(digits.len() - index - 1),
            _ => return None,
        }
    }
    let size = integer as f64 / POWERS.get(decimals?)?;
    Some(if is_negative { -size } else { size })
}

/// Reads a Fortran number, `D` exponents included; `None` for blank columns.
pub(super) fn number(text: &str) -> Result<Option<f64>> {
    if text.is_empty() {
        return Ok(None);
    }
    let parsed = text.parse().or_else(|_| text.replace(['D', 'd'], "e").parse::<f64>());
    let value = parsed.ok().filter(|value| value.is_finite());
    value.map(Some).with_context(|| format!("`{text}` is not a number"))
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt as _, SeedableRng as _};

    use super::{any_decimal, decimal, number, usual};

    #[test]
    fn plain_decimals_are_the_numbers_of_the_standard_library() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        for _ in 0..100_000 {
            let size = 10_f64.powi(random.random_range(-3..10)) * random.random_range(-1.0..1.0);
            let decimals = random.random_range(1..6);
            let text = format!("{size:14.decimals$}");
            let want: f64 = text.trim().parse().unwrap();
            match decimal(text.as_bytes()) {
                Some(have) => assert_eq!(have.to_bits(), want.to_bits(), "{text}"),
                None => assert!(text.trim().len() > 16, "{text}"),
            }
        }
        for (text, want) in [(" 20000000.123", 20_000_000.123), ("-.5", -0.5), ("5.", 5.0), (" 0.000 ", 0.0)]
        {
            assert_eq!(decimal(text.as_bytes()), Some(want), "{text}");
        }
    }

    #[test]
    fn the_usual_form_is_read_as_any_other() {
        let mut random = ChaCha8Rng::seed_from_u64(6);
        let mut read = 0;
        for _ in 0..200_000 {
            let size = 10_f64.powi(random.random_range(0..10)) * random.random_range(0.0..1.0);
            let mut text = format!("{size:14.3}").into_bytes();
            assert_eq!(usual(&text).is_some(), size >= 9.9995, "{size}");
            read += u32::from(usual(&text).is_some());
            // Any byte in any column, which is either refused or read as the general reader does.
            if random.random_bool(0.8) {
                text[random.random_range(0..14)] = random.random();
            }
            if let Some(value) = usual(&text) {
                assert_eq!(Some(value), any_decimal(&text), "{text:?}");
            }
        }
        assert!(read > 100_000);
        for text in ["     10.000 ", "1      10.000", "-     10.000", "      10.0000", "#     10.000"] {
            assert_eq!(usual(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn other_forms_are_left_to_the_general_reader() {
        for text in [
            "",
            "   ",
            ".",
            "-",
            "-.",
            "5",
            "1e5",
            "1.0D+03",
            "1.2.3",
            "+1.0",
            "1 .0",
            "2?.5",
            "0.1234567890123456",
        ] {
            assert_eq!(decimal(text.as_bytes()), None, "{text}");
        }
        assert_eq!(number("+1.0").unwrap(), Some(1.0));
    }
}
