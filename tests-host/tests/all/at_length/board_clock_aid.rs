//! The forecast receiver clock on the emulated board, and its benefit with few satellites.
//!
//! More than a minute of the whole sky fills the clock's window; then all but a few satellites of
//! GPS are lost. The wanted results are the injected faults: the faulty satellite, and its time.

use std::cmp::Ordering;

use raim::replay::{self, Lump, Pace, Window};
use raim::sentence::epochs;
use raim::signal::encode::{Frequency, Selection};
use raim::signal::fault::Fault;
use raim::signal::sky::raw::Simulation;
use raim::verdict::EpochOutput;
use raim_core::frame::Ecef;
use raim_core::satellite::Constellation;
use rig::board::is_installed;
use rig::{image, lockstep};

/// Time at which the sky empties, s: the window holds 60 values.
const EMPTY_S: u32 = 75;

/// Start of the first fault, s.
const FAULT_S: u32 = 80;

/// Duration of each fault, s.
const FAULT_LENGTH_S: u32 = 2;

/// Quiet before the next fault on four satellites, s: too short for the promise to return.
const SHORT_QUIET_S: u32 = 2;

/// Quiet before the next fault on five satellites, s: a satellite that was excluded brings no
/// redundancy before it has agreed for 10 s.
const LONG_QUIET_S: u32 = 12;

/// End of the recording, s.
const END_S: u32 = 150;

/// Satellites in all directions, each of which is well tested with a clock beside them.
const FOUR: [&str; 4] = ["G05", "G06", "G09", "G13"];

/// Five satellites. All but the last two can be distinguished from each other, from the clock and
/// from a wrong time tag.
const FIVE: [&str; 5] = ["G02", "G07", "G29", "G05", "G13"];

fn simulation() -> Simulation {
    Simulation::above_xian(7200.0, END_S, 11)
}

/// Returns the start of the fault with this number, s.
fn begin_s(number: usize, quiet_s: u32) -> u32 {
    FAULT_S + number as u32 * (FAULT_LENGTH_S + quiet_s)
}

/// Returns a step of 100 m on each of the satellites in turn.
fn steps(satellites: &[&str], quiet_s: u32) -> Vec<String> {
    let step = |(number, satellite): (usize, &&str)| {
        let begin_s = begin_s(number, quiet_s);
        format!("{satellite}:+100@{begin_s}..{}", begin_s + FAULT_LENGTH_S)
    };
    satellites.iter().enumerate().map(step).collect()
}

/// Returns the fault at a second.
fn fault_at(second: u32, quiet_s: u32) -> Option<usize> {
    let since_s = second.checked_sub(FAULT_S)?;
    let number = since_s / (FAULT_LENGTH_S + quiet_s);
    (since_s % (FAULT_LENGTH_S + quiet_s) < FAULT_LENGTH_S).then_some(number as usize)
}

/// Returns GPS as the module receives it: only `kept` satellites once the sky has emptied, and some
/// faults.
fn received(kept: &[&str], faults: &[String]) -> Vec<Lump> {
    let (simulation, recording) = (simulation(), simulation().record());
    let seen = simulation.sights_at(EMPTY_S);
    let lost = seen
        .iter()
        .filter(|sight| sight.satellite.constellation() == Constellation::Gps)
        .map(|sight| sight.satellite.to_string())
        .filter(|satellite| !kept.contains(&satellite.as_str()))
        .map(|satellite| format!("{satellite}:lost@{EMPTY_S}.."));
    let faults: Vec<Fault> =
        lost.chain(faults.iter().cloned()).map(|text| Fault::parse_inject(&text).expect("a fault")).collect();
    let selection = Selection::new("G", Frequency::Dual).expect("a system");
    replay::encode(&recording, &selection, &faults, &Window::ALL).expect("a recording")
}

/// Returns the board's reports, second by second, after a comparison with the host's.
fn judged_on_board(lumps: &[Lump]) -> Option<Vec<EpochOutput>> {
    if !is_installed() {
        return None;
    }
    let commands = ["CLOCKAID,ON".to_owned()];
    let image = image::build().expect("the image builds");
    let mut reported = String::new();
    let source = lumps.iter().cloned().map(Ok);
    let board = lockstep::on_board(&image, source, &commands, |heard| reported.push_str(&heard.board));
    assert_eq!(board.expect("both judge").difference, None, "board and host");
    let outputs = epochs(&reported).expect("sentences");
    assert_eq!(outputs.len(), END_S as usize, "one verdict a second");
    Some(outputs)
}

fn verdict(output: &EpochOutput) -> (char, &str) {
    (output.state.state, output.state.reason.as_str())
}

fn names(output: &EpochOutput) -> Vec<String> {
    output.excluded.iter().map(|excluded| excluded.satellite.to_string()).collect()
}

fn error_m(output: &EpochOutput) -> f64 {
    let truth: Ecef = simulation().site.position;
    output.position.expect("a position").to_ecef().distance_m(truth)
}

/// Returns the reports from the second on at which the sky empties.
fn with_few(outputs: &[EpochOutput]) -> impl Iterator<Item = (u32, &EpochOutput)> {
    (0..).zip(outputs).skip(EMPTY_S as usize)
}

#[test]
fn step_on_one_of_four_satellites_is_an_alarm() {
    let Some(outputs) = judged_on_board(&received(&FOUR, &steps(&FOUR, SHORT_QUIET_S))) else { return };
    // With one degree of freedom the promise returns after ten seconds of agreement; between the
    // faults there are two.
    let returns_s = begin_s(FOUR.len() - 1, SHORT_QUIET_S) + FAULT_LENGTH_S + 10;
    // With four satellites the clock is a forecast ever since the sky emptied. After about a minute
    // its error exceeds its sigma, which is `SIGMAS`.
    let is_forecast = |&(second, _): &(u32, &EpochOutput)| second < EMPTY_S + 50;
    for (second, output) in with_few(&outputs).take_while(is_forecast) {
        assert_eq!((output.state.used, output.state.dof), (4, Some(1)), "{second} s");
        let want = match fault_at(second, SHORT_QUIET_S) {
            // After the first alert the fault may pass for noise, and for a minute the levels exceed the
            // limit.
            _ if (FAULT_S..returns_s + 60).contains(&second) && verdict(output) == ('U', "HPL") => continue,
            Some(number) if number < FOUR.len() => ('A', "FAULT"),
            _ if (FAULT_S..returns_s).contains(&second) => ('U', "RECOVERING"),
            _ => ('P', "OK"),
        };
        assert_eq!(verdict(output), want, "{second} s");
    }
}

#[test]
fn without_the_clock_four_satellites_are_no_test() {
    let lumps = received(&FOUR, &steps(&FOUR, SHORT_QUIET_S));
    let reported = replay::on_host(&lumps, &[], Pace::LockStep, |_| {}).expect("the host judges");
    for (second, output) in with_few(&epochs(&reported.sentences()).expect("sentences")) {
        assert_eq!(verdict(output), ('U', "REDUNDANCY"), "{second} s");
    }
}

#[test]
fn step_on_one_of_five_satellites_is_excluded() {
    let Some(outputs) = judged_on_board(&received(&FIVE, &steps(&FIVE, LONG_QUIET_S))) else { return };
    for (second, output) in with_few(&outputs) {
        match fault_at(second, LONG_QUIET_S).and_then(|number| FIVE.get(number)) {
            // This is after the two alarms, at the end.
            None if second >= begin_s(FIVE.len() - 2, LONG_QUIET_S) => {
                let have = verdict(output);
                assert!(have == ('U', "RECOVERING") || have == ('P', "OK"), "{second} s: {have:?}");
            }
            None => assert_eq!(verdict(output), ('P', "OK"), "{second} s"),
            // Its fault and a wrong time are similar: noise decides whether the module reports the
            // alarm or already recovers.
            Some(&"G05") => assert_ne!(verdict(output).0, 'P', "{second} s"),
            // Its fault and one of another satellite are similar: the module reports it, and
            // accepts none.
            Some(&"G13") => assert_eq!(verdict(output), ('A', "AMBIGUOUS"), "{second} s"),
            Some(&faulty) => {
                assert_eq!(verdict(output), ('P', "EXCLUDED"), "{second} s");
                assert_eq!(names(output), [faulty], "{second} s");
                assert!(error_m(output) < 30.0, "{second} s: {} m off", error_m(output));
            }
        }
    }
}

/// Another clock may be that of another receiver, so that the jump is an alert of the clock.
#[test]
fn jump_of_the_clock_by_2_km_is_no_satellites_fault() {
    let jump = [format!("*:+2000@{FAULT_S}..")];
    let Some(outputs) = judged_on_board(&received(&FIVE, &jump)) else { return };
    for (second, output) in with_few(&outputs) {
        let wanted: &[(char, &str)] = match second.cmp(&FAULT_S) {
            Ordering::Less => &[('P', "OK")],
            Ordering::Equal => &[('A', "CLOCK")],
            Ordering::Greater => &[('U', "RECOVERING"), ('P', "OK")],
        };
        assert!(wanted.contains(&verdict(output)), "{second} s: {:?}", verdict(output));
        assert_eq!(names(output), Vec::<String>::new(), "{second} s");
        if second != FAULT_S {
            assert!(error_m(output) < 30.0, "{second} s: {} m off", error_m(output));
        }
    }
    assert_eq!(verdict(&outputs[END_S as usize - 1]), ('P', "OK"));
    // The forecast row is gone at the jump, and returns after the new clock has been observed for
    // twelve protected seconds.
    let dof = |second: u32| outputs[second as usize].state.dof;
    assert_eq!(
        [dof(FAULT_S - 1), dof(FAULT_S), dof(FAULT_S + 1), dof(END_S - 1)].map(Option::unwrap),
        [2, 1, 1, 2]
    );
}
