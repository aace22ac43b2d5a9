//! The error model: from elevation, signal and ephemeris to a standard deviation. No other module
//! composes a sigma.
//!
//! ```text
//! σ² = σ_eph² + a² σ_code² + (σ_trop / (sin el + 0.05))² + σ_iono²
//! σ_code² = max(σ_0² + σ_mp²/sin²el, w² (σ_0² + σ_mp²))      w = 10^((42 − C/N0)/20), at least 1
//! σ_iono  = a quarter of the model's residual error on one frequency; all ranges share the rest
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `σ_eph` | `ephemeris_m`, from URA or SISA | m |
//! | `a` | `noise_gain`: 1 for one frequency, about 3 for the ionosphere-free pair | – |
//! | `w` | `weakness`: noise relative to a strong signal ([`noise_factor_from_cn0`]) | – |
//! | `σ_0`, `σ_mp` | code noise and multipath at the zenith | m |
//! | `σ_trop` | residual error of the tropospheric model at the zenith | m |
//! | `σ_iono` | `ionosphere_m`, error of the ionospheric model that differs from range to range ([`ionosphere`]); 0 for the pair | m |
//!
//! For ARAIM ([`crate::integrity::araim`]) the orbit and clock error comes from an integrity
//! support message, and the troposphere model from [Blanch2015]:
//!
//! ```text
//! C_int = URA² + σ_user² + σ_tropo²      C_acc the same with URE      σ_tropo = 0.12 · 1.001/√(0.002001 + sin²el)
//! ```
//!
//! A receiver's noise and multipath depend on the site of its antenna ([`UserModel`]):
//!
//! ```text
//! ground      σ_user² = a² σ_code²
//! airborne    σ_user² = 0.4² + (0.34 + 0.40 e^(−el/14°))² + (0.018 + 40/(261 + el²))²     el in degrees; for the pair only
//! ```
//!
//! The airborne model is from [ED-259A]: smoothed ranges of two frequencies, from a certified
//! antenna on a fuselage, with the residual ionosphere of the pair. An antenna on a roof or a car
//! has two to five times the multipath, so that these numbers are not valid there.
//!
//! The module receives no integrity support message: an [`Ism`] is a preset or comes from a
//! command. If a satellite broadcasts a larger URA, the larger one counts.
//!
//! Under an open sky only signals of low satellites are weak. Elevation and strength then describe
//! the same error, so that the larger of the two counts. If the signal of a high satellite is weak,
//! a roof or a tree is in its path.
//!
//! Assumes independent errors. An integrity test depends on these numbers, so that they are rather
//! too large. The monitor reports how the residuals compare with them
//! ([`crate::report::Report::sigma_check`]).
//!
//! Sigmas are computed in single precision.
//!
//! [Blanch2015]: crate#references
//! [ED-259A]: crate#references

pub mod adaptation;
pub mod ionosphere;
pub(crate) mod residuals;
pub mod shared;

use crate::numeric::angle::arc_sine;
use crate::numeric::sqrt;
use crate::satellite::{Constellation, SatelliteId};

/// Code noise at the zenith, m: that of a geodetic receiver.
const CODE_NOISE_M: f32 = 0.3;

/// Code multipath at the zenith, m. It grows towards the horizon.
const MULTIPATH_M: f32 = 0.3;

/// Tropospheric model error at the zenith, m ([DO-229] appendix A: 0.12 m).
///
/// [DO-229]: crate#references
const TROPOSPHERE_M: f32 = 0.12;

/// Largest error that a satellite in its normal state broadcasts, m: SISA index 107, URA index 1
/// and below.
const NORMAL_PROMISE_M: f32 = 3.2;

/// Carrier to noise density of a rather weak signal near the zenith, under an open sky, dB-Hz.
///
/// Below it, the noise of a tracking loop grows with the inverse root, and reflections are no
/// longer weak compared with the signal.
const STRONG_DBHZ: f32 = 42.0;

/// Sigma of every range as long as the position is unknown and nothing is corrected, m.
pub const COARSE_M: f32 = 30.0;

/// One sigma of a group delay that the message does not contain, m. The inter-signal corrections
/// that GPS and `BeiDou` publish in CNAV scatter by some nanoseconds.
pub const UNCALIBRATED_DELAY_M: f32 = 2.0;

/// One sigma of a range whose combination of carriers differs from that of most ranges of its
/// system, m.
///
/// A receiver's delay differs between carriers by some metres, and the combination amplifies this.
/// If the difference is common to all satellites of a system, it is part of the clock. With mixed
/// combinations it is an error of the few.
pub const MIXED_CARRIERS_M: f32 = 10.0;

/// Returns the standard deviation of a satellite's broadcast orbit and clock, m.
///
/// `promised_m` is its broadcast URA or SISA. In the normal state this is a coarse step of a scale,
/// 2 to 3 m for all systems. The actual errors differ by a factor of ten: 0.2 m for Galileo, 0.6 m
/// for GPS and `BeiDou`-3, 1 to 2 m and more for `BeiDou`-2 ([Montenbruck2018]). The numbers here
/// are at least twice as large, because the test must also be valid on bad days. If a satellite
/// broadcasts more than in the normal state, that value counts.
///
/// [Montenbruck2018]: crate#references
pub fn ephemeris_sigma_m(satellite: SatelliteId, promised_m: f32) -> f32 {
    if promised_m > NORMAL_PROMISE_M {
        return promised_m;
    }
    match (satellite.constellation(), satellite.number()) {
        (Constellation::Galileo, _) => 0.7,
        // The second generation. In many receivers its ranges differ by some metres from those of
        // the third.
        (Constellation::Beidou, ..=18) => 4.0,
        (Constellation::Gps | Constellation::Beidou, _) => 1.2,
        (Constellation::Glonass, _) => 3.0,
    }
}

/// Returns the noise of a range relative to that of a strong signal; 1 for an unknown strength.
pub fn noise_factor_from_cn0(cn0_dbhz: Option<f32>) -> f32 {
    const PER_DB: f32 = core::f32::consts::LN_10 / 20.0;
    match cn0_dbhz {
        // A NaN strength counts as 0 dB-Hz.
        Some(cn0_dbhz) if !(cn0_dbhz >= STRONG_DBHZ) => {
            libm::expf(PER_DB * (STRONG_DBHZ - cn0_dbhz.max(0.0)))
        }
        _ => 1.0,
    }
}

/// Returns the variance of the error of a range whose signal may be reflected, m².
///
/// ```text
///                σ² = σ_beside² + σ_alone²                  e² = (σ_0² + σ_mp²/sin²el) / (σ_0² + σ_mp²)
/// one frequency  σ_beside = 20 m (w² − e²), 0 to 14 m       σ_alone² = 25 m² (w² − 12), below 31 dB-Hz
/// two            σ_beside = 0                               σ_alone² = 25 m² (w² − 25), below 28 dB-Hz
/// ```
///
/// Under an open sky the signal of a low satellite is weak, by at most `e²` in power. If a signal
/// is weaker than its elevation explains, the antenna is small, or a wall or roof blocks the direct
/// path. A reflection beside the direct path makes C/A code up to 12 m wrong ([Eissfeller2007]). A
/// reflection alone is late by its whole detour: on a car between tall buildings the rms residual is
/// 7 m above 36 dB-Hz, 10 m down to 32 dB-Hz, and 30, 40 and 58 m in each 4 dB-Hz below. The noise
/// and multipath of two frequencies are amplified threefold, which contains most of it down to
/// 28 dB-Hz. Signals that a receiver tracks without their code are as weak under an open sky.
///
/// `weakness` is that of [`noise_factor_from_cn0`]; `is_single` is false for an epoch with ranges of
/// two frequencies.
///
/// [Eissfeller2007]: crate#references
pub fn reflection_m2(sin_elevation: f32, weakness: f32, is_single: bool) -> f32 {
    const BESIDE_M: f32 = 20.0;
    const LARGEST_BESIDE_M: f32 = 14.0;
    const ALONE_M2: f32 = 5.0 * 5.0;
    let power = weakness * weakness;
    let alone_m2 = |explained: f32| ALONE_M2 * (power - explained).max(0.0);
    if !is_single {
        return alone_m2(25.0);
    }
    let open = code_by_elevation_m2(sin_elevation.max(0.05)) / code_by_elevation_m2(1.0);
    let beside_m = (BESIDE_M * (power - open)).clamp(0.0, LARGEST_BESIDE_M);
    beside_m * beside_m + alone_m2(12.0)
}

/// Number of sigmas with which a shared range error enters the protection levels.
///
/// The error is not noise, because it stays for hours and does not average out.
pub const COMMON_SIGMAS: f32 = 3.0;

/// Integrity support parameters of one constellation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct IsmParameters {
    /// Standard deviation of orbit and clock for integrity, m.
    pub ura_m: f64,
    /// Standard deviation of orbit and clock for accuracy and continuity, m.
    pub ure_m: f64,
    /// Largest nominal bias, m.
    pub bias_m: f64,
    /// Probability that a satellite is faulty.
    pub satellite_fault: f64,
    /// Probability that all satellites are faulty together.
    pub constellation_fault: f64,
}

impl IsmParameters {
    const fn new([ura_m, ure_m, bias_m, satellite_fault, constellation_fault]: [f64; 5]) -> Self {
        Self { ura_m, ure_m, bias_m, satellite_fault, constellation_fault }
    }

    /// Checks every field: sigmas positive and up to 100 m, URE up to URA, bias up to 100 m,
    /// probabilities in [0, 0.5).
    #[inline(never)]
    #[doc(hidden)]
    pub fn is_valid(&self) -> bool {
        let sigma = |value: f64| value > 0.0 && value <= 100.0;
        let probability = |value: f64| (0.0..0.5).contains(&value);
        sigma(self.ura_m)
            && sigma(self.ure_m)
            && self.ure_m <= self.ura_m
            && (0.0..=100.0).contains(&self.bias_m)
            && probability(self.satellite_fault)
            && probability(self.constellation_fault)
    }
}

/// Model of the receiver's noise and multipath.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum UserModel {
    /// An antenna on the ground, and ranges that are not smoothed: the numbers of this module.
    Ground,
    /// An antenna on an aircraft, and ranges of two frequencies smoothed over 100 s. Ranges of one
    /// frequency count as on the ground.
    Airborne,
}

/// Integrity support message: parameters of each constellation, and the model of the receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Ism {
    /// Parameters of each constellation, in ascending id.
    #[doc(hidden)]
    pub constellations: [IsmParameters; Constellation::COUNT],
    /// Model of the receiver.
    pub user: UserModel,
}

impl Ism {
    /// The draft of ICAO Annex 10, June 2024. It has no URA for `BeiDou`, so that Galileo's is used
    /// with the probabilities of the draft. Biases are 0.
    pub const ICAO: Self = Self {
        constellations: [
            IsmParameters::new([2.4, 2.4, 0.0, 1e-5, 1e-8]),
            IsmParameters::new([6.0, 4.0, 0.0, 1e-5, 1e-4]),
            IsmParameters::new([6.0, 4.0, 0.0, 3e-5, 2e-4]),
            IsmParameters::new([9.0, 8.0, 0.0, 1.02e-4, 1e-4]),
        ],
        user: UserModel::Ground,
    };

    /// [`Self::ICAO`] aboard an aircraft.
    pub const ICAO_AIRBORNE: Self = Self { user: UserModel::Airborne, ..Self::ICAO };

    /// Parameters of published studies: URA 1 m, URE 0.5 m, a bias of 0.75 m, and a rare loss of
    /// GPS as a whole.
    pub const RESEARCH: Self = Self {
        constellations: [
            IsmParameters::new([1.0, 0.5, 0.75, 1e-5, 1e-8]),
            IsmParameters::new([1.0, 0.5, 0.75, 1e-5, 1e-4]),
            IsmParameters::new([1.0, 0.5, 0.75, 1e-5, 1e-4]),
            IsmParameters::new([1.0, 0.5, 0.75, 1e-5, 1e-4]),
        ],
        user: UserModel::Ground,
    };

    /// [`Self::RESEARCH`] aboard an aircraft.
    pub const RESEARCH_AIRBORNE: Self = Self { user: UserModel::Airborne, ..Self::RESEARCH };

    /// Returns the message with other parameters of one constellation.
    #[must_use]
    pub fn with(mut self, constellation: Constellation, parameters: IsmParameters) -> Self {
        if let Some(own) = self.constellations.get_mut(constellation as usize) {
            *own = parameters;
        }
        self
    }

    /// Returns the parameters of one constellation.
    pub fn of(&self, constellation: Constellation) -> IsmParameters {
        let [first, ..] = self.constellations;
        self.constellations.get(constellation as usize).copied().unwrap_or(first)
    }

    /// Returns true if every number is in its range.
    pub fn is_valid(&self) -> bool {
        self.constellations.iter().all(IsmParameters::is_valid)
    }
}

/// Returns the standard deviation of the corrected range for integrity, m; `promised_m` is the
/// satellite's broadcast URA or SISA.
pub fn integrity_sigma_m(support: &IsmParameters, promised_m: f32, budget: &ErrorBudget) -> f32 {
    integrity_sigma_with_m(support, promised_m, budget, budget.receiver_m2())
}

/// Works like [`integrity_sigma_m`], with the receiver's part of the variance, m².
pub fn integrity_sigma_with_m(
    support: &IsmParameters,
    promised_m: f32,
    budget: &ErrorBudget,
    receiver_m2: f32,
) -> f32 {
    let ura_m = promised_m.max(support.ura_m as f32);
    let sin_elevation = budget.sin_elevation.max(0.05);
    let troposphere_m2 = 0.12 * 0.12 * 1.001 * 1.001 / (0.002_001 + sin_elevation * sin_elevation);
    let ionosphere_m2 = budget.ionosphere_m * budget.ionosphere_m;
    sqrt(ura_m * ura_m + receiver_m2 + ionosphere_m2 + troposphere_m2)
}

/// Returns the receiver's part of the variance, m².
fn user_m2(sin_elevation: f32, budget: &ErrorBudget) -> f32 {
    let is_pair = budget.noise_gain > 1.0;
    if cfg!(feature = "araim") && budget.user == UserModel::Airborne && is_pair {
        airborne_m2(sin_elevation, budget.weakness)
    } else {
        budget.noise_gain * budget.noise_gain * code_m2(sin_elevation, budget.weakness)
    }
}

/// Returns the noise, multipath and residual ionosphere of a pair aboard an aircraft, m²
/// ([ED-259A]).
///
/// A weak signal is noisier here too. As in [`code_m2`], the larger of the two errors counts.
///
/// [ED-259A]: crate#references
fn airborne_m2(sin_elevation: f32, weakness: f32) -> f32 {
    const NOISE_M2: f32 = 0.4 * 0.4;
    const DEGREES: f32 = 180.0 / core::f32::consts::PI;
    let elevation_deg = DEGREES * arc_sine(sin_elevation.max(0.0));
    let multipath_m = |elevation_deg: f32| 0.34 + 0.40 * libm::expf(elevation_deg / -14.0);
    let model_m2 = |elevation_deg: f32| NOISE_M2 + multipath_m(elevation_deg) * multipath_m(elevation_deg);
    let ionosphere_m = 0.018 + 40.0 / (261.0 + elevation_deg * elevation_deg);
    model_m2(elevation_deg).max(weakness * weakness * model_m2(90.0)) + ionosphere_m * ionosphere_m
}

/// Returns code noise and multipath of one frequency, m².
fn code_m2(sin_elevation: f32, weakness: f32) -> f32 {
    code_by_elevation_m2(sin_elevation).max(weakness * weakness * code_by_elevation_m2(1.0))
}

/// Returns code noise and multipath of a signal under an open sky, m².
fn code_by_elevation_m2(sin_elevation: f32) -> f32 {
    const NOISE_M2: f32 = CODE_NOISE_M * CODE_NOISE_M;
    const MULTIPATH_M2: f32 = MULTIPATH_M * MULTIPATH_M;
    NOISE_M2 + MULTIPATH_M2 / (sin_elevation * sin_elevation)
}

/// Components of the error of one range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorBudget {
    /// Sine of the elevation, −1 to 1.
    pub sin_elevation: f32,
    /// Orbit and clock error, m.
    pub ephemeris_m: f32,
    /// Factor on code noise and multipath, dimensionless.
    pub noise_gain: f32,
    /// Noise relative to a strong signal, at least 1.
    pub weakness: f32,
    /// Residual ionospheric error along the path, m.
    pub ionosphere_m: f32,
    /// Site of the antenna.
    pub user: UserModel,
}

impl ErrorBudget {
    /// Returns the receiver's part of the variance, noise and multipath, m².
    pub fn receiver_m2(&self) -> f32 {
        user_m2(self.sin_elevation.max(0.05), self)
    }
}

/// Returns the standard deviation of the corrected range, m.
pub fn sigma_m(budget: &ErrorBudget) -> f32 {
    sigma_with_m(budget, budget.receiver_m2())
}

/// Works like [`sigma_m`], with the receiver's part of the variance, m².
pub fn sigma_with_m(budget: &ErrorBudget, receiver_m2: f32) -> f32 {
    // Below 3°, where masks end, the model is not calibrated, and the error of 3° is used.
    let sin_elevation = budget.sin_elevation.max(0.05);
    let troposphere_m = TROPOSPHERE_M / (sin_elevation + 0.05);
    sqrt(
        budget.ephemeris_m * budget.ephemeris_m
            + receiver_m2
            + troposphere_m * troposphere_m
            + budget.ionosphere_m * budget.ionosphere_m,
    )
}
