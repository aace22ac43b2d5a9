//! Real recordings through the module: errors, rate of protection, no misleading epoch.
//!
//! The bounds are those of an independent program on the same data, rounded up.

use raim::replay::{self, Pace, Summary, Truth, Window};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::recording::Recording;
use raim::signal::sample::Sample;
use raim_core::frame::Ecef;
use rig::document;
use rig::recordings::{kamakura, station_3040};
use rig::skip;
use rig::stations::{DGAR, ESBC, KMS3, STATIC_BASE, Station, TLSE};

fn summary(station: &Station, systems: &str, frequency: Frequency) -> Option<Summary> {
    Some(summary_of(&station.load()?, (station.folder, station.truth), systems, frequency))
}

/// Sends a recording to the module as bytes, and compares its positions with the place of the
/// antenna.
fn summary_of(
    recording: &Recording,
    (name, truth): (&str, Ecef),
    systems: &str,
    frequency: Frequency,
) -> Summary {
    let selection = Selection::new(systems, frequency).unwrap();
    let lumps = replay::encode(recording, &selection, &[], &Window::ALL).unwrap();
    let coefficients =
        recording.klobuchar.map(|klobuchar| klobuchar.map(|value| format!("{value:e}")).join(","));
    let commands: Vec<String> = coefficients.iter().map(|numbers| format!("IONO,{numbers}")).collect();
    let run = replay::on_host(&lumps, &commands, Pace::Recorded, |_| {}).unwrap();
    let track = replay::track(&lumps, &run, Some(&Truth::Fixed(truth)));
    let summary = Summary::of(&track, &[], true);
    println!(
        "{} {systems} {frequency:?}: {:.2} / {:.2} m, {} of {} protected, {} alerts",
        name,
        summary.horizontal_rms_m.unwrap_or(f64::NAN),
        summary.vertical_rms_m.unwrap_or(f64::NAN),
        summary.protected,
        summary.epochs,
        summary.alerts
    );
    summary
}

/// Checks that root mean square errors are within the bounds, with a fix in 99.9 % and protection
/// in 99 % of the epochs, without an alert and without a misleading epoch. Checks also that the
/// results have the figures.
fn assert_sound(station: &Station, systems: &str, frequency: Frequency, want_m: (f64, f64)) {
    let Some(have) = summary(station, systems, frequency) else { return };
    assert!(have.horizontal_rms_m.unwrap() <= want_m.0, "want {want_m:?}: {have:?}");
    assert!(have.vertical_rms_m.unwrap() <= want_m.1, "want {want_m:?}: {have:?}");
    assert!(have.fixes * 1000 >= have.epochs * 999, "{have:?}");
    assert!(have.protected * 100 >= have.epochs * 99, "{have:?}");
    assert_eq!((have.alerts, have.misleading, have.hazardous), (0, Some(0), Some(0)), "{have:?}");
    document::must_say("results/receivers.md", &row(&have, systems, frequency));
}

/// Returns the cells of the results from the systems on.
fn row(summary: &Summary, systems: &str, frequency: Frequency) -> String {
    let systems = match systems {
        "GCE" => "GPS, Galileo, BeiDou",
        "GC" => "GPS, BeiDou",
        _ => "GPS",
    };
    let ranges = if frequency == Frequency::Dual { "ionosphere-free" } else { "one frequency" };
    let Summary { protected, epochs, .. } = summary;
    let [horizontal_m, vertical_m] = errors_m(summary);
    format!("| {systems} | {ranges} | {horizontal_m:.2} / {vertical_m:.2} | {protected} of {epochs} |")
}

fn errors_m(summary: &Summary) -> [f64; 2] {
    [summary.horizontal_rms_m, summary.vertical_rms_m].map(|error_m| error_m.expect("positions"))
}

#[test]
fn a_day_with_three_systems_free_of_the_ionosphere() {
    assert_sound(&ESBC, "GCE", Frequency::Dual, (0.95, 1.35));
}

#[test]
fn readme_and_results_have_the_errors_of_that_day() {
    let Some(have) = summary(&ESBC, "GCE", Frequency::Dual) else { return };
    let [horizontal_m, vertical_m] = errors_m(&have);
    document::must_say(
        "README.md",
        &format!("errors of {horizontal_m:.2} m horizontally and {vertical_m:.2} m vertically"),
    );
    let Summary { protected, epochs, .. } = have;
    document::must_say(
        "RESULTS.md",
        &format!("{horizontal_m:.2} / {vertical_m:.2} m, {protected} of {epochs} epochs protected"),
    );
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

/// Checks that every epoch is protected, with the antenna within its levels.
fn assert_within_its_levels(name: &str, packaged: Option<Sample>, systems: &str, epochs: usize) {
    let Some(Sample { observations, navigation, truth }) = packaged else {
        return skip::say("the recordings of packages (`cargo xtask setup --recordings`)");
    };
    let recording = Recording::load(&[observations], &[navigation]).expect("a recording");
    for frequency in [Frequency::Dual, Frequency::Single] {
        let have = summary_of(&recording, (name, truth), systems, frequency);
        assert_eq!((have.epochs, have.protected), (epochs, epochs), "{frequency:?}: {have:?}");
        assert_eq!((have.alerts, have.misleading, have.hazardous), (0, Some(0), Some(0)), "{have:?}");
    }
}

#[test]
fn packaged_minute_of_three_systems_is_within_its_levels() {
    assert_within_its_levels("kamakura", kamakura(), "GCE", 60);
}

#[test]
fn packaged_hour_of_gps_of_2005_is_within_its_levels() {
    assert_within_its_levels("3040", station_3040(), "G", 120);
}
