//! The papers' experiments in their quick form: every bound holds, and the tables are the committed ones.

use indicatif::ProgressBar;
use tests_host::experiment::{EXPERIMENTS, Effort};

fn holds(name: &str) {
    let experiment = EXPERIMENTS.iter().find(|experiment| experiment.name == name).expect("an experiment");
    let outcome = (experiment.run)(Effort::Quick, &ProgressBar::hidden()).expect("an outcome");
    let failures: Vec<_> = outcome.failures().collect();
    assert!(failures.is_empty(), "{failures:#?}");
    insta::assert_snapshot!(name, outcome.to_string());
}

#[test]
fn lin2016() {
    holds("lin2016");
}
