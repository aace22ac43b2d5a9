//! Errors in words: whoever reads one learns which of the reasons it was.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::error::Error;

use rai_core::continuity::ContinuityError;
use rai_core::epoch::EpochError;
use rai_core::integrity::raim::detection::threshold::ThresholdError;
use rai_core::least_squares::SnapshotError;
use rai_core::least_squares::equations::RowError;
use rai_core::least_squares::fix::FixError;
use rai_core::monitor::MonitorError;
use rai_core::numeric::probability::Probability;
use rai_core::requirements::RequirementsError;

/// Lower-case words, no two reasons alike.
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
        &EpochError::Range,
        &EpochError::Position,
        &EpochError::Sigma,
        &EpochError::Duplicate,
        &EpochError::Full,
    ]);
    check(&[&ContinuityError::Speed, &ContinuityError::Height, &ContinuityError::Recovery]);
    check(&[
        &RequirementsError::HorizontalAlertLimit,
        &RequirementsError::VerticalAlertLimit,
        &RequirementsError::TimeToAlert,
        &RequirementsError::GuardFraction,
    ]);
}

#[test]
fn an_error_says_what_the_one_inside_it_says() {
    for inner in [SnapshotError::Insufficient, SnapshotError::Singular] {
        assert_eq!(FixError::Snapshot(inner).to_string(), inner.to_string());
    }
    check(&[&FixError::NotConverged, &FixError::Snapshot(SnapshotError::Singular)]);
    let inner = RequirementsError::GuardFraction;
    assert_eq!(MonitorError::Requirements(inner).to_string(), inner.to_string());
    let nearest = Probability::new(1e-5).unwrap();
    let (false_alarm, missed) =
        (ThresholdError::FalseAlarm { nearest }, ThresholdError::MissedDetection { nearest });
    check(&[&false_alarm, &missed]);
    assert_eq!(MonitorError::Threshold(missed).to_string(), missed.to_string());
}
