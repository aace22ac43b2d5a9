//! Record of the figures that each attack measured last, in `records/attacks.tsv`.
//!
//! A line has four or five columns: attack, form (`quick` or `long`), quantity, value, and its bound
//! if it has one. The first line of an attack in a form has the quantity `version`. Values are
//! rounded as [`Outcome::words`] prints them. The table of the document comes from the record, and
//! the quick form is compared with it by the test of each attack.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};

use super::{Bound, Effort, Outcome, attacks, rounded};

const FILE: &str = "attacks.tsv";

/// Quantity of the first line.
const VERSION: &str = "version";

/// Figure as it is recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// Name of the quantity, with its unit.
    pub quantity: String,
    /// Rounded value.
    pub value: String,
    /// Words of the bound, empty without one.
    pub bound: String,
}

/// Figures of one attack in one form.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Name of the attack.
    pub attack: String,
    /// Amount of work.
    pub effort: Effort,
    /// Version of the sources, as git describes it.
    pub version: String,
    /// Figures in the order of the attack.
    pub figures: Vec<Recorded>,
}

impl Entry {
    /// Returns the entry of an outcome.
    pub fn of(outcome: &Outcome, effort: Effort, version: &str) -> Self {
        let cell = |text: &str| text.replace(['\t', '\n'], " ");
        let figure = |figure: &super::Figure| Recorded {
            quantity: cell(&figure.quantity),
            value: rounded(figure.value),
            bound: match figure.bound {
                Bound::AtMost(f64::INFINITY) => String::new(),
                bound => bound.words(),
            },
        };
        Self {
            attack: outcome.name.to_owned(),
            effort,
            version: version.to_owned(),
            figures: outcome.figures.iter().map(figure).collect(),
        }
    }
}

/// All figures that were recorded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record(Vec<Entry>);

impl Record {
    /// Reads the committed record.
    ///
    /// # Errors
    /// If the file cannot be read, or a line is not of the record.
    pub fn committed() -> Result<Self> {
        Self::parse(&read(FILE)?).context(FILE)
    }

    /// Writes the record in the order of the attacks. Entries of attacks that do not exist any more
    /// are left out.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self) -> Result<PathBuf> {
        write(FILE, &self.text())
    }

    /// Returns the entry of an attack in a form.
    pub fn entry(&self, attack: &str, effort: Effort) -> Option<&Entry> {
        self.0.iter().find(|entry| entry.attack == attack && entry.effort == effort)
    }

    /// Replaces the entry of the same attack in the same form.
    pub fn put(&mut self, entry: Entry) {
        self.0.retain(|old| (&old.attack, old.effort) != (&entry.attack, entry.effort));
        self.0.push(entry);
    }

    fn parse(text: &str) -> Result<Self> {
        let mut entries: Vec<Entry> = Vec::new();
        for line in text.lines() {
            let cells: Vec<&str> = line.split('\t').collect();
            let (attack, form, quantity, value, bound) = match cells[..] {
                [attack, form, quantity, value] => (attack, form, quantity, value, ""),
                [attack, form, quantity, value, bound] => (attack, form, quantity, value, bound),
                _ => anyhow::bail!("`{line}` must have four or five columns"),
            };
            let effort =
                Effort::of(form).with_context(|| format!("`{line}`: {form} must be quick or long"))?;
            match entries.last_mut() {
                _ if quantity == VERSION => entries.push(Entry {
                    attack: attack.to_owned(),
                    effort,
                    version: value.to_owned(),
                    figures: Vec::new(),
                }),
                Some(last) if last.attack == attack && last.effort == effort => {
                    let [quantity, value, bound] = [quantity, value, bound].map(str::to_owned);
                    last.figures.push(Recorded { quantity, value, bound });
                }
                _ => anyhow::bail!("`{line}` must follow the version of {attack}, {form}"),
            }
        }
        Ok(Self(entries))
    }

    fn text(&self) -> String {
        let mut text = String::new();
        let all = attacks()
            .into_iter()
            .flat_map(|attack| Effort::ALL.map(|effort| self.entry(attack.name, effort)));
        for entry in all.flatten() {
            let start = format!("{}\t{}", entry.attack, entry.effort.word());
            let _ = writeln!(text, "{start}\t{VERSION}\t{}", entry.version);
            for Recorded { quantity, value, bound } in &entry.figures {
                let mark = if bound.is_empty() { "" } else { "\t" };
                let _ = writeln!(text, "{start}\t{quantity}\t{value}{mark}{bound}");
            }
        }
        text
    }
}

/// Reads a file of the folder `records`.
pub(super) fn read(file: &str) -> Result<String> {
    let path = path(file);
    fs::read_to_string(&path).with_context(|| path.display().to_string())
}

/// Writes a file of the folder `records`; returns its path.
pub(super) fn write(file: &str, text: &str) -> Result<PathBuf> {
    let path = path(file);
    fs::write(&path, text).with_context(|| path.display().to_string())?;
    Ok(path)
}

fn path(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("records").join(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(attack: &str, effort: Effort, value: &str) -> Entry {
        let [quantity, value, bound] = ["epochs", value, "≤ 3"].map(str::to_owned);
        let figures = vec![Recorded { quantity, value, bound }];
        Entry { attack: attack.to_owned(), effort, version: "v1".to_owned(), figures }
    }

    #[test]
    fn what_is_written_is_what_is_read() {
        let mut record = Record::default();
        for (attack, effort, value) in
            [("leap", Effort::Quick, "1"), ("step", Effort::Long, "2"), ("step", Effort::Quick, "3")]
        {
            record.put(entry(attack, effort, value));
        }
        let read = Record::parse(&record.text()).expect("a record");
        for form in [("leap", Effort::Quick), ("step", Effort::Long), ("step", Effort::Quick)] {
            assert_eq!(read.entry(form.0, form.1), record.entry(form.0, form.1));
        }
    }

    #[test]
    fn new_entry_replaces_that_of_its_form_alone() {
        let mut record = Record::default();
        record.put(entry("step", Effort::Long, "1"));
        record.put(entry("step", Effort::Quick, "2"));
        record.put(entry("step", Effort::Quick, "3"));
        assert_eq!(record.entry("step", Effort::Long), Some(&entry("step", Effort::Long, "1")));
        assert_eq!(record.entry("step", Effort::Quick), Some(&entry("step", Effort::Quick, "3")));
    }

    #[test]
    fn line_that_is_not_of_a_record_is_named() {
        for (text, want) in [
            ("step\tquick\tepochs", "four or five columns"),
            ("step\tquick\tepochs\t1\t≤ 3\t0", "four or five columns"),
            ("step\tbriefly\tepochs\t1", "must be quick or long"),
            ("step\tquick\tepochs\t1", "must follow the version of step, quick"),
        ] {
            let error = format!("{:#}", Record::parse(text).expect_err("no record"));
            assert!(error.contains(want), "have {error}, want {want}");
        }
    }
}
