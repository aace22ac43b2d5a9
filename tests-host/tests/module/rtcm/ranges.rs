//! Ranges of a message, which the input must return to their resolution.

use super::TOW_MS;
use super::gps_at;
use super::knowing;
use super::names_of_nonzero;
use crate::wire::B1I;
use crate::wire::B3I;
use crate::wire::Cell;
use crate::wire::E1C;
use crate::wire::L1C;
use crate::wire::L2W;
use crate::wire::epochs;
use crate::wire::feed;
use crate::wire::msm;
use raim_firmware::raw::Band;
use raim_firmware::time::GpsTime;

#[test]
fn an_epoch_of_three_systems_holds_the_ranges_that_were_sent() {
    let mut input = knowing();
    let mut bytes = gps_at(TOW_MS, 2.2e7, true);
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
        // P(Y) is tracked without its code, so that its 40 dB-Hz do not describe the signal.
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

/// If a range grows, the frequency falls.
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
                let want =
                    crate::wire::rates(satellite.satellite.number(), id).filter(|_| level == 5 || level == 7);
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
        // P(Y) takes the strength of C/A.
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
