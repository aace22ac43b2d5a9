//! The papers' experiments in their quick form: every bound holds, and the tables are the committed
//! ones.
//!
//! Results of a recording have their own snapshot, because not everybody has the recording.

mod results;

use std::collections::BTreeSet;

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
