//! Real recordings through the module: errors, rate of protection, no misleading epoch.
//!
//! The bounds are those of an independent program on the same data, rounded up.

use raim::replay::{self, Pace, Summary, Truth, Window};
use raim::signal::encode::{Frequency, Selection};
use rig::stations::{DGAR, ESBC, KMS3, STATIC_BASE, Station, TLSE};

fn summary(station: &Station, systems: &str, frequency: Frequency) -> Option<Summary> {
    let recording = station.load()?;
    let selection = Selection::new(systems, frequency).unwrap();
    let lumps = replay::encode(&recording, &selection, &[], &Window::ALL).unwrap();
    let coefficients =
        recording.klobuchar.map(|klobuchar| klobuchar.map(|value| format!("{value:e}")).join(","));
    let commands: Vec<String> = coefficients.iter().map(|numbers| format!("IONO,{numbers}")).collect();
    let run = replay::on_host(&lumps, &commands, Pace::Recorded, |_| {}).unwrap();
    let track = replay::track(&lumps, &run, Some(&Truth::Fixed(station.truth))).unwrap();
    let summary = Summary::of(&track, &[], true);
    println!(
        "{} {systems} {frequency:?}: {:.2} / {:.2} m, {} of {} protected, {} alerts",
        station.folder,
        summary.horizontal_rms_m.unwrap_or(f64::NAN),
        summary.vertical_rms_m.unwrap_or(f64::NAN),
        summary.protected,
        summary.epochs,
        summary.alerts
    );
    Some(summary)
}

/// Checks that root mean square errors are within the bounds, with a fix in 99.9 % and protection
/// in 99 % of the epochs, without an alert and without a misleading epoch.
fn assert_sound(station: &Station, systems: &str, frequency: Frequency, want_m: (f64, f64)) {
    let Some(have) = summary(station, systems, frequency) else { return };
    assert!(have.horizontal_rms_m.unwrap() <= want_m.0, "want {want_m:?}: {have:?}");
    assert!(have.vertical_rms_m.unwrap() <= want_m.1, "want {want_m:?}: {have:?}");
    assert!(have.fixes * 1000 >= have.epochs * 999, "{have:?}");
    assert!(have.protected * 100 >= have.epochs * 99, "{have:?}");
    assert_eq!((have.alerts, have.misleading, have.hazardous), (0, Some(0), Some(0)), "{have:?}");
}

#[test]
fn a_day_with_three_systems_free_of_the_ionosphere() {
    assert_sound(&ESBC, "GCE", Frequency::Dual, (0.95, 1.35));
}

#[test]
fn a_day_with_two_systems_free_of_the_ionosphere() {
    assert_sound(&ESBC, "GC", Frequency::Dual, (1.35, 1.85));
}

#[test]
fn a_day_with_two_systems_on_one_frequency() {
    assert_sound(&ESBC, "GC", Frequency::Single, (0.85, 1.0));
}

#[test]
fn geostationary_and_inclined_satellites_at_one_hertz() {
    assert_sound(&STATIC_BASE, "GC", Frequency::Dual, (0.6, 0.9));
}

#[test]
fn rinex_2_of_gps_alone_runs_through() {
    assert_sound(&DGAR, "G", Frequency::Dual, (1.6, 2.0));
}

#[test]
fn rinex_4_runs_through() {
    assert_sound(&KMS3, "GCE", Frequency::Dual, (2.0, 3.0));
}

#[test]
fn a_merged_navigation_file_runs_through() {
    assert_sound(&TLSE, "GCE", Frequency::Dual, (2.0, 3.0));
}
