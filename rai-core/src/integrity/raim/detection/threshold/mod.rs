//! Thresholds from committed tables: the values from which a statistic means a fault.
//!
//! ```text
//! tau1(ν)    Q(tau1; ν) = Pfa                 global test: SSE ≥ tau1 detects
//! lambda(ν)  G(tau1; ν, lambda) = Pmd         smallest fault, as non-centrality, that is missed with at most Pmd
//! T_d(n)     Q(T_d²; 1) = Pfa / n             w-test, two-sided, one of n
//! ```
//!
//! `Q` is the upper tail of the central, `G` the lower tail of the non-central χ² distribution.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `tau1` | `tau1` | dimensionless: a sum of squares in units of sigma² |
//! | `lambda` | `lambda` | dimensionless: a squared bias in units of sigma² |
//! | `T_d` | `w_test` | dimensionless: a residual in units of its sigma |
//! | `ν` | `dof` | degrees of freedom |
//!
//! The table is generated (`cargo xtask tables`) and exact to 1e-12 relative. Nothing is
//! interpolated between probabilities and nothing is extrapolated: a probability that is not in the
//! table is an error that names the nearest one, and beyond a row's end the result is `None`.
//! Without the feature `tables` only the probabilities of the phases of flight are there, and
//! without `double-tables` they are in single precision.
//!
//! [`chi_square`](crate::numeric::chi_square) computes thresholds that depend on the geometry;
//! [`policy`] chooses among them.
//!
//! References: [Yang2015] §1–2, [Lin2016] eq. 12, 20, 24.
//!
//! [Yang2015]: crate#references
//! [Lin2016]: crate#references

use core::fmt;

use crate::bounded::{MAX_ROWS, assert_capacity};
use crate::numeric::probability::Probability;
use crate::numeric::real::Real;

pub mod policy;
mod rows;
mod table;

pub use crate::numeric::chi_square::MAX_DOF;

use rows::{Rows, TableScalar};

/// The largest number of simultaneous w-tests in the tables.
pub const MAX_TESTS: usize = 64;

/// Largest relative difference to a probability of the table that still counts as equal. It permits
/// decimal rounding only.
const SAME_PROBABILITY: f64 = 1e-9;

/// Thresholds for one pair of probabilities, in the precision of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thresholds<'t> {
    tau1: &'t [TableScalar],
    lambda: &'t [TableScalar],
    w_test: &'t [TableScalar],
}

/// The probability that is not in the tables.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ThresholdError {
    /// No thresholds for this probability of false alarm.
    FalseAlarm {
        /// The probability that was given.
        value: Probability,
        /// The table's probability with the closest ratio.
        nearest: Probability,
    },
    /// No thresholds for this probability of missed detection.
    MissedDetection {
        /// The probability that was given.
        value: Probability,
        /// The table's probability with the closest ratio.
        nearest: Probability,
    },
}

impl fmt::Display for ThresholdError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::FalseAlarm { .. } => "probability of false alarm must be one of the tables",
            Self::MissedDetection { .. } => "probability of missed detection must be one of the tables",
        })
    }
}

impl core::error::Error for ThresholdError {}

/// Returns the probabilities of false alarm in the tables, largest first.
pub fn false_alarms() -> &'static [Probability] {
    &rows::FALSE_ALARM
}

/// Returns the probabilities of missed detection in the tables, largest first.
pub fn missed_detections() -> &'static [Probability] {
    &rows::MISSED_DETECTION
}

impl Thresholds<'static> {
    /// Returns the committed rows of a pair of probabilities.
    ///
    /// # Errors
    /// [`ThresholdError`] names the probability that is not in the tables, and the nearest one.
    pub fn from_tables(
        false_alarm: Probability,
        missed_detection: Probability,
    ) -> Result<Self, ThresholdError> {
        Self::up_to::<MAX_ROWS>(false_alarm, missed_detection)
    }

    /// Works like [`Self::from_tables`], with rows that end at `N`, for epochs of at most as many
    /// ranges. An image then contains no more of the tables than it needs.
    ///
    /// # Errors
    /// As [`Self::from_tables`].
    pub fn up_to<const N: usize>(
        false_alarm: Probability,
        missed_detection: Probability,
    ) -> Result<Self, ThresholdError> {
        const { assert_capacity(N) };
        let alarm = matching(&rows::FALSE_ALARM, false_alarm)
            .map_err(|nearest| ThresholdError::FalseAlarm { value: false_alarm, nearest })?;
        let miss = matching(&rows::MISSED_DETECTION, missed_detection)
            .map_err(|nearest| ThresholdError::MissedDetection { value: missed_detection, nearest })?;
        // There are as many rows as probabilities, so that the defaults are never used.
        let tau1 = Rows::<N>::TAU1.get(alarm).map_or(&[][..], Rows::<N>::dof);
        let w_test = Rows::<N>::W_TEST.get(alarm).map_or(&[][..], |row| row);
        let lambda = Rows::<N>::LAMBDA.get(alarm).and_then(|rows| rows.get(miss));
        let lambda = lambda.map_or(&[][..], Rows::<N>::dof);
        Ok(Self { tau1, lambda, w_test })
    }
}

#[cfg(feature = "double-tables")]
impl<'t> Thresholds<'t> {
    /// Returns thresholds from rows that the caller computed, for probabilities outside the tables.
    ///
    /// Element 0 is for one degree of freedom (`tau1`, `lambda`) and for one test (`w_test`).
    pub const fn from_rows(tau1: &'t [f64], lambda: &'t [f64], w_test: &'t [f64]) -> Self {
        Self { tau1, lambda, w_test }
    }
}

impl Thresholds<'_> {
    /// Returns the threshold of the global test, or `None` without redundancy or beyond the row.
    pub fn tau1<T: Real>(&self, dof: usize) -> Option<T> {
        element(self.tau1, dof)
    }

    /// Returns the non-centrality of the smallest fault that is missed with at most the required
    /// probability, or `None` as [`Self::tau1`].
    pub fn lambda<T: Real>(&self, dof: usize) -> Option<T> {
        element(self.lambda, dof)
    }

    /// Returns the squared bias, in units of its variance, that is missed with the required
    /// probability if this share of its square shows; infinity if too little shows, or without
    /// [`Self::lambda`].
    pub(crate) fn hidden<T: Real>(&self, dof: usize, shown: T) -> T {
        let lambda = self.lambda::<T>(dof).filter(|_| shown >= T::UNTESTABLE);
        lambda.map_or_else(|| T::narrow(f64::INFINITY), |lambda| lambda / shown)
    }

    /// Returns the two-sided threshold of each of `tests` w-tests, or `None` for 0 tests or beyond
    /// the row.
    pub fn w_test<T: Real>(&self, tests: usize) -> Option<T> {
        element(self.w_test, tests)
    }
}

/// Returns a row's element, counted from one.
// Not inlined, so that its many callers share one copy.
#[inline(never)]
fn element<T: Real>(row: &[TableScalar], number: usize) -> Option<T> {
    row.get(number.checked_sub(1)?).map(|element| T::narrow(element.widen()))
}

/// Returns the index of `wanted` among the probabilities, or the nearest of them as an error.
#[inline(never)]
fn matching(grid: &[Probability], wanted: Probability) -> Result<usize, Probability> {
    // Equality is tested first, because it is cheap. The tolerance test divides for every entry.
    if let Some(index) = grid.iter().position(|known| *known == wanted) {
        return Ok(index);
    }
    let ratio = |known: &Probability| (known.get() / wanted.get()).max(wanted.get() / known.get());
    let nearest = grid.iter().enumerate().min_by(|(_, a), (_, b)| ratio(a).total_cmp(&ratio(b)));
    match nearest {
        Some((index, known)) if ratio(known) <= 1.0 + SAME_PROBABILITY => Ok(index),
        Some((_, known)) => Err(*known),
        None => Err(wanted),
    }
}

/// Returns a probability of the generated table, checked at compile time.
const fn tail(probability: f64) -> Probability {
    match Probability::new(probability) {
        Some(tail) => tail,
        None => unreachable!(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn probability(tail: f64) -> Probability {
        Probability::new(tail).unwrap_or(super::tail(0.49))
    }

    fn thresholds(false_alarm: f64, missed_detection: f64) -> Option<Thresholds<'static>> {
        Thresholds::from_tables(probability(false_alarm), probability(missed_detection)).ok()
    }

    fn assert_published(have: Option<f64>, want: f64) {
        let relative = have.map(|have| libm::fabs(have / want - 1.0));
        // Published to ten digits; a w-test threshold to seven.
        let limit = if want < 10.0 { 1.2e-7 } else { 5e-9 };
        assert!(relative.is_some_and(|error| error <= limit), "have {have:?}, want {want}");
    }

    #[test]
    fn global_test_thresholds_are_the_published_ones() {
        let approach = thresholds(3.33e-7, 1e-3);
        let published = [(1, 26.04819513), (4, 35.70345585), (5, 38.270087), (40, 101.1492289)];
        for (dof, want) in published {
            assert_published(approach.and_then(|rows| rows.tau1(dof)), want);
        }
    }

    #[test]
    fn noncentralities_are_the_published_ones() {
        let (approach, lin2016) = (thresholds(3.33e-7, 1e-3), thresholds(1e-4, 1e-6));
        for (dof, want) in [(1, 67.14123537), (8, 87.89566148), (40, 128.1192491)] {
            assert_published(approach.and_then(|rows| rows.lambda(dof)), want);
        }
        for (dof, want) in [(1, 74.71901598), (10, 102.875109), (30, 131.9774202)] {
            assert_published(lin2016.and_then(|rows| rows.lambda(dof)), want);
        }
    }

    #[test]
    fn w_test_thresholds_are_the_published_ones() {
        let lin2016 = thresholds(1e-4, 1e-6);
        for (tests, want) in [(5, 4.264891), (8, 4.368680), (14, 4.489387), (44, 4.727525)] {
            assert_published(lin2016.and_then(|rows| rows.w_test(tests)), want);
        }
    }

    /// Otherwise a module in single precision, whose tables hold no more digits, would judge
    /// differently from a host.
    #[test]
    fn a_test_in_single_precision_takes_the_nearest_to_the_published() {
        let approach = thresholds(3.33e-7, 1e-3);
        let have = approach.map(|rows| [rows.tau1::<f32>(4), rows.lambda(8), rows.w_test(1)]);
        // The w-test of one is the root of the global test with one degree of freedom.
        let published = [35.703_455_85_f64, 87.895_661_48, libm::sqrt(26.048_195_13)];
        assert_eq!(have, Some(published.map(|want| Some(want as f32))));
    }

    #[test]
    fn nothing_is_extrapolated() {
        let rows = thresholds(1e-5, 1e-3);
        let have = rows.map(|rows| [rows.tau1::<f64>(0), rows.lambda(0), rows.w_test(0)]);
        assert_eq!(have, Some([None; 3]));
        let have = rows.map(|rows| [rows.tau1::<f64>(61), rows.lambda(61), rows.w_test(65)]);
        assert_eq!(have, Some([None; 3]));
        let have = rows
            .map(|rows| [rows.tau1::<f64>(60), rows.lambda(60), rows.w_test(64)].map(|end| end.is_some()));
        assert_eq!(have, Some([true; 3]));
    }

    #[test]
    fn unknown_probability_names_the_nearest() {
        let have = Thresholds::from_tables(probability(2e-8), probability(1e-3));
        assert_eq!(
            have,
            Err(ThresholdError::FalseAlarm { value: probability(2e-8), nearest: probability(1e-8) })
        );
        let have = Thresholds::from_tables(probability(1e-5), probability(0.4));
        assert_eq!(
            have,
            Err(ThresholdError::MissedDetection { value: probability(0.4), nearest: probability(1e-3) })
        );
    }

    #[test]
    fn one_in_fifteen_thousand_is_not_its_rounding() {
        let exact = thresholds(1.0 / 15_000.0, 1e-3).and_then(|rows| rows.tau1::<f64>(4));
        let rounded = thresholds(6.667e-5, 1e-3).and_then(|rows| rows.tau1(4));
        assert!(exact.is_some() && rounded.is_some() && exact != rounded, "{exact:?} {rounded:?}");
    }

    #[cfg(feature = "double-tables")]
    #[test]
    fn rows_of_the_caller_are_read_from_one() {
        let rows = Thresholds::from_rows(&[10.0, 20.0], &[30.0], &[4.0]);
        assert_eq!([rows.tau1(2), rows.lambda(1), rows.w_test(1)], [Some(20.0), Some(30.0), Some(4.0)]);
        assert_eq!([rows.tau1::<f64>(3), rows.lambda(2), rows.w_test(2)], [None; 3]);
    }
}
