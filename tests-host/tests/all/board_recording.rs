//! Real recordings on the emulated board: the host's sentences, byte for byte, faults and
//! exclusions included; and gpsd behind the board's port.

use std::time::Duration;

use rai_core::frame::LocalFrame;
use tests_host::board::is_installed;
use tests_host::capture::{self, Capture};
use tests_host::encode::{Frequency, Selection};
use tests_host::fault::Fault;
use tests_host::gpsd::Gpsd;
use tests_host::image;
use tests_host::replay::{self, BoardRun, HostRun, Lump, Pace, Truth, Window};
use tests_host::shared;
use tests_host::sky::raw::Simulation;
use tests_host::stations::{ESBC, STATIC_BASE};

/// A command that changes nothing.
const AS_IT_STARTS: &str = "PHASE,NPA";

/// Largest cost of an epoch on the chip, instructions, without the first one with all its
/// ephemerides.
const EPOCH_INSTRUCTIONS: u64 = 4_000_000;

fn on_both(lumps: &[Lump], command: &str) -> (HostRun, BoardRun) {
    let commands = [command.to_owned()];
    let host = replay::on_host(lumps, &commands, Pace::LockStep, |_| {}).expect("the host judges");
    let image = image::build().expect("the image builds");
    let board = replay::on_board(&image, lumps, &host, &commands, |_| {}).expect("the board judges");
    (host, board)
}

fn assert_identical(lumps: &[Lump], command: &str) -> (HostRun, BoardRun) {
    let (host, board) = on_both(lumps, command);
    assert_eq!(board.sentences, host.sentences());
    assert_eq!(board.losses, 0, "bytes lost on the board");
    let costliest = board.instructions.iter().skip(1).max().copied().unwrap_or(0);
    println!("{} epochs, identical; at most {costliest} instructions", lumps.len());
    assert!(costliest > 0 && costliest <= EPOCH_INSTRUCTIONS, "{:?}", board.instructions);
    (host, board)
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
    let (host, _) = assert_identical(&lumps, AS_IT_STARTS);
    assert!(host.sentences().matches("$PRAIX").count() >= 10, "exclusions are part of the comparison");
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
    let (host, board) = on_both(&lumps, "SYSTEMS,GCERJ");
    let said = host.sentences();
    assert_eq!((&board.sentences, board.losses), (&said, 0));
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
    let (host, board) = on_both(&lumps, AS_IT_STARTS);
    let track = replay::track(&lumps, &host, None::<&Truth>).unwrap();
    let want =
        track.last().and_then(|moment| moment.output.as_ref()).and_then(|output| output.position).unwrap();
    for sentence in board.sentences.split_inclusive("\r\n") {
        gpsd.feed(sentence.as_bytes()).expect("gpsd listens");
    }
    let fix = gpsd
        .wait_for(Duration::from_secs(10), |object| {
            object["class"] == "TPV" && object["mode"] == 3 && object["epx"].is_number()
        })
        .expect("a 3D fix with the errors of GBS");
    let have = rai_core::frame::Geodetic {
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
    let image = image::build().expect("the image builds");
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
        let commands = [choice.to_owned()];
        let host = replay::on_host(&lumps, &commands, Pace::LockStep, |_| {}).expect("the host judges");
        let board = replay::on_board(&image, &lumps, &host, &commands, |_| {}).expect("the board judges");
        assert_eq!(board.sentences, host.sentences(), "{choice}");
        println!("{choice}: identical; instructions {:?}", board.instructions);
    }
}
