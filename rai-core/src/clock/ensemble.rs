//! One coasting clock for each constellation: which one aids the next epoch, and what each learns from a snapshot.
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
//! An epoch takes one aiding clock. It is the one with the smallest standard deviation among the constellations
//! observed: where satellites are few every clock raises the degrees of freedom by one, so the surest serves best.
//!
//! Four windows of 60 values in `f32` take 2.4 kB; each constellation observed costs 5,000 instructions an epoch.
//! References: [Chen2009] §3.
//!
//! [Chen2009]: crate#references

use super::{CoastingClock, WINDOW};
use crate::epoch::{Aiding, EpochView};
use crate::least_squares::equations::Row;
use crate::least_squares::{Fit, Snapshot};
use crate::numeric::real::Real;
use crate::numeric::space::zero;
use crate::satellite::Constellation;

/// Satellites of a constellation without which its clock is not learned: a lone one determines it untested.
const MIN_SATELLITES: usize = 2;

/// Longest time that a clock is forecast over after it was learned last, s.
///
/// A forecast takes a row without being learned from while the satellites alone cannot be tested. What a temperature or a
/// shock does to a quartz within a minute is still what the minute before has shown; what it does in ten is not.
pub const HOLD_OVER_S: f64 = 60.0;

/// A receiver clock as the satellites of an epoch have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolvedClock {
    /// Receiver clock times the speed of light, m.
    pub value_m: f64,
    /// Its standard deviation, m.
    pub sigma_m: f64,
}

/// The coasting clocks of a receiver.
#[derive(Clone, Debug)]
pub struct Clocks<T: Real, const L: usize = WINDOW> {
    each: [CoastingClock<T, L>; Constellation::COUNT],
}

impl<T: Real, const L: usize> Default for Clocks<T, L> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const L: usize> Clocks<T, L> {
    /// Clocks of which nothing is known.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn new() -> Self {
        // One by one, and not by a loop, which would make them beside where they stay.
        Self {
            each: [CoastingClock::new(), CoastingClock::new(), CoastingClock::new(), CoastingClock::new()],
        }
    }

    /// Forgets everything.
    pub fn restart(&mut self) {
        self.each.iter_mut().for_each(CoastingClock::restart);
    }

    /// One constellation's clock.
    pub fn of(&self, constellation: Constellation) -> Option<&CoastingClock<T, L>> {
        self.each.get(constellation as usize)
    }

    /// The row that aids an epoch; `None` where no constellation observed has a forecast.
    ///
    /// None reaches farther than [`HOLD_OVER_S`] beyond what was learned last: what vouches for itself ends by itself.
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

    /// Learns what an epoch says of the clocks.
    ///
    /// A forecast that was left out in it was a jump of the clock: that clock starts again from what the satellites
    /// say.
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

/// What an epoch that passed the test says of the receiver clocks, exclusions done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolvedClocks {
    each: [ClockOfEpoch; Constellation::COUNT],
}

/// What it says of one constellation's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct ClockOfEpoch {
    /// Its forecast was left out.
    has_jumped: bool,
    /// By the satellites alone.
    alone: Option<SolvedClock>,
}

impl SolvedClocks {
    /// Reads the clocks of a snapshot.
    #[inline(never)]
    pub fn of<T: Real>(snapshot: &Snapshot<'_, T>) -> Self {
        Self {
            each: Constellation::ALL.map(|constellation| ClockOfEpoch {
                has_jumped: aiding_row(snapshot, constellation).is_some_and(|(row, _)| left_out(row)),
                alone: satellites_alone(snapshot, constellation),
            }),
        }
    }
}

/// A constellation's receiver clock without its forecast; `None` where fewer than two of its satellites, or the
/// satellites alone, do not determine it.
pub fn satellites_alone<T: Real>(
    snapshot: &Snapshot<'_, T>,
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
    Some(SolvedClock { value_m, sigma_m: variance.sqrt().widen() })
}

fn aiding_row<'s, T: Real>(
    snapshot: &'s Snapshot<'_, T>,
    constellation: Constellation,
) -> Option<(&'s Row<T>, &'s Fit<T>)> {
    snapshot.rows().find(|(row, _)| row.clock == Some(constellation) && is_forecast(row))
}

/// A row that touches a clock and no coordinate.
fn is_forecast<T: Real>(row: &Row<T>) -> bool {
    row.design == zero()
}

fn left_out<T: Real>(row: &Row<T>) -> bool {
    !(row.weight > T::zero())
}
