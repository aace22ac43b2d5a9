//! The wire: good streams give what was sent, bad ones a named counter and nothing else.

mod orbits;
mod wire;

use orbits::CASES;
use proptest::prelude::*;
use rai_core::frame::Ecef;
use rai_firmware::ephemeris::{GroupDelay, Source};
use rai_firmware::input::{Counters, Input};
use rai_firmware::raw::{Band, RawEpoch};
use rai_firmware::time::{GpsTime, WEEK_MS};
use wire::{B1I, B3I, Bits, Cell, E1C, L1C, L2W, Seen, ephemeris, epochs, feed, frame, msm, silence};

/// Time of week of the first epoch: at the first case's reference time.
const TOW_MS: u32 = 360_000_000;

/// An input that knows the week.
fn knowing() -> Input {
    let mut input = Input::new();
    feed(&mut input, &ephemeris(&CASES[2]));
    input
}

fn gps(tow_ms: u32, more: bool) -> Vec<u8> {
    msm(1077, tow_ms, more, &[Cell(5, L1C, 2.2e7, 45.0), Cell(5, L2W, 2.2e7 + 5.0, 40.0)])
}

fn names_of_nonzero(counters: &Counters) -> Vec<(&'static str, u32)> {
    let dull = ["frames", "epochs", "ephemerides"];
    counters.iter().filter(|(name, value)| *value > 0 && !dull.contains(name)).collect()
}

#[test]
fn an_epoch_of_three_systems_holds_the_ranges_that_were_sent() {
    let mut input = knowing();
    let mut bytes = gps(TOW_MS, true);
    bytes.extend(msm(1097, TOW_MS, true, &[Cell(31, E1C, 2.5e7, 50.0)]));
    bytes.extend(msm(
        1127,
        TOW_MS - 14_000,
        false,
        &[Cell(6, B1I, 3.8e7, 42.5), Cell(6, B3I, 3.8e7 + 9.0, 44.0)],
    ));
    let have = epochs(feed(&mut input, &bytes));
    assert_eq!(have.len(), 1);
    assert_eq!(have[0].time, GpsTime { week: 2111, tow_ms: TOW_MS });
    let flat: Vec<_> = have[0]
        .satellites
        .iter()
        .flat_map(|raw| {
            raw.signals.iter().map(|signal| {
                (raw.satellite.to_string(), signal.carrier.band, signal.cn0_dbhz(), signal.range_m)
            })
        })
        .collect();
    let want = [
        ("G05", Band::L1, Some(45.0), 2.2e7),
        // P(Y), tracked without knowing it: its 40 dB-Hz say nothing of the signal.
        ("G05", Band::L2, None, 2.2e7 + 5.0),
        ("E31", Band::E1, Some(50.0), 2.5e7),
        ("C06", Band::B1I, Some(42.5), 3.8e7),
        ("C06", Band::B3I, Some(44.0), 3.8e7 + 9.0),
    ];
    assert_eq!(flat.len(), want.len());
    for (have, want) in flat.iter().zip(want) {
        assert_eq!((have.0.as_str(), have.1, have.2), (want.0, want.1, want.2));
        // A step of the fine range is 2⁻²⁹ ms, 0.56 mm.
        assert!((have.3 - want.3).abs() < 3e-4, "have {have:?}, want {want:?}");
    }
    assert_eq!(names_of_nonzero(input.counters()), []);
}

#[test]
fn every_level_with_full_ranges_is_read_to_its_resolution() {
    for system in [1070, 1090, 1120] {
        // The narrow fine range has steps of 2⁻²⁴ ms, 18 mm, the wide one of 2⁻²⁹ ms.
        for (level, tolerance_m) in [(4, 9e-3), (5, 9e-3), (6, 3e-4), (7, 3e-4)] {
            let mut input = knowing();
            let cells = [Cell(7, L1C, 2.3e7 + 0.123, 41.0), Cell(19, L1C, 2.1e7 - 0.321, 47.0)];
            let have = epochs(feed(&mut input, &msm(system + level, TOW_MS, false, &cells)));
            let signals: Vec<_> = have[0].satellites.iter().flat_map(|raw| raw.signals.iter()).collect();
            assert_eq!(signals.len(), 2);
            for (have, want) in signals.iter().zip(cells) {
                assert!((have.range_m - want.2).abs() < tolerance_m, "{}: {have:?}", system + level);
                assert!(
                    (f64::from(have.cn0_dbhz().unwrap_or(0.0)) - want.3).abs() < 1e-6,
                    "{}: {have:?}",
                    system + level
                );
            }
        }
    }
}

/// A range that grows is a frequency that falls.
#[test]
fn levels_with_rates_tell_the_doppler_and_others_none() {
    let cells = [
        Cell(5, L1C, 2.2e7, 45.0),
        Cell(5, L2W, 2.2e7, 40.0),
        Cell(9, L1C, 2.4e7, 40.0),
        Cell(19, L1C, 2.1e7, 47.0),
        Cell(19, L2W, 2.1e7, 47.0),
    ];
    for level in 4..=7 {
        let have = epochs(feed(&mut knowing(), &msm(1070 + level, TOW_MS, false, &cells)));
        for satellite in &have[0].satellites {
            for signal in &satellite.signals {
                let id = if signal.carrier.band == Band::L1 { L1C } else { L2W };
                let want = wire::rates(satellite.satellite.number(), id).filter(|_| level == 5 || level == 7);
                let want_hz = want.map(|(rough, fine)| {
                    -(rough as f64 + fine as f64 * 1e-4) * signal.carrier.frequency_hz() / 299_792_458.0
                });
                let have_hz = signal.doppler_hz();
                assert_eq!(have_hz.is_some(), want_hz.is_some(), "level {level}, {}", satellite.satellite);
                let error_hz = f64::from(have_hz.unwrap_or(0.0)) - want_hz.unwrap_or(0.0);
                assert!(error_hz.abs() < 2e-3, "level {level}: have {have_hz:?}, want {want_hz:?}");
            }
        }
    }
}

#[test]
fn the_two_galileo_messages_differ_in_what_their_clock_refers_to() {
    let step_s = 2f64.powi(-32);
    let mut case = CASES[2];
    for (source, want) in [
        (
            Source::GalileoInav,
            [(Band::E1, Some(9.0 * step_s)), (Band::E5b, Some(9.0 * step_s * (154f64 / 118.0).powi(2)))],
        ),
        (Source::GalileoFnav, [(Band::E1, Some(-3.0 * step_s)), (Band::E5b, None)]),
    ] {
        case.source = source;
        let seen = feed(&mut Input::new(), &ephemeris(&case));
        let [Seen::Ephemeris(have)] = seen.as_slice() else { panic!("{seen:?}") };
        assert_eq!(have.source(), source);
        assert!((have.accuracy_m((Band::E1, None)).unwrap() - 3.12).abs() < 1e-6);
        for (band, want) in want {
            let have = have.group_delay(band).map(GroupDelay::seconds);
            assert_eq!(have.is_some(), want.is_some(), "{band:?}");
            assert!((have.unwrap_or(0.0) - want.unwrap_or(0.0)).abs() < 1e-15, "{band:?} {have:?} {want:?}");
        }
    }
}

#[test]
fn ephemerides_on_the_wire_give_the_positions_of_a_separate_program() {
    let mut input = Input::new();
    for case in &CASES[..7] {
        let seen = feed(&mut input, &ephemeris(case));
        let [Seen::Ephemeris(have)] = seen.as_slice() else { panic!("{}: {seen:?}", case.id()) };
        assert_eq!((have.satellite(), have.toe()), (case.id(), case.toe()));
        for want in &case.want {
            let received =
                GpsTime::from_ms(case.toe().to_ms().checked_add_signed(want.after_toe_ms).unwrap());
            let state = have.at(received, want.range_m).unwrap();
            let [x, y, z] = want.position_m;
            assert!(state.position.distance_m(Ecef::new(x, y, z)) < 5e-4, "{}: {state:?}", case.id());
            assert!((state.clock_s - want.clock_s).abs() < 1e-13, "{}: {state:?}", case.id());
        }
    }
}

#[test]
fn the_standard_s_own_example_of_1005_is_read() {
    // The example of the standard's section 4: frame and coordinates.
    let bytes = [
        0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98, 0x0E, 0xDE, 0xEF, 0x34, 0xB4, 0xBD, 0x62, 0xAC,
        0x09, 0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98,
    ];
    let seen = feed(&mut Input::new(), &bytes);
    let [Seen::Position(have)] = seen.as_slice() else { panic!("{seen:?}") };
    let want = Ecef::new(1_114_104.599_9, -4_850_729.710_8, 3_975_521.464_3);
    assert!(have.distance_m(want) < 1e-4, "have {have:?}, want {want:?}");
}

#[test]
fn a_position_at_the_centre_of_the_earth_is_none() {
    let mut input = Input::new();
    let bytes = frame(&Bits::default().put(12, 1005).put(60, 0).put(60, 0).put(20, 0).bytes());
    assert!(feed(&mut input, &bytes).is_empty());
    assert_eq!(names_of_nonzero(input.counters()), [("positions_invalid", 1)]);
}

#[test]
fn a_good_frame_inside_a_bad_one_is_not_lost() {
    let mut input = knowing();
    // A false preamble whose length swallows all three epochs.
    let mut bytes = vec![0xD3, 0x01, 0x20];
    for epoch in 0..3 {
        bytes.extend(gps(TOW_MS + epoch * 1000, false));
    }
    bytes.resize(3 + 0x120 + 3, 0);
    let have = epochs(feed(&mut input, &bytes));
    let times: Vec<u32> = have.iter().map(|epoch| epoch.time.tow_ms - TOW_MS).collect();
    assert_eq!(times, [0, 1000, 2000]);
    assert_eq!(input.counters().crc_failures, 1);
}

#[test]
fn a_wrong_crc_is_counted_and_the_next_frame_is_read() {
    let mut input = knowing();
    let mut bad = gps(TOW_MS, false);
    *bad.last_mut().unwrap() ^= 1;
    assert!(feed(&mut input, &bad).is_empty());
    assert_eq!(input.counters().crc_failures, 1);
    assert_eq!(input.counters().bytes_skipped as usize, bad.len());
    assert_eq!(epochs(feed(&mut input, &gps(TOW_MS, false))).len(), 1);
}

#[test]
fn a_frame_cut_anywhere_costs_itself_only() {
    let whole = gps(TOW_MS, false);
    for cut in 0..whole.len() {
        let mut input = knowing();
        let mut bytes = whole[..cut].to_vec();
        for epoch in 1..=3 {
            bytes.extend(gps(TOW_MS + epoch * 1000, false));
        }
        // The stream goes on beyond whatever length the cut frame announced.
        bytes.resize(bytes.len() + 1029, 0);
        assert_eq!(epochs(feed(&mut input, &bytes)).len(), 3, "cut at {cut}");
    }
}

#[test]
fn a_silent_line_frees_the_epoch_that_a_cut_frame_holds_back() {
    let mut input = knowing();
    // The cut frame's length field is the next frame's preamble: 211 bytes that do not come.
    let mut bytes = vec![0xD3, 0x00];
    bytes.extend(gps(TOW_MS, false));
    assert!(feed(&mut input, &bytes).is_empty());
    assert!(matches!(silence(&mut input).as_slice(), [Seen::Epoch(_)]));
    assert!(silence(&mut input).is_empty());
    assert_eq!(names_of_nonzero(input.counters()), [("bytes_skipped", 2), ("frames_cut", 1)]);
}

#[test]
fn a_frame_of_maximal_length_is_read_through() {
    let mut input = knowing();
    let mut payload = Bits::default().put(12, 4095).bytes();
    payload.resize(1023, 0xD3);
    let mut bytes = frame(&payload);
    bytes.extend(gps(TOW_MS, false));
    assert_eq!(epochs(feed(&mut input, &bytes)).len(), 1);
    assert_eq!(names_of_nonzero(input.counters()), [("messages_other", 1)]);
}

#[test]
fn a_message_shorter_than_its_type_is_malformed() {
    for number in [1005, 1006, 1019, 1042, 1045, 1046, 1074, 1077, 1084, 1097, 1117, 1127] {
        let mut input = knowing();
        assert!(feed(&mut input, &frame(&Bits::default().put(12, number).put(20, 0).bytes())).is_empty());
        assert_eq!(names_of_nonzero(input.counters()), [("messages_malformed", 1)], "{number}");
    }
    let mut input = knowing();
    assert!(feed(&mut input, &frame(&[])).is_empty());
    assert_eq!(names_of_nonzero(input.counters()), [("messages_malformed", 1)]);
}

#[test]
fn masks_with_more_cells_than_the_standard_allows_are_malformed() {
    let mut input = knowing();
    let bits = Bits::default().put(12, 1077).put(12, 1).put(30, i64::from(TOW_MS)).put(19, 0);
    let bytes = bits.put(32, -1).put(32, -1).put(32, -1);
    let mut payload = bytes.bytes();
    payload.resize(1023, 0xFF);
    assert!(feed(&mut input, &frame(&payload)).is_empty());
    assert_eq!(names_of_nonzero(input.counters()), [("messages_malformed", 1)]);
}

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
    let mut input = knowing();
    feed(&mut input, &gps(TOW_MS, false));
    assert_eq!(epochs(feed(&mut input, &gps(TOW_MS + 5 * 3_600_000, false))).len(), 1);
    let later: Vec<usize> =
        (1..=7).map(|n| epochs(feed(&mut input, &gps(TOW_MS + n * 1000, false))).len()).collect();
    assert_eq!(later, [1, 1, 1, 1, 1, 1, 1]);
    assert_eq!(names_of_nonzero(input.counters()), [("time_restarts", 1)]);
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
fn of_two_codes_on_one_band_the_one_that_the_clock_is_of_is_used() {
    // Signals 4, 15 and 16 are L1 Y, L2 CM and L2 CL; [RTCM-10403.3] table 3.5-91.
    for (cells, want) in [
        ([Cell(5, L1C, 2.2e7, 45.0), Cell(5, 4, 2.2e7 + 1.0, 40.0)], 2.2e7 + 1.0),
        ([Cell(5, 15, 2.2e7, 45.0), Cell(5, 16, 2.2e7 + 1.0, 45.0)], 2.2e7),
    ] {
        let mut input = knowing();
        let have = epochs(feed(&mut input, &msm(1077, TOW_MS, false, &cells)));
        let signals = have[0].satellites[0].signals.iter();
        let signals: Vec<_> = signals.map(|signal| (signal.range_m.round(), signal.cn0_dbhz())).collect();
        // C/A lends P(Y) its strength.
        assert_eq!(signals, [(want, Some(45.0))]);
        assert_eq!(names_of_nonzero(input.counters()), [("signals_surplus", 1)]);
    }
}

#[test]
fn of_two_satellites_with_one_id_the_first_is_used() {
    let mut input = knowing();
    let mut bytes = msm(1077, TOW_MS, true, &[Cell(5, L1C, 2.2e7, 45.0)]);
    bytes.extend(msm(1077, TOW_MS, false, &[Cell(5, L1C, 2.3e7, 45.0), Cell(6, L1C, 2.4e7, 45.0)]));
    let have = epochs(feed(&mut input, &bytes));
    let ranges: Vec<f64> = have[0].satellites.iter().map(|raw| raw.signals[0].range_m.round()).collect();
    assert_eq!(ranges, [2.2e7, 2.4e7]);
    assert_eq!(names_of_nonzero(input.counters()), [("satellites_duplicate", 1)]);
}

#[test]
fn the_sixty_fourth_satellite_of_one_message_is_unknown_and_the_next_message_overflows() {
    let mut input = knowing();
    let all: Vec<Cell> = (1..=64).map(|id| Cell(id, B1I, 3.0e7, 40.0)).collect();
    let mut bytes = msm(1127, TOW_MS - 14_000, true, &all);
    bytes.extend(msm(1077, TOW_MS, false, &[Cell(1, L1C, 2.2e7, 45.0), Cell(2, L1C, 2.2e7, 45.0)]));
    let have = epochs(feed(&mut input, &bytes));
    assert_eq!(have[0].satellites.len(), 64);
    assert_eq!(names_of_nonzero(input.counters()), [("satellites_unknown", 1), ("satellites_surplus", 1)]);
}

#[test]
fn ranges_that_no_satellite_can_have_are_dropped() {
    let mut input = knowing();
    let cells = [Cell(1, L1C, 0.0, 45.0), Cell(2, L1C, 7.5e7, 45.0), Cell(3, L1C, 2.2e7, 45.0)];
    let have = epochs(feed(&mut input, &msm(1077, TOW_MS, false, &cells)));
    assert_eq!(have[0].satellites.len(), 1);
    assert_eq!(names_of_nonzero(input.counters()), [("ranges_out_of_bounds", 2)]);
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

/// Ranges of three systems at one instant, in the order GPS, GLONASS, `BeiDou`; the last two say that none follows.
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
    // The first time the word of GLONASS is taken; after that it is known to be wrong.
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
    // BeiDou has set: GLONASS is the last and right.
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
                // Of Galileo, whose messages say besides whether more follow.
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
fn a_message_an_hour_ahead_costs_its_own_epoch_alone() {
    let mut input = knowing();
    feed(&mut input, &gps(TOW_MS, false));
    let times = [1, 3601, 2, 3, 4].map(|second| TOW_MS + second * 1000);
    let have: Vec<_> =
        times.iter().map(|&tow_ms| epochs(feed(&mut input, &gps(tow_ms, false))).len()).collect();
    assert_eq!(have, [1, 1, 1, 1, 1]);
    assert_eq!(names_of_nonzero(input.counters()), [("time_restarts", 1)]);
}

#[test]
fn a_wrong_gps_week_does_not_outvote_two_systems_that_agree() {
    let mut input = knowing();
    feed(&mut input, &gps(TOW_MS, false));
    let mut wrong = CASES[0];
    wrong.week += 3;
    for _ in 0..2 {
        // Galileo and BeiDou say the right week once, and 32 GPS satellites a wrong one.
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

#[test]
fn what_is_left_of_an_epoch_after_lost_bytes_is_dropped_whole() {
    let mut input = knowing();
    feed(&mut input, &gps(TOW_MS, true));
    input.interrupt();
    // The end of the epoch of which bytes were lost, then a whole one.
    assert!(feed(&mut input, &msm(1097, TOW_MS, false, &[Cell(31, E1C, 2.5e7, 50.0)])).is_empty());
    assert_eq!(sizes(&epochs(feed(&mut input, &gps(TOW_MS + 1000, false)))), [(1000, 1)]);
    assert_eq!(input.counters().epochs_broken, 2);
}

/// Every type that is read, and some that are not.
const TYPES: [i64; 24] = [
    1005, 1006, 1019, 1020, 1042, 1045, 1046, 1071, 1074, 1075, 1076, 1077, 1084, 1087, 1094, 1095, 1096,
    1097, 1107, 1117, 1124, 1125, 1126, 1127,
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    /// Noise, then a good epoch: the noise is counted and the epoch read.
    #[test]
    fn random_bytes_leave_the_input_alive(noise in prop::collection::vec(any::<u8>(), 0..1500)) {
        let mut input = knowing();
        feed(&mut input, &noise);
        // Whatever length the noise announced last has run out after a full frame of zeros.
        feed(&mut input, &[0; 1031]);
        prop_assert_eq!(epochs(feed(&mut input, &gps(TOW_MS, false))).len(), 1);
        prop_assert!(noise.is_empty() || input.counters().bytes_skipped as usize >= noise.len());
    }

    /// A right CRC around any payload of any type.
    #[test]
    fn a_valid_frame_may_hold_anything(
        number in prop::sample::select(&TYPES[..]),
        length in 2usize..1024,
        fill in prop::collection::vec(any::<u8>(), 1023),
        sparse in any::<bool>(),
    ) {
        let mut payload = Bits::default().put(12, number).put(4, i64::from(fill[1] & 15)).bytes();
        payload.extend_from_slice(&fill[2..]);
        payload.truncate(length);
        if sparse {
            // Masks with few bits, so that the cells are reached.
            payload.iter_mut().skip(9).take(12).for_each(|byte| *byte &= 1 << (*byte & 7));
        }
        let mut input = knowing();
        for seen in feed(&mut input, &frame(&payload)) {
            if let Seen::Epoch(epoch) = seen {
                prop_assert!(epoch.satellites.iter().flat_map(|raw| &raw.signals).all(|s| s.range_m.is_finite()));
            }
        }
        prop_assert_eq!(input.counters().frames, 2);
    }
}
