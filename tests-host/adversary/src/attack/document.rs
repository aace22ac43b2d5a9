//! Table of all attacks in `results/adversary.md`, from their list and the record.

use std::fmt::Write as _;

use super::record::{Entry, Record, Recorded};
use super::{Effort, attacks};

/// Largest number of quantities that are listed although no bound holds for them.
const QUANTITIES: usize = 16;

/// Figures of the same quantity under the same bound.
struct Same<'r> {
    quantity: &'r str,
    bound: &'r str,
    values: Vec<&'r str>,
}

impl Same<'_> {
    fn words(&self) -> String {
        let bound = if self.bound.is_empty() { String::new() } else { format!(" ({})", self.bound) };
        format!("{} {}{bound}", self.quantity, range(&self.values))
    }
}

/// Returns the figures of one attack in one form: the range of each quantity, and only quantities
/// with a bound, if any, if these are many.
fn cell(entry: Option<&Entry>, is_bounded: impl Fn(&str) -> bool) -> String {
    let figures = entry.map_or(&[][..], |entry| &entry.figures);
    let mut all: Vec<Same> = Vec::new();
    for Recorded { quantity, value, bound } in figures {
        let same = all.iter_mut().find(|same| same.quantity == *quantity && same.bound == *bound);
        match same {
            Some(same) => same.values.push(value),
            None => all.push(Same { quantity, bound, values: vec![value] }),
        }
    }
    if all.len() > QUANTITIES && all.iter().any(|same| is_bounded(same.quantity)) {
        all.retain(|same| is_bounded(same.quantity));
    }
    all.iter().map(Same::words).collect::<Vec<_>>().join("; ").replace('|', "\\|")
}

/// Returns the only value, or the least and the largest.
fn range(values: &[&str]) -> String {
    let mut values = values.to_vec();
    let number = |value: &str| value.parse().unwrap_or(f64::NAN);
    values.sort_by(|one, other| number(one).total_cmp(&number(other)));
    match (values.first(), values.last()) {
        (Some(least), Some(largest)) if least != largest => format!("{least} to {largest}"),
        (least, _) => least.copied().unwrap_or_default().to_owned(),
    }
}

fn table(record: &Record) -> String {
    let mut table =
        "| attack | attempt | before | quick form | at length | note |\n|---|---|---|---|---|---|\n"
            .to_owned();
    for attack in attacks() {
        let forms = Effort::ALL.map(|effort| record.entry(attack.name, effort));
        // A quantity without a recorded bound at length has one if it has one in the quick form.
        let is_bounded = |quantity: &str| {
            let figures = forms.iter().flatten().flat_map(|entry| &entry.figures);
            figures.into_iter().any(|figure| figure.quantity == quantity && !figure.bound.is_empty())
        };
        let [quick, long] = forms.map(|entry| cell(entry, is_bounded));
        let (name, about, before, note) = (attack.name, attack.about, attack.before, attack.note);
        let _ = writeln!(table, "| `{name}` | {about} | {before} | {quick} | {long} | {note} |");
    }
    table
}

#[test]
fn document_has_every_attack_with_what_it_measured_last() {
    let record = Record::committed().expect("a record");
    rig::document::must_have("results/adversary.md", "attacks", &table(&record));
}

fn entry(count: usize, quantities: usize, bound: &str) -> Entry {
    let figure = |index: usize| Recorded {
        quantity: format!("q{}", index % quantities),
        value: index.to_string(),
        bound: if index.is_multiple_of(quantities) { bound.to_owned() } else { String::new() },
    };
    let figures = (0..count).map(figure).collect();
    Entry { attack: "leap".into(), effort: Effort::Quick, version: "v1".into(), figures }
}

#[test]
fn figures_are_a_range_of_each_quantity_with_its_bound() {
    assert_eq!(cell(Some(&entry(3, 2, "≤ 2")), |_| true), "q0 0 to 2 (≤ 2); q1 1");
    assert_eq!(cell(Some(&entry(14, 3, "≤ 20")), |_| true), "q0 0 to 12 (≤ 20); q1 1 to 13; q2 2 to 11");
}

#[test]
fn many_quantities_are_those_with_a_bound() {
    assert_eq!(cell(Some(&entry(40, 20, "≤ 20")), |quantity| quantity == "q0"), "q0 0 to 20 (≤ 20)");
}

#[test]
fn attack_that_is_not_recorded_has_no_figures() {
    assert_eq!(cell(None, |_| true), "");
}
