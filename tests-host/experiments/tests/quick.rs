//! The papers' experiments in their quick form: every bound holds, and the tables are the committed
//! ones.
//!
//! Results of a recording have their own snapshot, because not everybody has the recording.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use experiments::{EXPERIMENTS, Effort, record};
use indicatif::ProgressBar;
use serde_json::Value;

fn holds(name: &str) {
    let experiment = EXPERIMENTS.iter().find(|experiment| experiment.name == name).expect("an experiment");
    let mut outcome = (experiment.run)(Effort::Quick, &ProgressBar::hidden()).expect("an outcome");
    let failures: Vec<_> = outcome.failures().collect();
    assert!(failures.is_empty(), "{failures:#?}");
    let mut recorded = outcome.clone();
    outcome.sections.retain(|section| !section.title.contains("recording"));
    recorded.sections.retain(|section| section.title.contains("recording") && !section.rows.is_empty());
    insta::assert_snapshot!(name, outcome.to_string());
    if !recorded.sections.is_empty() {
        insta::assert_snapshot!(format!("{name}_recording"), recorded.to_string());
    }
}

/// Defines a test for each experiment, under its name. Those after `at_length` take seconds.
macro_rules! experiments {
    ({ $($name:ident,)* } at_length { $($long:ident,)* }) => {
        $(#[test]
        fn $name() {
            holds(stringify!($name));
        })*

        mod at_length {
            $(#[test]
            fn $long() {
                super::holds(stringify!($long));
            })*
        }

        #[test]
        fn every_experiment_has_a_test() {
            let tested = BTreeSet::from([$(stringify!($name),)* $(stringify!($long),)*]);
            let known: BTreeSet<&str> = EXPERIMENTS.iter().map(|experiment| experiment.name).collect();
            assert_eq!(known, tested);
        }
    };
}

experiments! {
    { chen2009, lin2016, }
    at_length { yang2015, methods, parity, tian2024, probabilities, araim, fde, noise, }
}

/// Returns a rate with its interval.
fn rate(row: &Value) -> String {
    let of = |name: &str| row[name].as_f64().expect("a number");
    format!("{:.2} ({:.2} to {:.2})", of("ours"), of("low"), of("high"))
}

/// `cargo xtask reproduce noise --record` renews the record, `RAI_BLESS=1` the table.
#[test]
fn results_have_the_false_alarms_by_every_setting_of_the_noise() {
    let record = record::committed("noise").expect("a record");
    let is_rate =
        |row: &&Value| row["quantity"].as_str().is_some_and(|quantity| quantity.starts_with("false "));
    let rows: Vec<&Value> = record["rows"].as_array().expect("rows").iter().filter(is_rate).collect();
    let mut table = String::from(
        "| `NOISE` | geometries | false detection, over P<sub>fa</sub> | false alert, over P<sub>fa</sub> |\n\
         |---|---|---|---|\n",
    );
    for pair in rows.chunks(2) {
        let [detection, alert] = pair else { panic!("rows come in pairs") };
        let text = |row: &Value, name: &str| row[name].as_str().expect("a text").to_owned();
        let quantity = text(detection, "quantity");
        let setting = quantity.strip_prefix("false detection, ").expect("a detection");
        let (word, rest) = setting
            .split_once(", ")
            .map_or((setting, String::new()), |(word, rest)| (word, format!(", {rest}")));
        let reason = text(detection, "reason");
        let draws = reason.split(' ').nth(2).expect("a number of draws");
        writeln!(table, "| `{word}`{rest} | {draws} | {} | {} |", rate(detection), rate(alert)).unwrap();
    }
    rig::document::must_have("results/integrity.md", "noise", &table);
}
