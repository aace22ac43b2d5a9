//! What was seen of each attack, as tables of the documents.

use std::fmt::Write as _;

use super::MEANS;

/// What an attack led to in a module.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Second of the attack in which the module first said something else than under the genuine sky.
    pub seen_s: Option<u32>,
    /// What it said: the reason of the epoch, or `FALSE` of OSNMA.
    pub by: String,
    /// Second in which proved Galileo first decided.
    pub decided_s: Option<u32>,
    /// Promised epochs of the attack.
    pub promised: usize,
    /// Those whose error is beyond a level, and the second of the last.
    pub beyond: usize,
    /// See `beyond`.
    pub last_beyond_s: Option<u32>,
    /// Of poisoned blocks, time from the start to four proved satellites, with and without them, s.
    pub first_four_s: Option<(u32, u32)>,
}

/// What an attack led to, in each module.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The attack.
    pub name: &'static str,
    /// The same in few words.
    pub short: &'static str,
    /// One for each of the means.
    pub cells: Vec<Cell>,
}

impl Cell {
    fn words(&self) -> String {
        let seen = match (self.seen_s, self.first_four_s) {
            (Some(seen_s), _) => format!("`{}`, {seen_s} s", self.by),
            (None, Some((with_s, without_s))) => {
                return format!("four proved after {with_s} s, without it {without_s} s");
            }
            (None, None) if self.beyond == 0 => return "no harm".to_owned(),
            (None, None) => "not seen".to_owned(),
        };
        let seen = match self.decided_s.filter(|_| self.by != "SYSTEM") {
            Some(decided_s) => format!("{seen}, `SYSTEM` from {decided_s} s"),
            None => seen,
        };
        match self.last_beyond_s {
            Some(last_s) => format!("{seen}; {} beyond, to {last_s} s", self.beyond),
            None => seen,
        }
    }
}

/// Returns the table of all attacks behind the genuine sky.
pub fn markdown(rows: &[Row]) -> String {
    let names: Vec<&str> = MEANS.iter().map(|means| means.name).collect();
    let mut table = format!("| attack | {} |\n|---|{}\n", names.join(" | "), "---|".repeat(names.len()));
    for Row { name, cells, .. } in rows {
        let words: Vec<String> = cells.iter().map(Cell::words).collect();
        let _ = writeln!(table, "| {name} | {} |", words.join(" | "));
    }
    table
}

/// Attacks of the short table, by their short names.
const SHORT: [&str; 4] = [
    "relayed 5 s late",
    "relayed 40 s late, from the start",
    "all ranges pulled off at 0.5 m/s",
    "all forged, signed by another key",
];

/// Returns the table of what a module sees by its ranges alone, and with everything.
pub fn summary(rows: &[Row]) -> String {
    let mut table = "| signed sky, jammed, then ([all](results/adversary.md#a-signed-sky)) | seen by ranges alone | with `KEY`, `TRUST` and Doppler |\n|---|---|---|\n".to_owned();
    for Row { short, cells, .. } in rows.iter().filter(|row| SHORT.contains(&row.short)) {
        if let (Some(first), Some(last)) = (cells.first(), cells.last()) {
            let _ = writeln!(table, "| {short} | {} | {} |", first.words(), last.words());
        }
    }
    table
}
