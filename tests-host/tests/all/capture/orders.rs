//! Receivers that end every message as the last one of its epoch, and send the systems in another order
//! each time.

use crc::{CRC_24_LTE_A, Crc};
use raim::replay::{self, Pace, Window};
use raim::signal::capture::Capture;
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::sky::Fleet;
use raim::signal::sky::raw::Simulation;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom as _;
use rand::{RngExt as _, SeedableRng as _};

/// CRC-24Q has this polynomial, too, and begins with zero.
const CRC_24Q: Crc<u32> = Crc::<u32>::new(&CRC_24_LTE_A);

/// Returns the frames in some bytes of RTCM 3.
fn frames(mut bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut frames = Vec::new();
    while let [0xD3, high, low, ..] = *bytes {
        let (frame, rest) = bytes.split_at(6 + usize::from(u16::from_be_bytes([high & 3, low])));
        frames.push(frame.to_vec());
        bytes = rest;
    }
    frames
}

/// Returns the number of a message.
fn number(frame: &[u8]) -> u16 {
    u16::from_be_bytes([frame[3], frame[4]]) >> 4
}

/// Clears the bit by which ranges say that more of their epoch follow, behind 12, 12 and 30 bits.
fn end_here(frame: &mut [u8]) {
    frame[3 + 6] &= !0x02;
    let end = frame.len() - 3;
    let sum = CRC_24Q.checksum(&frame[..end]).to_be_bytes();
    frame[end..].copy_from_slice(&sum[1..]);
}

#[test]
fn epochs_of_messages_in_any_order_are_judged_though_each_says_it_is_the_last() {
    let fleets = [Fleet::Gps31, Fleet::Galileo24, Fleet::Beidou24];
    let simulation = Simulation {
        satellites: fleets.into_iter().flat_map(Fleet::satellites).collect(),
        ..Simulation::above_xian(3600.0, 120, 5)
    };
    let recording = simulation.record();
    for seed in 0..4 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let selection = Selection::new("GEC", Frequency::Dual).unwrap();
        let mut encoder = Encoder::new(&recording.ephemerides, selection);
        let mut bytes = Vec::new();
        for epoch in &recording.epochs {
            let frames = frames(&encoder.epoch(epoch).unwrap());
            let (mut ranges, others): (Vec<_>, Vec<_>) =
                frames.into_iter().partition(|frame| (1071..=1137).contains(&number(frame)));
            ranges.shuffle(&mut random);
            ranges.truncate(if random.random_bool(0.2) { 2 } else { 3 });
            for frame in &mut ranges {
                end_here(frame);
            }
            bytes.extend(others.into_iter().chain(ranges).flatten());
        }
        let prepared = Capture::of(bytes, None).unwrap().lumps(&[], &Window::ALL).unwrap();
        let run = replay::on_host(&prepared.lumps, &[], Pace::Recorded, |_| ()).unwrap();
        let judged = run.sentences().matches("$PRAIS").count();
        assert!(judged >= 110, "seed {seed}: {judged} of 120");
    }
}
