//! Figures of the experiments: the tables of `results/integrity.md` from the records in full, and
//! others from the snapshots of the reduced form.

use std::fmt::Write as _;

use experiments::record;
use rig::document;
use serde_json::Value;

use crate::Passages;
use crate::budgets::Budgets;

const DOCUMENT: &str = "results/integrity.md";

/// Methods of isolation that the table compares.
const METHODS: [&str; 5] = ["BAARDA", "SIMULTANEOUS", "HYBRID", "GROUPING", "RANSAC"];

/// Methods that decide on three faults among few satellites.
const DECIDING: [&str; 5] = ["BAARDA", "SEQUENTIAL", "HYBRID", "GROUPING", "RANSAC"];

/// Rows of an experiment.
struct Recorded(Value);

impl Recorded {
    fn of(name: &str) -> Self {
        Self(record::committed(name).expect("a record"))
    }

    fn rows(&self) -> impl Iterator<Item = &Value> {
        self.0["rows"].as_array().into_iter().flatten()
    }

    /// Returns the rows of a section, or of all, whose quantity has a beginning.
    fn named<'a>(&'a self, section: &'a str, quantity: &'a str) -> impl Iterator<Item = &'a Value> {
        let has = |row: &Value, field: &str, start: &str| {
            row[field].as_str().is_some_and(|text| text.starts_with(start))
        };
        self.rows().filter(move |row| has(row, "section", section) && has(row, "quantity", quantity))
    }

    fn row<'a>(&'a self, section: &'a str, quantity: &'a str) -> &'a Value {
        self.named(section, quantity).next().unwrap_or_else(|| panic!("no row {section}, {quantity}"))
    }
}

fn number(row: &Value, field: &str) -> f64 {
    row[field].as_f64().unwrap_or_else(|| panic!("no number {field} in {row}"))
}

/// Returns the percentage behind a word in the reason of a row, and zero without it.
fn percent(row: &Value, word: &str) -> f64 {
    let parts = row["reason"].as_str().unwrap_or_default().split(", ");
    let values =
        parts.filter_map(|part| part.strip_prefix(word)?.strip_suffix('%')?.trim().parse::<f64>().ok());
    values.sum()
}

#[test]
fn table_of_methods_is_that_of_the_record() {
    let recorded = Recorded::of("methods");
    let mut table = format!(
        "| satellites, faulty | {} |\n|---|{}\n",
        METHODS.map(|name| format!("`{name}`")).join(" | "),
        "---|".repeat(5)
    );
    for (name, section, faults) in [
        ("8 GPS", "8 satellites of GPS", 1),
        ("8 GPS", "8 satellites of GPS", 2),
        ("12 BeiDou", "12 satellites of BeiDou", 2),
        ("12 BeiDou", "12 satellites of BeiDou", 3),
        ("28 GPS and BeiDou", "28 satellites of GPS and BeiDou", 1),
        ("28 GPS and BeiDou", "28 satellites of GPS and BeiDou", 2),
        ("28 GPS and BeiDou", "28 satellites of GPS and BeiDou", 3),
    ] {
        let cells = METHODS.map(|method| cell(recorded.row(section, &quantity(faults, method))));
        let _ = writeln!(table, "| {name}, {faults} | {} |", cells.join(" | "));
    }
    let costs = METHODS.map(|method| {
        Budgets::read().thousands(&format!("epoch judged by {method}, faulty 2 of 20 satellites, f32"))
    });
    let _ = writeln!(table, "| instructions per epoch, 20 satellites, 2 | {} |", costs.join(" | "));
    document::must_have(DOCUMENT, "methods", &table);
}

fn quantity(faults: u8, method: &str) -> String {
    format!("{faults} fault{}, {method}", if faults == 1 { "" } else { "s" })
}

fn cell(row: &Value) -> String {
    let wrong = percent(row, "wrong");
    let wrong = if wrong < 0.05 { "–".to_owned() } else { format!("{wrong:.1}") };
    format!("{:.1} ({wrong})", 100.0 * number(row, "ours"))
}

/// Returns the passages about three faults among few satellites.
fn few_satellites() -> Passages {
    let recorded = Recorded::of("methods");
    let of = |methods: &[&str], word: &str| {
        let skies = ["8 satellites of GPS", "10 satellites of GPS and BeiDou"];
        let rows =
            skies.into_iter().flat_map(|sky| methods.iter().map(move |method| (sky, quantity(3, method))));
        let values: Vec<f64> = rows.map(|(sky, name)| percent(recorded.row(sky, &name), word)).collect();
        let [least, most] =
            [f64::min, f64::max].map(|pick| values.iter().copied().reduce(pick).expect("a value"));
        if format!("{least:.0}") == format!("{most:.0}") {
            format!("{most:.0}")
        } else {
            format!("{least:.0} to {most:.0}")
        }
    };
    let beyond = of(&DECIDING, "beyond its level");
    vec![
        (
            DOCUMENT,
            format!(
                "{} % of these epochs are protected with a healthy satellite excluded ({} % by `SIMULTANEOUS`, which \
                 rarely decides). {beyond} % are beyond their level",
                of(&DECIDING, "wrong"),
                of(&["SIMULTANEOUS"], "wrong"),
            ),
        ),
        ("LIMITS.md", format!("with three, {beyond} % of all epochs")),
    ]
}

#[test]
fn table_of_the_edge_of_availability_is_that_of_the_record() {
    let recorded = Recorded::of("fde");
    let interval = |row: &Value, decimals: usize| {
        let [ours, low, high] =
            ["ours", "low", "high"].map(|field| format!("{:.decimals$}", number(row, field)));
        format!("{ours} ({low} to {high})")
    };
    let largest = |start: &'static str, field: &'static str| {
        let rows = recorded.named("", start);
        rows.max_by(|one, other| number(one, field).total_cmp(&number(other, field))).expect("a row")
    };
    let closed = number(recorded.row("", "largest risk of any geometry"), "ours");
    let wrong = number(largest("of these wrong exclusion", "high"), "high");
    let failed = |size: &str| {
        let is_of_size = |row: &&Value| row["quantity"].as_str().is_some_and(|name| name.contains(size));
        let rows = recorded.named("", "failed exclusion").filter(is_of_size);
        rows.max_by(|one, other| number(one, "high").total_cmp(&number(other, "high"))).expect("a rate")
    };
    let rows = [
        ("false detection, over P<sub>fa</sub>", interval(recorded.row("", "false detection"), 2)),
        ("false alert, over P<sub>fa</sub>", interval(recorded.row("", "false alert"), 2)),
        (
            "missed alert, at the worst of eight sizes of the fault, over P<sub>md</sub>",
            interval(largest("missed alert", "ours"), 3),
        ),
        ("missed alert, worst geometry and size in closed form, over P<sub>md</sub>", format!("{closed:.3}")),
        (
            "of the missed alerts those with a healthy satellite excluded, over P<sub>md</sub>",
            format!("below {wrong:.2}"),
        ),
        (
            "failed exclusion, of faults that move the position by the limit to four times as far, over 10⁻³",
            interval(failed("by HAL"), 2),
        ),
        (
            "failed exclusion, of faults that every other explanation just fails to explain, over 10⁻³",
            interval(failed("1 of the one that is just told apart"), 2),
        ),
    ];
    let mut table = "| event | rate, relative to the requirement |\n|---|---|\n".to_owned();
    for (event, rate) in rows {
        let _ = writeln!(table, "| {event} | {rate} |");
    }
    document::must_have(DOCUMENT, "fde", &table);
    let setup = recorded.0["setup"].as_str().unwrap_or_default();
    let count: u64 =
        setup.split(' ').next().and_then(|word| word.parse().ok()).expect("a number of geometries");
    document::must_say(DOCUMENT, &format!("{},{:03} geometries", count / 1000, count % 1000));
    let share = 100.0 * number(recorded.row("", "geometries with an exclusion level"), "ours");
    document::must_say(
        DOCUMENT,
        &format!("In {share:.0} % of the geometries the exclusion level is within 556 m"),
    );
}

/// Returns the snapshot of an experiment in the reduced form.
fn snapshot(name: &str) -> String {
    document::text(&format!("tests-host/experiments/tests/snapshots/quick__{name}.snap"))
}

/// Returns the passages whose figures are in a record or a snapshot.
pub(crate) fn all() -> Passages {
    let is_rate = |line: &&str| line.trim_end().ends_with("draws; f32 and f64 differ in 0");
    let rates = ["probabilities", "probabilities_recording"]
        .map(|name| snapshot(name).lines().filter(is_rate).count());
    let thresholds = snapshot("yang2015");
    let worst =
        thresholds.lines().find_map(|line| line.split_once("worst relative error")).expect("a line").1;
    let words: Vec<&str> = worst.split_whitespace().collect();
    let (error, count) = (words[0], words[2]);
    let mut passages = vec![
        ("results/adversary.md", format!("| {} rates within their intervals", rates.iter().sum::<usize>())),
        ("RESULTS.md", format!("| {count} values, worst {error} |")),
        (DOCUMENT, format!("| {count} values, worst relative error {error} |")),
    ];
    passages.extend(few_satellites());
    passages
}
