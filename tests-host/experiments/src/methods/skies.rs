//! Skies: published orbits at random instants, thinned to a number of satellites, with the module's
//! own sigmas.
//!
//! ```text
//! ρ_i = |x_i − x| + b_c + σ_i ε_i + fault_i      ε ~ N(0, 1)
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `σ_i` | [`Observation::sigma_m`], by [`raim_core::internals::weighting`] for the ionosphere-free pair | m |
//! | `b_c` | [`CLOCKS_M`] | m |
//!
//! Orbit and clock error is that of GPS for all, because the slots of a fleet are not codes that
//! identify a generation.

use raim::signal::sky::{Fleet, Satellite, Sight, Site, sights};
use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::Ecef;
use raim_core::internals::weighting::{ErrorBudget, UserModel, sigma_m};
use rand::RngExt as _;
use rand::rngs::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

use super::super::draw::{distinct, generator};

/// Capacity of an epoch, satellites, as on the target.
pub(super) const CAPACITY: usize = 40;

/// A kind of sky.
pub(super) struct Kind {
    pub(super) name: &'static str,
    /// Label under the bars of a picture.
    pub(super) label: &'static str,
    fleets: &'static [Fleet],
    satellites: usize,
    seed: u64,
}

/// One constellation, then two.
pub(super) const KINDS: [Kind; 7] = [
    Kind { name: "8 satellites of GPS", label: "8 G", fleets: &[Fleet::Gps31], satellites: 8, seed: 1 },
    Kind {
        name: "12 satellites of BeiDou",
        label: "12 C",
        fleets: &[Fleet::Beidou44],
        satellites: 12,
        seed: 2,
    },
    Kind {
        name: "20 satellites of BeiDou",
        label: "20 C",
        fleets: &[Fleet::Beidou44],
        satellites: 20,
        seed: 3,
    },
    Kind { name: "10 satellites of GPS and BeiDou", label: "10 GC", fleets: BOTH, satellites: 10, seed: 4 },
    Kind { name: "16 satellites of GPS and BeiDou", label: "16 GC", fleets: BOTH, satellites: 16, seed: 5 },
    Kind { name: "28 satellites of GPS and BeiDou", label: "28 GC", fleets: BOTH, satellites: 28, seed: 6 },
    Kind { name: "40 satellites of GPS and BeiDou", label: "40 GC", fleets: BOTH, satellites: 40, seed: 7 },
];

const BOTH: &[Fleet] = &[Fleet::Gps31, Fleet::Beidou44];

/// Receiver clocks times the speed of light by constellation, m.
const CLOCKS_M: [f64; 4] = [30_000.0, 30_040.0, 30_010.0, 30_090.0];

/// Elevation mask, degrees.
const MASK_DEG: f64 = 5.0;

/// Smallest number of satellites of a constellation; with fewer nothing about it could be tested.
const FEWEST_OF_EACH: usize = 3;

/// One epoch with faults.
pub(super) struct Scene {
    pub(super) sights: Vec<Sight>,
    pub(super) site: Ecef,
    pub(super) epoch: Epoch<CAPACITY>,
    /// Indices of the faulty satellites, ascending.
    pub(super) faulty: Vec<usize>,
    /// Measured minus true range of each, m.
    pub(super) errors_m: Vec<f64>,
}

impl Kind {
    /// Returns the scene of a number, with its own sky, noise and faulty satellites, each wrong by
    /// the step in a random direction.
    pub(super) fn scene(&self, number: u64, faults: usize, step_m: f64) -> Scene {
        let mut generator = generator(self.seed, number);
        let site = Site::geodetic(34.17, 108.57, 400.0);
        let sights = self.sights(&site, &mut generator);
        let faulty = distinct(&mut generator, faults, sights.len());
        let (mut epoch, mut errors_m) = (Epoch::new(0.0), Vec::new());
        for (index, sight) in sights.iter().enumerate() {
            let sigma_m = sigma_at(sight);
            let noise: f64 = StandardNormal.sample(&mut generator);
            let sign = if generator.random() { 1.0 } else { -1.0 };
            let fault_m = if faulty.contains(&index) { sign * step_m } else { 0.0 };
            let error_m = CLOCKS_M[sight.satellite.constellation() as usize] + sigma_m * noise + fault_m;
            let Sight { satellite, position, range_m, .. } = *sight;
            let observation = Observation { satellite, position, range_m: range_m + error_m, sigma_m };
            epoch.push(observation).expect("a simulated range is sound");
            errors_m.push(error_m);
        }
        Scene { sights, site: site.position, epoch, faulty, errors_m }
    }

    /// Draws satellites from those in view, at an instant with enough of them.
    fn sights(&self, site: &Site, generator: &mut ChaCha8Rng) -> Vec<Sight> {
        let satellites: Vec<Satellite> = self.fleets.iter().flat_map(|fleet| fleet.satellites()).collect();
        loop {
            let t_s = generator.random_range(0.0..86_400.0);
            let seen = sights(&satellites, site, t_s, MASK_DEG.to_radians());
            if seen.len() >= self.satellites {
                let chosen = distinct(generator, self.satellites, seen.len());
                let sights: Vec<Sight> = chosen.iter().map(|&index| seen[index]).collect();
                if self.is_testable(&sights) {
                    return sights;
                }
            }
        }
    }

    fn is_testable(&self, sights: &[Sight]) -> bool {
        self.fleets.iter().all(|fleet| {
            let belongs = |sight: &&Sight| sight.satellite.constellation() == fleet.constellation();
            sights.iter().filter(belongs).count() >= FEWEST_OF_EACH
        })
    }
}

fn sigma_at(sight: &Sight) -> f64 {
    /// Noise factor of the ionosphere-free pair.
    const NOISE_GAIN: f32 = 3.0;
    const EPHEMERIS_M: f32 = 1.2;
    f64::from(sigma_m(&ErrorBudget {
        sin_elevation: sight.line_of_sight.up as f32,
        ephemeris_m: EPHEMERIS_M,
        noise_gain: NOISE_GAIN,
        weakness: 1.0,
        ionosphere_m: 0.0,
        user: UserModel::Ground,
    }))
}
