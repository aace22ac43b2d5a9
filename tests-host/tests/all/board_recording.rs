//! Real recordings on the emulated board: the host's sentences, byte for byte, faults and
//! exclusions included; and gpsd behind the board's port.

use std::time::Duration;

use oracle::gpsd::Gpsd;
use raim::replay::{self, BoardRun, Lump, Window};
use raim::sentence;
use raim::signal::encode::{Frequency, Selection};
use raim::signal::fault::Fault;
use raim::signal::sky::raw::Simulation;
use raim_core::frame::LocalFrame;
use rig::board::is_installed;
use rig::stations::{ESBC, STATIC_BASE};
use rig::{image, lockstep};

/// Command that changes nothing.
pub(crate) const AS_IT_STARTS: &str = "PHASE,NPA";

/// Largest cost of an epoch on the chip, instructions, without the first one with all its
/// ephemerides.
const EPOCH_INSTRUCTIONS: u64 = 4_000_000;

/// Sentences of both for some lumps.
pub(crate) struct Both {
    pub(crate) host: String,
    pub(crate) board: String,
    pub(crate) run: BoardRun,
}

pub(crate) fn on_both(lumps: &[Lump], command: &str) -> Both {
    let (mut host, mut board) = (String::new(), String::new());
    let image = image::build().expect("the image builds");
    let source = lumps.iter().cloned().map(Ok);
    let run = lockstep::on_board(&image, source, &[command.to_owned()], |heard| {
        host.push_str(&heard.host);
        board.push_str(&heard.board);
    });
    Both { host, board, run: run.expect("both judge") }
}

pub(crate) fn assert_identical(lumps: &[Lump], command: &str) -> Both {
    let both = on_both(lumps, command);
    let BoardRun { instructions, losses, difference, .. } = &both.run;
    assert_eq!((&both.board, difference), (&both.host, &None));
    assert_eq!(*losses, 0, "bytes lost on the board");
    let costliest = instructions.iter().skip(1).max().copied().unwrap_or(0);
    println!("{} epochs, identical; at most {costliest} instructions", lumps.len());
    assert!(costliest > 0 && costliest <= EPOCH_INSTRUCTIONS, "{instructions:?}");
    both
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

/// Many seconds each.
mod at_length {
    use super::*;

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
}
