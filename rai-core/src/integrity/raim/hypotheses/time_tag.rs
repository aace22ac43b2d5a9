//! Time-tag hypothesis: does one wrong time of all ranges explain the data as well as an exclusion?
//!
//! If a receiver tags its ranges with a wrong time, the module compares them with satellite
//! positions at that time. Each range is then wrong by its range rate times the time error. In
//! addition to "satellite `i` is faulty" this is one more hypothesis, and one more column in the
//! design.
//!
//! ```text
//! y_i = h_i · x + b_c + ṙ_i δ + ε_i
//! a_i = ṙ_i − r̄_c − d_i · P Σ w_j d_j (ṙ_j − r̄_c)        A = Σ w_i a_i²        δ = Σ w_i a_i v_i / A
//! SSE_δ = SSE − δ² A     dof_δ = dof − 1
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `ṙ_i` | range rate for a receiver at rest ([`RangeRates`]) | m/s |
//! | `r̄_c` | its weighted mean over constellation `c`; `d`, `P`, `w`, `v` as in [`crate::least_squares`] | m/s |
//! | `a_i` | part of the rates that neither position nor clocks explain | m/s |
//! | `δ` | error of the tag, positive if it is late | s |
//!
//! In parity space the column is a line like that of a row. Its product with row `i` is
//! `√w_i a_i/√A`, and it is projected out of the rows like another row
//! ([`crate::least_squares::downdate`]). An exclusion of `k` rows therefore has one more kind of
//! rival: the time together with 0 to `k − 1` rows. A rival must explain nearly as much, as in
//! [`super::separability`]. But if only one row was excluded, `Q⁻¹(P_md)` replaces `T_d`. A wrong
//! time is then attributed to a satellite no more often than a fault is missed. With little
//! redundancy the time explains a part of every fault, and the smaller margin still lets a
//! satellite be identified.
//!
//! - The tag is wrong if the time alone explains the data: at least as well as the one excluded
//!   row, or nearly as well as several ([`TimeTagOutcome::Time`]).
//! - The case is ambiguous if the time explains nearly as much as the one excluded row, or explains
//!   the data together with fewer rows ([`TimeTagOutcome::Rows`]).
//! - Without an excluded row, the tag is wrong if the time's w-test, `δ √A`, is above its threshold
//!   and above the w-test of every row. This test also applies to epochs that pass the global test.
//!   It adds the false alarms of one more row.
//! - If no row was excluded and the w-test is below its threshold, the levels are enlarged: with
//!   the same w-test, a wrong time moves the position up to three times as far as a satellite. They
//!   become at least `s_δ |δ √A| + k' √(s_δ² + σ²)` with `s_δ = |P Σ w_j d_j (ṙ_j − r̄_c)| / √A`
//!   ([`crate::integrity::raim::levels`]). With correct tags this rarely exceeds a satellite's
//!   level.
//!
//! The column assumes constant range rates: their change, below 0.2 m/s², amounts to 4 mm in 0.2 s.
//! A wrong time also shifts the position of a moving receiver along its way. This part is not
//! tested here.
//!
//! **Limits.** Range rates are expensive, so that the test is skipped if SSE is below half of the
//! squared threshold. A time error of one constellation only is not tested. With little redundancy
//! the time explains by chance as much as a satellite does.

use heapless::Vec;

use crate::bounded::{fill, gather};
use crate::epoch::EpochView;
use crate::integrity::raim::detection::Detection;
use crate::integrity::raim::detection::threshold::Thresholds;
use crate::integrity::raim::isolation::exclusion::Exclusion;
use crate::integrity::raim::isolation::sets::{SetBudget, each_of_size_beside};
use crate::integrity::raim::levels::{KFactors, Slopes};
use crate::least_squares::downdate::{
    ExclusionSet, NormalisedRow, NormalisedRows, ReducedRow, testable_rows,
};
use crate::least_squares::equations::Row;
use crate::least_squares::{Excludable, RowFit, Snapshot, infinity};
use crate::numeric::real::Real;
use crate::numeric::space::{dot, plus_scaled, product, zero};
use crate::report::MAX_EXCLUDED;
use crate::satellite::{Constellation, SatelliteId};

/// Source of range rates for a receiver at rest, m/s; `None` for a satellite without a known orbit.
///
/// It is called only for epochs whose residuals are large enough for a wrong time
/// ([`is_suspicious`]).
pub type RangeRates<'r> = dyn Fn(SatelliteId) -> Option<f32> + 'r;

/// Returns true if the residuals may contain a wrong time that moves the position farther than a
/// satellite does.
///
/// SSE is then at least half of the squared threshold of a w-test, or fails the global test. With
/// two thirds instead of half, hardly any healthy epoch would be tested, and no attack exceeded a
/// level. But if most ranges change alike, a smaller wrong time moves the position beyond its
/// level.
pub(crate) fn is_suspicious<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    thresholds: &Thresholds<'_>,
) -> bool {
    if !cfg!(feature = "hypotheses") {
        return false;
    }
    let least = least_suspicious(snapshot, thresholds);
    !Detection::passes(snapshot, thresholds)
        || least.is_some_and(|least| snapshot.sse() >= least * T::narrow(0.5))
}

/// Returns the squared threshold of one w-test, or `None` beyond the tables.
fn least_suspicious<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    thresholds: &Thresholds<'_>,
) -> Option<T> {
    thresholds.w_test::<T>(snapshot.used()).map(|threshold| threshold * threshold)
}

/// Effect of a wrong time on an exclusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeTagOutcome<T> {
    /// A wrong time changes nothing about the exclusion.
    None,
    /// No row was left out, and a wrong time with this absolute w-test would move the position by
    /// these slopes.
    Shift(Slopes<T>, T),
    /// Other rows together with a wrong time explain the data nearly as well, or the time alone
    /// does so nearly.
    Rows,
    /// A wrong time alone explains the data.
    Time,
}

/// Range rates of an epoch, one for each satellite, m/s.
#[derive(Clone, Debug)]
pub(crate) struct EpochRates<T, const N: usize> {
    of_rows: Vec<T, N>,
}

impl<T: Real, const N: usize> EpochRates<T, N> {
    /// Returns the rates of all satellites, or `None` if one is unknown or NaN.
    // Not inlined, so that the stack of the orbits is free during the searches.
    #[inline(never)]
    pub(crate) fn of(epoch: &EpochView<'_>, rates: &RangeRates<'_>) -> Option<Self> {
        let mut of_rows = Vec::new();
        for observation in epoch.observations() {
            let rate = rates(observation.satellite).filter(|rate| rate.is_finite())?;
            of_rows.push(T::narrow(f64::from(rate))).ok()?;
        }
        Some(Self { of_rows })
    }

    /// Compares a wrong time with an exclusion. Its rows are taken back for the comparison and left
    /// out again.
    ///
    /// If the time is wrong, they are not left out again.
    #[inline(never)]
    pub(crate) fn compare(
        &self,
        solution: &mut impl Excludable<T, N>,
        exclusion: &Exclusion<T>,
        thresholds: &Thresholds<'_>,
        factors: &KFactors<T>,
    ) -> TimeTagOutcome<T> {
        let set: Vec<usize, MAX_EXCLUDED> = gather(exclusion.rows.iter().map(|excluded| excluded.index));
        if !set.is_empty() && solution.take_back(&set).is_err() {
            return TimeTagOutcome::None;
        }
        let doubt = self.doubt(solution.snapshot(), &set, thresholds, factors);
        // This should succeed, because the rest was solved before.
        if doubt != TimeTagOutcome::Time && !set.is_empty() && solution.set_aside(&set).is_err() {
            return TimeTagOutcome::Rows;
        }
        doubt
    }

    /// Returns true if the time alone explains a snapshot's residuals as well as an exclusion does.
    ///
    /// `gone` is the number of excluded rows, `found` the SSE without them. If it is one row, the
    /// time must explain at least as much. If it is none, or a whole constellation, the rest need
    /// only pass with the time, because leaving out a constellation takes more unknowns.
    ///
    /// There is no margin for ARAIM, whose sigmas are larger than most errors: with a margin on
    /// SSE, exclusions would be rejected that its tests distinguish.
    pub(crate) fn rival(
        &self,
        snapshot: &Snapshot<'_, T, N>,
        gone: u32,
        found: T,
        thresholds: &Thresholds<'_>,
    ) -> bool {
        let mut rows = NormalisedRows::<T, N>::new();
        testable_rows(snapshot, &mut rows);
        TimeTagColumn::of(snapshot, &self.of_rows, &rows).is_some_and(|column| {
            let left = column.sse(&rows);
            let dof = snapshot.dof().saturating_sub(1);
            let passes = Detection::of(left, dof, thresholds).is_some_and(|test| !test.fault());
            passes && (gone != 1 || left <= found)
        })
    }

    fn doubt(
        &self,
        snapshot: &Snapshot<'_, T, N>,
        set: &[usize],
        thresholds: &Thresholds<'_>,
        factors: &KFactors<T>,
    ) -> TimeTagOutcome<T> {
        let mut rows = NormalisedRows::<T, N>::new();
        testable_rows(snapshot, &mut rows);
        let Some(column) = TimeTagColumn::of(snapshot, &self.of_rows, &rows) else {
            return TimeTagOutcome::None;
        };
        let left = column.sse(&rows);
        let passes = |left: T, unknowns: usize| {
            let dof = snapshot.dof().saturating_sub(unknowns);
            Detection::of(left, dof, thresholds).is_some_and(|test| !test.fault())
        };
        let is_alone = passes(left, 1);
        let Some(margin) = least_suspicious(snapshot, thresholds) else { return TimeTagOutcome::None };
        if set.is_empty() {
            let explained = column.residual * column.residual;
            let is_best = explained >= margin && explained >= snapshot.statistics().worst.largest;
            return if is_alone && is_best {
                TimeTagOutcome::Time
            } else {
                TimeTagOutcome::Shift(column.slopes, column.residual.abs())
            };
        }
        let Some(found) = ExclusionSet::among(&rows, set).map(|found| found.sse(&rows)) else {
            return TimeTagOutcome::Rows;
        };
        if set.len() > 1 && is_alone && left - found < margin {
            return TimeTagOutcome::Time;
        }
        if let [_] = set {
            let missed = factors.detection();
            return match is_alone && left - found < missed * missed {
                true if left <= found => TimeTagOutcome::Time,
                true => TimeTagOutcome::Rows,
                false => TimeTagOutcome::None,
            };
        }
        let mut work = SetBudget::for_all();
        // A set that explains less than this in addition to the time is no rival.
        let least = left - found - margin;
        for size in 1..set.len() {
            let mut has_rival = false;
            each_of_size_beside::<T, N>(column.standings(&rows), size, &mut work, least, |explained| {
                has_rival |= passes(left - explained, size + 1);
                if has_rival { infinity() } else { least }
            });
            if has_rival || work.cut {
                return TimeTagOutcome::Rows;
            }
        }
        TimeTagOutcome::None
    }
}

/// Column of a wrong time, as a line in parity space.
pub(crate) struct TimeTagColumn<T: Real, const N: usize> {
    /// Products with the testable rows, in their order.
    projected: Vec<T, N>,
    /// W-test of the time: `δ √A`, dimensionless.
    residual: T,
    /// Effect of a wrong time on the position per unit of its w-test.
    slopes: Slopes<T>,
}

impl<T: Real, const N: usize> TimeTagColumn<T, N> {
    /// Returns `None` if position and clocks explain the rates, or if the scalar overflows.
    #[inline(never)]
    fn of(snapshot: &Snapshot<'_, T, N>, rates: &[T], rows: &[NormalisedRow<T>]) -> Option<Self> {
        // Aiding rows have the rate 0.
        let rated = || snapshot.rows().zip(rates.iter().copied().chain(core::iter::repeat(T::zero())));
        let used = || rated().filter(|((row, _), _)| row.weight > T::zero());
        let means = Constellation::ALL.map(|clock| {
            let mine = used().filter(|((row, _), _)| row.clock == Some(clock));
            let (weighted, weight) = mine.fold((T::zero(), T::zero()), |(sum, weight), ((row, _), rate)| {
                (sum + row.weight * rate, weight + row.weight)
            });
            if weight > T::zero() { weighted / weight } else { T::zero() }
        });
        let mean = |clock: Option<Constellation>| {
            clock.and_then(|clock| means.get(clock as usize)).copied().unwrap_or_else(T::zero)
        };
        let (gradient, whole) = used().fold((zero(), T::zero()), |(sum, whole), ((row, fit), rate)| {
            let centred = rate - mean(row.clock);
            let sum = plus_scaled(&sum, row.weight * centred, &fit.centred);
            (sum, whole + row.weight * centred * centred)
        });
        let place = product(snapshot.covariance(), &gradient);
        let left =
            |row: &Row<T>, fit: &RowFit<T>, rate: T| rate - mean(row.clock) - dot(&fit.centred, &place);
        let (square, product) =
            used().fold((T::zero(), T::zero()), |(square, product), ((row, fit), rate)| {
                let left = left(row, fit, rate);
                (square + row.weight * left * left, product + row.weight * left * fit.residual)
            });
        // NaN also returns here.
        if !(square > whole * T::UNTESTABLE && square.is_finite()) {
            return None;
        }
        let scale = square.sqrt_approx().recip();
        let mut projected = Vec::new();
        fill(
            &mut projected,
            rows.iter().map(|testable| {
                let rate = rates.get(testable.index).copied().unwrap_or_else(T::zero);
                let row = snapshot.row(testable.index);
                row.map_or_else(T::zero, |(row, fit)| left(row, fit, rate) * scale / row.sigma)
            }),
        );
        let slopes = Slopes {
            horizontal: (place.x * place.x + place.y * place.y).sqrt_approx() * scale,
            vertical: place.z.abs() * scale,
        };
        Some(Self { projected, residual: product * scale, slopes })
    }

    /// Iterates over the rows with the column projected out.
    fn standings<'r>(&self, rows: &'r [NormalisedRow<T>]) -> impl Iterator<Item = ReducedRow<'r, T>> {
        self.beside(rows).map(|(row, projected)| ReducedRow::beside(row, projected, self.residual))
    }

    /// Iterates over the rows and their products with the column.
    fn beside<'r>(&self, rows: &'r [NormalisedRow<T>]) -> impl Iterator<Item = (&'r NormalisedRow<T>, T)> {
        rows.iter().zip(self.projected.iter().copied())
    }

    /// Returns the SSE that a wrong time leaves. It is summed again, because after a gross fault
    /// `SSE − δ² A` would cancel in `f32`.
    fn sse(&self, rows: &NormalisedRows<T, N>) -> T {
        self.beside(rows).fold(T::zero(), |sum, (row, projected)| {
            let left = row.residual - projected * self.residual;
            sum + left * left
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use nalgebra::{DMatrix, DVector, Vector3};

    use super::*;
    use crate::least_squares::Workspace;
    use crate::least_squares::equations::LinearEpoch;

    /// Returns twelve satellites of two constellations: direction, rate in m/s, residual in m,
    /// sigma in m.
    fn drawn() -> [(Constellation, Vector3<f64>, f64, f64, f64); 12] {
        core::array::from_fn(|index| {
            let turn = index as f64;
            let (azimuth, up) = (2.4 * turn, 0.2 + 0.75 * (0.37 * turn).sin().abs());
            let level = (1.0 - up * up).sqrt();
            let clock = if index % 3 == 0 { Constellation::Galileo } else { Constellation::Gps };
            let direction = Vector3::new(level * azimuth.sin(), level * azimuth.cos(), up);
            (clock, direction, 700.0 * (1.7 * turn).cos(), 8.0 * (2.9 * turn).sin(), 1.0 + 0.2 * turn)
        })
    }

    /// Returns the weighted sum of squares of dense least squares over all unknowns, with or
    /// without the time.
    fn dense_sse(with_time: bool) -> f64 {
        let rows = drawn();
        let design = DMatrix::from_fn(rows.len(), 5 + usize::from(with_time), |row, column| {
            let (clock, direction, rate, _, sigma) = rows[row];
            let value = match column {
                0..3 => -direction[column],
                3 | 4 => f64::from(u8::from((clock == Constellation::Galileo) == (column == 4))),
                _ => rate,
            };
            value / sigma
        });
        let measured = DVector::from_fn(rows.len(), |row, _| rows[row].3 / rows[row].4);
        let solved = design.clone().svd(true, true).solve(&measured, 1e-12).unwrap();
        (measured - design * solved).norm_squared()
    }

    fn column_sse<T: Real>() -> (T, T) {
        let mut equations = LinearEpoch::<T, 16>::new();
        for (clock, direction, _, residual_m, sigma_m) in drawn() {
            equations.satellite(clock, direction, residual_m, sigma_m).unwrap();
        }
        let mut workspace = Workspace::of(equations);
        let snapshot = workspace.solve().unwrap();
        let mut rows = Vec::new();
        testable_rows(&snapshot, &mut rows);
        let rates: Vec<T, 16> = gather(drawn().map(|(_, _, rate, _, _)| T::narrow(rate)));
        (snapshot.sse(), TimeTagColumn::of(&snapshot, &rates, &rows).unwrap().sse(&rows))
    }

    #[test]
    fn column_of_the_time_leaves_what_dense_least_squares_leave() {
        let (without, with) = (dense_sse(false), dense_sse(true));
        let (have, have_with) = column_sse::<f64>();
        assert!((have - without).abs() < 1e-9 * without, "{have}, not {without}");
        assert!((have_with - with).abs() < 1e-9 * with, "{have_with}, not {with}");
        // Single precision resolves a millionth of the sum that it begins with.
        let (_, have_with) = column_sse::<f32>();
        assert!((f64::from(have_with) - with).abs() < 1e-5 * without, "{have_with}, not {with}");
    }

    #[test]
    fn rates_that_a_place_explains_are_no_column() {
        let mut equations = LinearEpoch::<f64, 16>::new();
        for (clock, direction, _, residual_m, sigma_m) in drawn() {
            equations.satellite(clock, direction, residual_m, sigma_m).unwrap();
        }
        let mut workspace = Workspace::of(equations);
        let snapshot = workspace.solve().unwrap();
        let mut rows = Vec::new();
        testable_rows(&snapshot, &mut rows);
        let mut of_motion: Vec<f64, 16> = gather(drawn().map(|(_, direction, ..)| 500.0 * direction.x));
        assert!(TimeTagColumn::of(&snapshot, &of_motion, &rows).is_none());
        of_motion[3] = f64::NAN;
        assert!(TimeTagColumn::of(&snapshot, &of_motion, &rows).is_none());
    }
}
