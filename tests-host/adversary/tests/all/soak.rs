//! The short soak: some minutes on the emulated board, under a simulated sky and with a recording,
//! with every kind of disturbance.

use adversary::soak::{self, Outcome, Plan, table};
use rig::board::is_installed;
use rig::image;

/// Soaks and checks the counts that must be zero, after a check that every kind of event occurred.
fn soak(plan: Plan) {
    let image = image::build().expect("the image builds");
    let outcome = soak::run(&image, plan, |_| {}).expect("the board runs to the end");
    println!("{}", table::table(std::slice::from_ref(&outcome)));
    assert_eq!(outcome.broken(), Vec::<String>::new());
    assert_all_happened(&outcome);
}

fn assert_all_happened(outcome: &Outcome) {
    let (tally, watch) = (&outcome.tally, &outcome.watch);
    assert!(outcome.disturbances.iter().all(|(_, count)| *count > 0), "{:?}", outcome.disturbances);
    assert!(tally.starts_asked > 2 && watch.starts == tally.starts_asked, "{} starts", watch.starts);
    assert!(!watch.to_alert_s.is_empty(), "the line fell silent under a high pin");
    assert!(tally.early > 0, "ephemerides came too early");
    assert!(outcome.unread > 0, "the host port was left unread");
    assert!(tally.falsified > 0 && tally.beyond_promise > 0, "false ranges");
    assert!(tally.accepted.iter().sum::<u64>() > 0, "false ranges that matter");
    // Several false ranges at once contradict the sigmas, which ends promises for a minute.
    assert!(tally.in_state('P') > tally.offered / 8, "{:?}", tally.verdicts);
    assert!(tally.due > tally.offered / 3, "{} of {} epochs were due", tally.due, tally.offered);
    assert!(!watch.to_pin_ticks.is_empty(), "the time to the pin was measured");
}

#[test]
fn minutes_of_a_simulated_sky_leave_every_count_at_zero() {
    if is_installed() {
        soak(Plan::short_sky(4));
    }
}

#[test]
fn minutes_of_a_recording_leave_every_count_at_zero() {
    if !is_installed() {
        return;
    }
    if let Some(plan) = Plan::short_recording(1) {
        soak(plan);
    }
}
