//! The demonstration: its refusals, and its result on the emulated board.

use raim::page::canvas::Ground;
use raim::page::{Moment, Verdict};
use raim::signal::fault::satellite;
use rig::board::is_installed;
use rig::demo::{Live, Plan, View};
use rig::image;

/// Returns the plan of `cargo xtask demo` without options.
fn shown_by_default() -> Plan {
    Plan { bias_m: -200.0, ..plan("G15") }
}

fn plan(name: &str) -> Plan {
    Plan { satellite: satellite(name).unwrap(), bias_m: 80.0, seed: 1 }
}

#[test]
fn satellite_that_is_not_in_the_sky_is_refused_with_those_that_are() {
    let have = plan("C33").simulation().unwrap_err().to_string();
    assert!(have.starts_with("C33 is never received; the satellites are G01 G02"), "{have}");
    assert!(have.ends_with("C12 C13 C14"), "{have}");
}

#[test]
fn every_satellite_in_the_sky_stands_high_enough_when_it_is_its_turn() {
    let all = plan("C08").simulation().unwrap().satellites;
    for id in all.iter().map(|satellite| satellite.id) {
        let simulation = Plan { satellite: id, ..plan("C08") }.simulation().unwrap();
        let last = simulation.sights_at(119);
        assert!(last.iter().any(|sight| sight.satellite == id), "{id} is below the mask at the end");
    }
}

#[test]
fn drifting_satellite_is_left_out_on_the_board_before_the_error_passes_its_bound() {
    if !is_installed() {
        return;
    }
    let mut shown = Vec::new();
    let mut live = Live::new(shown_by_default(), View::Lines, &mut shown);
    let image = image::build().expect("the image builds");
    let story =
        shown_by_default().run(&image, |moments| live.show(moments).unwrap()).expect("the board answers");
    assert_eq!(story.moments.len(), 122);
    // At the end the line is silent, and the module reports it and drops the pin.
    let silence = story.moments.last().unwrap();
    assert_eq!((silence.verdict, silence.reason.as_str()), (Verdict::Alert, "STALE"));
    assert_eq!(silence.pin_is_high, Some(false));
    assert_eq!(story.misleading(), 0, "{story}");
    let excluded: Vec<String> = story.excluded().iter().map(|(satellite, _)| satellite.to_string()).collect();
    assert_eq!(excluded, ["G15"], "{story}");
    let detected_s = story.detection().expect("a detection").time_s;
    assert!((41.0..60.0).contains(&detected_s), "noticed at {detected_s} s");
    // The pin agrees with the verdict, and is low before there is one.
    assert!(!story.pin_at_boot);
    let agrees = |moment: &Moment| moment.pin_is_high == Some(moment.verdict == Verdict::Protected);
    assert!(story.moments.iter().all(agrees), "{story}");
    // With the whole bias, accepting it multiplies the error by more than ten.
    let whole = 70.0..90.0;
    let accepted: Vec<f64> = (story.ordinary.iter())
        .filter(|said| whole.contains(&said.time_s))
        .map(|said| said.horizontal_error_m)
        .collect();
    let have: Vec<f64> = (story.moments.iter())
        .filter(|moment| whole.contains(&moment.time_s))
        .filter_map(|moment| moment.horizontal_error_m)
        .collect();
    assert_eq!((accepted.len(), have.len()), (20, 20));
    let (have_m, accepted_m) = (have.iter().sum::<f64>() / 20.0, accepted.iter().sum::<f64>() / 20.0);
    assert!(accepted_m > 10.0 * have_m, "{have_m} m on average, {accepted_m} m where all are accepted");
    let shown = String::from_utf8(shown).unwrap();
    assert!(shown.lines().count() >= 24 && shown.contains("G15 left out"), "{shown}");
    assert!(story.picture(Ground::Sheet).unwrap().starts_with("<svg"));
    assert!(story.page().unwrap().html().contains("G15 drifts off"));
}
