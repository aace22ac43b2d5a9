//! Real recordings on the emulated board: the host's sentences, byte for byte, faults and
//! exclusions included; and gpsd behind the board's port.

use std::time::Duration;

use oracle::gpsd::Gpsd;
use raim::replay::{self, BoardRun, Lump, Pace, Window};
use raim::sentence;
use raim::signal::capture::{self, Capture};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::fault::Fault;
use raim::signal::sky::Sight;
use raim::signal::sky::raw::Simulation;
use raim_core::frame::LocalFrame;
use rig::board::is_installed;
use rig::shared;
use rig::stations::{ESBC, STATIC_BASE};
use rig::{image, lockstep};

/// Command that changes nothing.
const AS_IT_STARTS: &str = "PHASE,NPA";

/// Largest cost of an epoch on the chip, instructions, without the first one with all its
/// ephemerides.
const EPOCH_INSTRUCTIONS: u64 = 4_000_000;

/// Sentences of both for some lumps.
struct Both {
    host: String,
    board: String,
    run: BoardRun,
}

fn on_both(lumps: &[Lump], command: &str) -> Both {
    let (mut host, mut board) = (String::new(), String::new());
    let image = image::build().expect("the image builds");
    let source = lumps.iter().cloned().map(Ok);
    let run = lockstep::on_board(&image, source, &[command.to_owned()], |heard| {
        host.push_str(&heard.host);
        board.push_str(&heard.board);
    });
    Both { host, board, run: run.expect("both judge") }
}

fn assert_identical(lumps: &[Lump], command: &str) -> Both {
    let both = on_both(lumps, command);
    let BoardRun { instructions, losses, difference, .. } = &both.run;
    assert_eq!((&both.board, difference), (&both.host, &None));
    assert_eq!(*losses, 0, "bytes lost on the board");
    let costliest = instructions.iter().skip(1).max().copied().unwrap_or(0);
    println!("{} epochs, identical; at most {costliest} instructions", lumps.len());
    assert!(costliest > 0 && costliest <= EPOCH_INSTRUCTIONS, "{instructions:?}");
    both
}

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

#[test]
fn a_real_day_with_faults_is_judged_alike() {
    if !is_installed() {
        return;
    }
    let Some(recording) = ESBC.load() else { return };
    let faults = ["G05:+100@150..300", "G07:+90@450..600", "E07:-120@450..600"]
        .map(|text| Fault::parse_inject(text).unwrap());
    let window = Window { to_s: 900.0, ..Window::ALL };
    let selection = Selection::new("GCE", Frequency::Dual).unwrap();
    let lumps = replay::encode(&recording, &selection, &faults, &window).unwrap();
    let both = assert_identical(&lumps, AS_IT_STARTS);
    assert!(both.host.matches("$PRAIX").count() >= 10, "exclusions are part of the comparison");
}

#[test]
fn geostationary_satellites_at_one_hertz_are_judged_alike() {
    if !is_installed() {
        return;
    }
    let Some(recording) = STATIC_BASE.load() else { return };
    let window = Window { to_s: 20.0, ..Window::ALL };
    let selection = Selection::new("GCE", Frequency::Dual).unwrap();
    assert_identical(&replay::encode(&recording, &selection, &[], &window).unwrap(), AS_IT_STARTS);
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
    let Both { host: said, board, run } = on_both(&lumps, "SYSTEMS,GCERJ");
    assert_eq!((&board, run.losses), (&said, 0));
    let (last, of_glonass) = (said.rfind("$PRAIS").unwrap(), said.rfind("$GLGSA").unwrap());
    assert!(last > of_glonass && said[last..].contains(",P,OK,"), "{}", &said[last..]);
}

#[test]
fn gpsd_behind_the_board_has_a_3d_fix_and_its_errors() {
    if !is_installed() {
        return;
    }
    let Some(mut gpsd) = Gpsd::start_or_skip().expect("gpsd starts") else { return };
    let recording = Simulation::above_xian(0.0, 30, 7).record();
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    let lumps = replay::encode(&recording, &selection, &[], &Window::ALL).unwrap();
    let both = on_both(&lumps, AS_IT_STARTS);
    let want = sentence::epochs(&both.host).unwrap().last().and_then(|output| output.position).unwrap();
    for sentence in both.board.split_inclusive("\r\n") {
        gpsd.feed(sentence.as_bytes()).expect("gpsd listens");
    }
    let fix = gpsd
        .wait_for(Duration::from_secs(10), |object| {
            object["class"] == "TPV" && object["mode"] == 3 && object["epx"].is_number()
        })
        .expect("a 3D fix with the errors of GBS");
    let have = raim_core::frame::Geodetic {
        latitude_rad: fix["lat"].as_f64().unwrap().to_radians(),
        longitude_rad: fix["lon"].as_f64().unwrap().to_radians(),
        height_m: fix["altHAE"].as_f64().unwrap(),
    };
    let apart = LocalFrame::at(want.to_ecef()).rotate(have.to_ecef() - want.to_ecef());
    assert!(apart.horizontal() < 20.0 && apart.up.abs() < 40.0, "gpsd {have:?}, module {want:?}");
    let errors = gpsd.wait_for(Duration::from_secs(10), |object| object["class"] == "GST");
    let errors = errors.expect("the errors of GST");
    assert!(errors["lat"].as_f64().unwrap() > 0.0 && errors["alt"].as_f64().unwrap() > 0.0, "{errors}");
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
