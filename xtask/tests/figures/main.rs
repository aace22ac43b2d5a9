//! Figures in the documents agree with their sources.
//!
//! Each number with a unit, and each number in a table of `results/`, belongs to a passage that is
//! compared here with the code, its budgets or a committed record, or that names its source: a
//! command that exists, an input, or a generated block ([`passages`]). Tests that measure compare
//! their own passages and blocks (`rig::document`).

mod attacks;
mod budgets;
mod commands;
mod cost;
mod experiments;
mod limits;
mod memory;
mod numbers;
mod passages;

use std::collections::BTreeSet;

use rig::document;

use crate::budgets::Budgets;
use crate::passages::{Passage, Source};

/// Documents in which every figure needs a source.
const DOCUMENTS: [&str; 8] = [
    "README.md",
    "RESULTS.md",
    "DESIGN.md",
    "LIMITS.md",
    "results/adversary.md",
    "results/cost.md",
    "results/integrity.md",
    "results/receivers.md",
];

/// Passages that a document must have: document, passage.
type Passages = Vec<(&'static str, String)>;

/// Returns the passages whose figures are computed here.
fn compared() -> Passages {
    let budgets = Budgets::read();
    [limits::all(), cost::all(&budgets), memory::all(&budgets), experiments::all()].concat()
}

#[test]
fn figures_in_the_documents_are_those_of_code_and_budgets() {
    let is_missing = |(name, passage): &(&str, String)| {
        !document::joined(&document::text(name)).contains(passage.as_str())
    };
    let differing: Vec<String> = compared()
        .into_iter()
        .filter(is_missing)
        .map(|(name, passage)| format!("{name} must say: {passage}"))
        .collect();
    assert!(differing.is_empty(), "figures differ from their sources:\n{}", differing.join("\n"));
}

/// Returns the figures of a passage that no computed passage contains.
fn free(name: &str, passage: &Passage, compared: &Passages) -> Vec<String> {
    let all = if passage.is_row() && name.starts_with("results/") {
        numbers::in_row(&passage.text)
    } else {
        numbers::with_unit(&passage.text)
    };
    let computed: Vec<_> = compared
        .iter()
        .filter(|(of, _)| *of == name)
        .filter_map(|(_, words)| passage.text.find(words.as_str()).map(|at| at..at + words.len()))
        .collect();
    let is_free = |(at, _): &(usize, String)| !computed.iter().any(|range| range.contains(at));
    all.into_iter().filter(is_free).map(|(_, figure)| figure).collect()
}

#[test]
fn every_figure_is_compared_or_names_its_source() {
    let compared = compared();
    let mut without = Vec::new();
    for name in DOCUMENTS {
        for passage in passages::of(&document::text(name)) {
            let free = free(name, &passage, &compared);
            if passage.sources.is_empty() && !free.is_empty() {
                without.push(format!("{name}: {free:?} in: {}", passage.text));
            }
        }
    }
    assert!(without.is_empty(), "no source is named for\n{}", without.join("\n"));
}

#[test]
fn commands_in_the_documents_exist() {
    let all = DOCUMENTS.iter().flat_map(|name| {
        let sources = passages::of(&document::text(name)).into_iter().flat_map(|passage| passage.sources);
        sources.map(move |source| (*name, source))
    });
    let commands: BTreeSet<_> = all
        .filter_map(|(name, source)| match source {
            Source::Command(command) => Some((name, command)),
            Source::Given(_) | Source::Block(_) => None,
        })
        .collect();
    assert!(commands.len() > 100, "{}", commands.len());
    let defects: Vec<String> = commands
        .iter()
        .filter_map(|(name, command)| Some(format!("{name}: `{command}`: {}", commands::defect(command)?)))
        .collect();
    assert!(defects.is_empty(), "commands do not exist:\n{}", defects.join("\n"));
}
