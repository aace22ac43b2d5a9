//! Captures that break off, that have noise between their frames, or damaged frames.

use raim::signal::pieces::{Kind, pieces};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt as _, SeedableRng as _};

use super::{epochs, judged, times};

#[test]
fn a_capture_that_breaks_off_anywhere_has_the_epochs_before() {
    let Some(bytes) = epochs(12) else { return };
    let whole = judged(&bytes, &[]);
    // Ends of the frames of ranges.
    let mut end = 0;
    let ends: Vec<usize> = pieces(&bytes)
        .filter_map(|piece| {
            end += piece.bytes.len();
            (piece.kind == Kind::RAWX).then_some(end)
        })
        .collect();
    assert_eq!(whole.len(), ends.len());
    for length in (ends[0]..bytes.len()).step_by(97).chain(ends.clone()) {
        let want = ends.partition_point(|end| *end <= length);
        assert_eq!(judged(&bytes[..length], &[]), whole[..want], "the first {length} bytes");
    }
    for start in (1..ends[ends.len() - 3]).step_by(997) {
        let lost = ends.partition_point(|end| *end < start + 1);
        let begins_in_ranges = pieces(&bytes[start..]).next().is_some_and(|piece| piece.kind == Kind::Rest);
        let have = times(&judged(&bytes[start..], &[]));
        let want = times(&whole)[lost..].to_vec();
        assert!(have == want || begins_in_ranges && have == want[1..], "from byte {start}");
    }
}

#[test]
fn noise_between_frames_costs_no_epoch() {
    /// Beginnings of frames that announce more bytes than follow.
    const FALSE: [&[u8]; 5] = [
        &[0xB5, 0x62, 0x02, 0x15, 0xF0, 0x10],
        &[0xB5, 0x62, 0x01, 0x07, 0xFF, 0x03],
        &[0xD3, 0x03, 0xFF],
        b"$GNRMC,120041.00,A*",
        &[0xB5, 0x62, 0xB5],
    ];
    let Some(bytes) = epochs(40) else { return };
    let whole = judged(&bytes, &[]);
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for round in 0..8 {
        let mut noisy = Vec::new();
        for piece in pieces(&bytes) {
            // More of the long ones in a row would be too expensive: the module checks four bytes
            // for each received one.
            if random.random_bool(0.02) {
                noisy.extend_from_slice(FALSE[random.random_range(0..FALSE.len())]);
            }
            if random.random_bool(0.1) {
                noisy.extend((0..random.random_range(1..60)).map(|_| random.random::<u8>()));
            }
            noisy.extend_from_slice(piece.bytes);
        }
        let have = judged(&noisy, &[]);
        assert_eq!(times(&have), times(&whole), "round {round}");
        for (have, want) in have.iter().zip(&whole) {
            assert_eq!(have.output, want.output, "round {round}: {:?}", want.time);
        }
    }
}

#[test]
fn a_frame_of_ranges_that_is_damaged_costs_its_epoch_and_no_other() {
    let Some(bytes) = epochs(24) else { return };
    let whole = times(&judged(&bytes, &[]));
    for hurt in 0..whole.len() {
        let (mut damaged, mut seen) = (Vec::new(), 0);
        for piece in pieces(&bytes) {
            let begin = damaged.len();
            damaged.extend_from_slice(piece.bytes);
            if piece.kind == Kind::RAWX {
                match hurt % 3 {
                    _ if seen != hurt => {}
                    0 => damaged[begin + 100] ^= 4,
                    1 => damaged.truncate(begin + 200),
                    _ => drop(damaged.drain(begin..begin + 50)),
                }
                seen += 1;
            }
        }
        let mut want = whole.clone();
        want.remove(hurt);
        assert_eq!(times(&judged(&damaged, &[])), want, "epoch {hurt}");
    }
}
