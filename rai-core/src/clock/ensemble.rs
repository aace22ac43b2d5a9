//! One coasting clock for each constellation: the choice of the clock that aids an epoch, and the
//! clocks of a snapshot.
//!
//! ```text
//! Q_cc = 1/W_c + h̄_c P h̄_cᵀ                    variance of the solved clock b_c
//! b_c without the forecast = b_c − (Q_cc w_i / r_i) v_i      i: the aiding row, r_i = 1 − w_i Q_cc
//! Q_cc without the forecast = Q_cc / r_i
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `b_c` | [`SolvedClock::value_m`] | m |
//! | `√Q_cc` | [`SolvedClock::sigma_m`] | m |
//! | `v_i`, `w_i`, `r_i` | residual, weight and redundancy of the aiding row | m, 1/m², – |
//!
//! An epoch is aided by one clock. Any clock adds one degree of freedom, so that the most accurate
//! one among the observed constellations is the best.
//!
//! Four windows of 60 values in `f32` take 2.4 kB. Each observed constellation takes 5,000
//! instructions per epoch. References: [Chen2009] §3.
//!
//! [Chen2009]: crate#references

use super::{CoastingClock, WINDOW};
use crate::epoch::{Aiding, EpochView};
use crate::least_squares::equations::Row;
use crate::least_squares::{RowFit, Snapshot};
use crate::numeric::real::Real;
use crate::numeric::space::is_zero;
use crate::satellite::Constellation;

/// Least number of a constellation's satellites from which its clock is learned. A lone satellite
/// determines the clock without a test.
const MIN_SATELLITES: usize = 2;

/// Longest time between the last learned value of a clock and its forecast, s.
///
/// As long as the satellites alone cannot be tested, a forecast is used without learning. The last
/// minute shows how temperature and shock affect a quartz within a minute, but not within ten.
pub const HOLD_OVER_S: f64 = 60.0;

/// Number of clocks; 0 in a build without aiding.
const CLOCKS: usize = if cfg!(feature = "aiding") { Constellation::COUNT } else { 0 };

/// A receiver clock, solved from the satellites of an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolvedClock {
    /// Receiver clock times the speed of light, m.
    pub value_m: f64,
    /// Standard deviation of `value_m`, m.
    pub sigma_m: f64,
}

/// The coasting clocks of a receiver.
#[derive(Clone, Debug)]
pub struct Clocks<T: Real, const L: usize = WINDOW> {
    each: [CoastingClock<T, L>; CLOCKS],
}

impl<T: Real, const L: usize> Default for Clocks<T, L> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const L: usize> Clocks<T, L> {
    /// Returns clocks without values.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn new() -> Self {
        // Listed one by one, because a loop would make them on the stack first.
        Self {
            #[cfg(feature = "aiding")]
            each: [CoastingClock::new(), CoastingClock::new(), CoastingClock::new(), CoastingClock::new()],
            #[cfg(not(feature = "aiding"))]
            each: [],
        }
    }

    /// Forgets everything.
    pub fn restart(&mut self) {
        self.each.iter_mut().for_each(CoastingClock::restart);
    }

    /// Returns one constellation's clock.
    pub fn of(&self, constellation: Constellation) -> Option<&CoastingClock<T, L>> {
        self.each.get(constellation as usize)
    }

    /// Returns the row that aids an epoch, or `None` if no observed constellation has a forecast.
    ///
    /// No forecast is used later than [`HOLD_OVER_S`] after the last learned value, because by then
    /// it would confirm itself.
    #[inline(never)]
    pub fn aiding(&self, epoch: &EpochView<'_>) -> Option<Aiding> {
        let observed = |constellation: &Constellation| {
            epoch
                .observations()
                .iter()
                .any(|observation| observation.satellite.constellation() == *constellation)
        };
        let forecasts = Constellation::ALL.into_iter().filter(observed).filter_map(|constellation| {
            let clock = self.of(constellation)?;
            let is_recent = epoch.time_s() - clock.last_time_s()? <= HOLD_OVER_S;
            Some((constellation, clock.forecast(epoch.time_s()).filter(|_| is_recent)?))
        });
        let (constellation, forecast) = forecasts.min_by(|(_, a), (_, b)| a.sigma_m.total_cmp(&b.sigma_m))?;
        Some(Aiding::Clock { constellation, value_m: forecast.value_m, sigma_m: forecast.sigma_m })
    }

    /// Learns the clocks of an epoch.
    ///
    /// If a forecast was left out, that clock has jumped. It then starts again from the satellites'
    /// value.
    pub fn learn(&mut self, time_s: f64, solved: &SolvedClocks) {
        for (clock, of_epoch) in self.each.iter_mut().zip(&solved.each) {
            if of_epoch.has_jumped {
                clock.restart();
            }
            if let Some(solved) = of_epoch.alone {
                clock.observe(time_s, solved.value_m, solved.sigma_m);
            }
        }
    }
}

/// Receiver clocks of an epoch that passed the test, after exclusions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolvedClocks {
    each: [ClockOfEpoch; Constellation::COUNT],
}

/// Receiver clock of one constellation in an epoch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct ClockOfEpoch {
    /// True if its forecast was left out.
    has_jumped: bool,
    /// Clock from the satellites alone.
    alone: Option<SolvedClock>,
}

impl SolvedClocks {
    /// Reads the clocks of a snapshot.
    #[inline(never)]
    pub fn of<T: Real, const N: usize>(snapshot: &Snapshot<'_, T, N>) -> Self {
        Self {
            each: Constellation::ALL.map(|constellation| ClockOfEpoch {
                has_jumped: aiding_row(snapshot, constellation).is_some_and(|(row, _)| left_out(row)),
                alone: satellites_alone(snapshot, constellation),
            }),
        }
    }
}

/// Returns a constellation's receiver clock without its forecast. Returns `None` if it has fewer
/// than two satellites, or if the satellites alone do not determine the clock.
pub fn satellites_alone<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    constellation: Constellation,
) -> Option<SolvedClock> {
    let belongs = |row: &Row<T>| row.clock == Some(constellation) && !is_forecast(row) && !left_out(row);
    if snapshot.rows().filter(|(row, _)| belongs(row)).count() < MIN_SATELLITES {
        return None;
    }
    let aided_m = snapshot.clock_m(constellation)?;
    let variance = snapshot.clock_variance(constellation)?;
    let (value_m, variance) = match aiding_row(snapshot, constellation) {
        Some((row, fit)) if !left_out(row) => {
            if fit.redundancy < T::UNTESTABLE {
                return None;
            }
            let pulled = variance * row.weight / fit.redundancy * fit.residual;
            (aided_m - pulled.widen(), variance / fit.redundancy)
        }
        _ => (aided_m, variance),
    };
    Some(SolvedClock { value_m, sigma_m: variance.sqrt_approx().widen() })
}

fn aiding_row<'s, T: Real, const N: usize>(
    snapshot: &'s Snapshot<'_, T, N>,
    constellation: Constellation,
) -> Option<(&'s Row<T>, &'s RowFit<T>)> {
    snapshot.rows().find(|(row, _)| row.clock == Some(constellation) && is_forecast(row))
}

/// Returns true for a row that depends on a clock but on no coordinate.
fn is_forecast<T: Real>(row: &Row<T>) -> bool {
    is_zero(&row.design)
}

fn left_out<T: Real>(row: &Row<T>) -> bool {
    !(row.weight > T::zero())
}
