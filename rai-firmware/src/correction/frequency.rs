//! Choice between one frequency and two: the kind with the smaller protection levels is used.
//!
//! A pair of frequencies is free of the ionosphere, but three times as noisy. One frequency has
//! little noise, but also the residual of the ionosphere's model. The better choice depends on the
//! place, the sky, the receiver, and the signals of each satellite:
//!
//! ```text
//! N = Σ_i w_i h_i h_iᵀ − Σ_c (Σ_c w h)(Σ_c w h)ᵀ / Σ_c w        P = N⁻¹
//! g = P (Σ_i w_i h_i m_i − Σ_c (Σ_c w h)(Σ_c w m) / Σ_c w)
//! H = K_h √(larger eigenvalue of P_EN) + K_c |g_EN|        V = K_v √P_UU + K_c |g_U|
//! cost = max(H/HAL, V/VAL)
//! ```
//!
//! | symbol | here | unit |
//! |---|---|---|
//! | `h`, `w` | line of sight, `1/σ²`, as in the integrity test | –, 1/m² |
//! | `m` | residual of the ionospheric model on each range, one sigma, all of one sign | m |
//! | `K_h`, `K_v`, `K_c` | [`HORIZONTAL`], [`VERTICAL`], [`COMMON_SIGMAS`] | – |
//! | `H`, `V` | [`Spread`]: the fault-free part of the levels | m |
//!
//! Residuals are not used, because a choice by residuals would prefer the set in which a fault does
//! not show. The rest of the levels scales with the same spread, because both sets have the same
//! satellites.
//!
//! **No oscillation.** The set in use stays until the other has been better by a fifth for ten
//! consecutive epochs. As long as it is not better, the sets are compared only every tenth epoch:
//! geometry changes slowly, and a comparison costs as much as a correction. Each change moves the
//! receiver clock by the delay between carriers. With clock aiding the set never changes, because
//! such a change looks like a clock jump.

use raim_core::numeric::sqrt;
use raim_core::satellite::Constellation;
use raim_core::weighting::COMMON_SIGMAS;

/// Factor `K_h` of the horizontal standard deviation, at 1e-7: `√(2 ln 1e7)`.
const HORIZONTAL: f32 = 5.68;

/// Factor `K_v` of the vertical standard deviation, at 1e-7: `Q⁻¹(5e-8)`.
const VERTICAL: f32 = 5.33;

/// Cost of the other set, relative to the set in use, below which the other set is better.
const BETTER: f32 = 0.8;

/// Consecutive epochs for which the other set must be better.
const PERSISTENT: u8 = 10;

/// Kind of range for a satellite that offers both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ranges {
    /// Ionosphere-free pairs; one frequency for a satellite without a pair.
    Pairs,
    /// One frequency; a pair for a satellite without a single range.
    Singles,
}

impl Ranges {
    const fn other(self) -> Self {
        match self {
            Self::Pairs => Self::Singles,
            Self::Singles => Self::Pairs,
        }
    }
}

/// The fault-free part of the protection levels, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Level in the worst horizontal direction.
    pub horizontal_m: f32,
    /// Level upwards.
    pub vertical_m: f32,
}

impl Spread {
    /// Returns the larger of the two ratios of a level to its limit.
    pub fn cost(&self, hal_m: f32, val_m: f32) -> f32 {
        (self.horizontal_m / hal_m).max(self.vertical_m / val_m)
    }
}

/// The set in use, with the number of epochs for which the other has been better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preference {
    ranges: Ranges,
    epochs_better: u8,
    /// Epochs until the next comparison.
    rest: u8,
}

impl Preference {
    /// Returns the preference at start: pairs, until singles are better.
    pub const fn new() -> Self {
        Self { ranges: Ranges::Pairs, epochs_better: 0, rest: 0 }
    }

    /// Returns the set in use.
    pub const fn ranges(&self) -> Ranges {
        self.ranges
    }

    /// Compares the costs of both sets and returns the set to use. `cost` is `None` for a set
    /// without a position.
    pub fn weigh(&mut self, cost: impl Fn(Ranges) -> Option<f32>) -> Ranges {
        if let Some(rest) = self.rest.checked_sub(1) {
            self.rest = rest;
            return self.ranges;
        }
        let is_better = match (cost(self.ranges), cost(self.ranges.other())) {
            (Some(mine), Some(others)) => others < BETTER * mine,
            (mine, others) => mine.is_none() && others.is_some(),
        };
        self.epochs_better = if is_better { self.epochs_better.saturating_add(1) } else { 0 };
        self.rest = if is_better { 0 } else { PERSISTENT - 1 };
        if self.epochs_better >= PERSISTENT {
            *self = Self { ranges: self.ranges.other(), epochs_better: 0, rest: PERSISTENT - 1 };
        }
        self.ranges
    }
}

impl Default for Preference {
    fn default() -> Self {
        Self::new()
    }
}

/// Sums over the ranges of one constellation or of all.
#[derive(Clone, Copy)]
struct Sums {
    weight: f32,
    /// `Σ w h`.
    direction: [f32; 3],
    /// `Σ w m`.
    common: f32,
}

/// Normal equations of a set of ranges, without residuals.
#[derive(Clone, Copy)]
pub(super) struct Geometry {
    /// `Σ w h hᵀ`: EE, EN, EU, NN, NU, UU.
    normal: [f32; 6],
    /// `Σ w h m`.
    pull: [f32; 3],
    systems: [Sums; Constellation::COUNT],
}

/// Returns the upper triangle of `a bᵀ`.
fn outer(a: [f32; 3], b: [f32; 3]) -> [f32; 6] {
    [a[0] * b[0], a[0] * b[1], a[0] * b[2], a[1] * b[1], a[1] * b[2], a[2] * b[2]]
}

impl Geometry {
    pub(super) const fn new() -> Self {
        const NONE: Sums = Sums { weight: 0.0, direction: [0.0; 3], common: 0.0 };
        Self { normal: [0.0; 6], pull: [0.0; 3], systems: [NONE; Constellation::COUNT] }
    }

    /// Adds a range, with the part of its error that is common to all.
    pub(super) fn add(&mut self, system: Constellation, direction: [f32; 3], sigma_m: f32, common_m: f32) {
        let weight = 1.0 / (sigma_m * sigma_m);
        accumulate(&mut self.normal, outer(direction, direction), weight);
        accumulate(&mut self.pull, direction, weight * common_m);
        let sums = self.systems.iter_mut().zip(Constellation::ALL).find(|(_, known)| *known == system);
        if let Some((sums, _)) = sums {
            sums.weight += weight;
            accumulate(&mut sums.direction, direction, weight);
            sums.common += weight * common_m;
        }
    }

    /// Returns the spread of the position, or `None` for a singular geometry.
    pub(super) fn spread(&self) -> Option<Spread> {
        let (mut normal, mut pull) = (self.normal, self.pull);
        for sums in self.systems.iter().filter(|sums| sums.weight > 0.0) {
            accumulate(&mut normal, outer(sums.direction, sums.direction), -1.0 / sums.weight);
            accumulate(&mut pull, sums.direction, -sums.common / sums.weight);
        }
        let [ee, en, eu, nn, nu, uu] = inverse(normal)?;
        let shift = [
            ee * pull[0] + en * pull[1] + eu * pull[2],
            en * pull[0] + nn * pull[1] + nu * pull[2],
            eu * pull[0] + nu * pull[1] + uu * pull[2],
        ];
        let (mean, half) = (0.5 * (ee + nn), 0.5 * (ee - nn));
        let major = mean + sqrt(half * half + en * en);
        let aside = sqrt(shift[0] * shift[0] + shift[1] * shift[1]);
        let spread = Spread {
            horizontal_m: HORIZONTAL * sqrt(major) + COMMON_SIGMAS * aside,
            vertical_m: VERTICAL * sqrt(uu) + COMMON_SIGMAS * shift[2].abs(),
        };
        (spread.horizontal_m.is_finite() && spread.vertical_m.is_finite()).then_some(spread)
    }
}

fn accumulate<const N: usize>(sum: &mut [f32; N], terms: [f32; N], weight: f32) {
    for (sum, term) in sum.iter_mut().zip(terms) {
        *sum += weight * term;
    }
}

/// Returns the inverse of a symmetric matrix; `None` unless its determinant is positive by more
/// than rounding.
fn inverse([ee, en, eu, nn, nu, uu]: [f32; 6]) -> Option<[f32; 6]> {
    /// Least determinant, as a share of that of independent axes. A smaller one may be only
    /// rounding.
    const SINGULAR: f32 = 1e-5;
    let (a, b, c) = (nn * uu - nu * nu, eu * nu - en * uu, en * nu - eu * nn);
    let determinant = ee * a + en * b + eu * c;
    if !(determinant > SINGULAR * ee * nn * uu && determinant > 0.0) {
        return None;
    }
    let scale = 1.0 / determinant;
    let minors = [a, b, c, ee * uu - eu * eu, en * eu - ee * nu, ee * nn - en * en];
    Some(minors.map(|minor| minor * scale))
}
