//! What ranges are wrong by, and the epoch that a receiver would make of them.
//!
//! ```text
//! ρ_i = |x_i − x| + ω_e/c (x_i y − y_i x) + b + noise σ_i ε_i + fault
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | `σ_i` | what is expected of the range: the module's own model, or what the specification says |
//! | `ε_i` | normal, by seed, satellite, place and epoch: the same for every method, mask and fault |
//! | `b` | [`CLOCK_M`], the same for all systems; each estimates its own |
//!
//! What the receiver *says* of a range is the model's sigma too, but for `SEPARATION`, which weighs by what is promised of
//! the satellites ([`rai_core::weighting`]). Ranges are ionosphere-free pairs.

use rai_core::epoch::{Epoch, Observation};
use rai_core::frame::{EARTH_ROTATION_RAD_S, Ecef, Enu, SPEED_OF_LIGHT_M_S};
use rai_core::monitor::Method;
use rai_core::satellite::SatelliteId;
use rai_core::weighting::{ErrorBudget, Ism, UserModel, ephemeris_sigma_m, integrity_sigma_m, sigma_m};
use rai_firmware::config::Configuration;

use super::sky::Heaven;
use super::spec::ErrorSpec;
use crate::sky::{Noise, Site};

/// Room for satellites of four systems; the module itself has less and counts what it leaves out.
pub const CAPACITY: usize = 48;

/// The receiver's clock, m.
const CLOCK_M: f64 = 12_345.0;

/// Of the pair L1 and L5: `√(f₁⁴ + f₅⁴)/(f₁² − f₅²)`.
const NOISE_GAIN: f32 = 2.588;

/// A model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ErrorModel {
    /// The module's own, with its antenna there.
    User(UserModel),
    /// The same sigma everywhere, m.
    Constant(f64),
    /// Sigma at the zenith, m, divided by the sine of the elevation.
    Cosecant(f64),
}

impl ErrorModel {
    /// What a checked specification asks for.
    pub fn of(spec: &ErrorSpec) -> Self {
        match (spec.user.as_deref(), spec.sigma_m, spec.zenith_m) {
            (_, Some(sigma_m), _) => Self::Constant(sigma_m),
            (_, _, Some(zenith_m)) => Self::Cosecant(zenith_m),
            (Some("airborne"), ..) => Self::User(UserModel::Airborne),
            _ => Self::User(UserModel::Ground),
        }
    }

    /// What is expected of a range, m.
    fn expected_m(self, satellite: SatelliteId, sin_elevation: f64) -> f64 {
        match self {
            Self::User(user) => f64::from(sigma_m(&budget(user, satellite, sin_elevation))),
            Self::Constant(sigma_m) => sigma_m,
            Self::Cosecant(zenith_m) => zenith_m / sin_elevation.max(0.01),
        }
    }

    /// What is said of a range to a method, m.
    fn said_m(self, judge: &Configuration, satellite: SatelliteId, sin_elevation: f64) -> f64 {
        match self {
            Self::User(user) if judge.method == Method::Araim => {
                let support = judge.promises.ism().of(satellite.constellation());
                f64::from(integrity_sigma_m(&support, 0.0, &budget(user, satellite, sin_elevation)))
            }
            _ => self.expected_m(satellite, sin_elevation),
        }
    }

    /// The promises that go with it, for [`Method::Araim`].
    pub fn promises(self, ism: Ism) -> Ism {
        match self {
            Self::User(user) => Ism { user, ..ism },
            Self::Constant(_) | Self::Cosecant(_) => ism,
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

/// A range that is seen, with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Without sigma, which depends on who is asked.
    pub observation: Observation,
    /// Its place among those seen.
    pub index: usize,
    /// Unit vector site → satellite.
    pub line_of_sight: Enu,
}

/// The ranges of the satellites above the mask, with their noise and no fault.
pub fn seen(
    heaven: &Heaven,
    site: &Site,
    mask_deg: f64,
    model: ErrorModel,
    (noise, factor, epoch): (&Noise, f64, u64),
) -> Vec<Seen> {
    let sin_mask = libm::sin(mask_deg.to_radians());
    let above = heaven.iter().map(|&(satellite, position)| (satellite, position, site.direction(position)));
    let above = above.filter(|(_, _, line_of_sight)| line_of_sight.up >= sin_mask);
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

/// How far a signal goes while the earth turns under it, m: in first order, good to a millimetre.
fn distance_m(satellite: Ecef, site: Ecef) -> f64 {
    const RATE: f64 = EARTH_ROTATION_RAD_S / SPEED_OF_LIGHT_M_S;
    site.distance_m(satellite) + RATE * (satellite.x_m * site.y_m - satellite.y_m * site.x_m)
}

/// The epoch as one judge gets it, with what a fault adds to each range.
pub fn epoch(
    seen: &[Seen],
    model: ErrorModel,
    judge: &Configuration,
    time_s: f64,
    fault_m: impl Fn(&Seen) -> f64,
) -> Epoch<CAPACITY> {
    let mut epoch = Epoch::new(time_s);
    for one in seen {
        let observation = Observation {
            range_m: one.observation.range_m + fault_m(one),
            sigma_m: model.said_m(judge, one.observation.satellite, one.line_of_sight.up),
            ..one.observation
        };
        // What is absurd or beyond the room is left out, as the module does.
        let _ = epoch.push(observation);
    }
    epoch
}
