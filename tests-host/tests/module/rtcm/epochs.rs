//! Messages that make one epoch, and the time at which it is complete.

use super::TOW_MS;
use super::gps;
use super::gps_at;
use super::knowing;
use super::names_of_nonzero;
use crate::wire::B1I;
use crate::wire::Cell;
use crate::wire::E1C;
use crate::wire::Seen;
use crate::wire::end_epoch;
use crate::wire::epochs;
use crate::wire::feed;
use crate::wire::msm;
use proptest::prelude::*;
use raim_firmware::raw::RawEpoch;
use raim_firmware::time::WEEK_MS;

#[test]
fn an_epoch_without_end_mark_is_complete_when_another_begins() {
    let mut input = knowing();
    assert!(feed(&mut input, &gps(TOW_MS, true)).is_empty());
    let mut bytes = gps(TOW_MS + 1000, true);
    bytes.extend(msm(1097, TOW_MS + 1000, false, &[Cell(31, E1C, 2.5e7, 50.0)]));
    let have = epochs(feed(&mut input, &bytes));
    let sizes: Vec<_> =
        have.iter().map(|epoch| (epoch.time.tow_ms - TOW_MS, epoch.satellites.len())).collect();
    assert_eq!(sizes, [(0, 1), (1000, 2)]);
}

#[test]
fn a_system_that_is_not_used_still_ends_the_epoch() {
    let mut input = knowing();
    let mut bytes = gps(TOW_MS, true);
    // SBAS.
    bytes.extend(msm(1107, TOW_MS, false, &[Cell(3, 2, 2.0e7, 50.0)]));
    assert_eq!(epochs(feed(&mut input, &bytes)).len(), 1);
    assert_eq!(names_of_nonzero(input.counters()), [("observations_other", 1)]);
}

#[test]
fn a_system_without_satellites_still_ends_the_epoch() {
    for (number, time) in [(1077, TOW_MS), (1094, TOW_MS), (1127, TOW_MS - 14_000)] {
        let mut input = knowing();
        let mut bytes = msm(1097, TOW_MS, true, &[Cell(31, E1C, 2.5e7, 50.0)]);
        bytes.extend(msm(number, time, false, &[]));
        let have = epochs(feed(&mut input, &bytes));
        let sizes: Vec<_> = have.iter().map(|epoch| (epoch.time.tow_ms, epoch.satellites.len())).collect();
        assert_eq!(sizes, [(TOW_MS, 1)], "{number}");
        assert_eq!(names_of_nonzero(input.counters()), [], "{number}");
    }
}

#[test]
fn an_empty_sky_is_an_epoch_too() {
    let mut input = knowing();
    feed(&mut input, &gps(TOW_MS, false));
    let have = epochs(feed(&mut input, &msm(1077, TOW_MS + 1000, false, &[])));
    assert!(matches!(have.as_slice(), [epoch] if epoch.satellites.is_empty()), "{have:?}");
}

#[test]
fn a_message_without_satellites_moves_no_clock() {
    for ahead_ms in [0, 1000, 30_000, 3_600_000] {
        let mut input = knowing();
        let mut whole = 0;
        for epoch in 0..10 {
            let tow_ms = TOW_MS + 1000 * epoch;
            let bytes = [msm(1077, tow_ms + ahead_ms, true, &[]), gps(tow_ms, false)].concat();
            whole += sizes(&epochs(feed(&mut input, &bytes)))
                .iter()
                .filter(|(_, satellites)| *satellites > 0)
                .count();
        }
        assert_eq!(whole, 10, "{ahead_ms} ms ahead: {:?}", names_of_nonzero(input.counters()));
    }
}

/// Returns the ranges of three systems at one instant, in the order GPS, GLONASS, `BeiDou`; the
/// last two state that none follows.
fn with_glonass_without_more_bit(tow_ms: u32) -> Vec<u8> {
    let mut bytes = gps(tow_ms, true);
    bytes.extend(msm(1087, 12_345, false, &[Cell(3, 2, 2.0e7, 50.0)]));
    bytes.extend(msm(1127, tow_ms - 14_000, false, &[Cell(6, B1I, 3.8e7, 42.0)]));
    bytes
}

fn sizes(epochs: &[RawEpoch]) -> Vec<(u32, usize)> {
    epochs.iter().map(|epoch| (epoch.time.tow_ms - TOW_MS, epoch.satellites.len())).collect()
}

#[test]
fn a_glonass_message_without_more_bit_does_not_swallow_beidou() {
    let mut input = knowing();
    let bytes: Vec<u8> = (0..5).flat_map(|n| with_glonass_without_more_bit(TOW_MS + n * 1000)).collect();
    let have = sizes(&epochs(feed(&mut input, &bytes)));
    // At first the statement of GLONASS counts; after that it is known to be wrong.
    assert_eq!(have, [(0, 1), (1000, 2), (2000, 2), (3000, 2), (4000, 2)]);
    assert_eq!(input.counters().observations_after_end, 1);
}

#[test]
fn an_epoch_that_comes_twice_makes_nobody_distrusted() {
    let mut input = knowing();
    let whole = |n: u32| {
        let mut bytes = gps(TOW_MS + n * 1000, true);
        bytes.extend(msm(1127, TOW_MS + n * 1000 - 14_000, false, &[Cell(6, B1I, 3.8e7, 42.0)]));
        bytes
    };
    for n in 0..3 {
        assert_eq!(sizes(&epochs(feed(&mut input, &whole(n)))), [(n * 1000, 2)], "at once");
        assert!(feed(&mut input, &whole(n)).is_empty());
    }
    assert_eq!(names_of_nonzero(input.counters()), [("epochs_backwards", 3)]);
}

#[test]
fn a_system_whose_word_does_not_count_is_complete_with_a_pause_and_forgiven_in_time() {
    let mut input = knowing();
    feed(&mut input, &with_glonass_without_more_bit(TOW_MS));
    feed(&mut input, &with_glonass_without_more_bit(TOW_MS + 1000));
    // `BeiDou` has set, so that GLONASS is the last and right.
    let alone = |n: u32| {
        let mut bytes = gps(TOW_MS + n * 1000, true);
        bytes.extend(msm(1087, 12_345, false, &[Cell(3, 2, 2.0e7, 50.0)]));
        bytes
    };
    for n in 2..5 {
        assert!(feed(&mut input, &alone(n)).is_empty(), "epoch {n} waits");
        let mut paused = 0;
        input.pause(|_| paused += 1);
        assert_eq!(paused, 1, "epoch {n} is complete when the line pauses");
    }
    assert_eq!(
        sizes(&epochs(feed(&mut input, &alone(5)))),
        [(5000, 1)],
        "right three times: its word counts"
    );
}

#[test]
fn systems_tagged_less_than_ten_milliseconds_apart_are_one_epoch() {
    for apart_ms in [1, 9] {
        let mut input = knowing();
        let mut bytes = gps(TOW_MS, true);
        bytes.extend(msm(1097, TOW_MS + apart_ms, true, &[Cell(31, E1C, 2.5e7, 50.0)]));
        bytes.extend(msm(1127, TOW_MS - 14_000 - apart_ms, false, &[Cell(6, B1I, 3.8e7, 42.0)]));
        assert_eq!(sizes(&epochs(feed(&mut input, &bytes))), [(0, 3)], "{apart_ms} ms apart");
        assert_eq!(names_of_nonzero(input.counters()), []);
    }
}

#[test]
fn tags_on_both_sides_of_the_week_s_end_are_one_epoch() {
    let mut input = knowing();
    feed(&mut input, &gps(WEEK_MS - 1000, false));
    let mut bytes = gps(WEEK_MS - 1, true);
    bytes.extend(msm(1097, 0, false, &[Cell(31, E1C, 2.5e7, 50.0)]));
    assert_eq!(epochs(feed(&mut input, &bytes)).iter().map(|epoch| epoch.satellites.len()).sum::<usize>(), 2);
    assert_eq!(input.counters().epochs, 2);
}

#[test]
fn an_empty_message_an_hour_ahead_costs_no_epoch() {
    for (place, more) in [(0, true), (0, false), (1, true), (1, false), (2, true), (2, false)] {
        let mut input = knowing();
        feed(&mut input, &gps(TOW_MS - 1000, false));
        let have: Vec<_> = (0..4)
            .flat_map(|n| {
                let tow_ms = TOW_MS + n * 1000;
                let mut frames = vec![
                    gps(tow_ms, true),
                    msm(1097, tow_ms, true, &[Cell(31, E1C, 2.5e7, 50.0)]),
                    msm(1127, tow_ms - 14_000, false, &[Cell(6, B1I, 3.8e7, 42.0)]),
                ];
                // The message is of Galileo, whose messages also state whether more follow.
                frames.insert(place, msm(1097, tow_ms + 3_600_000, more, &[]));
                sizes(&epochs(feed(&mut input, &frames.concat())))
            })
            .collect();
        let whole: Vec<_> = have.iter().filter(|(_, satellites)| *satellites == 3).collect();
        assert!(whole.len() >= 3, "place {place}, more {more}: {have:?}");
        assert_eq!(input.counters().observations_ahead, 4, "{have:?}");
    }
}

#[test]
fn an_empty_message_between_two_others_splits_no_epoch() {
    for ahead_ms in [-10_000_i32, -1000, -300, -20, 20, 100, 480, 1000, 10_000] {
        for more in [true, false] {
            let mut input = knowing();
            let have: Vec<_> = (0..4)
                .flat_map(|n| {
                    let tow_ms = TOW_MS + n * 1000;
                    let galileo = msm(1097, tow_ms, false, &[Cell(31, E1C, 2.5e7, 50.0)]);
                    let empty = msm(1127, (tow_ms - 14_000).saturating_add_signed(ahead_ms), more, &[]);
                    sizes(&epochs(feed(&mut input, &[gps(tow_ms, true), empty, galileo].concat())))
                })
                .collect();
            assert_eq!(have, [(0, 2), (1000, 2), (2000, 2), (3000, 2)], "{ahead_ms} ms ahead, more {more}");
            assert_eq!(input.counters().observations_ahead, 4);
        }
    }
}

proptest! {
    /// A wrong statement of the end costs the epoch in which the system is not distrusted yet.
    #[test]
    fn empty_messages_with_any_tags_anywhere_cost_one_epoch_at_most(
        empties in prop::array::uniform8((0..4_usize, -5000..5000_i32, any::<bool>(), 0..3_usize)),
    ) {
        let mut input = knowing();
        let mut whole = 0;
        for (n, (place, apart_ms, more, system)) in empties.into_iter().enumerate() {
            let tow_ms = TOW_MS + 1000 * n as u32;
            let mut frames = vec![
                gps(tow_ms, true),
                msm(1097, tow_ms, true, &[Cell(31, E1C, 2.5e7, 50.0)]),
                msm(1127, tow_ms - 14_000, false, &[Cell(6, B1I, 3.8e7, 42.0)]),
            ];
            let (number, tag_ms) = [(1077, tow_ms), (1097, tow_ms), (1127, tow_ms - 14_000)][system];
            frames.insert(place, msm(number, tag_ms.saturating_add_signed(apart_ms), more, &[]));
            let mut have = epochs(feed(&mut input, &frames.concat()));
            input.pause(|event| have.extend(epochs(vec![Seen::from(event)])));
            whole += have.iter().filter(|epoch| epoch.satellites.len() == 3).count();
        }
        prop_assert!(whole >= 7, "{whole} of 8");
    }
}

#[test]
fn an_empty_message_that_states_the_end_too_early_costs_the_first_epoch_alone() {
    // Before the ranges of its own epoch, and behind those of the epoch before.
    for ahead_ms in [0, 1000] {
        let mut input = knowing();
        let mut have = Vec::new();
        for n in 0..6 {
            let tow_ms = TOW_MS + n * 1000;
            let empty = msm(1077, tow_ms + ahead_ms, false, &[]);
            let galileo = msm(1097, tow_ms, false, &[Cell(31, E1C, 2.5e7, 50.0)]);
            let whole = [gps(tow_ms, true), galileo].concat();
            let bytes = if ahead_ms == 0 { [empty, whole].concat() } else { [whole, empty].concat() };
            have.extend(sizes(&epochs(feed(&mut input, &bytes))));
            input.pause(|event| have.extend(sizes(&epochs(vec![Seen::from(event)]))));
        }
        let whole = have.iter().filter(|(_, satellites)| *satellites == 2).count();
        assert_eq!(whole, 5, "{ahead_ms} ms ahead: {have:?}");
    }
}

#[test]
fn a_message_an_hour_ahead_costs_its_own_epoch_alone() {
    let mut input = knowing();
    let first = epochs(feed(&mut input, &gps(TOW_MS, false)))[0].time;
    input.confirm(first, 0);
    let times = [1, 3601, 2, 3, 4].map(|second| TOW_MS + second * 1000);
    let have: Vec<_> =
        times.iter().map(|&tow_ms| epochs(feed(&mut input, &gps(tow_ms, false))).len()).collect();
    assert_eq!(have, [1, 1, 1, 1, 1]);
    assert_eq!(names_of_nonzero(input.counters()), [("time_restarts", 1)]);
}

#[test]
fn what_is_left_of_an_epoch_after_lost_bytes_is_dropped_whole() {
    let mut input = knowing();
    feed(&mut input, &gps(TOW_MS, true));
    input.interrupt();
    // The rest of an epoch with lost bytes comes, then a whole one.
    assert!(feed(&mut input, &msm(1097, TOW_MS, false, &[Cell(31, E1C, 2.5e7, 50.0)])).is_empty());
    assert_eq!(sizes(&epochs(feed(&mut input, &gps(TOW_MS + 1000, false)))), [(1000, 1)]);
    assert_eq!(input.counters().epochs_broken, 2);
}

#[test]
fn ranges_that_come_again_under_a_new_tag_are_dropped_and_counted() {
    let mut input = knowing();
    let mut complete = |tow_ms, range_m| epochs(feed(&mut input, &gps_at(tow_ms, range_m, false))).len();
    let fresh = [
        (0, 2.2e7),
        (1000, 2.2e7 + 1.0),
        (2000, 2.2e7 + 1.0),
        (3000, 2.2e7 + 1.0),
        (4000, 2.2e7),
        (5000, 2.2e7),
    ];
    let complete: Vec<usize> = fresh.iter().map(|&(ms, range_m)| complete(TOW_MS + ms, range_m)).collect();
    assert_eq!(complete, [1, 1, 0, 0, 1, 0]);
    assert_eq!(names_of_nonzero(input.counters()), [("epochs_repeated", 3)]);
    // The same range of another satellite is no repeat.
    let other = msm(1077, TOW_MS + 6000, false, &[Cell(6, crate::wire::L1C, 2.2e7, 45.0)]);
    assert_eq!(epochs(feed(&mut input, &other)).len(), 1);
}

/// Galileo's ranges, which come after those of GPS.
fn galileo(tow_ms: u32, more: bool) -> Vec<u8> {
    msm(1097, tow_ms, more, &[Cell(31, E1C, 2.5e7, 50.0)])
}

#[test]
fn silence_completes_an_epoch_whose_messages_all_announce_more() {
    let mut input = knowing();
    for n in 0..3 {
        assert!(feed(&mut input, &gps(TOW_MS + n * 60_000, true)).is_empty(), "epoch {n} is open");
        assert_eq!(sizes(&epochs(end_epoch(&mut input))), [(n * 60_000, 1)]);
        assert!(end_epoch(&mut input).is_empty(), "epoch {n} is complete once");
    }
    assert_eq!(names_of_nonzero(input.counters()), []);
}

#[test]
fn silence_completes_no_epoch_without_ranges() {
    let mut input = knowing();
    assert!(end_epoch(&mut input).is_empty());
    feed(&mut input, &gps(TOW_MS, false));
    assert!(end_epoch(&mut input).is_empty());
    assert!(feed(&mut input, &msm(1077, TOW_MS + 1000, true, &[])).is_empty());
    assert!(end_epoch(&mut input).is_empty());
}

#[test]
fn a_message_after_the_silence_is_no_second_epoch_and_ends_the_trust_in_silence() {
    let mut input = knowing();
    let mut whole = |n: u32| {
        let tow_ms = TOW_MS + n * 1000;
        let mut have = feed(&mut input, &gps(tow_ms, true));
        have.extend(end_epoch(&mut input));
        have.extend(feed(&mut input, &galileo(tow_ms, false)));
        sizes(&epochs(have))
    };
    assert_eq!(whole(0), [(0, 1)]);
    // As for a system that states the end wrongly, the next epochs wait for the rest.
    for n in 1..5 {
        assert_eq!(whole(n), [(n * 1000, 2)]);
    }
    assert_eq!(names_of_nonzero(input.counters()), [("observations_after_end", 1)]);
    // Right three times again: the statement counts.
    for n in 5..8 {
        assert!(feed(&mut input, &gps(TOW_MS + n * 1000, true)).len() <= 1);
        assert!(end_epoch(&mut input).is_empty());
    }
    assert_eq!(sizes(&epochs(feed(&mut input, &gps(TOW_MS + 8000, true)))), [(7000, 1)]);
    assert_eq!(sizes(&epochs(end_epoch(&mut input))), [(8000, 1)]);
}

#[test]
fn an_epoch_that_comes_again_after_the_silence_is_dropped() {
    let mut input = knowing();
    feed(&mut input, &gps(TOW_MS, true));
    assert_eq!(epochs(end_epoch(&mut input)).len(), 1);
    assert!(feed(&mut input, &gps(TOW_MS, true)).is_empty());
    assert!(end_epoch(&mut input).is_empty());
    let seen = feed(&mut input, &gps(TOW_MS + 1000, false));
    assert_eq!(seen.len(), 1, "no rivalry: {seen:?}");
    assert_eq!(sizes(&epochs(seen)), [(1000, 1)]);
}
