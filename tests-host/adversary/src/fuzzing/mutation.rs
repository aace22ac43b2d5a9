//! Random changes of known inputs, the same for the same seed.

use rand::rngs::ChaCha8Rng;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};

/// Longest input that a mutation makes.
const LONGEST: usize = 4096;

/// Bytes at which behaviour changes: signs, ends of ranges, preambles, separators.
const REMARKABLE: [u8; 14] =
    [0x00, 0x01, 0x7F, 0x80, 0xFE, 0xFF, 0xD3, 0xB5, 0x62, b'$', b',', b'*', b'\r', b'\n'];

/// Generator of mutated inputs.
pub(super) struct Mutator<'c> {
    corpus: &'c [Vec<u8>],
    rng: ChaCha8Rng,
}

impl<'c> Mutator<'c> {
    pub(super) fn new(corpus: &'c [Vec<u8>], seed: u64) -> Self {
        Self { corpus, rng: ChaCha8Rng::seed_from_u64(seed) }
    }

    /// Returns an input of the corpus with one to eight changes.
    pub(super) fn input(&mut self) -> Vec<u8> {
        let mut input = self.corpus.choose(&mut self.rng).cloned().unwrap_or_default();
        for _ in 0..self.rng.random_range(1..=8) {
            self.change(&mut input);
        }
        input.truncate(LONGEST);
        input
    }

    fn change(&mut self, input: &mut Vec<u8>) {
        let piece = self.piece(input.len());
        match self.rng.random_range(0..7) {
            0 => self.set(input, |rng, byte| byte ^ 1 << rng.random_range(0..8)),
            1 => self.set(input, |rng, _| rng.random()),
            2 => self.set(input, |rng, _| *REMARKABLE.choose(rng).unwrap_or(&0)),
            3 => drop(input.drain(piece)),
            4 => {
                let copy = input[piece.clone()].to_vec();
                input.splice(piece.start..piece.start, copy);
            }
            5 => input[piece].reverse(),
            _ => self.graft(input),
        }
    }

    /// Replaces a piece by one of another input.
    fn graft(&mut self, input: &mut Vec<u8>) {
        let corpus = self.corpus;
        let Some(other) = corpus.choose(&mut self.rng) else { return };
        let (out, r#in) = (self.piece(input.len()), self.piece(other.len()));
        input.splice(out, other[r#in].iter().copied());
    }

    fn set(&mut self, input: &mut [u8], new: impl Fn(&mut ChaCha8Rng, u8) -> u8) {
        if let Some(at) = (0..input.len()).collect::<Vec<_>>().choose(&mut self.rng) {
            input[*at] = new(&mut self.rng, input[*at]);
        }
    }

    /// Returns a range of an input, short ones more often; empty for an empty input.
    fn piece(&mut self, length: usize) -> std::ops::Range<usize> {
        let start = self.rng.random_range(0..=length);
        let longest = (length - start).min(1 << self.rng.random_range(0..10));
        start..start + self.rng.random_range(0..=longest)
    }
}
