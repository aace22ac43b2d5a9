//! Normal noise by address: the same seed, satellite, channel and epoch always give the same
//! number.
//!
//! Hence a satellite's noise does not depend on the others in view, an experiment can jump to any
//! epoch, and parallel runs agree with sequential ones.

use raim_core::satellite::SatelliteId;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Number of generator words reserved for one number; the sampler takes two, and seldom more than
/// four.
const WORDS_PER_NUMBER: u128 = 64;

/// A source of standard normal numbers.
#[derive(Clone, Debug)]
pub struct Noise {
    seed: <ChaCha8Rng as SeedableRng>::Seed,
}

impl Noise {
    /// Returns a source whose numbers all follow from the seed.
    pub fn new(seed: u64) -> Self {
        Self { seed: ChaCha8Rng::seed_from_u64(seed).get_seed() }
    }

    /// Returns the number of one satellite's channel (a signal, or anything else that is
    /// independent) at one epoch.
    pub fn normal(&self, satellite: SatelliteId, channel: u8, epoch: u64) -> f64 {
        let constellation = satellite.constellation() as u64;
        let mut generator = ChaCha8Rng::from_seed(self.seed);
        generator.set_stream(constellation << 16 | u64::from(satellite.number()) << 8 | u64::from(channel));
        generator.set_word_pos(u128::from(epoch) * WORDS_PER_NUMBER);
        StandardNormal.sample(&mut generator)
    }
}
