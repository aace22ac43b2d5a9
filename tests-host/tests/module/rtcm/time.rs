//! The present week, and time that only goes forward.

use super::TOW_MS;
use super::gps;
use super::knowing;
use super::names_of_nonzero;
use crate::orbits::CASES;
use crate::wire::B1I;
use crate::wire::Cell;
use crate::wire::E1C;
use crate::wire::Seen;
use crate::wire::ephemeris;
use crate::wire::epochs;
use crate::wire::feed;
use crate::wire::msm;
use raim_firmware::input::Input;
use raim_firmware::time::WEEK_MS;

#[test]
fn without_an_ephemeris_the_week_is_unknown_and_epochs_are_dropped() {
    let mut input = Input::new();
    assert!(feed(&mut input, &gps(TOW_MS, false)).is_empty());
    assert_eq!(names_of_nonzero(input.counters()), [("epochs_without_week", 1)]);
}

#[test]
fn a_gps_ephemeris_alone_tells_the_week_of_the_third_cycle() {
    let mut input = Input::new();
    feed(&mut input, &ephemeris(&CASES[0]));
    assert_eq!(epochs(feed(&mut input, &gps(TOW_MS, false)))[0].time.week, 2111);
}

#[test]
fn an_epoch_that_goes_back_is_dropped_whole() {
    let mut input = knowing();
    feed(&mut input, &gps(TOW_MS, false));
    let mut back = gps(TOW_MS - 1000, true);
    back.extend(msm(1097, TOW_MS - 1000, false, &[Cell(31, E1C, 2.5e7, 50.0)]));
    back.extend(gps(TOW_MS, false));
    assert!(feed(&mut input, &back).is_empty());
    assert_eq!(names_of_nonzero(input.counters()), [("epochs_backwards", 2)]);
    assert_eq!(epochs(feed(&mut input, &gps(TOW_MS + 1000, false))).len(), 1);
}

#[test]
fn one_time_far_ahead_does_not_silence_the_receiver() {
    for is_confirmed in [true, false] {
        let mut input = knowing();
        let first = epochs(feed(&mut input, &gps(TOW_MS, false)))[0].time;
        if is_confirmed {
            input.confirm(first, 0);
        }
        assert_eq!(epochs(feed(&mut input, &gps(TOW_MS + 5 * 3_600_000, false))).len(), 1);
        let later: Vec<usize> =
            (1..=7).map(|n| epochs(feed(&mut input, &gps(TOW_MS + n * 1000, false))).len()).collect();
        // Before ranges have agreed with orbits, neither of two times is known to be right.
        let (want, dropped) = if is_confirmed { ([1; 7], 0) } else { ([0, 0, 0, 0, 1, 1, 1], 4) };
        assert_eq!(later, want);
        assert_eq!((input.counters().time_restarts, input.counters().epochs_backwards), (1, dropped));
    }
}

#[test]
fn the_week_rolls_over_between_two_epochs() {
    let mut input = knowing();
    let mut times = Vec::new();
    for tow_ms in [TOW_MS, WEEK_MS - 2000, WEEK_MS - 1000, 0, 1000, 15_000] {
        // BeiDou's own week ends 14 s later.
        let beidou_ms = (tow_ms + WEEK_MS - 14_000) % WEEK_MS;
        let mut bytes = gps(tow_ms, true);
        bytes.extend(msm(1127, beidou_ms, false, &[Cell(6, B1I, 3.8e7, 42.0)]));
        let have = epochs(feed(&mut input, &bytes));
        assert_eq!(have[0].satellites.len(), 2, "at {tow_ms}");
        times.push((have[0].time.week, have[0].time.tow_ms));
    }
    let second = WEEK_MS - 1000;
    assert_eq!(times[2..], [(2111, second), (2112, 0), (2112, 1000), (2112, 15_000)]);
}

#[test]
fn ephemerides_that_agree_correct_a_wrong_week() {
    let mut input = Input::new();
    let mut wrong = CASES[4];
    wrong.week += 700;
    feed(&mut input, &ephemeris(&wrong));
    assert_eq!(epochs(feed(&mut input, &gps(TOW_MS, false)))[0].time.week, 2811);
    for _ in 0..4 {
        feed(&mut input, &ephemeris(&CASES[2]));
    }
    assert_eq!(epochs(feed(&mut input, &gps(TOW_MS + 1000, false)))[0].time.week, 2111);
    assert_eq!(names_of_nonzero(input.counters()), [("week_corrections", 1)]);
}

#[test]
fn a_time_beyond_the_week_is_counted() {
    let mut input = knowing();
    assert!(feed(&mut input, &gps(WEEK_MS, false)).is_empty());
    assert_eq!(names_of_nonzero(input.counters()), [("times_out_of_range", 1)]);
}

#[test]
fn a_week_old_ephemeris_does_not_look_fresh() {
    let mut input = knowing();
    feed(&mut input, &gps(TOW_MS, false));
    let mut old = CASES[0];
    old.week -= 1;
    let seen = feed(&mut input, &ephemeris(&old));
    let [Seen::Ephemeris(have)] = seen.as_slice() else { panic!("{seen:?}") };
    assert_eq!(have.toe().week, 2110);
}

#[test]
fn a_wrong_gps_week_does_not_outvote_two_systems_that_agree() {
    let mut input = knowing();
    feed(&mut input, &gps(TOW_MS, false));
    let mut wrong = CASES[0];
    wrong.week += 3;
    for _ in 0..2 {
        // Galileo and `BeiDou` state the right week once, and 32 GPS satellites a wrong one.
        for right in [&CASES[2], &CASES[4]] {
            feed(&mut input, &ephemeris(right));
        }
        for _ in 0..32 {
            feed(&mut input, &ephemeris(&wrong));
        }
    }
    assert_eq!(input.counters().week_corrections, 0);
    assert_eq!(epochs(feed(&mut input, &gps(TOW_MS + 1000, false)))[0].time.week, 2111);
}

#[test]
fn two_systems_that_agree_correct_the_week_of_a_third_that_came_first() {
    let mut input = Input::new();
    let mut wrong = CASES[0];
    wrong.week += 3;
    for _ in 0..32 {
        feed(&mut input, &ephemeris(&wrong));
    }
    for right in [&CASES[2], &CASES[4], &CASES[2], &CASES[4]] {
        feed(&mut input, &ephemeris(right));
    }
    assert_eq!(epochs(feed(&mut input, &gps(TOW_MS, false)))[0].time.week, 2111);
}

/// The GLONASS messages of each second come before those of GPS, or after an end that was stated
/// too early.
#[test]
fn glonass_tells_the_leap_seconds_before_gps_and_behind_it() {
    const LEAP_MS: u32 = 18_000;
    const MOSCOW_MS: u32 = 3 * 3_600_000;
    let glonass = |tow_ms: u32| {
        let moscow_ms = tow_ms - LEAP_MS + MOSCOW_MS;
        let time = ((moscow_ms / 86_400_000) << 27) + moscow_ms % 86_400_000;
        msm(1087, time, true, &[Cell(3, 2, 2.0e7, 50.0)])
    };
    for is_first in [true, false] {
        let mut input = knowing();
        for second in 0..12 {
            let tow_ms = TOW_MS + 1000 * second;
            let own = [glonass(tow_ms), gps(tow_ms, !is_first)];
            let [a, b] = if is_first { [0, 1] } else { [1, 0] };
            let came_ms = 1000 * u64::from(second);
            input.feed(&own[a], came_ms, |_| {});
            input.feed(&own[b], came_ms + 30, |_| {});
        }
        assert_eq!(input.leap_second().map(|leap| leap.seconds), Some(18), "first: {is_first}");
    }
    // Behind a complete epoch, a message is not before the next.
    let mut input = knowing();
    for second in 0..12 {
        let (tow_ms, came_ms) = (TOW_MS + 1000 * second, 1000 * u64::from(second));
        input.feed(&gps(tow_ms, false), came_ms, |_| {});
        input.feed(&glonass(tow_ms), came_ms + 30, |_| {});
    }
    assert_eq!(input.leap_second(), None);
}

/// [RTCM-10403.3] DF416: day 7 means that the day is not known.
///
/// [RTCM-10403.3]: raim_firmware#references
#[test]
fn glonass_without_a_day_has_the_day_of_the_known_time() {
    const DAY_MS: u32 = 86_400_000;
    const MOSCOW_MS: u32 = 3 * 3_600_000;
    const LEAP_MS: u32 = 18_000;
    const CELLS: [Cell; 1] = [Cell(3, 2, 2.0e7, 50.0)];
    // Each half hour of the week is tried, with its edges and the three hours in which receivers
    // send day 7.
    for half_hour in 0..336 {
        let tow_ms = half_hour * 1_800_000 + 1_000;
        let mut input = knowing();
        // Time and leap seconds come from GPS and GLONASS with a day, twelve seconds of both.
        for second in 0..12 {
            let now_ms = tow_ms + 1000 * second;
            let moscow_ms = (now_ms + 7 * DAY_MS - LEAP_MS + MOSCOW_MS) % (7 * DAY_MS);
            let tagged = ((moscow_ms / DAY_MS) << 27) + moscow_ms % DAY_MS;
            feed(&mut input, &gps(now_ms % (7 * DAY_MS), true));
            feed(&mut input, &msm(1087, tagged, false, &CELLS));
        }
        let later_ms = tow_ms + 20_000;
        let of_day_ms = (later_ms + 7 * DAY_MS - LEAP_MS + MOSCOW_MS) % DAY_MS;
        let seen = epochs(feed(&mut input, &msm(1087, (7 << 27) + of_day_ms, false, &CELLS)));
        assert_eq!(input.counters().times_out_of_range, 0);
        assert_eq!(seen.len(), 1, "half hour {half_hour}");
        assert_eq!(seen[0].time.tow_ms, later_ms % (7 * DAY_MS), "half hour {half_hour}");
    }
}

#[test]
fn glonass_without_a_day_is_counted_before_the_time_is_known() {
    let mut input = Input::new();
    feed(&mut input, &msm(1087, (7 << 27) + 10_191_000, false, &[Cell(3, 2, 2.0e7, 50.0)]));
    assert_eq!((input.counters().times_out_of_range, input.counters().epochs_without_week), (0, 1));
}
