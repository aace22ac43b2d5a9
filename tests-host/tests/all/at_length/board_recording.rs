//! More recordings and skies on the emulated board and in process.

use raim::replay::{self, Pace, Window};
use raim::sentence;
use raim::signal::capture::{self, Capture};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::fault::Fault;
use raim::signal::sky::Sight;
use raim::signal::sky::raw::Simulation;
use rig::board::is_installed;
use rig::shared;
use rig::stations::ESBC;

use crate::board_recording::{AS_IT_STARTS, Both, assert_identical, on_both};

/// Returns states and reasons, epoch by epoch.
fn verdicts(sentences: &str) -> Vec<(char, String)> {
    let epochs = sentence::epochs(sentences).unwrap();
    epochs.into_iter().map(|epoch| (epoch.state.state, epoch.state.reason)).collect()
}

/// Satellites agree for a minute after the alert by the tags, and for some tenths of a second by
/// the board's clock.
#[test]
fn a_recovery_ends_with_the_same_epoch() {
    if !is_installed() {
        return;
    }
    let simulation = Simulation { step_s: 30.0, ..Simulation::above_xian(3600.0, 16, 5) };
    let seen = simulation.sights_at(0);
    // The faults are of more satellites than can be excluded.
    let fault = |(sight, bias_m): (&Sight, i32)| {
        Fault::parse_inject(&format!("{}:{bias_m:+}@120..210", sight.satellite)).unwrap()
    };
    let faults: Vec<Fault> = seen.iter().zip([300, -450, 700, -900, 1300, -1700]).map(fault).collect();
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    let lumps = replay::encode(&simulation.record(), &selection, &faults, &Window::ALL).unwrap();
    let both = assert_identical(&lumps, AS_IT_STARTS);
    let have = verdicts(&both.host);
    let states: String = have.iter().map(|(state, _)| *state).collect();
    let recorded = replay::on_host(&lumps, &[], Pace::Recorded, |_| {}).unwrap();
    assert_eq!(have, verdicts(&recorded.sentences()), "time runs as by the tags where it counts");
    assert!(states.contains("AUU") && states.ends_with('P'), "{states}");
}

/// The stream has navigation bits of five systems, state vectors that are integrated, and ranges as
/// doubles.
#[test]
fn a_u_blox_stream_of_five_systems_is_judged_alike() {
    let Some(path) = shared::path_or_skip("data/ubx/static1hz_base.ubx.gz") else { return };
    if !is_installed() {
        return;
    }
    let bytes = capture::read(&path.display().to_string(), 0.0).unwrap();
    let window = Window { to_s: 40.0, ..Window::ALL };
    let lumps = Capture::of(bytes, None).unwrap().lumps(&[], &window).unwrap().lumps;
    // The epochs have more than fifty satellites, so the other tests check the cost.
    let Both { host: reported, board, run } = on_both(&lumps, "SYSTEMS,GCERJ");
    assert_eq!((&board, run.losses), (&reported, 0));
    let (last, of_glonass) = (reported.rfind("$PRAIS").unwrap(), reported.rfind("$GLGSA").unwrap());
    assert!(last > of_glonass && reported[last..].contains(",P,OK,"), "{}", &reported[last..]);
}

#[test]
fn every_method_and_policy_is_judged_alike() {
    if !is_installed() {
        return;
    }
    let Some(recording) = ESBC.load() else { return };
    let faults =
        ["G05:+100@60..", "E07:-140@120..", "G07:+90@180.."].map(|text| Fault::parse_inject(text).unwrap());
    let window = Window { to_s: 270.0, ..Window::ALL };
    let lumps =
        replay::encode(&recording, &Selection::new("GCE", Frequency::Dual).unwrap(), &faults, &window);
    let lumps = lumps.unwrap();
    for choice in [
        "METHOD,SIMULTANEOUS",
        "METHOD,SEQUENTIAL",
        "METHOD,HYBRID",
        "METHOD,GROUPING",
        "METHOD,RANSAC",
        "POLICY,T2",
        "POLICY,TOP",
        "CLOCKAID,ON",
    ] {
        let both = on_both(&lumps, choice);
        assert_eq!(both.board, both.host, "{choice}");
        println!("{choice}: identical; instructions {:?}", both.run.instructions);
    }
}
