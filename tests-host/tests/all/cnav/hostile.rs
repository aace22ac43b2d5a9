//! Wrong frames, and values at their ends: nothing of it is read, or leaves a number that is none.

use raim::signal::encode::ubx::{self, CnavMessage, Form};
use raim::signal::encode::{Frequency, Selection, sbf};
use raim::signal::sky::raw::Simulation;
use raim_core::satellite::SatelliteId;
use raim_firmware::ephemeris::CnavContent;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};

use super::{NOON, cnav, gps, heard};

const DELAYS: CnavMessage = CnavMessage::Delays([-368, -12, 197, -36, 33]);

fn words(satellite: SatelliteId) -> Vec<u32> {
    ubx::cnav_words(satellite, DELAYS, false, NOON).unwrap()
}

#[test]
fn every_flipped_bit_of_a_frame_is_refused_and_the_spare_bits_do_not_matter() {
    let right = words(gps(9));
    for bit in 0..320 {
        let mut words = right.clone();
        words[bit / 32] ^= 1 << (31 - bit % 32);
        let (frames, counters) = heard(&ubx::subframe(gps(9), 7, &words));
        if bit < 300 {
            assert_eq!((frames.len(), counters.subframes_parity), (0, 1), "bit {bit}");
        } else {
            assert_eq!((frames.len(), counters.subframes), (1, 1), "bit {bit}");
        }
    }
}

#[test]
fn frames_of_another_satellite_and_with_another_preamble_are_refused() {
    for number in 1..=32 {
        let (frames, counters) = heard(&ubx::subframe(gps(number), 6, &words(gps(9))));
        let want = usize::from(number == 9);
        assert_eq!((frames.len(), counters.subframes_malformed as usize), (want, 1 - want), "G{number:02}");
    }
    // Of QZSS the lower six bits of 193 to 202.
    for number in 1..=10 {
        let qzss = SatelliteId::qzss(number).unwrap();
        for signal in [4, 5, 8, 9] {
            let (frames, _) = heard(&ubx::subframe(qzss, signal, &words(qzss)));
            assert_eq!(frames.iter().map(|frame| frame.satellite).collect::<Vec<_>>(), [qzss]);
        }
        let (frames, _) = heard(&ubx::subframe(gps(number), 6, &words(qzss)));
        assert_eq!(frames.len(), 1, "both have the number {number}, and signals tell them apart");
    }
    for bit in 0..8 {
        let mut other = words(gps(9));
        other[0] ^= 1 << (31 - bit);
        // The CRC of all bits behind the preamble, and of the wrong preamble: by long division.
        let sealed = with_crc(&other);
        let (frames, counters) = heard(&ubx::subframe(gps(9), 6, &sealed));
        assert_eq!((frames.len(), counters.subframes_malformed), (0, 1), "bit {bit}: {counters:?}");
    }
}

/// Returns the words with a right CRC, by the polynomial's definition.
fn with_crc(words: &[u32]) -> Vec<u32> {
    let mut words = words.to_vec();
    words[8] &= !0 << 12;
    words[9] = 0;
    let bit = |at: usize| words[at / 32] >> (31 - at % 32) & 1;
    let crc = (0..276).map(bit).fold(0_u32, |crc, bit| {
        let sum = crc << 1 ^ if (crc >> 23 ^ bit) & 1 == 1 { 0x0186_4CFB } else { 0 };
        sum & 0x00FF_FFFF
    });
    // The CRC occupies bits 276 to 299: the last 12 bits of the ninth word and the first 12 of the tenth.
    words[8] |= crc >> 12;
    words[9] = (crc & 0xFFF) << 20;
    words
}

#[test]
fn a_crc_by_its_definition_is_that_of_the_encoder() {
    assert_eq!(with_crc(&words(gps(9))), words(gps(9)));
    assert_eq!(Form::Cnav.sealed(&words(gps(9))).unwrap(), words(gps(9)));
}

#[test]
fn frames_of_other_lengths_and_signals_are_not_taken_for_cnav() {
    for length in [0, 1, 8, 9, 11, 16] {
        let mut words = words(gps(9));
        words.resize(length, 0);
        let (frames, counters) = heard(&ubx::subframe(gps(9), 6, &words));
        assert_eq!((frames.len(), counters.subframes), (0, 0), "{length} words: {counters:?}");
    }
    for signal in 0..16 {
        let (frames, _) = heard(&ubx::subframe(gps(9), signal, &words(gps(9))));
        assert_eq!(frames.len(), usize::from(matches!(signal, 3 | 4 | 6 | 7)), "signal {signal}");
        let qzss = SatelliteId::qzss(2).unwrap();
        let (frames, _) = heard(&ubx::subframe(qzss, signal, &words(qzss)));
        assert_eq!(frames.len(), usize::from(matches!(signal, 4 | 5 | 8 | 9)), "signal {signal} of QZSS");
    }
    for kind in 0..64 {
        let (frames, _) = heard(&cnav(gps(9), CnavMessage::Other(kind), false));
        let is_other = frames.iter().all(|frame| frame.content == CnavContent::Other);
        assert_eq!((frames.len(), is_other), (1, !matches!(kind, 10 | 30)), "type {kind}");
    }
}

#[test]
fn blocks_of_sbf_bring_the_same_frames_from_their_own_signals_alone() {
    let qzss = SatelliteId::qzss(3).unwrap();
    for (satellite, signal, number, source) in
        [(gps(9), 3, 4018, 3), (gps(9), 7, 4019, 4), (qzss, 5, 4067, 7), (qzss, 8, 4068, 26)]
    {
        let by_ubx = ubx::subframe(satellite, signal, &words(satellite));
        let by_sbf = sbf::of_ubx(&by_ubx, NOON);
        assert_eq!(u16::from_le_bytes([by_sbf[4], by_sbf[5]]), number);
        assert_eq!(heard(&by_sbf).0, heard(&by_ubx).0);
        for other in 0..32 {
            let mut block = by_sbf.clone();
            block[17] = other;
            assert_eq!(heard(&sbf::sealed(block)).0.len(), usize::from(other == source), "{number}, {other}");
        }
        let mut refused_by_the_receiver = by_sbf.clone();
        refused_by_the_receiver[15] = 0;
        assert_eq!(heard(&sbf::sealed(refused_by_the_receiver)).1.subframes_parity, 1);
        for svid in 0..=255 {
            let mut block = by_sbf.clone();
            block[14] = svid;
            let frames = heard(&sbf::sealed(block)).0;
            assert!(frames.iter().all(|frame| frame.satellite == satellite), "{svid}: {frames:?}");
        }
    }
}

/// Ends of each field of 13 bits, and the value for unknown.
const ENDS: [i16; 5] = [-4096, -4095, -1, 0, 4095];

#[test]
fn delays_at_their_ends_leave_no_number_that_is_none_and_no_promise_beyond_its_level() {
    let recording = Simulation::above_xian(3600.0, 40, 5).record();
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    for [group, other] in ENDS.iter().flat_map(|group| ENDS.map(|other| [*group, other])) {
        let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection.clone(), None);
        let mut receiver = Receiver::new(MemoryPin::default(), Boot::on_host("cnav")).unwrap();
        let truth = recording.approximate_position.unwrap();
        let (mut reported, mut worst) = (Vec::new(), 0.0_f64);
        for (second, epoch) in (0_u64..).zip(&recording.epochs) {
            // One satellite after another learns the extreme delays.
            let number = (second % 32) as u8 + 1;
            let mut bytes =
                cnav(gps(number), CnavMessage::Delays([group, other, other, other, other]), false);
            bytes.extend(encoder.epoch(epoch).unwrap());
            receiver.gnss(&bytes, 1000 * second, &mut reported);
            let report = receiver.last_report().unwrap();
            let Some((solution, levels)) = report.solution.as_ref().zip(report.protection) else { continue };
            if receiver.pin().high {
                worst = worst.max(solution.position.distance_m(truth) / levels.hpl_m.hypot(levels.vpl_m));
            }
        }
        let reported = String::from_utf8(reported).unwrap();
        assert!(!reported.contains("NaN") && !reported.contains("inf"), "{group}, {other}");
        println!("TGD {group}, ISC {other}: error up to {worst:.2} of the level");
        assert!(worst < 1.0, "TGD {group}, ISC {other}: {worst}");
    }
}
