//! A sky with its integrity parameters, and dense least squares of any part of it.
//!
//! ```text
//! S^k = (Gᵀ W G)⁻¹ Gᵀ W        W = 1/C_int, 0 for the rows of mode k        a column of G for each clock that is left
//! ```

use anyhow::{Context as _, Result};
use nalgebra::{DMatrix, DVector, Vector3};
use raim::signal::sky::{Fleet, Satellite, Site, sights};
use raim_core::internals::integrity::araim::{Prior, ROWS};
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::internals::numeric::real::Real;
use raim_core::internals::weighting::{ErrorBudget, Ism, UserModel, integrity_sigma_m};
use raim_core::satellite::Constellation;

/// Elevation mask, degrees.
const MASK_DEG: f64 = 5.0;

/// Constellations in the order in which they are added.
pub(super) const FLEETS: [Fleet; 4] = [Fleet::Gps24, Fleet::Galileo24, Fleet::Beidou24, Fleet::Glonass24];

/// A satellite in view, with its integrity parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sighted {
    pub(super) constellation: Constellation,
    /// Unit vector to the satellite: east, north, up.
    pub(super) direction: Vector3<f64>,
    pub(super) sigma_m: f64,
    pub(super) accuracy_m: f64,
    pub(super) bias_m: f64,
    pub(super) fault: f64,
}

/// All satellites in view, and the fault priors of their constellations.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    pub(super) satellites: Vec<Sighted>,
    pub(super) constellations: [f64; Constellation::COUNT],
}

impl Scene {
    /// Returns the sky of `count` constellations above a site at an instant.
    pub(super) fn above(site: &Site, count: usize, t_s: f64, ism: &Ism) -> Self {
        let fleet: Vec<Satellite> = FLEETS.into_iter().take(count).flat_map(Fleet::satellites).collect();
        let seen = sights(&fleet, site, t_s, MASK_DEG.to_radians());
        let satellites = seen.iter().map(|sight| {
            let constellation = sight.satellite.constellation();
            let support = ism.of(constellation);
            let towards = sight.line_of_sight;
            let sigma_m = sigma_m(&support, towards.up);
            let accuracy_m2 = sigma_m * sigma_m - support.ura_m.powi(2) + support.ure_m.powi(2);
            Sighted {
                constellation,
                direction: Vector3::new(towards.east, towards.north, towards.up),
                sigma_m,
                accuracy_m: accuracy_m2.sqrt(),
                bias_m: support.bias_m,
                fault: support.satellite_fault,
            }
        });
        let constellations = Constellation::ALL.map(|one| ism.of(one).constellation_fault);
        Self { satellites: satellites.collect(), constellations }
    }

    /// Returns the equations with these residuals, m.
    pub(super) fn epoch<T: Real>(&self, residuals_m: &DVector<f64>) -> Result<LinearEpoch<T, ROWS>> {
        let mut epoch = LinearEpoch::new();
        for (one, &residual_m) in self.satellites.iter().zip(residuals_m.iter()) {
            epoch.satellite(one.constellation, one.direction, residual_m, one.sigma_m)?;
        }
        Ok(epoch)
    }

    /// Returns the priors for the core.
    pub(super) fn priors<T: Real>(&self) -> Vec<Prior<T>> {
        let prior = |one: &Sighted| Prior {
            accuracy_m: T::narrow(one.accuracy_m),
            bias_m: T::narrow(one.bias_m),
            fault: T::narrow(one.fault),
        };
        self.satellites.iter().map(prior).collect()
    }

    /// Returns `S` without these satellites, three rows; 0 in their columns.
    pub(super) fn gains(&self, taken: &[usize]) -> Result<DMatrix<f64>> {
        let count = self.satellites.len();
        let kept: Vec<usize> = (0..count).filter(|index| !taken.contains(index)).collect();
        let mut clocks: Vec<Constellation> =
            kept.iter().map(|&index| self.satellites[index].constellation).collect();
        clocks.sort_unstable();
        clocks.dedup();
        let design = DMatrix::from_fn(kept.len(), 3 + clocks.len(), |row, column| {
            let one = &self.satellites[kept[row]];
            match column {
                0..3 => -one.direction[column],
                _ => f64::from(u8::from(clocks[column - 3] == one.constellation)),
            }
        });
        let weights = DVector::from_iterator(
            kept.len(),
            kept.iter().map(|&index| self.satellites[index].sigma_m.powi(-2)),
        );
        let weighted = design.transpose() * DMatrix::from_diagonal(&weights);
        let inverse = (&weighted * &design).try_inverse().context("a geometry that determines a position")?;
        let part = inverse * weighted;
        let mut gains = DMatrix::zeros(3, count);
        for (column, &index) in kept.iter().enumerate() {
            gains.set_column(index, &part.fixed_view::<3, 1>(0, column));
        }
        Ok(gains)
    }

    /// Returns the satellites of a constellation.
    pub(super) fn members(&self, constellation: Constellation) -> Vec<usize> {
        let all = self.satellites.iter().enumerate();
        all.filter(|(_, one)| one.constellation == constellation).map(|(index, _)| index).collect()
    }
}

/// Returns the spread of a row over variances of the ranges: `√(Σ s_i² σ_i²)`.
pub(super) fn spread(gains: impl Iterator<Item = f64>, sigmas_m: impl Iterator<Item = f64>) -> f64 {
    gains.zip(sigmas_m).map(|(gain, sigma_m)| (gain * sigma_m).powi(2)).sum::<f64>().sqrt()
}

/// Returns the sigma of a pair of frequencies aboard an aircraft, for integrity, m.
fn sigma_m(support: &raim_core::internals::weighting::IsmParameters, sin_elevation: f64) -> f64 {
    let budget = ErrorBudget {
        sin_elevation: sin_elevation as f32,
        ephemeris_m: 0.0,
        noise_gain: 2.588,
        weakness: 1.0,
        ionosphere_m: 0.0,
        user: UserModel::Airborne,
    };
    f64::from(integrity_sigma_m(support, 0.0, &budget))
}
