//! Wrong UBX: each kind is counted by its name, nothing wrong is accepted, and right frames beside
//! it are read.

use raim::signal::encode::ubx;
use raim::signal::measurement::{Ephemeris, TimedEphemeris};
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::input::Counters;
use raim_firmware::raw::Band;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;
use rtcm_rs::{Message, MessageBuilder};

use super::bits::{SOURCES, beidou, gps, inav};
use super::{NOON, by_rtcm, reported};

const RAWX: [u8; 2] = [0x02, 0x15];
const SFRBX: [u8; 2] = [0x02, 0x13];

/// Splits a run of good frames.
fn frames(bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut frames = Vec::new();
    let mut rest = bytes;
    while let [_, _, _, _, low, high, ..] = rest {
        let length = 8 + usize::from(*low) + 256 * usize::from(*high);
        let (frame, behind) = rest.split_at(length);
        frames.push(frame.to_vec());
        rest = behind;
    }
    frames
}

fn payload(frame: &[u8]) -> Vec<u8> {
    frame[6..frame.len() - 2].to_vec()
}

/// Returns one measurement of GPS L1 C/A.
fn measurement(range_m: f64, satellite: [u8; 3]) -> Vec<u8> {
    let mut bytes = Vec::new();
    bytes.extend_from_slice(&range_m.to_le_bytes());
    bytes.extend_from_slice(&(-0.5_f64).to_le_bytes());
    bytes.extend_from_slice(&0_f32.to_le_bytes());
    bytes.extend_from_slice(&satellite);
    bytes.extend_from_slice(&[0, 0xF4, 0xFB, 45, 5, 1, 5, 1, 0]);
    bytes
}

/// Returns an epoch of these measurements.
fn rawx(tow_s: f64, week: u16, many: u8, version: u8, measurements: &[Vec<u8>]) -> Vec<u8> {
    let mut payload = tow_s.to_le_bytes().to_vec();
    payload.extend_from_slice(&week.to_le_bytes());
    payload.extend_from_slice(&[18, many, 1, version, 0, 0]);
    payload.extend(measurements.concat());
    ubx::frame(RAWX, &payload)
}

fn epoch_of(measurements: &[Vec<u8>]) -> Vec<u8> {
    rawx(432_000.0, 2111, measurements.len() as u8, 1, measurements)
}

#[test]
fn no_wrong_bit_of_a_page_makes_another_ephemeris() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    for (name, source) in SOURCES {
        let ephemeris = source(&mut random);
        let want = by_rtcm(&ephemeris);
        let pages = frames(&ubx::pages(&ephemeris, NOON).unwrap());
        let (mut refused, mut harmless) = (0, 0);
        for wrong in 0..pages.len() {
            let original = payload(&pages[wrong]);
            for bit in 64..8 * original.len() {
                let mut page = original.clone();
                page[bit / 8] ^= 1 << (bit % 8);
                let mut stream = pages.clone();
                stream[wrong] = ubx::frame(SFRBX, &page);
                let (have, counters) = reported(&stream.concat());
                if have.ephemerides.is_empty() {
                    let counted = counters.subframes_parity + counters.subframes_malformed;
                    assert_eq!(counted, 1, "{name}: page {wrong}, bit {bit}: {counters:?}");
                    refused += 1;
                } else {
                    assert_eq!(have.ephemerides, want, "{name}: page {wrong}, bit {bit}");
                    harmless += 1;
                }
            }
        }
        // Harmless bits are padding, or unused bits that the code does not cover.
        println!("{name}: {refused} wrong bits refused, {harmless} harmless");
        assert!(refused > 5 * harmless / 2, "{name}: {refused} refused, {harmless} harmless");
    }
}

#[test]
fn pages_out_of_order_make_the_same_ephemeris() {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    for (name, source) in SOURCES {
        for _ in 0..20 {
            let ephemeris = source(&mut random);
            let mut pages = frames(&ubx::pages(&ephemeris, NOON).unwrap());
            // I/NAV completes a set with its last word.
            let is_inav = matches!(ephemeris.message, Ephemeris::GalileoInav(_));
            let movable = pages.len() - usize::from(is_inav);
            pages[..movable].shuffle(&mut random);
            let (have, counters) = reported(&pages.concat());
            assert_eq!(have.ephemerides, by_rtcm(&ephemeris), "{name}: {counters:?}");
        }
    }
}

#[test]
fn pages_of_two_issues_make_none() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for (name, source) in SOURCES {
        let first = source(&mut random);
        let number = first.satellite;
        let second = loop {
            let other = source(&mut random);
            if other.satellite == number {
                break other;
            }
        };
        // The sets are half a minute apart, so that those of BeiDou, which have no issue number, do
        // not follow each other.
        let later = raim_firmware::time::GpsTime::from_ms(NOON.to_ms() + 30_000);
        let (first, second) =
            (frames(&ubx::pages(&first, NOON).unwrap()), frames(&ubx::pages(&second, later).unwrap()));
        for taken in 1..first.len() - 1 {
            let mixed = [&first[..taken], &second[taken..]].concat().concat();
            let (have, counters) = reported(&mixed);
            assert!(have.ephemerides.is_empty(), "{name}, {taken} of the first");
            assert!(counters.subframes_mixed >= 1, "{name}, {taken} of the first: {counters:?}");
        }
    }
}

#[test]
fn a_missing_page_makes_none_until_it_comes() {
    let mut random = ChaCha8Rng::seed_from_u64(8);
    for (name, source) in SOURCES {
        let ephemeris = source(&mut random);
        let pages = frames(&ubx::pages(&ephemeris, NOON).unwrap());
        for missing in 0..pages.len() {
            let mut some = pages.clone();
            let late = some.remove(missing);
            assert!(reported(&some.concat()).0.ephemerides.is_empty(), "{name}: without page {missing}");
            some.push(late);
            // The last word of I/NAV is repeated in any case.
            some.push(pages[pages.len() - 1].clone());
            assert!(!reported(&some.concat()).0.ephemerides.is_empty(), "{name}: page {missing} late");
        }
    }
}

#[test]
fn every_number_of_words_but_the_right_one_is_refused() {
    for (system, signal, right) in
        [(0, 0, 10..=63), (2, 1, 8..=63), (2, 3, 8..=63), (3, 0, 10..=10), (6, 0, 4..=4)]
    {
        for words in 0..=16_u8 {
            let mut payload = vec![system, 7, signal, 0, words, 0, 2, 0];
            payload.resize(8 + 4 * usize::from(words), 0x55);
            let (have, counters) = reported(&ubx::frame(SFRBX, &payload));
            assert!(have.ephemerides.is_empty());
            let refused = counters.subframes_malformed + counters.subframes_other + counters.subframes_parity;
            assert_eq!(refused, 1, "{system}, {words} words: {counters:?}");
            if !right.contains(&words) {
                assert_eq!(counters.subframes_parity, 0, "{system}, {words} words: {counters:?}");
            }
            // The count differs from the number of bytes.
            payload[4] = words + 1;
            let (_, counters) = reported(&ubx::frame(SFRBX, &payload));
            assert_eq!(counters.subframes_malformed, 1, "{system}, {words} words");
        }
    }
}

#[test]
fn systems_satellites_and_signals_that_are_none_are_counted() {
    let words = [0_u32; 10];
    let frame = |system: u8, satellite: u8, signal: u8| {
        let mut payload = vec![system, satellite, signal, 0, 10, 0, 2, 0];
        for word in words {
            payload.extend_from_slice(&u32::to_le_bytes(word));
        }
        reported(&ubx::frame(SFRBX, &payload)).1
    };
    for system in [1, 4, 7, 8, 255] {
        assert_eq!(frame(system, 1, 0).subframes_other, 1, "system {system}");
    }
    for (system, satellite) in
        [(0, 0), (0, 33), (0, 255), (2, 37), (3, 64), (5, 11), (5, 193), (6, 33), (6, 255)]
    {
        assert_eq!(frame(system, satellite, 0).satellites_unknown, 1, "{system} {satellite}");
    }
    // CNAV on L2C has ten words, too, and these have a right CRC. L1C is not read.
    assert_eq!(frame(0, 1, 3).subframes_malformed, 1);
    assert_eq!(frame(0, 1, 12).subframes_other, 1);
    let of =
        |system, satellite, signal| reported(&epoch_of(&[measurement(2.2e7, [system, satellite, signal])])).1;
    assert_eq!(of(7, 1, 0).observations_other, 1);
    assert_eq!(of(0, 33, 0).satellites_unknown, 1);
    assert_eq!(of(0, 1, 9).signals_other, 1);
}

/// Returns the number of satellites of an epoch, and the counters.
fn satellites(frame: &[u8]) -> (Option<usize>, Counters) {
    let (reported, counters) = reported(frame);
    (reported.epochs.first().map(|epoch| epoch.satellites.len()), counters)
}

#[test]
fn doubles_are_hostile_numbers() {
    for range_m in [f64::NAN, f64::INFINITY, -f64::INFINITY, -2.2e7, 0.0, 1e300, f64::MIN_POSITIVE] {
        let (have, counters) = satellites(&epoch_of(&[measurement(range_m, [0, 5, 0])]));
        assert_eq!((have, counters.ranges_out_of_bounds), (Some(0), 1), "{range_m}");
    }
    let good = [measurement(2.2e7, [0, 5, 0])];
    for tow_s in [f64::NAN, f64::INFINITY, -1.0, 604_800.0, 1e300] {
        let (have, counters) = satellites(&rawx(tow_s, 2111, 1, 1, &good));
        assert_eq!((have, counters.times_out_of_range), (None, 1), "{tow_s}");
    }
    // The last half millisecond of a week is the next week.
    let (have, _) = reported(&rawx(604_799.999_8, 2111, 1, 1, &good));
    assert_eq!(have.epochs[0].time, raim_firmware::time::GpsTime { week: 2112, tow_ms: 0 });
    let moved_m = have.epochs[0].satellites[0].signals[0].range_m - 2.2e7;
    assert!((moved_m - 0.000_2 * 299_792_458.0).abs() < 0.01, "{moved_m}");
}

#[test]
fn every_wrong_bit_of_a_frame_is_counted_and_costs_that_frame_alone() {
    let (good, victim) = (
        epoch_of(&[measurement(2.2e7, [0, 5, 0])]),
        frames(&ubx::pages(&gps(&mut ChaCha8Rng::seed_from_u64(1)), NOON).unwrap()),
    );
    let victim = &victim[0];
    for bit in 0..8 * victim.len() {
        let mut wrong = victim.clone();
        wrong[bit / 8] ^= 1 << (bit % 8);
        let mut input = raim_firmware::input::Input::new();
        let mut heard = super::Reported::default();
        input.feed(&[&wrong[..], &good[..]].concat(), 0, |event| heard.receive(&event));
        // A longer length waits for bytes that never come.
        input.silence(|event| heard.receive(&event));
        let counters = input.counters();
        assert_eq!(heard.epochs.len(), 1, "bit {bit}: {counters:?}");
        assert_eq!((counters.frames, counters.subframes), (1, 0), "bit {bit}: {counters:?}");
        assert_eq!(counters.bytes_skipped as usize, wrong.len(), "bit {bit}: {counters:?}");
        // The first two bytes make it a frame, the next four select the message and its length.
        let named = counters.crc_failures + counters.frames_cut;
        assert!(bit < 16 || named >= 1 || (32..48).contains(&bit), "bit {bit}: {counters:?}");
    }
}

#[test]
fn a_set_that_is_never_completed_is_counted_when_it_is_given_up() {
    let mut random = ChaCha8Rng::seed_from_u64(14);
    for (name, source) in SOURCES {
        let ephemeris = source(&mut random);
        let pages = frames(&ubx::pages(&ephemeris, NOON).unwrap());
        let (last, others) = pages.split_last().unwrap();
        let mut input = raim_firmware::input::Input::new();
        let mut heard = super::Reported::default();
        input.feed(&others.concat(), 0, |event| heard.receive(&event));
        input.feed(last, 180_000, |event| heard.receive(&event));
        assert!(heard.ephemerides.is_empty(), "{name}");
        assert_eq!(input.counters().subframes_abandoned, 1, "{name}: {:?}", input.counters());
    }
}

#[test]
fn headers_that_lie_are_refused() {
    let good = [measurement(2.2e7, [0, 5, 0])];
    assert_eq!(satellites(&rawx(432_000.0, 0, 1, 1, &good)).1.epochs_without_week, 1);
    assert_eq!(satellites(&rawx(432_000.0, 2111, 1, 2, &good)).1.messages_malformed, 1);
    // RTKLIB reads version 0 of the eighth generation, which has the same layout.
    assert_eq!(satellites(&rawx(432_000.0, 2111, 1, 0, &good)).0, Some(1));
    assert_eq!(satellites(&rawx(432_000.0, 2111, 2, 1, &good)).1.messages_malformed, 1);
    assert_eq!(satellites(&rawx(432_000.0, 2111, 0, 1, &good)).1.messages_malformed, 1);
    // A receiver was observed to set the highest bit of the count.
    assert_eq!(satellites(&rawx(432_000.0, 2111, 0x81, 1, &good)).0, Some(1));
    for length in 0..16 {
        let counters = satellites(&ubx::frame(RAWX, &vec![0; length])).1;
        assert_eq!(counters.messages_malformed, 1, "{length} bytes");
    }
    // The time of an epoch without satellites is not confirmed until one has some.
    let (have, counters) = satellites(&epoch_of(&[]));
    assert_eq!((have, counters.observations_ahead), (None, 1));
}

#[test]
fn an_epoch_holds_what_it_can_and_counts_the_rest() {
    // 64 satellites with one signal each, of systems that have as many.
    let all =
        (1..=32).map(|n| [0, n, 0]).chain((1..=36).map(|n| [2, n, 0])).chain((1..=63).map(|n| [3, n, 0]));
    let measurements: Vec<Vec<u8>> = all.map(|satellite| measurement(2.2e7, satellite)).collect();
    let (have, counters) = satellites(&epoch_of(&measurements[..64]));
    assert_eq!((have, counters.satellites_surplus), (Some(64), 0));
    let (have, counters) = satellites(&epoch_of(&measurements));
    assert_eq!((have, counters.satellites_surplus as usize), (Some(64), measurements.len() - 64));
    // As many as a message can have.
    let most: Vec<Vec<u8>> = measurements.iter().cycle().take(255).cloned().collect();
    let (have, counters) = satellites(&epoch_of(&most));
    assert_eq!((have, counters.satellites_surplus + counters.signals_surplus), (Some(64), 255 - 64));
    // The same signal twice: the first counts.
    let twice = [measurement(2.2e7, [0, 5, 0]), measurement(2.3e7, [0, 5, 0])];
    let (reported, counters) = reported(&epoch_of(&twice));
    let signals = &reported.epochs[0].satellites[0].signals;
    assert_eq!((signals.len(), counters.signals_surplus), (1, 1));
    assert!((signals[0].range_m - 2.2e7).abs() < 1e-6);
}

/// The message cannot say that a Doppler frequency was not measured; converters write zero.
#[test]
fn doppler_of_zero_is_none() {
    for (doppler_hz, want) in [(0.0_f32, None), (-0.0, None), (1.0, Some(1.0)), (-3000.5, Some(-3000.5))] {
        let mut measured = measurement(2.2e7, [0, 5, 0]);
        measured[16..20].copy_from_slice(&doppler_hz.to_le_bytes());
        let (reported, _) = reported(&epoch_of(&[measured]));
        assert_eq!(reported.epochs[0].satellites[0].signals[0].doppler_hz(), want, "{doppler_hz}");
    }
}

/// A false beginning of the longest message, and a true one behind it, which it covers.
#[test]
fn false_beginning_costs_no_epoch_of_any_length() {
    let all = (1..=32).flat_map(|n| [[0, n, 0], [2, n, 0], [3, n, 0], [0, n, 3], [2, n, 5], [3, n, 2]]);
    let all: Vec<Vec<u8>> =
        all.chain((33..=63).map(|n| [3, n, 0])).map(|kind| measurement(2.2e7, kind)).collect();
    let mut lie = [&[0xB5, 0x62][..], &RAWX, &(16 + 32 * 255_u16).to_le_bytes(), &[0; 11]].concat();
    lie.push(255);
    let others = ubx::frame([0x01, 0x07], &[0; 92]).repeat(90);
    for many in [150, 200, all.len()] {
        let stream = [&lie[..], &epoch_of(&all[..many]), &others].concat().repeat(10);
        let (_, counters) = satellites(&stream);
        assert_eq!(counters.frames, 910, "{many} measurements: {counters:?}");
    }
}

#[test]
fn of_five_signals_of_beidou_those_with_known_delays_are_kept() {
    // B1I, B2I, B3I, B1C, B2a as RAWX numbers them, in every order.
    let signals = [0_u8, 2, 4, 5, 7];
    let mut random = ChaCha8Rng::seed_from_u64(13);
    for many in 4..=5 {
        for _ in 0..60 {
            let mut order = signals;
            order.shuffle(&mut random);
            let measurements: Vec<Vec<u8>> =
                order[..many].iter().map(|signal| measurement(2.2e7, [3, 20, *signal])).collect();
            let (reported, counters) = reported(&epoch_of(&measurements));
            let kept: Vec<Band> =
                reported.epochs[0].satellites[0].signals.iter().map(|signal| signal.carrier.band).collect();
            assert_eq!((kept.len(), counters.signals_surplus as usize), (3, many - 3), "{order:?}");
            for (signal, band) in [(0, Band::B1I), (2, Band::B2I), (4, Band::B3I)] {
                assert_eq!(kept.contains(&band), order[..many].contains(&signal), "{order:?}: {kept:?}");
            }
        }
    }
}

/// Returns a stream in which all formats are mixed, and its ephemeris.
fn mixture() -> (Vec<Vec<u8>>, TimedEphemeris) {
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let ephemeris = gps(&mut random);
    let mut builder = MessageBuilder::new();
    let Ephemeris::Gps(message) = &ephemeris.message else { unreachable!() };
    let rtcm = builder.build_message(&Message::Msg1019(message.clone())).unwrap().to_vec();
    let nmea = b"$GNGGA,092725.00,4717.11399,N,00833.91590,E,1,08,1.01,499.6,M,48.0,M,,*5B\r\n".to_vec();
    let mut parts = vec![nmea.clone()];
    for frame in frames(&ubx::pages(&ephemeris, NOON).unwrap()) {
        parts.extend([frame, rtcm.clone(), nmea.clone()]);
    }
    parts.push(epoch_of(&[measurement(2.2e7, [0, 5, 0])]));
    (parts, ephemeris)
}

#[test]
fn formats_that_are_mixed_are_read_however_the_bytes_arrive() {
    let (parts, ephemeris) = mixture();
    let stream = parts.concat();
    // Three by RTCM and one by UBX.
    let want = [by_rtcm(&ephemeris), by_rtcm(&ephemeris), by_rtcm(&ephemeris), by_rtcm(&ephemeris)].concat();
    for cut in 0..=stream.len() {
        let mut input = raim_firmware::input::Input::new();
        let mut heard = super::Reported::default();
        let (front, back) = stream.split_at(cut);
        input.feed(front, 0, |event| heard.receive(&event));
        input.feed(back, 1, |event| heard.receive(&event));
        assert_eq!((heard.ephemerides.len(), heard.epochs.len()), (4, 1), "cut at {cut}");
        assert_eq!(heard.ephemerides, want, "cut at {cut}");
    }
}

#[test]
fn a_frame_that_is_cut_at_any_byte_costs_itself_alone() {
    let (parts, ephemeris) = mixture();
    let want = by_rtcm(&ephemeris);
    let victim = epoch_of(&[measurement(2.1e7, [0, 6, 0]), measurement(2.1e7, [0, 7, 0])]);
    let stream = parts.concat();
    for cut in 1..victim.len() {
        let mut input = raim_firmware::input::Input::new();
        let mut heard = super::Reported::default();
        input.feed(&[&victim[..cut], &stream[..]].concat(), 0, |event| heard.receive(&event));
        input.silence(|event| heard.receive(&event));
        assert_eq!(heard.ephemerides.len(), 4, "cut at {cut}: {:?}", input.counters());
        assert!(heard.ephemerides.iter().all(|ephemeris| *ephemeris == want[0]), "cut at {cut}");
        assert_eq!(heard.epochs.len(), 1, "cut at {cut}");
    }
}

#[test]
fn a_satellite_that_comes_back_begins_anew() {
    let mut random = ChaCha8Rng::seed_from_u64(10);
    for source in [gps, inav, beidou] {
        let ephemeris = source(&mut random);
        let pages = frames(&ubx::pages(&ephemeris, NOON).unwrap());
        let mut input = raim_firmware::input::Input::new();
        let mut heard = super::Reported::default();
        let (last, others) = pages.split_last().unwrap();
        input.feed(&others.concat(), 0, |event| heard.receive(&event));
        // Three minutes later its last page comes, and matches no set.
        input.feed(last, 180_000, |event| heard.receive(&event));
        assert!(heard.ephemerides.is_empty(), "{ephemeris:?}");
        input.feed(&pages.concat(), 190_000, |event| heard.receive(&event));
        // A word 5 of Galileo serves two sets: that of the words behind it, and that of the words
        // before the next one.
        heard.ephemerides.dedup();
        assert_eq!(heard.ephemerides, by_rtcm(&ephemeris));
    }
}

#[test]
fn more_satellites_than_there_is_room_for_are_heard_later() {
    let mut random = ChaCha8Rng::seed_from_u64(12);
    let mut ephemerides: Vec<TimedEphemeris> = Vec::new();
    while ephemerides.len() < 60 {
        let next = [gps, inav][ephemerides.len() % 2](&mut random);
        if ephemerides.iter().all(|known| known.satellite != next.satellite) {
            ephemerides.push(next);
        }
    }
    let pages: Vec<Vec<Vec<u8>>> =
        ephemerides.iter().map(|ephemeris| frames(&ubx::pages(ephemeris, NOON).unwrap())).collect();
    let (mut input, mut heard) = (raim_firmware::input::Input::new(), super::Reported::default());
    // All satellites send their pages in parallel, twice.
    for turn in 0..10 {
        for pages in &pages {
            if let Some(page) = pages.get(turn % 5) {
                input.feed(page, 6_000 * turn as u64, |event| heard.receive(&event));
            }
        }
    }
    let mut satellites: Vec<SatelliteId> =
        heard.ephemerides.iter().map(raim_firmware::ephemeris::Ephemeris::satellite).collect();
    satellites.sort_unstable();
    satellites.dedup();
    assert!(input.counters().subframes_surplus > 0);
    assert_eq!(satellites.len(), 60, "{:?}", input.counters());
    assert!(satellites.iter().any(|satellite| satellite.constellation() == Constellation::Galileo));
}
