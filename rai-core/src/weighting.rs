//! The error model: from elevation, signal and ephemeris to a standard deviation. The one place that knows what a
//! sigma is made of.
//!
//! ```text
//! σ² = σ_eph² + (a_noise)² (σ_0² + σ_mp²/sin²el) + (σ_trop / (sin el + 0.05))² + σ_iono²
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `σ_eph` | `ephemeris_m`, from URA or SISA | m |
//! | `a_noise` | `noise_gain`: 1 for one frequency, about 3 for the ionosphere-free pair | – |
//! | `σ_0`, `σ_mp` | code noise and multipath at the zenith | m |
//! | `σ_trop` | what the tropospheric model leaves at the zenith | m |
//! | `σ_iono` | `ionosphere_m`, what the ionospheric model leaves along the path; 0 for the pair | m |
//!
//! Assumes independent errors. An integrity test stands and falls with these numbers, so they are on the
//! large side, and the monitor reports how the residuals compare ([`crate::report::Report::sigma_check`]).

use crate::satellite::{Constellation, SatelliteId};

/// Code noise at the zenith, m: a geodetic receiver's 0.3 m.
const CODE_NOISE_M: f64 = 0.3;

/// Code multipath that grows towards the horizon, m at the zenith.
const MULTIPATH_M: f64 = 0.3;

/// Tropospheric model error at the zenith, m ([DO-229] appendix A: 0.12 m).
const TROPOSPHERE_M: f64 = 0.12;

/// The largest error that a satellite in its normal state announces, m: SISA index 107, URA index 1 and below.
const NORMAL_PROMISE_M: f64 = 3.2;

/// Standard deviation of a satellite's broadcast orbit and clock, m.
///
/// `promised_m` is what it announces as URA or SISA. In the normal state that is the coarsest step of a scale, 2 to
/// 3 m for all systems, while their errors differ by ten: 0.2 m for Galileo, 0.6 m for GPS and `BeiDou`-3, 1 to 2 m and more for
/// `BeiDou`-2 ([Montenbruck2018]). The numbers here are twice these and more, since the test must hold on bad days. A
/// satellite that announces more than the normal state is believed.
pub fn ephemeris_sigma_m(satellite: SatelliteId, promised_m: f64) -> f64 {
    if promised_m > NORMAL_PROMISE_M {
        return promised_m;
    }
    match (satellite.constellation(), satellite.number()) {
        (Constellation::Galileo, _) => 0.7,
        // The second generation, whose ranges differ by some metres from the third's in many receivers.
        (Constellation::Beidou, ..=18) => 4.0,
        (Constellation::Gps | Constellation::Beidou, _) => 1.2,
        (Constellation::Glonass, _) => 3.0,
    }
}

/// What an error of one range is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorBudget {
    /// Sine of the elevation, −1 to 1.
    pub sin_elevation: f64,
    /// Orbit and clock error, m.
    pub ephemeris_m: f64,
    /// Factor on code noise and multipath, dimensionless.
    pub noise_gain: f64,
    /// Ionospheric error left along the path, m.
    pub ionosphere_m: f64,
}

/// Standard deviation of the corrected range, m.
pub fn sigma_m(budget: &ErrorBudget) -> f64 {
    // Below 3° nothing here is calibrated: the error stays that of 3°, where masks end.
    let sin_elevation = budget.sin_elevation.max(0.05);
    let code_m2 = CODE_NOISE_M * CODE_NOISE_M + MULTIPATH_M * MULTIPATH_M / (sin_elevation * sin_elevation);
    let troposphere_m = TROPOSPHERE_M / (sin_elevation + 0.05);
    libm::sqrt(
        budget.ephemeris_m * budget.ephemeris_m
            + budget.noise_gain * budget.noise_gain * code_m2
            + troposphere_m * troposphere_m
            + budget.ionosphere_m * budget.ionosphere_m,
    )
}
