//! The tables of attacks in `results/adversary.md`, compared with the record of the attacks.
//!
//! Each number of a cell must be a figure that the attack measured, rounded to the digits of the
//! number, or the sum of its figures of one kind, as of `protected with 4`, `protected with 5`.
//! Numbers up to the words *at length* are those of the quick form, the others those of the long
//! form. [`GIVEN`] lists numbers that are inputs.

use std::collections::BTreeMap;

use adversary::attack::record::{Entry, Record};
use adversary::attack::several_record;
use adversary::attack::{ATTACKS, Effort};
use rig::document;

use crate::numbers;
use crate::passages::{self, Passage, Source};

const DOCUMENT: &str = "results/adversary.md";

/// Numbers that describe an input, or that the attack does not print: attack, number.
const GIVEN: &[(&str, &str)] = &[
    ("gross-pairs", "4,320"),
    ("gross-pairs", "43,200"),
    ("repeater", "16"),
    ("repeater", "62"),
    ("repeater", "31"),
    // Factors and a sum in its table.
    ("false-signs", "2"),
    ("false-signs", "4"),
    ("false-signs", "18,000"),
    // Seeds of a run by hand.
    ("streets", "40"),
    ("streets", "39"),
    ("streets", "258,566"),
];

/// Passages elsewhere, whose numbers are figures of an attack: document, passage, attack, form.
const ELSEWHERE: &[(&str, &str, &str, Effort)] = &[
    ("LIMITS.md", "within 48 s, the clock also", "walk-off", Effort::Long),
    ("LIMITS.md", "within 54 s. Until then", "drag-off", Effort::Long),
    ("LIMITS.md", "error beyond their level, up to 43 m (`shifted-system`)", "shifted-system", Effort::Long),
    ("LIMITS.md", "up to 377 m (`few-shifted`", "few-shifted", Effort::Long),
    ("LIMITS.md", "and 96 to 100 % of the steps are detected", "one-frequency-recorded", Effort::Long),
    (DOCUMENT, "Of the 36 epochs of `SIGMAS` all have a truth, and 34 have", "false-signs", Effort::Quick),
    (DOCUMENT, "248 of 353 promised epochs with a truth are as far off", "false-signs", Effort::Quick),
    (
        DOCUMENT,
        "each clock runs for 32 hours at 1 Hz and one for 914 hours at 30 s, and no sign alarms",
        "false-signs",
        Effort::Long,
    ),
];

/// Row of a table: attack, last cell, form of its first numbers.
type Row = (String, String, Effort);

/// Returns the rows of both tables. Another test compares generated ones.
fn rows() -> Vec<Row> {
    let is_generated =
        |passage: &Passage| passage.sources.iter().any(|source| matches!(source, Source::Block(_)));
    let passages = passages::of(&document::text(DOCUMENT));
    let written = passages.into_iter().filter(|passage| !is_generated(passage));
    written.filter_map(|passage| row(&passage.text)).collect()
}

fn row(text: &str) -> Option<Row> {
    let cells: Vec<&str> = text.trim_matches(['|', ' ']).split('|').map(str::trim).collect();
    let name = cells[0].strip_prefix('`')?.strip_suffix('`')?;
    ATTACKS.iter().find(|attack| attack.name == name)?;
    let effort = match cells.len() {
        4 => Effort::Quick,
        2 => Effort::Long,
        _ => return None,
    };
    // Figures of an earlier version follow the word.
    let now = cells[cells.len() - 1].split("; before").next().unwrap_or_default();
    Some((name.to_owned(), now.to_owned(), effort))
}

/// Returns what a row says that the record does not.
fn differences(record: &Record, (attack, cell, first): &Row) -> Vec<String> {
    let (quick, long) = cell.split_at(cell.find("at length").unwrap_or(cell.len()));
    [unknown(record, attack, quick, *first), unknown(record, attack, long, Effort::Long)].concat()
}

/// Returns the numbers of a text that an attack did not measure in a form.
fn unknown(record: &Record, attack: &str, text: &str, effort: Effort) -> Vec<String> {
    let figures = record.entry(attack, effort).map(candidates).unwrap_or_default();
    let is_known = |number: &str| {
        GIVEN.contains(&(attack, number)) || figures.iter().any(|value| is_rounded(number, *value))
    };
    let unknown = numbers::in_row(text).into_iter().filter(|(_, number)| !is_known(number));
    let form = effort.word();
    unknown
        .map(|(_, number)| format!("`{attack}`: the {form} form did not measure {number}, but {figures:?}"))
        .collect()
}

/// Returns the figures of an entry, the numbers in their names, and their sums by kind.
fn candidates(entry: &Entry) -> Vec<f64> {
    let (mut sums, mut values) = (BTreeMap::<&str, f64>::new(), Vec::new());
    for (quantity, value) in &entry.figures {
        let value = value.parse().unwrap_or(f64::NAN);
        *sums.entry(kind(quantity)).or_default() += value;
        values.push(value);
        values.extend(numbers_in(quantity));
    }
    values.extend(sums.into_values());
    values.sort_by(f64::total_cmp);
    values.dedup_by(|one, other| one.total_cmp(other).is_eq());
    values
}

/// Returns the numbers in a name, as in `protected of 485`.
fn numbers_in(quantity: &str) -> impl Iterator<Item = f64> {
    quantity.split([' ', ',', ':', '%', '/']).filter_map(|word| word.parse().ok())
}

/// Returns the first word of a quantity, behind the case that it is of.
fn kind(quantity: &str) -> &str {
    let quantity = quantity.rsplit(": ").next().unwrap_or_default();
    quantity.split(' ').next().unwrap_or_default()
}

/// Returns true if a number is a value, rounded to the digits that the number has.
fn is_rounded(number: &str, value: f64) -> bool {
    let decimals = number.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    format!("{value:.decimals$}") == number.replace(',', "")
}

#[test]
fn cells_have_the_figures_that_the_attacks_measured() {
    let record = Record::committed().expect("a record");
    let rows = rows();
    let differences: Vec<_> = rows.iter().flat_map(|row| differences(&record, row)).collect();
    assert!(differences.is_empty(), "{DOCUMENT}: {}", differences.join("\n"));
}

#[test]
fn table_of_own_signs_has_the_figures_that_the_attack_measured() {
    let record = Record::committed().expect("a record");
    let text = document::text(DOCUMENT);
    let rest = text.split_once("| recording | hours |").expect("the table").1;
    let table = rest.split("\n\n").next().unwrap_or_default();
    // The first cell describes the recording.
    let cells = table.lines().skip(2).filter_map(|row| row.trim_matches(['|', ' ']).split_once('|'));
    let differences: Vec<_> =
        cells.flat_map(|(_, row)| unknown(&record, "false-signs", row, Effort::Quick)).collect();
    assert!(differences.is_empty(), "{DOCUMENT}, {}", differences.join("\n"));
}

#[test]
fn passages_elsewhere_have_the_figures_that_the_attacks_measured() {
    let record = Record::committed().expect("a record");
    for (name, passage, attack, effort) in ELSEWHERE {
        document::must_say(name, passage);
        let differences = unknown(&record, attack, passage, *effort);
        assert!(differences.is_empty(), "{name}, {passage}: {}", differences.join("\n"));
    }
}

#[test]
fn every_attack_has_a_row_and_a_record_of_both_forms() {
    let (record, rows) = (Record::committed().expect("a record"), rows());
    for attack in ATTACKS.iter().map(|attack| attack.name) {
        let count = rows
            .iter()
            .filter(|(name, _, effort)| (name.as_str(), *effort) == (attack, Effort::Quick))
            .count();
        assert_eq!(count, 1, "{DOCUMENT}: rows of {attack}");
        for effort in Effort::ALL {
            let is_there = record.entry(attack, effort).is_some();
            assert!(
                is_there,
                "{attack}, {}: `cargo xtask attack {attack} --record` is missing",
                effort.word()
            );
        }
    }
}

#[test]
fn several_faults_are_those_of_the_record() {
    let cells = several_record::committed().expect("a record");
    document::must_have("results/integrity.md", "several", &several_record::markdown(&cells));
    let (least, most) =
        (cells.iter().map(|cell| cell.epochs).min(), cells.iter().map(|cell| cell.epochs).max());
    assert_eq!((least, most), (Some(1000), Some(1000)), "`cargo xtask attack --several 1000 --record`");
    document::must_say("results/integrity.md", "likely: 1,000 epochs per cell");
    let worst =
        cells.iter().map(|cell| 100.0 * cell.misleading as f64 / cell.epochs as f64).fold(0.0, f64::max);
    document::must_say(
        "RESULTS.md",
        &format!("0 to {worst:.1} % of all epochs are protected beyond their level"),
    );
    for methods in
        [&["AUTO", "GROUPING"][..], &["HYBRID", "BAARDA", "SEQUENTIAL", "RANSAC"], &["SIMULTANEOUS"]]
    {
        for method in methods {
            let cell = |satellites: usize| {
                let of_sky =
                    cells.iter().filter(|cell| (cell.method, cell.satellites) == (*method, satellites));
                let percents = of_sky.map(|cell| 100.0 * cell.misleading as f64 / cell.epochs as f64);
                let words =
                    percents.map(|percent| if percent > 0.0 { format!("{percent:.1}") } else { "0".into() });
                words.collect::<Vec<_>>().join(" / ")
            };
            let names = methods.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
            document::must_say(
                "LIMITS.md",
                &format!("| {names} | {} |", [8, 10, 12, 18].map(cell).join(" | ")),
            );
        }
    }
}

#[test]
fn number_is_a_figure_a_sum_or_given() {
    let figures = [("a: protected with 4", "92"), ("protected with 5", "3.4"), ("beyond", "0")];
    let figures = figures.map(|(quantity, value)| (quantity.to_owned(), value.to_owned())).to_vec();
    let mut record = Record::default();
    record.put(Entry { attack: "step".into(), effort: Effort::Quick, version: "v".into(), figures });
    let unknown = |cell: &str| differences(&record, &("step".into(), cell.into(), Effort::Quick)).len();
    assert_eq!(unknown("0 of 95, 3 in `12`"), 0);
    assert_eq!(unknown("0 of 96"), 1);
    assert_eq!(unknown("92; at length 92"), 1);
}
