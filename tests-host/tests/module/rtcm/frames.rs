//! Frames that are cut, wrong or noise cost themselves only.

use super::TOW_MS;
use super::gps;
use super::knowing;
use super::names_of_nonzero;
use crate::wire::Bits;
use crate::wire::Seen;
use crate::wire::epochs;
use crate::wire::feed;
use crate::wire::frame;
use crate::wire::silence;
use proptest::prelude::*;

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
fn a_cut_frame_holds_back_no_epoch() {
    let mut input = knowing();
    // The cut frame's length field is the next frame's preamble: 211 bytes that do not come.
    let mut bytes = vec![0xD3, 0x00];
    bytes.extend(gps(TOW_MS, false));
    assert!(matches!(feed(&mut input, &bytes).as_slice(), [Seen::Epoch(_)]));
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
