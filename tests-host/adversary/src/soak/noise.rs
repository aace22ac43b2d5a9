//! A bad line: the effect of a cable beside a motor on a stream of frames.
//!
//! Each kind of disturbance occurs in a lump of bytes with the same probability, independently of
//! the others.
//!
//! | disturbance | effect | costs frames |
//! |---|---|---|
//! | flips | 1 to 8 bits change | yes |
//! | losses | a run of 1 to 20 bytes is missing | yes |
//! | glitch | a run of 10 to 100 bytes is read at the wrong rate: other bytes, half as many or twice | yes |
//! | burst | 20 to 300 random bytes are inserted, inside a frame or between two | inside |
//! | duplicate | a frame is repeated | no |
//! | reordering | two frames are swapped | no |
//! | pause | the line pauses for 20 to 900 ms, mostly inside a frame | beyond [`HARMLESS_PAUSE_MS`] |
//!
//! A burst between two frames can look like the beginning of a frame and delay the frames after it.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Longest pause that does not end a burst of frames, ms. The module waits for half a second.
pub const HARMLESS_PAUSE_MS: u64 = 400;

/// First byte of a frame.
const PREAMBLE: u8 = 0xD3;

/// Kind of disturbance of a lump of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbance {
    /// Bits change.
    Flips,
    /// Bytes are missing.
    Losses,
    /// Bytes are read at the wrong rate.
    Glitch,
    /// Random bytes are inserted.
    Burst,
    /// A frame is repeated.
    Duplicate,
    /// Two frames are swapped.
    Reordering,
    /// The line pauses.
    Pause,
}

impl Disturbance {
    /// All kinds, those of frames before those of bytes, because the sender's buffers come before
    /// the wire.
    pub const ALL: [Self; 7] = [
        Self::Duplicate,
        Self::Reordering,
        Self::Flips,
        Self::Losses,
        Self::Glitch,
        Self::Burst,
        Self::Pause,
    ];

    /// Returns the name for a table.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Flips => "bit flips",
            Self::Losses => "lost bytes",
            Self::Glitch => "baud glitches",
            Self::Burst => "bursts",
            Self::Duplicate => "duplicates",
            Self::Reordering => "reorderings",
            Self::Pause => "pauses",
        }
    }
}

/// Bytes that come without a pause between them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Piece {
    /// Pause of the line before the bytes, ms.
    pub pause_ms: u64,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// A lump after the line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Carried {
    /// Pieces that arrive.
    pub pieces: Vec<Piece>,
    /// True if a frame may have been lost.
    pub is_harmed: bool,
}

/// A line with random disturbances.
#[derive(Debug)]
pub struct Line {
    rng: ChaCha8Rng,
    probability: f64,
    counts: [u64; Disturbance::ALL.len()],
}

impl Line {
    /// Returns a line on which each kind of disturbance occurs in a lump with `probability`.
    pub fn new(probability: f64, seed: u64) -> Self {
        Self { rng: ChaCha8Rng::seed_from_u64(seed), probability, counts: [0; Disturbance::ALL.len()] }
    }

    /// Returns the number of disturbances of each kind.
    pub fn counts(&self) -> impl Iterator<Item = (Disturbance, u64)> {
        Disturbance::ALL.into_iter().zip(self.counts)
    }

    /// Carries a lump of frames.
    pub fn carry(&mut self, lump: &[u8]) -> Carried {
        let mut frames: Vec<Vec<u8>> = frames(lump).into_iter().map(<[u8]>::to_vec).collect();
        let mut carried = Carried::default();
        let mut pause_ms = None;
        for (index, disturbance) in Disturbance::ALL.into_iter().enumerate() {
            if frames.is_empty() || !self.rng.random_bool(self.probability) {
                continue;
            }
            self.counts[index] += 1;
            carried.is_harmed |= match disturbance {
                Disturbance::Pause => *pause_ms.insert(self.rng.random_range(20..=900)) > HARMLESS_PAUSE_MS,
                _ => self.disturb(disturbance, &mut frames),
            };
        }
        let bytes = frames.concat();
        let cut = pause_ms.map_or(0, |_| self.rng.random_range(0..=bytes.len()));
        let (head, tail) = bytes.split_at(cut);
        carried.pieces = vec![
            Piece { pause_ms: 0, bytes: head.to_vec() },
            Piece { pause_ms: pause_ms.unwrap_or(0), bytes: tail.to_vec() },
        ];
        carried
    }

    /// Changes the frames; returns true if one may be lost.
    fn disturb(&mut self, disturbance: Disturbance, frames: &mut Vec<Vec<u8>>) -> bool {
        let one = self.rng.random_range(0..frames.len());
        match disturbance {
            Disturbance::Duplicate => frames.insert(one, frames[one].clone()),
            Disturbance::Reordering => {
                let other = self.rng.random_range(0..frames.len());
                frames.swap(one, other);
            }
            Disturbance::Flips => self.flip(&mut frames[one]),
            Disturbance::Losses => {
                let run = self.run(frames[one].len(), 1, 20);
                frames[one].drain(run);
            }
            Disturbance::Glitch => self.garble(&mut frames[one]),
            Disturbance::Burst => return self.burst(frames, one),
            Disturbance::Pause => {}
        }
        matches!(disturbance, Disturbance::Flips | Disturbance::Losses | Disturbance::Glitch)
    }

    fn flip(&mut self, frame: &mut [u8]) {
        for _ in 0..self.rng.random_range(1..=8) {
            let at = self.rng.random_range(0..frame.len());
            frame[at] ^= 1 << self.rng.random_range(0..8);
        }
    }

    fn garble(&mut self, frame: &mut Vec<u8>) {
        let run = self.run(frame.len(), 10, 100);
        let length = if self.rng.random() { run.len() / 2 } else { run.len() * 2 };
        let garbage = self.garbage(length);
        frame.splice(run, garbage);
    }

    fn burst(&mut self, frames: &mut Vec<Vec<u8>>, one: usize) -> bool {
        let length = self.rng.random_range(20..=300);
        let garbage = self.garbage(length);
        let is_inside = self.rng.random();
        if is_inside {
            let at = self.rng.random_range(0..=frames[one].len());
            frames[one].splice(at..at, garbage);
        } else {
            frames.insert(one, garbage);
        }
        is_inside
    }

    /// Returns random bytes.
    pub fn garbage(&mut self, length: usize) -> Vec<u8> {
        (0..length).map(|_| self.rng.random()).collect()
    }

    /// Returns a random range of `least` to `most` bytes of a frame, or all of a shorter frame.
    fn run(&mut self, frame: usize, least: usize, most: usize) -> std::ops::Range<usize> {
        let length = self.rng.random_range(least..=most).min(frame);
        let start = self.rng.random_range(0..=frame - length);
        start..start + length
    }
}

/// Splits a lump into frames. A remainder without a preamble counts as one more frame.
pub fn frames(lump: &[u8]) -> Vec<&[u8]> {
    let mut rest = lump;
    let mut frames = Vec::new();
    while let [PREAMBLE, high, low, ..] = *rest {
        let length = 6 + (usize::from(high & 3) << 8 | usize::from(low));
        let (frame, after) = rest.split_at(length.min(rest.len()));
        frames.push(frame);
        rest = after;
    }
    if !rest.is_empty() {
        frames.push(rest);
    }
    frames
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a frame of that many bytes filled with its number. The line checks no checksum.
    fn frame(number: u8, length: usize) -> Vec<u8> {
        let mut frame = vec![number; length];
        frame[..3].copy_from_slice(&[PREAMBLE, ((length - 6) >> 8) as u8, (length - 6) as u8]);
        frame
    }

    fn lump() -> Vec<u8> {
        [frame(1, 60), frame(2, 300), frame(3, 9)].concat()
    }

    fn received(carried: &Carried) -> Vec<u8> {
        carried.pieces.iter().flat_map(|piece| piece.bytes.iter().copied()).collect()
    }

    /// Returns the lump after a line with a single kind of disturbance.
    fn with_only(disturbance: Disturbance, seed: u64) -> Vec<u8> {
        let mut line = Line::new(1.0, seed);
        let mut frames: Vec<Vec<u8>> = frames(&lump()).into_iter().map(<[u8]>::to_vec).collect();
        line.disturb(disturbance, &mut frames);
        frames.concat()
    }

    #[test]
    fn a_good_line_changes_nothing() {
        let carried = Line::new(0.0, 1).carry(&lump());
        assert_eq!((received(&carried), carried.is_harmed), (lump(), false));
    }

    #[test]
    fn the_same_seed_is_the_same_noise_and_another_is_not() {
        let carry = |seed| Line::new(0.5, seed).carry(&lump());
        assert_eq!(carry(7), carry(7));
        assert_ne!(carry(7), carry(8));
    }

    #[test]
    fn each_kind_happens_as_often_as_it_should() {
        let mut line = Line::new(0.1, 3);
        (0..4000).for_each(|_| drop(line.carry(&lump())));
        // Binomial: 400 expected, standard deviation 19.
        for (disturbance, count) in line.counts() {
            assert!((305..495).contains(&count), "{}: {count} of 400", disturbance.name());
        }
    }

    #[test]
    fn flips_keep_the_length_and_losses_and_glitches_do_not() {
        for seed in 0..50 {
            let flipped = with_only(Disturbance::Flips, seed);
            let bits: u32 = flipped.iter().zip(lump()).map(|(have, sent)| (have ^ sent).count_ones()).sum();
            assert!(flipped.len() == lump().len() && bits <= 8, "{bits} bits");
            let lost = lump().len() - with_only(Disturbance::Losses, seed).len();
            assert!((1..=20).contains(&lost), "{lost} bytes lost");
            assert_ne!(with_only(Disturbance::Glitch, seed).len(), lump().len());
        }
    }

    #[test]
    fn duplicates_and_reorderings_keep_every_frame_whole() {
        let kinds = |bytes: &[u8]| {
            let mut all: Vec<Vec<u8>> = frames(bytes).into_iter().map(<[u8]>::to_vec).collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        for seed in 0..50 {
            for disturbance in [Disturbance::Duplicate, Disturbance::Reordering] {
                assert_eq!(kinds(&with_only(disturbance, seed)), kinds(&lump()));
            }
            assert!(frames(&with_only(Disturbance::Duplicate, seed)).len() == 4);
        }
    }

    #[test]
    fn a_burst_takes_nothing_away() {
        for seed in 0..50 {
            let with = with_only(Disturbance::Burst, seed);
            let mut rest = with.iter();
            assert!(
                lump().iter().all(|byte| rest.any(|other| other == byte)),
                "in order, with bytes between"
            );
            assert!((20..=300).contains(&(with.len() - lump().len())));
        }
    }

    #[test]
    fn frames_are_cut_at_their_lengths() {
        let lengths: Vec<usize> = frames(&lump()).into_iter().map(<[u8]>::len).collect();
        assert_eq!(lengths, [60, 300, 9]);
        assert_eq!(frames(&[1, 2, 3]), [[1, 2, 3]], "the tail of a frame is carried too");
    }
}
