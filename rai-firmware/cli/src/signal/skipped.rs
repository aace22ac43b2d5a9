//! Counts of skipped records: a flaw costs its record, not its file.
//!
//! | flaw | field | counts towards the refusal |
//! |---|---|---|
//! | a record that cannot be read | `damaged` | its lines |
//! | a satellite that no system has, such as `R00` | `unknown_satellites` | its line |
//! | a comment or header line between records | `comments` | no |
//! | a header field that cannot be read and that RAI can do without, or a byte order mark | `header_fields` | no |
//! | an epoch or ephemeris that the end of the file cuts | `cut` | no |
//! | an epoch that is not later than the one before | `out_of_order` | its lines |
//! | a record of a kind or system that RAI does not read | `other_kinds` | no |

use std::fmt;

use anyhow::{Result, ensure};

/// Place of a flaw.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "commands", derive(serde::Serialize))]
pub struct Place {
    /// File as the caller names it.
    pub file: String,
    /// Number of the line, from 1; in a compact file that of its compact line.
    pub line: u64,
}

/// Counts of skipped records, and the place of the first flaw.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "commands", derive(serde::Serialize))]
pub struct Skipped {
    /// Records, or single values beside a pseudorange, that cannot be read.
    pub damaged: u64,
    /// Records of satellites that no system has.
    pub unknown_satellites: u64,
    /// Comments and header lines between records.
    pub comments: u64,
    /// Unreadable header fields that RAI does not need.
    pub header_fields: u64,
    /// Epochs and ephemerides that the end of the file cuts.
    pub cut: u64,
    /// Epochs that are not later than the one before.
    pub out_of_order: u64,
    /// Records of kinds and systems that RAI does not read; not a flaw.
    pub other_kinds: u64,
    /// Lines of the records that damage costs.
    pub lost_lines: u64,
    /// Place of the first flaw.
    pub first: Option<Place>,
}

/// Kinds of flaws that have a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// Counted as `damaged`.
    Damaged,
    /// Counted as `unknown_satellites`.
    UnknownSatellite,
    /// Counted as `comments`.
    Comment,
    /// Counted as `header_fields`.
    HeaderField,
    /// Counted as `cut`.
    Cut,
    /// Counted as `out_of_order`.
    OutOfOrder,
}

impl Skipped {
    /// Reciprocal of the share of lines that a file may lose; a file that loses more is refused.
    const TENTH: u64 = 10;

    /// Counts a flaw at a line.
    pub fn note(&mut self, flaw: Flaw, line: u64) {
        let count = match flaw {
            Flaw::Damaged => &mut self.damaged,
            Flaw::UnknownSatellite => &mut self.unknown_satellites,
            Flaw::Comment => &mut self.comments,
            Flaw::HeaderField => &mut self.header_fields,
            Flaw::Cut => &mut self.cut,
            Flaw::OutOfOrder => &mut self.out_of_order,
        };
        *count += 1;
        let is_first = self.first.as_ref().is_none_or(|first| line < first.line);
        if is_first {
            self.first = Some(Place { file: String::new(), line });
        }
    }

    /// Counts a flaw and the lines that it costs.
    pub fn lose(&mut self, flaw: Flaw, line: u64, lines: u64) {
        self.note(flaw, line);
        self.lost_lines += lines;
    }

    /// Returns the counts with the name of their file.
    #[must_use]
    pub fn named(mut self, file: &str) -> Self {
        if let Some(first) = &mut self.first {
            file.clone_into(&mut first.file);
        }
        self
    }

    /// Adds the counts of another part; the first place stays unless the other is earlier in the
    /// same file.
    pub fn add(&mut self, other: &Self) {
        self.damaged += other.damaged;
        self.unknown_satellites += other.unknown_satellites;
        self.comments += other.comments;
        self.header_fields += other.header_fields;
        self.cut += other.cut;
        self.out_of_order += other.out_of_order;
        self.other_kinds += other.other_kinds;
        self.lost_lines += other.lost_lines;
        let is_first = |place: &Place| {
            self.first.as_ref().is_none_or(|first| first.file == place.file && place.line < first.line)
        };
        if let Some(place) = other.first.as_ref().filter(|place| is_first(place)) {
            self.first = Some(place.clone());
        }
    }

    /// Returns true if no record was skipped.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Checks that at most a tenth of the lines is lost.
    ///
    /// # Errors
    /// More is lost; the message names the first line.
    pub fn check(&self, lines: u64) -> Result<()> {
        let first = self.first.as_ref().map_or(0, |first| first.line);
        let is_lost = self.lost_lines * Self::TENTH > lines;
        ensure!(
            !is_lost || self.out_of_order <= self.damaged + self.unknown_satellites,
            "time goes back or stands still in {} epochs, the first at line {first}: two recordings in one file, or one that is \
             not in the order of time; cut it there and give both parts",
            self.out_of_order,
        );
        ensure!(
            !is_lost,
            "{} of {lines} lines cannot be read, at most a tenth may be lost; the first is line {first}",
            self.lost_lines,
        );
        Ok(())
    }
}

impl fmt::Display for Skipped {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = [
            (self.damaged, "damaged"),
            (self.unknown_satellites, "of unknown satellites"),
            (self.comments, "comments between records"),
            (self.header_fields, "header fields"),
            (self.cut, "cut by the end of the file"),
            (self.out_of_order, "epochs out of order"),
            (self.other_kinds, "of kinds not read"),
        ];
        let reported = counts.iter().filter(|(count, _)| *count > 0);
        let reported: Vec<String> = reported.map(|(count, what)| format!("{count} {what}")).collect();
        formatter.write_str(&reported.join(", "))?;
        match &self.first {
            Some(Place { file, line }) => write!(formatter, "; first flaw: {file}, line {line}"),
            None => Ok(()),
        }
    }
}
