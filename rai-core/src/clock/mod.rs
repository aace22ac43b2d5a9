//! Clock coasting: a forecast of the receiver clock for the next epoch.
//!
//! A forecast clock is one more row, `[0 0 0 1] x = Ẑ`, with the standard deviation `σ_b`. Four
//! satellites can then be tested, and of five the faulty one can be identified.
//!
//! ```text
//! x_t = Z_t − Z_{t−1}                       window of L values, equally spaced
//! x_t − m = AR(3)                           m = mean x: the drift, removed and added again
//! Ẑ_{t+h} = Z_t + h m + Σ (x̂_{t+j} − m)     j = 1 … h
//! σ_b² = σ_clock² + (1.2 σ_predict(h))²
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `Z` | `clock_m`: receiver clock times the speed of light | m |
//! | `σ_clock` | `clock_sigma_m`, of the epoch that gave the last `Z`: `σ TDOP`, or `√Q_cc` of weighted rows | m |
//! | `Ẑ` | [`Forecast::value_m`] | m |
//! | `σ_predict` | [`Forecast::sigma_predict_m`], from the fit | m |
//! | `σ_b` | [`Forecast::sigma_m`] | m |
//! | `h` | [`Forecast::steps`] | – |
//! | `L` | const generic, [`WINDOW`] by default, at least [`MIN_VALUES`] | – |
//!
//! **Accepted values.** A clock must be solved without its forecast ([`SolvedClocks::of`]), because
//! a forecast that confirms itself would follow any fault. The caller must also check that the
//! satellites alone would be protected, because a faulty fix would spoil the forecasts of a minute.
//! A bias that grows too slowly for the test is learned with the clock. Its effect is within the
//! protection level of the satellites alone, and the reported level is not smaller.
//!
//! **Gaps.** The first two values set the spacing. A multiple of it is a hold-over: forecasts reach
//! up to [`HOLD_OVER_STEPS`] ahead, with growing variance. A value after the gap continues the
//! window without a difference across the gap. The missing steps are replaced by forecasts, with
//! the remaining error spread evenly. They serve the next forecast only and never a fit, because
//! invented values would not make it more accurate. Any other interval, and time that does not
//! advance, restarts the window.
//!
//! **Jumps.** If a value is farther than [`JUMP_SIGMAS`] from its forecast, the clock has jumped by
//! a millisecond or a steering step. The window then restarts with this value. Before the first
//! forecast, a change of rate above the limit of a quartz ([`RATE_CHANGE_M_S`]) is a jump.
//!
//! **Numbers.** Levels and the drift are `f64`. The differences minus the first one are generic:
//! for a clock of 3e8 m that drifts by 300 m/s they are centimetres to metres. All sums are
//! computed again from the window at each value, so that rounding errors do not accumulate. In
//! `f32` a clock of 60 values takes 600 bytes. On a Cortex-M4F a value takes 5,000 instructions, a
//! forecast 900 for one step and 2,200 for sixty.
//!
//! Departures from [Chen2009]:
//!
//! - The paper removes the mean of `Z`, which cancels in the differences, instead of the mean of
//!   `x`.
//! - It has no window length, and its eq. 7 lacks the new row's entry.
//! - The factor 1.2 is an addition. A variance fitted to 60 values is that of past errors; actual
//!   one-step errors are 1.09 to 1.17 times as large.
//!
//! References: [Chen2009], [Ulrych1976].
//!
//! [Chen2009]: crate#references
//! [Ulrych1976]: crate#references

mod autoregression;
mod ensemble;
mod window;

pub use autoregression::{Autoregression, Extrapolation, ORDER};
pub use ensemble::{Clocks, HOLD_OVER_S, SolvedClock, SolvedClocks, satellites_alone};

use crate::numeric::real::Real;
use window::Window;

/// Default number of values in a window.
pub const WINDOW: usize = 60;

/// Least number of values for a forecast.
pub const MIN_VALUES: usize = 12;

/// Number of runs of four differences in [`MIN_VALUES`].
const MIN_ROWS: usize = MIN_VALUES - 1 - ORDER;
const _: () = assert!(2 * MIN_ROWS > ORDER, "more equations than coefficients");

/// Largest number of steps of a forecast: it reaches no farther ahead than the window reaches back.
pub const HOLD_OVER_STEPS: usize = WINDOW;

/// Largest standard deviation of a forecast, m. A row with a larger one would have no effect.
pub const SIGMA_LIMIT_M: f64 = 1000.0;

/// Ratio of the actual one-step error to `σ_predict`, dimensionless: the measured 1.09 to 1.17 for
/// 60 values, rounded up.
pub const INFLATION: f64 = 1.2;

/// Smallest error that counts as a jump, in standard deviations of the forecast. Normal noise
/// exceeds it with a probability of 1e-7.
pub const JUMP_SIGMAS: f64 = 5.33;

/// Change of rate between two epochs beyond that of a quartz, m/s: 0.1 ppm.
pub const RATE_CHANGE_M_S: f64 = 30.0;

/// Largest difference of an interval from a multiple of the spacing, s.
///
/// Time tags are accurate to a millisecond; at a drift of 300 m/s this is 0.3 m.
const TIME_TOLERANCE_S: f64 = 1e-3;

/// Largest receiver clock, m, as for a range.
const LEVEL_LIMIT_M: f64 = 1e9;

/// Permitted standard deviations of a receiver clock, m, as for a range.
const SIGMA_M: core::ops::RangeInclusive<f64> = 1e-3..=1e6;

/// Forecast of a clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Receiver clock times the speed of light, m.
    pub value_m: f64,
    /// Standard deviation of the forecast steps, from the fit, m.
    pub sigma_predict_m: f64,
    /// Standard deviation of the forecast, m, including that of the last value and [`INFLATION`]:
    /// the sigma of an aiding row.
    pub sigma_m: f64,
    /// Steps ahead of the last value, at least 1.
    pub steps: usize,
}

/// Use of an observed value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Observed {
    /// The value continues the window.
    Continued,
    /// The value begins a window: it is the first one or a jump, or its interval to the last is no
    /// multiple of the spacing or too long.
    Restarted,
    /// The value is discarded, because it is not finite or out of bounds.
    Refused,
}

/// One value of the clock, with its standard deviation in metres.
#[derive(Clone, Copy, Debug)]
struct ClockReading<T> {
    time_s: f64,
    level_m: f64,
    sigma: T,
}

impl<T: Real> ClockReading<T> {
    fn new(time_s: f64, level_m: f64, sigma_m: f64) -> Option<Self> {
        // NaN fails each of these comparisons.
        let sound = time_s.is_finite() && level_m.abs() <= LEVEL_LIMIT_M && SIGMA_M.contains(&sigma_m);
        sound.then(|| Self { time_s, level_m, sigma: T::narrow(sigma_m) })
    }
}

/// A forecast before roots are computed, with variances in m².
struct Prediction<T> {
    value_m: f64,
    variance_predict: T,
    variance: T,
}

impl<T: Real> Prediction<T> {
    /// Returns true if a reading differs from the forecast by more than noise explains.
    fn misses(&self, reading: &ClockReading<T>) -> bool {
        let error = T::narrow(reading.level_m - self.value_m);
        let variance = self.variance + reading.sigma * reading.sigma;
        // A NaN error fails this comparison, so that it counts as a miss.
        !(error * error <= T::narrow(JUMP_SIGMAS * JUMP_SIGMAS) * variance)
    }
}

/// Window of one constellation's receiver clock, with its forecasts.
#[derive(Clone, Debug)]
pub struct CoastingClock<T: Real, const L: usize = WINDOW> {
    window: Window<T, L>,
    spacing_s: Option<f64>,
    last: Option<ClockReading<T>>,
    /// Latest differences, the last one first, relative to the window's reference, m.
    recent: [T; ORDER],
    /// Mean of the window, relative to its reference, m.
    mean: T,
    process: Autoregression<T>,
}

impl<T: Real, const L: usize> Default for CoastingClock<T, L> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const L: usize> CoastingClock<T, L> {
    /// Returns a clock without values.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn new() -> Self {
        const { assert!(L >= MIN_VALUES, "a window too short for any forecast") }
        Self {
            window: Window::new(),
            spacing_s: None,
            last: None,
            recent: [T::zero(); ORDER],
            mean: T::zero(),
            process: Autoregression::white(),
        }
    }

    /// Forgets all values. Call it if the clock has jumped or the values cannot be trusted.
    pub fn restart(&mut self) {
        // Reset field by field, because a new value would be on the stack first.
        self.window.clear();
        (self.spacing_s, self.last) = (None, None);
        (self.recent, self.mean) = ([T::zero(); ORDER], T::zero());
        self.process = Autoregression::white();
    }

    /// Adds the clock of an epoch that passed the test.
    pub fn observe(&mut self, time_s: f64, clock_m: f64, clock_sigma_m: f64) -> Observed {
        let Some(reading) = ClockReading::new(time_s, clock_m, clock_sigma_m) else {
            return Observed::Refused;
        };
        if self.follow(&reading).is_some() {
            self.last = Some(reading);
            return Observed::Continued;
        }
        self.restart();
        self.last = Some(reading);
        Observed::Restarted
    }

    /// Returns the forecast for a time after the last value. Returns `None` if the window is too
    /// short or the time beyond the hold-over.
    pub fn forecast(&self, time_s: f64) -> Option<Forecast> {
        let steps = Self::steps_in(time_s - self.last?.time_s, self.spacing_s?)?;
        let ahead = self.coast(steps)?;
        let (sigma_predict_m, sigma_m) =
            (ahead.variance_predict.sqrt_approx().widen(), ahead.variance.sqrt_approx().widen());
        Some(Forecast { value_m: ahead.value_m, sigma_predict_m, sigma_m, steps })
    }

    /// Returns the forecast `steps` ahead, or `None` if the window is too short or the variance too
    /// large.
    fn coast(&self, steps: usize) -> Option<Prediction<T>> {
        let last = self.last.filter(|_| self.ready())?;
        let none = (T::zero(), T::zero());
        let path = self.process.extrapolate(self.centred_recent()).take(steps);
        let (sum, variance_predict) = path.fold(none, |(sum, _), (step, variance)| (sum + step, variance));

        let count = T::narrow(steps as f64);
        let drifted_m = steps as f64 * self.window.reference_m() + (count * self.mean + sum).widen();
        let value_m = last.level_m + drifted_m;
        let variance = last.sigma * last.sigma + variance_predict * T::narrow(INFLATION * INFLATION);
        // NaN fails both comparisons.
        let sound = value_m.abs() <= LEVEL_LIMIT_M && variance <= T::narrow(SIGMA_LIMIT_M * SIGMA_LIMIT_M);
        sound.then_some(Prediction { value_m, variance_predict, variance })
    }

    /// Returns the time of the last value, s.
    pub fn last_time_s(&self) -> Option<f64> {
        self.last.map(|last| last.time_s)
    }

    /// Returns the fitted process.
    pub fn process(&self) -> &Autoregression<T> {
        &self.process
    }

    fn ready(&self) -> bool {
        self.process.rows() >= MIN_ROWS
    }

    fn centred_recent(&self) -> [T; ORDER] {
        self.recent.map(|difference| difference - self.mean)
    }

    /// Returns the steps of an interval, or `None` if it is not a multiple of the spacing or too
    /// long.
    fn steps_in(elapsed_s: f64, spacing_s: f64) -> Option<usize> {
        // The usual case needs no division.
        if libm::fabs(elapsed_s - spacing_s) <= TIME_TOLERANCE_S {
            return Some(1);
        }
        let steps = libm::round(elapsed_s / spacing_s);
        let on_time = libm::fabs(elapsed_s - steps * spacing_s) <= TIME_TOLERANCE_S;
        (on_time && (1.0..=HOLD_OVER_STEPS as f64).contains(&steps)).then_some(steps as usize)
    }

    /// Continues the window. Returns `None` if the reading does not fit; the window must then
    /// restart.
    fn follow(&mut self, reading: &ClockReading<T>) -> Option<()> {
        let last = self.last?;
        let elapsed_s = reading.time_s - last.time_s;
        let spacing_s = *self.spacing_s.get_or_insert(elapsed_s);
        if !(spacing_s > TIME_TOLERANCE_S) {
            return None;
        }
        let steps = Self::steps_in(elapsed_s, spacing_s)?;
        let per_step = self.window.relative(reading.level_m - last.level_m, steps);
        let jumped = if self.ready() {
            self.coast(steps).is_none_or(|ahead| ahead.misses(reading))
        } else {
            let noise = T::narrow(JUMP_SIGMAS) * (reading.sigma + last.sigma);
            !((per_step - self.mean).abs() <= T::narrow(RATE_CHANGE_M_S * spacing_s) + noise)
        };
        if jumped {
            return None;
        }
        self.bridge(steps, per_step);
        self.window.push((steps == 1).then_some(per_step));
        self.mean = self.window.mean();
        self.process = Autoregression::fit(self.window.centred(self.mean));
        Some(())
    }

    /// Appends `steps` differences: forecasts, with their error spread evenly, so that their mean
    /// is `per_step`. A single difference is exactly `per_step`.
    fn bridge(&mut self, steps: usize, per_step: T) {
        let ahead = self.process.extrapolate(self.centred_recent()).take(steps);
        let sum = ahead.clone().fold(T::zero(), |sum, (step, _)| sum + step);
        let offset = per_step - sum / T::narrow(steps as f64);
        for (step, _) in ahead {
            let [latest, before, _] = self.recent;
            self.recent = [step + offset, latest, before];
        }
    }
}
