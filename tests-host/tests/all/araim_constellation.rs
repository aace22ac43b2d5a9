//! A faulty constellation: its clock is harmless, and only solution separation detects a consistent
//! shift.
//!
//! The module receives RTCM and is observed through its sentences. The place of the antenna is
//! known: of the recording by survey, of the simulated sky by construction. The integrity
//! parameters are those at start, `ISM,ICAO`: there Galileo and `BeiDou` may fail as a whole. GPS,
//! with its prior of 1e-8, may not: a shift of GPS has no mode of its own, unless a command gives
//! GPS a larger prior. If it contradicts one other system, it is an alert with either prior.

use raim::replay::{self, Moment, Pace, Summary, Track, Truth, Window};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::fault::Fault;
use raim::signal::recording::Recording;
use raim::signal::sky::raw::Simulation;
use raim::signal::sky::{Fleet, Site};
use raim_core::frame::Ecef;
use raim_firmware::time::GpsTime;
use rig::document;
use rig::stations::ESBC;

/// Shifts by 60 m: east, north, up.
const SIDEWAYS: &str = "60,0,0";
const UPWARDS: &str = "0,0,60";
const SHIFTS: [&str; 3] = [SIDEWAYS, UPWARDS, "36,0,-48"];

/// Larger prior for GPS than the preset's: it fails as a whole as often as the others.
const DOUBTED: &str = "ISM,G,2.4,2.4,0,1e-5,1e-4";

fn run(recording: &Recording, systems: &str, faults: &[Fault], truth: Ecef) -> Track {
    run_set(recording, systems, faults, truth, &[])
}

fn run_set(recording: &Recording, systems: &str, faults: &[Fault], truth: Ecef, set: &[&str]) -> Track {
    let selection = Selection::new(systems, Frequency::Dual).unwrap();
    let lumps = replay::encode(recording, &selection, faults, &Window::ALL).unwrap();
    let setup = ["PHASE,NPA", "METHOD,SEPARATION"].iter().chain(set).map(|&command| command.to_owned());
    let setup: Vec<_> = setup.collect();
    let run = replay::on_host(&lumps, &setup, Pace::Recorded, |_| {}).unwrap();
    replay::track(&lumps, &run, Some(&Truth::Fixed(truth)))
}

fn state(moment: &Moment) -> (char, &str) {
    moment.output.as_ref().map_or((' ', ""), |output| (output.state.state, output.state.reason.as_str()))
}

/// Returns true if there is an alarm, or a satellite is left out.
fn is_seen(moment: &Moment) -> bool {
    let excludes = moment.output.as_ref().is_some_and(|output| !output.excluded.is_empty());
    state(moment).0 == 'A' || excludes
}

/// Returns GPS and Galileo over central Europe, half an hour at 30 s.
fn simulated() -> (Recording, Ecef) {
    let site = Site::geodetic(48.0, 11.0, 500.0);
    let fleets = [Fleet::Gps31, Fleet::Galileo24];
    let simulation = Simulation {
        satellites: fleets.into_iter().flat_map(Fleet::satellites).collect(),
        site,
        origin: GpsTime { week: 2295, tow_ms: 86_400_000 },
        epochs: 60,
        step_s: 30.0,
        ..Simulation::above_xian(3600.0, 60, 7)
    };
    (simulation.record(), site.position)
}

#[test]
fn a_simulated_constellation_that_is_shifted_by_60_m_is_seen_at_once_and_never_misleads() {
    const START_S: f64 = 600.0;
    let (recording, truth) = simulated();
    for shift in SHIFTS {
        let fault = Fault::parse_inject(&format!("E:shift={shift}@{START_S}..")).unwrap();
        let track = run(&recording, "GE", &[fault], truth);
        let (healthy, faulty): (Vec<_>, Vec<_>) = track.iter().partition(|moment| moment.elapsed_s < START_S);
        assert!(healthy.len() == 20 && !healthy.into_iter().any(is_seen), "an alarm without a fault");
        assert_eq!(Summary::of(&track, &[fault], true).misleading, Some(0), "{fault:?}");
        if shift == SIDEWAYS {
            assert!(faulty.into_iter().all(is_seen), "{fault:?}");
        }
    }
}

#[test]
fn a_shift_of_gps_is_seen_at_once_and_misleads_with_neither_prior() {
    const START_S: f64 = 600.0;
    let (recording, truth) = simulated();
    for shift in SHIFTS {
        let fault = Fault::parse_inject(&format!("G:shift={shift}@{START_S}..")).unwrap();
        let misled = |set: &[&str]| {
            let track = run_set(&recording, "GE", &[fault], truth, set);
            let (healthy, faulty): (Vec<_>, Vec<_>) =
                track.iter().partition(|moment| moment.elapsed_s < START_S);
            assert!(healthy.len() == 20 && !healthy.into_iter().any(is_seen), "an alarm without a fault");
            let unseen = faulty.into_iter().filter(|moment| !is_seen(moment)).count();
            (Summary::of(&track, &[fault], true).misleading.unwrap(), unseen)
        };
        let (misleading, unseen) = misled(&[DOUBTED]);
        println!("GE, G shifted by {shift} m: {unseen} of 40 epochs unseen, misleading {misleading}");
        assert_eq!(misleading, 0, "{fault:?}");
        if shift == SIDEWAYS {
            assert_eq!(unseen, 0, "{fault:?}");
            assert_eq!(misled(&[]), (0, 0), "{fault:?}");
        }
    }
}

#[test]
fn a_simulated_constellations_clock_is_harmless() {
    let (recording, truth) = simulated();
    let fault = Fault::parse_inject("E:+60@600..").unwrap();
    let track = run(&recording, "GE", &[fault], truth);
    let healthy = run(&recording, "GE", &[], truth);
    assert!(!track.iter().any(is_seen));
    for (moment, want) in track.iter().zip(&healthy) {
        let (have, want) = (moment.error.unwrap(), want.error.unwrap());
        let moved_m = (have.east - want.east).hypot(have.north - want.north).hypot(have.up - want.up);
        assert!(moved_m < 0.05, "at {} s moved by {moved_m} m", moment.elapsed_s);
    }
}

/// Returns faults for the half hours of the day, with a window of ten faulty epochs in each.
fn windows(system: &str, shift: &str) -> Vec<Fault> {
    let fault = |half_hour| {
        let start_s = 900.0 + 1800.0 * f64::from(half_hour);
        Fault::parse_inject(&format!("{system}:shift={shift}@{start_s}..{}", start_s + 300.0)).unwrap()
    };
    (0..47).map(fault).collect()
}

/// Outcomes of the windows.
#[derive(Debug, Default)]
struct Fate {
    at_once: usize,
    seen: usize,
    misleading: usize,
    largest_unseen_m: f64,
}

fn fate(recording: &Recording, systems: &str, faults: &[Fault]) -> Fate {
    let track = run(recording, systems, faults, ESBC.truth);
    let mut fate =
        Fate { misleading: Summary::of(&track, faults, true).misleading.unwrap(), ..Fate::default() };
    for fault in faults {
        let during: Vec<&Moment> = track.iter().filter(|moment| fault.is_active(moment.elapsed_s)).collect();
        fate.at_once += usize::from(is_seen(during[0]));
        fate.seen += during.iter().filter(|moment| is_seen(moment)).count();
        let unseen = during.iter().filter(|moment| !is_seen(moment)).filter_map(|moment| moment.error);
        let unseen_m = unseen.map(|error| error.horizontal().hypot(error.up)).fold(0.0, f64::max);
        fate.largest_unseen_m = fate.largest_unseen_m.max(unseen_m);
    }
    fate
}

/// Many seconds each.
mod at_length {
    use super::*;

    /// Galileo sideways is always detected in the first epoch. Upward shifts, and those of the few
    /// satellites of `BeiDou`, are detected if they move the position by more than the test allows;
    /// otherwise the error is within the levels.
    #[test]
    fn a_real_constellation_that_is_shifted_by_60_m_is_seen_at_once_and_never_misleads() {
        let Some(recording) = ESBC.load() else { return };
        for (systems, system, row) in [
            ("GE", "E", "| GPS, Galileo; Galileo | east / up / north and down |"),
            ("GCE", "E", "| and BeiDou; Galileo | the same |"),
            ("GCE", "C", "| and BeiDou; BeiDou | the same |"),
        ] {
            let (mut first, mut largest) = (Vec::new(), Vec::new());
            for shift in SHIFTS {
                let faults = windows(system, shift);
                let Fate { at_once, seen, misleading, largest_unseen_m } = fate(&recording, systems, &faults);
                first.push(at_once.to_string());
                largest.push(if largest_unseen_m > 0.0 {
                    format!("{largest_unseen_m:.1} m")
                } else {
                    "–".into()
                });
                println!(
                    "{systems}, {system} shifted by {shift} m: {at_once} of {} seen in the first epoch, {seen} of {} epochs, \
                     largest error unseen {largest_unseen_m:.1} m, misleading {misleading}",
                    faults.len(),
                    10 * faults.len()
                );
                assert_eq!(misleading, 0);
                if system == "E" && shift == SIDEWAYS {
                    assert_eq!((at_once, seen), (faults.len(), 10 * faults.len()));
                }
            }
            let row = format!("{row} {} | {} | 0 |", first.join(" / "), largest.join(" / "));
            document::must_say("results/receivers.md", &row);
        }
    }
}
