//! What the rows say together: gathered while their fits are written, so that no test reads them again.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `SSE` | [`Statistics::sse`] | – |
//! | `w²` of the worst row and of the runner-up | [`Worst`] | – |
//! | `slope_h²`, `slope_v²` | [`SquaredSlopes`] | m² |

use super::Fit;
use crate::least_squares::equations::Row;
use crate::numeric::real::Real;

/// Redundancy number below which too little of 1 is left for it, dimensionless: above, what is made of it in `f32` is good to
/// 0.5 %.
const HARDLY_TESTED: f64 = 0.1;

/// Of all rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Statistics<T: Real> {
    /// Weighted sum of squared residuals, dimensionless.
    pub(crate) sse: T,
    /// Of those that can be tested; none where all w-tests are 0.
    pub(crate) worst: Worst<T>,
    /// The largest of those that can be tested.
    pub(crate) slopes: SquaredSlopes<T>,
    /// Whether no row that takes part is hardly tested.
    pub(crate) all_are_tested: bool,
}

impl<T: Real> Statistics<T> {
    /// Of no rows.
    pub(super) fn none() -> Self {
        Self { sse: T::zero(), worst: Worst::none(), slopes: SquaredSlopes::none(), all_are_tested: true }
    }

    /// Takes one more row, but for whether it is hardly tested. One that is left out has weights of 0, and so says nothing.
    #[inline]
    pub(super) fn add(&mut self, index: usize, row: &Row<T>, fit: &Fit<T>) {
        let squared = fit.residual * fit.residual;
        self.sse += row.weight * squared;
        self.worst.add(index, squared * fit.test_weight);
        self.slopes = self.slopes.or(&fit.squared_slopes());
    }
}

/// The largest of squared w-tests, and the next. First of equals wins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Worst<T> {
    /// Index of the row; `None` where no test is above 0.
    pub(crate) index: Option<usize>,
    /// Its `w²`, dimensionless.
    pub(crate) largest: T,
    /// `w²` of the runner-up, dimensionless.
    pub(crate) runner_up: T,
}

impl<T: Real> Worst<T> {
    /// Of no rows.
    pub(crate) fn none() -> Self {
        Self { index: None, largest: T::zero(), runner_up: T::zero() }
    }

    /// Takes one more squared w-test.
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

/// Squared slopes: the largest is found without a root for each row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SquaredSlopes<T> {
    /// Horizontal, m² per unit of `λ`.
    pub(crate) horizontal: T,
    /// Vertical, m² per unit of `λ`.
    pub(crate) vertical: T,
}

impl<T: Real> SquaredSlopes<T> {
    /// Below all others.
    pub(crate) fn none() -> Self {
        Self { horizontal: T::zero(), vertical: T::zero() }
    }

    /// The larger of both, each component by itself.
    #[inline]
    pub(crate) fn or(&self, other: &Self) -> Self {
        Self {
            horizontal: larger(self.horizontal, other.horizontal),
            vertical: larger(self.vertical, other.vertical),
        }
    }
}

/// The larger of two numbers; one comparison, where a library call also orders what is not a number.
pub(crate) fn larger<T: Real>(a: T, b: T) -> T {
    if b > a { b } else { a }
}

fn smaller<T: Real>(a: T, b: T) -> T {
    if b < a { b } else { a }
}

impl<T: Real> Fit<T> {
    /// The squared slopes of the row; 0 for one that cannot be tested or is left out.
    #[inline]
    pub(crate) fn squared_slopes(&self) -> SquaredSlopes<T> {
        let (horizontal, vertical) = self.squared_gains();
        SquaredSlopes { horizontal: horizontal * self.test_weight, vertical: vertical * self.test_weight }
    }

    /// `g_E² + g_N²` and `g_U²`, m⁴.
    #[inline]
    pub(crate) fn squared_gains(&self) -> (T, T) {
        (self.gain.x * self.gain.x + self.gain.y * self.gain.y, self.gain.z * self.gain.z)
    }

    /// Whether too little of 1 is left for the redundancy, or what is not a number; never of a row that is left out.
    pub(crate) fn is_hardly_tested(&self) -> bool {
        !(self.redundancy >= T::narrow(HARDLY_TESTED))
    }
}
