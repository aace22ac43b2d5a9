//! Random numbers by address: the draws of a run depend neither on the thread nor on the other
//! runs.

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

/// Returns the random numbers of one run of an experiment.
pub(super) fn generator(seed: u64, run: u64) -> ChaCha8Rng {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(run);
    generator
}

/// Draws `count` different numbers below `below`, in ascending order: the faulty satellites of an
/// epoch.
pub(super) fn distinct(generator: &mut ChaCha8Rng, count: usize, below: usize) -> Vec<usize> {
    let mut chosen = rand::seq::index::sample(generator, below, count.min(below)).into_vec();
    chosen.sort_unstable();
    chosen
}
