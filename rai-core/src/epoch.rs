//! The ranges of one instant, checked once on entry.
//!
//! Every function that fills an epoch checks its input. In every epoch all numbers are therefore
//! finite, sigmas positive, satellites distinct and positions outside the earth. No later stage
//! checks this again.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `ρ` | `range_m` | m, corrected for the satellite's clock and for the atmosphere, receiver clock left in |
//! | `m` | [`SharedError`], the part of the error that all ranges share ([`crate::integrity::raim::shared_errors`]) | m at one sigma |
//! | `σ` | `sigma_m` | m, standard deviation of the corrected range ([`crate::weighting`]) |

use core::fmt;

use heapless::Vec;

use crate::bounded::assert_capacity;
use crate::frame::Ecef;
use crate::numeric::bounds::is_within;
use crate::numeric::sqrt;
use crate::satellite::{Constellation, SatelliteId};
use crate::weighting::shared::SharedError;

/// Largest range to a navigation satellite, receiver clock included, m.
///
/// A receiver clock may be off by more than a second; nothing physical exceeds this limit.
const RANGE_LIMIT_M: f64 = 1e9;

/// Permitted distances of a satellite from the centre of the earth, m: the ground to well beyond
/// geostationary.
const RADIUS_M: core::ops::RangeInclusive<f32> = 6.3e6..=1e8;

/// Permitted standard deviations, m. A smaller one, mixed with ordinary ones, would need more
/// digits than `f32` has. A pseudorange with a larger one would have no effect.
const SIGMA_M: core::ops::RangeInclusive<f64> = 1e-3..=1e6;

/// One satellite's corrected range, with the satellite's position when it sent the signal.
///
/// ```
/// use raim_core::{Constellation, Ecef, Observation, SatelliteId};
///
/// let observation = Observation {
///     satellite: SatelliteId::new(Constellation::Gps, 5).ok_or("number must be within 1 to 99")?,
///     position: Ecef::new(15.6e6, 0.0, 21.6e6),
///     range_m: 20_850_000.0,
///     sigma_m: 3.0,
/// };
/// assert_eq!(observation.satellite, "G05".parse()?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Observation {
    /// The satellite.
    pub satellite: SatelliteId,
    /// Satellite position in the earth-fixed frame at the instant of transmission.
    pub position: Ecef,
    /// Pseudorange corrected for satellite clock, relativity, group delay and atmosphere, m.
    pub range_m: f64,
    /// Standard deviation of `range_m`, m.
    pub sigma_m: f64,
}

/// Outside knowledge that adds a row to those of the satellites.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Aiding {
    /// A predicted receiver clock of one constellation ([Chen2009]).
    ///
    /// [Chen2009]: crate#references
    Clock {
        /// Constellation of the clock.
        constellation: Constellation,
        /// Predicted receiver clock offset times the speed of light, m.
        value_m: f64,
        /// Standard deviation of the prediction, m.
        sigma_m: f64,
    },
    /// A known height above the ellipsoid, from a barometer or a map.
    Height {
        /// Height above the ellipsoid, m.
        value_m: f64,
        /// Standard deviation, m.
        sigma_m: f64,
    },
}

/// Reason why an observation or an aiding row was refused. The epoch is unchanged.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum EpochError {
    /// The range is not finite or beyond ±1e9 m.
    Range(f64),
    /// The satellite's position is not finite, inside the earth or beyond 100,000 km.
    Position(Ecef),
    /// The standard deviation is not within 1e-3 to 1e6 m.
    Sigma(f64),
    /// The satellite, or this kind of aiding, is in the epoch already.
    Duplicate,
    /// The epoch has no room for another satellite or kind of aiding.
    Full,
}

/// Returns true if a satellite can be at a position. Single precision is a hundred times finer than
/// the bounds need.
fn is_plausible(position: Ecef) -> bool {
    let [x, y, z] = [position.x_m, position.y_m, position.z_m].map(|coordinate| coordinate as f32);
    let squares = |radius: &f32| radius * radius;
    (squares(RADIUS_M.start())..=squares(RADIUS_M.end())).contains(&(x * x + y * y + z * z))
}

impl fmt::Display for EpochError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Range(_) => "range must be within -1e9 to 1e9 m",
            Self::Position(_) => "satellite must be within 6.3e6 to 1e8 m of the earth's centre",
            Self::Sigma(_) => "sigma must be within 1e-3 to 1e6 m",
            Self::Duplicate => "satellite or kind of aiding must appear once",
            Self::Full => "epoch has no place for another satellite",
        })
    }
}

impl core::error::Error for EpochError {}

/// The ranges of one instant, at most `N`. Monitors, reports and the memory of their searches have
/// room for as many.
///
/// `N` must be within 4 to 64: a position needs four satellites, and a set of satellites must fit
/// one word. Another `N` does not compile:
///
/// ```compile_fail,E0080
/// raim_core::Epoch::<65>::new(0.0);
/// ```
///
/// ```
/// use raim_core::{Constellation, Ecef, Epoch, Observation, SatelliteId};
/// use raim_core::epoch::EpochError;
///
/// let mut epoch = Epoch::<16>::new(345_600.0);
/// let satellite = SatelliteId::new(Constellation::Galileo, 31).ok_or("no such satellite")?;
/// let position = Ecef::new(15.6e6, 0.0, 24.9e6);
/// let observation = Observation { satellite, position, range_m: 23.4e6, sigma_m: 2.0 };
/// epoch.push(observation)?;
/// assert_eq!(epoch.push(observation), Err(EpochError::Duplicate));
/// assert_eq!(epoch.observations().len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Epoch<const N: usize> {
    time_s: f64,
    observations: Vec<Observation, N>,
    /// Shared error of each observation.
    shared: Vec<SharedError, N>,
    /// Receiver's part of each variance, in 255ths and rounded up.
    receiver: Vec<u8, N>,
    aiding: Vec<Aiding, 2>,
}

impl<const N: usize> Epoch<N> {
    /// Returns an epoch without satellites.
    ///
    /// `time_s` counts seconds of any continuous time scale; only differences are used. A time that
    /// is not finite counts as 0.
    pub fn new(time_s: f64) -> Self {
        const { assert_capacity(N) };
        let time_s = if time_s.is_finite() { time_s } else { 0.0 };
        Self {
            time_s,
            observations: Vec::new(),
            shared: Vec::new(),
            receiver: Vec::new(),
            aiding: Vec::new(),
        }
    }

    /// Empties the epoch for another instant. A caller can thus reuse one epoch in place.
    pub fn restart(&mut self, time_s: f64) {
        self.time_s = if time_s.is_finite() { time_s } else { 0.0 };
        self.observations.clear();
        self.shared.clear();
        self.receiver.clear();
        self.aiding.clear();
    }

    /// Adds a satellite.
    ///
    /// # Errors
    /// [`EpochError`] names the invalid value; the epoch is then unchanged.
    pub fn push(&mut self, observation: Observation) -> Result<(), EpochError> {
        self.push_sharing(observation, SharedError::NONE)
    }

    /// Adds a satellite whose range shares an error with others, such as the residual of an
    /// ionosphere model.
    ///
    /// # Errors
    /// As [`Self::push`]; [`EpochError::Sigma`] also if a number of `shared` is negative, not
    /// finite or above 1e6 m.
    pub fn push_sharing(&mut self, observation: Observation, shared: SharedError) -> Result<(), EpochError> {
        // NaN fails every one of these comparisons.
        if !is_within(observation.range_m.abs(), &(0.0..=RANGE_LIMIT_M)) {
            return Err(EpochError::Range(observation.range_m));
        }
        if !is_plausible(observation.position) {
            return Err(EpochError::Position(observation.position));
        }
        if !is_within(observation.sigma_m, &SIGMA_M) {
            return Err(EpochError::Sigma(observation.sigma_m));
        }
        if !shared.is_valid() {
            return Err(EpochError::Sigma(shared.common_m.into()));
        }
        if self.observations.iter().any(|known| known.satellite == observation.satellite) {
            return Err(EpochError::Duplicate);
        }
        self.observations.push(observation).map_err(|_| EpochError::Full)?;
        if cfg!(feature = "past") {
            // Never full, because it is as long as `shared`.
            let _ = self.receiver.push(u8::MAX);
        }
        self.shared.push(shared).map_err(|_| EpochError::Full)
    }

    /// Sets the receiver's part of the variance of the satellite that was added last, m². The
    /// monitor raises this part if residuals show that it is too small. Before, it is the whole
    /// variance.
    #[doc(hidden)]
    pub fn set_receiver_m2(&mut self, receiver_m2: f32) {
        if let (Some(part), Some(last)) = (self.receiver.last_mut(), self.observations.last()) {
            let sigma_m = last.sigma_m as f32;
            // Rounded up, so that a small part is not 0. The cast saturates.
            *part = (255.0 * receiver_m2 / (sigma_m * sigma_m) + 1.0) as u8;
        }
    }

    /// Multiplies the receiver's part of each variance by the factor with which the epoch was
    /// judged ([`EpochOutcome::noise`](crate::monitor::EpochOutcome::noise)).
    #[doc(hidden)]
    pub fn change_noise(&mut self, noise: f32) {
        if changes(noise) {
            for (seen, part) in self.observations.iter_mut().zip(&self.receiver) {
                seen.sigma_m *= growth(noise, share(*part));
            }
        }
    }

    /// Adds outside knowledge: one clock and one height at most.
    ///
    /// # Errors
    /// [`EpochError::Range`] or [`EpochError::Sigma`] for values out of range,
    /// [`EpochError::Duplicate`] for a second row of the same kind. [`EpochError::Full`] in a build
    /// without the feature `aiding`, which has no room for such rows.
    pub fn aid(&mut self, aiding: Aiding) -> Result<(), EpochError> {
        self.accepts(&aiding)?;
        self.aiding.push(aiding).map_err(|_| EpochError::Full)
    }

    /// Checks outside knowledge.
    fn accepts(&self, aiding: &Aiding) -> Result<(), EpochError> {
        if !cfg!(feature = "aiding") {
            return Err(EpochError::Full);
        }
        let (Aiding::Clock { value_m, sigma_m, .. } | Aiding::Height { value_m, sigma_m }) = *aiding;
        if !is_within(value_m.abs(), &(0.0..=RANGE_LIMIT_M)) {
            return Err(EpochError::Range(value_m));
        }
        if !is_within(sigma_m, &SIGMA_M) {
            return Err(EpochError::Sigma(sigma_m));
        }
        let same_kind = |known: &Aiding| core::mem::discriminant(known) == core::mem::discriminant(aiding);
        if self.aiding.iter().any(same_kind) { Err(EpochError::Duplicate) } else { Ok(()) }
    }

    /// Returns a view without the capacity.
    #[doc(hidden)]
    pub fn view(&self) -> EpochView<'_> {
        let Self { time_s, observations, shared, receiver, aiding } = self;
        EpochView { time_s: *time_s, observations, shared, receiver, aiding }
    }

    /// Returns the seconds of the caller's continuous time scale.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Returns the satellites, in the order they were added.
    pub fn observations(&self) -> &[Observation] {
        &self.observations
    }

    /// Returns the shared error of each observation, in the same order.
    #[doc(hidden)]
    pub fn shared(&self) -> &[SharedError] {
        &self.shared
    }

    /// Returns the aiding rows, in the order they were added.
    #[doc(hidden)]
    pub fn aiding(&self) -> &[Aiding] {
        &self.aiding
    }
}

/// The ranges of one instant as [`crate::integrity`] reads them, without the capacity of their
/// storage.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct EpochView<'e> {
    time_s: f64,
    observations: &'e [Observation],
    shared: &'e [SharedError],
    receiver: &'e [u8],
    aiding: &'e [Aiding],
}

/// Returns a part that is stored in 255ths.
fn share(part: u8) -> f32 {
    f32::from(part) * (1.0 / 255.0)
}

/// Returns true if a factor on the receiver's part changes a variance.
fn changes(noise: f32) -> bool {
    noise.to_bits() != 1.0_f32.to_bits()
}

/// Returns the factor on a sigma if this part of its variance is multiplied by `noise`.
fn growth(noise: f32, part: f32) -> f64 {
    f64::from(sqrt(1.0 + (noise - 1.0) * part))
}

impl<'e> EpochView<'e> {
    /// Works like [`Epoch::time_s`].
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Works like [`Epoch::observations`].
    pub fn observations(&self) -> &'e [Observation] {
        self.observations
    }

    /// Iterates over the receiver's part of each variance, dimensionless.
    pub(crate) fn receivers_parts(&self) -> impl Iterator<Item = f32> + use<'e> {
        self.receiver.iter().map(|part| share(*part))
    }

    /// Works like [`Epoch::shared`].
    pub fn shared(&self) -> &'e [SharedError] {
        self.shared
    }
}

/// View of an epoch as the solver needs it: its ranges and aiding rows, and a clock forecast,
/// without copying the epoch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aided<'e> {
    view: EpochView<'e>,
    forecast: Option<Aiding>,
    /// Factor on the receiver's part of each variance.
    noise: f32,
}

impl<'e> Aided<'e> {
    /// Returns the epoch without a forecast.
    pub(crate) fn alone<const N: usize>(epoch: &'e Epoch<N>) -> Self {
        Self { view: epoch.view(), forecast: None, noise: 1.0 }
    }

    /// Returns the epoch with a forecast, if there is capacity for the row and the epoch has no
    /// aiding of the same kind.
    pub(crate) fn by<const N: usize>(epoch: &'e Epoch<N>, forecast: Option<Aiding>) -> Self {
        let has_room = epoch.observations.len() + epoch.aiding.len() < N;
        let forecast = forecast.filter(|forecast| has_room && epoch.accepts(forecast).is_ok());
        Self { forecast, ..Self::alone(epoch) }
    }

    /// Returns the epoch with the receiver's part of each variance multiplied by a factor.
    pub(crate) fn noisier(self, noise: f32) -> Self {
        Self { noise, ..self }
    }

    /// Iterates over the satellites, each with the standard deviation of its range, m.
    pub(crate) fn weighed(&self) -> impl Iterator<Item = (&'e Observation, f64)> {
        let Self { noise, view, .. } = *self;
        let is_changed = cfg!(feature = "past") && changes(noise);
        let mut parts = view.receivers_parts();
        view.observations.iter().map(move |observation| {
            let sigma_m = observation.sigma_m;
            let part = if is_changed { parts.next() } else { None };
            (observation, part.map_or(sigma_m, |part| sigma_m * growth(noise, part)))
        })
    }

    /// Returns the satellites.
    pub(crate) fn observations(&self) -> &'e [Observation] {
        self.view.observations
    }

    /// Iterates over all aiding rows, the forecast last.
    pub(crate) fn aiding(&self) -> impl Iterator<Item = &Aiding> {
        self.view.aiding.iter().chain(&self.forecast)
    }
}
