//! The demonstration: its refusals, and its result on the emulated board.

use raim::page::canvas::{Ground, ORANGE, RED, RGBColor};
use raim::page::{Moment, Verdict};
use raim::signal::fault::satellite;
use rig::board::is_installed;
use rig::demo::{Live, Plan, Story, View};
use rig::{document, image};

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

/// Compares summary, picture and README with the transcript, which prints what the board sent.
fn agree(transcript: &str, story: &Story) {
    let time_s = |line: &str| -> f64 { line.split_whitespace().next().unwrap().parse().unwrap() };
    let first = |words: &str| {
        let line = transcript.lines().find(|line| line.contains(words));
        time_s(line.unwrap_or_else(|| panic!("{words}: {transcript}")))
    };
    let (excluded_s, silent_s) = (first("G15 left out"), first("STALE"));
    let mut back_s = transcript.lines().map(time_s).zip(transcript.lines());
    let (back_s, _) = back_s.find(|(at_s, line)| *at_s > excluded_s && !line.contains("left out")).unwrap();
    let noticed_s = excluded_s - 40.0;
    // 200 m in 30 s.
    let grown_m = (noticed_s * 200.0 / 30.0).round();
    let epochs = back_s - excluded_s;
    let within_m = story.largest_protected_error_m().ceil();
    let astray_m = story.largest_accepted_error_m().round();

    let summary = story.to_string();
    for want in [
        format!(
            "G15 was wrong from 40 s; noticed after {noticed_s} s at {grown_m} m; left out for {epochs} epochs"
        ),
        "It was low at start, high in 120 epochs, and low 3 s after the line fell silent (alert STALE)"
            .to_owned(),
        "120 epochs were protected, none of them misleading; 2 were alerts, 0 unavailable".to_owned(),
    ] {
        assert!(summary.contains(&want), "{want}:\n{summary}");
    }
    assert_eq!(story.figures().len(), 5, "{summary}");

    for want in [
        format!("A receiver that accepts every satellite goes {astray_m} m astray."),
        format!("The module excludes it, and its position stays within {within_m} m"),
        "The range to one GPS satellite, G15, drifts off by 200 m.".to_owned(),
        format!("After {noticed_s} s the module excludes G15."),
        format!("stays within {within_m} m of the true one. It also stays *protected*"),
        format!("A receiver that accepts every satellite is {astray_m} m off (grey)."),
        "At the end the receiver sends nothing any more, and the module sets its integrity pin low."
            .to_owned(),
    ] {
        document::must_say("README.md", &want);
    }

    // The time axis ends 3 s after the last report, which is the second one on the silent line.
    let picture = story.picture(Ground::Sheet).unwrap();
    let x = |time_s: f64| 72.0 + (960.0 - 72.0 - 22.0) * time_s / (silent_s + 6.0);
    for (colour, from_s, to_s) in [(ORANGE, excluded_s, back_s), (RED, silent_s, silent_s + 6.0)] {
        let (left, width) = box_of(&picture, colour);
        assert!((left - x(from_s)).abs() <= 1.0 && (left + width - x(to_s)).abs() <= 1.0, "{left} {width}");
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/pictures/demo.svg");
    if std::env::var_os("RAI_BLESS").is_some() {
        std::fs::write(path, &picture).unwrap();
    }
    let shown = std::fs::read_to_string(path).unwrap();
    assert!(shown == picture, "pictures/demo.svg is not the picture of this run; RAI_BLESS=1 writes it");
}

/// Returns left edge and width of the last box in a colour, pixels.
fn box_of(svg: &str, colour: RGBColor) -> (f64, f64) {
    let colour = format!("fill=\"#{:02X}{:02X}{:02X}\"", colour.0, colour.1, colour.2);
    let line = svg.lines().rfind(|line| line.starts_with("<rect") && line.contains(&colour)).unwrap();
    let number = |name: &str| {
        let (_, rest) = line.split_once(&format!(" {name}=\"")).unwrap();
        rest.split_once('"').unwrap().0.parse().unwrap()
    };
    (number("x"), number("width"))
}

/// Many seconds each.
mod at_length {
    use super::*;

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
        // At the end the line is silent. That alone drops the pin: until then it is high.
        let (spoken, silent) = story.moments.split_at(120);
        let last = spoken.last().unwrap();
        assert_eq!((last.verdict, last.pin_is_high), (Verdict::Protected, Some(true)));
        for (silence, want_s) in silent.iter().zip([122.0, 125.0]) {
            assert_eq!((silence.verdict, silence.reason.as_str()), (Verdict::Alert, "STALE"));
            assert_eq!((silence.pin_is_high, silence.time_s), (Some(false), want_s));
        }
        assert!(story.moments.iter().all(|moment| moment.reason != "SETTINGS"), "{story}");
        assert_eq!(story.misleading(), 0, "{story}");
        let excluded: Vec<String> =
            story.excluded().iter().map(|(satellite, _)| satellite.to_string()).collect();
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
            .filter(|reported| whole.contains(&reported.time_s))
            .map(|reported| reported.horizontal_error_m)
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
        assert!(story.page().unwrap().html().contains("G15 drifts off"));
        agree(&shown, &story);
    }
}
