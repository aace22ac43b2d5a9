//! Errors of ranges, and the epoch that a receiver would measure.
//!
//! ```text
//! ρ_i = |x_i − x| + ω_e/c (x_i y − y_i x) + b + noise σ_i ε_i + fault
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | `σ_i` | expected standard deviation: from the module's own model, or from the specification |
//! | `ε_i` | normal, by seed, satellite, place and epoch: the same for every method, mask and fault |
//! | `b` | [`CLOCK_M`], the same for all systems; each estimates its own |
//!
//! The sigma that accompanies a range is the model's as well, except for `SEPARATION`, which
//! weights by the parameters of the integrity support message ([`raim_core::internals::weighting`]). Ranges
//! are ionosphere-free pairs.

use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::{EARTH_ROTATION_RAD_S, Ecef, Enu, SPEED_OF_LIGHT_M_S};
use raim_core::internals::weighting::{
    ErrorBudget, Ism, UserModel, ephemeris_sigma_m, integrity_sigma_m, sigma_m,
};
use raim_core::monitor::Method;
use raim_core::satellite::SatelliteId;
use raim_firmware::settings::Configuration;
use raim_single::CAPACITY;

use super::sky::Heaven;
use super::spec::ErrorSpec;
use crate::signal::sky::{Noise, Site};

/// The receiver's clock, m.
const CLOCK_M: f64 = 12_345.0;

/// Noise factor of the pair L1 and L5: `√(f₁⁴ + f₅⁴)/(f₁² − f₅²)`.
const NOISE_GAIN: f32 = 2.588;

/// Error model of ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ErrorModel {
    /// The module's own model, for this antenna.
    User(UserModel),
    /// The same sigma everywhere, m.
    Constant(f64),
    /// Sigma at the zenith, m, divided by the sine of the elevation.
    Cosecant(f64),
}

impl ErrorModel {
    /// Returns the model of a checked specification.
    pub fn of(spec: &ErrorSpec) -> Self {
        match (spec.user.as_deref(), spec.sigma_m, spec.zenith_m) {
            (_, Some(sigma_m), _) => Self::Constant(sigma_m),
            (_, _, Some(zenith_m)) => Self::Cosecant(zenith_m),
            (Some("airborne"), ..) => Self::User(UserModel::Airborne),
            _ => Self::User(UserModel::Ground),
        }
    }

    /// Returns the expected standard deviation of a range, m.
    fn expected_m(self, satellite: SatelliteId, sin_elevation: f64) -> f64 {
        match self {
            Self::User(user) => f64::from(sigma_m(&budget(user, satellite, sin_elevation))),
            Self::Constant(sigma_m) => sigma_m,
            Self::Cosecant(zenith_m) => zenith_m / sin_elevation.max(0.01),
        }
    }

    /// Returns what a judge is told of its ranges.
    pub fn said_to(self, judge: &Configuration) -> Reported {
        match self {
            Self::User(user) if judge.method == Method::Araim => {
                Reported::Promised(user, judge.promises.ism())
            }
            _ => Reported::Expected(self),
        }
    }

    /// Returns the matching integrity support parameters, for [`Method::Araim`].
    pub fn promises(self, ism: Ism) -> Ism {
        match self {
            Self::User(user) => {
                let mut ism = ism;
                ism.user = user;
                ism
            }
            Self::Constant(_) | Self::Cosecant(_) => ism,
        }
    }
}

/// The standard deviations that accompany the ranges of one method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reported {
    /// Those of the error model.
    Expected(ErrorModel),
    /// Those of the integrity support message, for [`Method::Araim`].
    Promised(UserModel, Ism),
}

impl Reported {
    /// Returns the standard deviation of a range, m.
    fn sigma_m(&self, satellite: SatelliteId, sin_elevation: f64) -> f64 {
        match self {
            Self::Expected(model) => model.expected_m(satellite, sin_elevation),
            Self::Promised(user, ism) => {
                let support = ism.of(satellite.constellation());
                f64::from(integrity_sigma_m(&support, 0.0, &budget(*user, satellite, sin_elevation)))
            }
        }
    }
}

fn budget(user: UserModel, satellite: SatelliteId, sin_elevation: f64) -> ErrorBudget {
    ErrorBudget {
        sin_elevation: sin_elevation as f32,
        ephemeris_m: ephemeris_sigma_m(satellite, 0.0),
        noise_gain: NOISE_GAIN,
        weakness: 1.0,
        ionosphere_m: 0.0,
        user,
    }
}

/// A range in view, with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Range without its sigma, which depends on the method.
    pub observation: Observation,
    /// Index among the ranges in view.
    pub index: usize,
    /// Unit vector from the site to the satellite.
    pub line_of_sight: Enu,
}

/// Returns the ranges of the satellites above the mask, with noise and without a fault.
pub fn seen(
    heaven: &Heaven,
    site: &Site,
    mask_deg: f64,
    model: ErrorModel,
    (noise, factor, epoch): (&Noise, f64, u64),
) -> Vec<Seen> {
    let sin_mask = libm::sin(mask_deg.to_radians());
    let above = heaven.iter().filter_map(|&(satellite, position)| {
        Some((satellite, position, site.direction_above(position, sin_mask)?))
    });
    let one = |(index, (satellite, position, line_of_sight)): (usize, (SatelliteId, _, Enu))| {
        let drawn_m = if factor > 0.0 {
            factor * model.expected_m(satellite, line_of_sight.up) * noise.normal(satellite, 0, epoch)
        } else {
            0.0
        };
        let range_m = distance_m(position, site.position) + CLOCK_M + drawn_m;
        let observation = Observation { satellite, position, range_m, sigma_m: 1.0 };
        Seen { observation, index, line_of_sight }
    };
    above.enumerate().map(one).collect()
}

/// Returns the path of a signal while the earth turns under it, m, to first order: accurate to a
/// millimetre.
fn distance_m(satellite: Ecef, site: Ecef) -> f64 {
    const RATE: f64 = EARTH_ROTATION_RAD_S / SPEED_OF_LIGHT_M_S;
    site.distance_m(satellite) + RATE * (satellite.x_m * site.y_m - satellite.y_m * site.x_m)
}

/// Returns the epoch as one judge receives it, with the fault added to each range.
pub fn epoch(
    seen: &[Seen],
    reported: &Reported,
    time_s: f64,
    fault_m: impl Fn(&Seen) -> f64,
) -> Epoch<CAPACITY> {
    let mut epoch = Epoch::new(time_s);
    for one in seen {
        let observation = Observation {
            range_m: one.observation.range_m + fault_m(one),
            sigma_m: reported.sigma_m(one.observation.satellite, one.line_of_sight.up),
            ..one.observation
        };
        // Absurd ranges and those beyond the capacity are left out, as in the module.
        let _ = epoch.push(observation);
    }
    epoch
}
