//! The papers' experiments in their quick form: every bound holds, and the tables are the committed
//! ones.
//!
//! Results of a recording have their own snapshot, because not everybody has the recording.

use experiments::{EXPERIMENTS, Effort};
use indicatif::ProgressBar;

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

#[test]
fn chen2009() {
    holds("chen2009");
}

#[test]
fn lin2016() {
    holds("lin2016");
}

/// Those that take seconds.
mod at_length {
    #[test]
    fn yang2015() {
        super::holds("yang2015");
    }

    #[test]
    fn methods() {
        super::holds("methods");
    }

    #[test]
    fn parity() {
        super::holds("parity");
    }

    #[test]
    fn tian2024() {
        super::holds("tian2024");
    }

    #[test]
    fn probabilities() {
        super::holds("probabilities");
    }

    #[test]
    fn araim() {
        super::holds("araim");
    }

    #[test]
    fn fde() {
        super::holds("fde");
    }
}
