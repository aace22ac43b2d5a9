//! A system whose time tags contradict the messages before it.

use super::TOW_MS;
use super::gps;
use super::knowing;
use super::names_of_nonzero;
use crate::wire::B1I;
use crate::wire::Cell;
use crate::wire::E1C;
use crate::wire::epochs;
use crate::wire::feed;
use crate::wire::msm;

/// Returns the ranges of three systems at one instant. `BeiDou` is last and tags it `ahead_ms` too
/// late.
fn whole(tow_ms: u32, ahead_ms: u32) -> Vec<u8> {
    let mut bytes = gps(tow_ms, true);
    bytes.extend(msm(1097, tow_ms, true, &[Cell(31, E1C, 2.5e7, 50.0)]));
    bytes.extend(msm(1127, tow_ms - 14_000 + ahead_ms, false, &[Cell(6, B1I, 3.8e7, 42.0)]));
    bytes
}

#[test]
fn system_tagged_seconds_ahead_is_left_out_and_the_others_stay() {
    // A station of 2012 tags `BeiDou` with GPS time, which is 14 s ahead.
    for ahead_ms in [500, 1000, 14_000, 600_000] {
        let mut input = knowing();
        let mut sizes = Vec::new();
        for n in 0..30 {
            let have = epochs(feed(&mut input, &whole(TOW_MS + n * 1000, ahead_ms)));
            sizes.push(have.iter().map(|epoch| epoch.satellites.len()).max());
        }
        assert!(sizes.iter().all(|&size| size == Some(2)), "{ahead_ms} ms: {sizes:?}");
        assert_eq!(names_of_nonzero(input.counters()), [("observations_astray", 30)], "{ahead_ms} ms");
    }
}

#[test]
fn a_chain_whose_end_was_lost_keeps_no_system_out() {
    let mut input = knowing();
    for n in 0..3 {
        feed(&mut input, &whole(TOW_MS + n * 1000, 0));
    }
    // The messages of Galileo and `BeiDou` of one instant are missing.
    feed(&mut input, &gps(TOW_MS + 3000, true));
    let have = epochs(feed(&mut input, &whole(TOW_MS + 4000, 0)));
    let sizes: Vec<_> = have.iter().map(|epoch| epoch.satellites.len()).collect();
    assert_eq!(sizes, [1, 3]);
    assert_eq!(names_of_nonzero(input.counters()), []);
}

#[test]
fn a_receiver_that_always_announces_more_keeps_every_system() {
    let mut input = knowing();
    let galileo = |tow_ms| msm(1097, tow_ms, true, &[Cell(31, E1C, 2.5e7, 50.0)]);
    let mut sizes = Vec::new();
    for n in 0..3 {
        feed(&mut input, &gps(TOW_MS + n * 2000, true));
        // The other system comes alone, a second later.
        let have = epochs(feed(&mut input, &galileo(TOW_MS + n * 2000 + 1000)));
        sizes.extend(have.iter().map(|epoch| epoch.satellites.len()));
    }
    assert_eq!(sizes, [1, 1, 1]);
    assert_eq!(names_of_nonzero(input.counters()), []);
}
