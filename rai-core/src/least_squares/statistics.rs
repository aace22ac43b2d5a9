//! Statistics of all rows, gathered while the fits are written, so that no test reads the rows
//! again.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `SSE` | [`Statistics::sse`] | – |
//! | `w²` of the worst row and of the runner-up | [`Worst`] | – |
//! | `slope_h²`, `slope_v²` | [`SquaredSlopes`] | m² |

use super::RowFit;
use crate::least_squares::equations::Row;
use crate::numeric::real::Real;

/// Redundancy number below which its subtraction from 1 loses too many digits, dimensionless. Above
/// it, `f32` results are accurate to 0.5 %.
const HARDLY_TESTED: f64 = 0.1;

/// Statistics of all rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Statistics<T: Real> {
    /// Weighted sum of squared residuals, dimensionless.
    pub(crate) sse: T,
    /// Worst of the testable rows, with the runner-up.
    pub(crate) worst: Worst<T>,
    /// Largest slopes of the testable rows.
    pub(crate) slopes: SquaredSlopes<T>,
    /// True if no row that takes part is hardly tested.
    pub(crate) all_are_tested: bool,
}

impl<T: Real> Statistics<T> {
    /// Returns statistics without rows.
    pub(super) fn none() -> Self {
        Self { sse: T::zero(), worst: Worst::none(), slopes: SquaredSlopes::none(), all_are_tested: true }
    }

    /// Adds one row to all fields but `all_are_tested`. A row that is left out has weight 0, so
    /// that it adds nothing.
    #[inline]
    pub(super) fn add(&mut self, index: usize, row: &Row<T>, fit: &RowFit<T>) {
        let squared = fit.residual * fit.residual;
        self.sse += row.weight * squared;
        self.worst.add(index, squared * fit.test_weight);
        self.slopes = self.slopes.or(&fit.squared_slopes());
    }
}

/// The largest squared w-test and the runner-up. The first of equal ones wins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Worst<T> {
    /// Index of the row; `None` if no test is above 0.
    pub(crate) index: Option<usize>,
    /// Its `w²`, dimensionless.
    pub(crate) largest: T,
    /// `w²` of the runner-up, dimensionless.
    pub(crate) runner_up: T,
}

impl<T: Real> Worst<T> {
    /// Returns a result without rows.
    pub(crate) fn none() -> Self {
        Self { index: None, largest: T::zero(), runner_up: T::zero() }
    }

    /// Adds one more squared w-test.
    #[inline]
    pub(crate) fn add(&mut self, index: usize, squared: T) {
        if squared > self.runner_up {
            self.runner_up = smaller(self.largest, squared);
            if squared > self.largest {
                self.largest = squared;
                self.index = Some(index);
            }
        }
    }
}

/// Squared slopes: their largest is found without a root for each row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SquaredSlopes<T> {
    /// Horizontal, m² per unit of `λ`.
    pub(crate) horizontal: T,
    /// Vertical, m² per unit of `λ`.
    pub(crate) vertical: T,
}

impl<T: Real> SquaredSlopes<T> {
    /// Returns slopes of zero.
    pub(crate) fn none() -> Self {
        Self { horizontal: T::zero(), vertical: T::zero() }
    }

    /// Returns the larger horizontal and the larger vertical slope of two.
    #[inline]
    pub(crate) fn or(&self, other: &Self) -> Self {
        Self {
            horizontal: larger(self.horizontal, other.horizontal),
            vertical: larger(self.vertical, other.vertical),
        }
    }
}

/// Returns the larger of two numbers by one comparison. A library call needs more, because it also
/// orders NaN.
pub(crate) fn larger<T: Real>(a: T, b: T) -> T {
    if b > a { b } else { a }
}

fn smaller<T: Real>(a: T, b: T) -> T {
    if b < a { b } else { a }
}

impl<T: Real> RowFit<T> {
    /// Returns the squared slopes of the row; 0 if it cannot be tested or is left out.
    #[inline]
    pub(crate) fn squared_slopes(&self) -> SquaredSlopes<T> {
        let (horizontal, vertical) = self.squared_gains();
        SquaredSlopes { horizontal: horizontal * self.test_weight, vertical: vertical * self.test_weight }
    }

    /// Returns `g_E² + g_N²` and `g_U²`, m⁴.
    #[inline]
    pub(crate) fn squared_gains(&self) -> (T, T) {
        (self.gain.x * self.gain.x + self.gain.y * self.gain.y, self.gain.z * self.gain.z)
    }

    /// Returns true if the redundancy is below [`HARDLY_TESTED`] or NaN; false for a row that is
    /// left out.
    pub(crate) fn is_hardly_tested(&self) -> bool {
        !(self.redundancy >= T::narrow(HARDLY_TESTED))
    }
}
