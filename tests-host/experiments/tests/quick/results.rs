//! The tables of `results/integrity.md` are those of the records in full. `cargo xtask reproduce NAME --record` renews a
//! record, and `RAI_BLESS=1` the table.

use std::fmt::Write as _;

use experiments::record;
use rig::bench::budget;
use rig::document::must_have;
use serde_json::Value;

const DOCUMENT: &str = "results/integrity.md";

/// Rows of a record.
struct Rows(Vec<Value>);

impl Rows {
    fn of(name: &str) -> Self {
        Self(record::committed(name).expect("a record"))
    }

    /// Returns the rows of a section, or of all, whose quantity has a beginning.
    fn named<'a>(&'a self, section: &'a str, quantity: &'a str) -> impl Iterator<Item = &'a Value> {
        self.0.iter().filter(move |row| {
            text(row, "section").starts_with(section) && text(row, "quantity").starts_with(quantity)
        })
    }

    fn row<'a>(&'a self, section: &'a str, quantity: &'a str) -> &'a Value {
        self.named(section, quantity).next().unwrap_or_else(|| panic!("no row {section}, {quantity}"))
    }

    /// Returns the row with the largest number in a field, of those whose quantity has a beginning
    /// and a part.
    fn largest<'a>(&'a self, field: &str, quantity: &'a str, part: &str) -> &'a Value {
        let rows = self.named("", quantity).filter(|row| text(row, "quantity").contains(part));
        rows.max_by(|one, other| number(one, field).total_cmp(&number(other, field))).expect("a row")
    }
}

fn text<'a>(row: &'a Value, field: &str) -> &'a str {
    row[field].as_str().unwrap_or_default()
}

fn number(row: &Value, field: &str) -> f64 {
    row[field].as_f64().unwrap_or_else(|| panic!("no number {field} in {row}"))
}

/// Returns a rate with its interval.
fn rate(row: &Value, decimals: usize) -> String {
    let [ours, low, high] = ["ours", "low", "high"].map(|field| format!("{:.decimals$}", number(row, field)));
    format!("{ours} ({low} to {high})")
}

/// Methods of isolation that the table compares.
const METHODS: [&str; 5] = ["BAARDA", "SIMULTANEOUS", "HYBRID", "GROUPING", "RANSAC"];

#[test]
fn methods() {
    let rows = Rows::of("methods");
    let heads = METHODS.map(|name| format!("`{name}`")).join(" | ");
    let mut table = format!("| satellites, faulty | {heads} |\n|---|{}\n", "---|".repeat(METHODS.len()));
    for (sky, section, faults) in [
        ("8 GPS", "8 satellites of GPS", 1),
        ("8 GPS", "8 satellites of GPS", 2),
        ("12 BeiDou", "12 satellites of BeiDou", 2),
        ("12 BeiDou", "12 satellites of BeiDou", 3),
        ("28 GPS and BeiDou", "28 satellites of GPS and BeiDou", 1),
        ("28 GPS and BeiDou", "28 satellites of GPS and BeiDou", 2),
        ("28 GPS and BeiDou", "28 satellites of GPS and BeiDou", 3),
    ] {
        let s = if faults == 1 { "" } else { "s" };
        let cells = METHODS.map(|method| share(rows.row(section, &format!("{faults} fault{s}, {method}"))));
        writeln!(table, "| {sky}, {faults} | {} |", cells.join(" | ")).unwrap();
    }
    let budgets = budget::committed().expect("budgets");
    let costs = METHODS.map(|method| {
        let instructions = budgets[&format!("epoch judged by {method}, faulty 2 of 20 satellites, f32")];
        format!("{},000", (instructions + 500) / 1000)
    });
    writeln!(table, "| instructions per epoch, 20 satellites, 2 | {} |", costs.join(" | ")).unwrap();
    must_have(DOCUMENT, "methods", &table);
}

/// Returns the percent of right exclusions, and of wrong ones, which the reason has.
fn share(row: &Value) -> String {
    let parts = text(row, "reason").split(", ");
    let wrong_pct: f64 = parts
        .filter_map(|part| part.strip_prefix("wrong")?.strip_suffix('%')?.trim().parse::<f64>().ok())
        .sum();
    let wrong = if wrong_pct < 0.05 { "–".to_owned() } else { format!("{wrong_pct:.1}") };
    format!("{:.1} ({wrong})", 100.0 * number(row, "ours"))
}

#[test]
fn edge_of_availability() {
    let rows = Rows::of("fde");
    let closed = number(rows.row("", "largest risk of any geometry"), "ours");
    let wrong = number(rows.largest("high", "of these wrong exclusion", ""), "high");
    let failed = |size| rate(rows.largest("high", "failed exclusion", size), 2);
    let mut table = "| event | rate, relative to the requirement |\n|---|---|\n".to_owned();
    for (event, rate) in [
        ("false detection, over P<sub>fa</sub>", rate(rows.row("", "false detection"), 2)),
        ("false alert, over P<sub>fa</sub>", rate(rows.row("", "false alert"), 2)),
        (
            "missed alert, at the worst of eight sizes of the fault, over P<sub>md</sub>",
            rate(rows.largest("ours", "missed alert", ""), 3),
        ),
        ("missed alert, worst geometry and size in closed form, over P<sub>md</sub>", format!("{closed:.3}")),
        (
            "of the missed alerts those with a healthy satellite excluded, over P<sub>md</sub>",
            format!("below {wrong:.2}"),
        ),
        (
            "failed exclusion, of faults that move the position by the limit to four times as far, over 10⁻³",
            failed("by HAL"),
        ),
        (
            "failed exclusion, of faults that every other explanation just fails to explain, over 10⁻³",
            failed("1 of the one that is just told apart"),
        ),
    ] {
        writeln!(table, "| {event} | {rate} |").unwrap();
    }
    must_have(DOCUMENT, "fde", &table);
}

#[test]
fn false_alarms_by_every_setting_of_the_noise() {
    let rows = Rows::of("noise");
    let mut table = String::from(
        "| `NOISE` | geometries | false detection, over P<sub>fa</sub> | false alert, over P<sub>fa</sub> |\n\
         |---|---|---|---|\n",
    );
    let rates: Vec<&Value> = rows.named("", "false ").collect();
    for pair in rates.chunks(2) {
        let [detection, alert] = pair else { panic!("rows come in pairs") };
        let setting = text(detection, "quantity").strip_prefix("false detection, ").expect("a detection");
        let (word, rest) = setting
            .split_once(", ")
            .map_or((setting, String::new()), |(word, rest)| (word, format!(", {rest}")));
        let draws = text(detection, "reason").split(' ').nth(2).expect("a number of draws");
        writeln!(table, "| `{word}`{rest} | {draws} | {} | {} |", rate(detection, 2), rate(alert, 2))
            .unwrap();
    }
    must_have(DOCUMENT, "noise", &table);
}
