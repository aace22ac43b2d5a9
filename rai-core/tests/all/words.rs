//! Error messages: each names its reason unambiguously.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::error::Error;

use raim_core::epoch::EpochError;
use raim_core::frame::Ecef;
use raim_core::internals::continuity::{ContinuityError, Recovery};
use raim_core::internals::integrity::raim::detection::threshold::ThresholdError;
use raim_core::internals::integrity::raim::detection::threshold::policy::NoThreshold;
use raim_core::internals::integrity::raim::isolation::ransac::NoConsensus;
use raim_core::internals::least_squares::SnapshotError;
use raim_core::internals::least_squares::equations::RowError;
use raim_core::internals::least_squares::fix::FixError;
use raim_core::internals::numeric::probability::Probability;
use raim_core::monitor::MonitorError;
use raim_core::requirements::RequirementsError;

/// Checks for lower-case words, with no two reasons alike.
fn check(errors: &[&dyn Error]) {
    let texts: BTreeSet<String> = errors.iter().map(ToString::to_string).collect();
    assert_eq!(texts.len(), errors.len(), "two alike: {texts:?}");
    for text in &texts {
        assert!(text.contains(' ') && !text.starts_with(char::is_uppercase), "{text:?}");
    }
}

#[test]
fn every_reason_has_words_of_its_own() {
    check(&[&RowError::Residual, &RowError::LineOfSight, &RowError::Sigma, &RowError::Full]);
    check(&[&SnapshotError::Insufficient, &SnapshotError::Singular]);
    check(&[
        &EpochError::Range(0.0),
        &EpochError::Position(Ecef::CENTRE),
        &EpochError::Sigma(0.0),
        &EpochError::Duplicate,
        &EpochError::Full,
    ]);
    let recovery = Recovery { epochs: 0, seconds: 0.0 };
    check(&[
        &ContinuityError::Speed(0.0),
        &ContinuityError::Height { min_height_m: 0.0, max_height_m: 0.0 },
        &ContinuityError::Recovery(recovery),
    ]);
    check(&[&NoThreshold::Redundancy, &NoThreshold::Risk]);
    check(&[&NoConsensus::TooFewSubsets, &NoConsensus::NoInlier]);
    check(&[
        &RequirementsError::HorizontalAlertLimit(0.0),
        &RequirementsError::VerticalAlertLimit(0.0),
        &RequirementsError::TimeToAlert(0.0),
        &RequirementsError::GuardFraction(0.0),
    ]);
}

#[test]
fn an_error_says_what_the_one_inside_it_says() {
    for inner in [SnapshotError::Insufficient, SnapshotError::Singular] {
        assert_eq!(FixError::Snapshot(inner).to_string(), inner.to_string());
    }
    check(&[&FixError::NotConverged, &FixError::Snapshot(SnapshotError::Singular)]);
    let inner = RequirementsError::GuardFraction(0.0);
    assert_eq!(MonitorError::Requirements(inner).to_string(), inner.to_string());
    let (value, nearest) = (Probability::new(2e-5).unwrap(), Probability::new(1e-5).unwrap());
    let (false_alarm, missed) =
        (ThresholdError::FalseAlarm { value, nearest }, ThresholdError::MissedDetection { value, nearest });
    check(&[&false_alarm, &missed]);
    assert_eq!(MonitorError::Threshold(missed).to_string(), missed.to_string());
}
