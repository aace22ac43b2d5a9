//! Third-order autoregression by exact forward and backward least squares.
//!
//! ```text
//! x_t = Σ a_k x_{t−k} + e_t,  k = 1 … 3                     forward
//! x_{t−3} = Σ a_k x_{t−3+k} + e'_t                          backward, with the same a
//! Σ_t (e_t² + e'_t²) → min      C a = c,  c_ij = Σ_t x_{t−i} x_{t−j} + x_{t−3+i} x_{t−3+j}
//! σ_e² = minimum / 2 rows       σ²(h) = σ_e² Σ_{j<h} Ψ_j²,  Ψ_j = ψ_0 + … + ψ_j,  ψ_j = Σ a_k ψ_{j−k},  ψ_0 = 1
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `x` | centred differences of a clock | m |
//! | `a` | `coefficients` | – |
//! | `σ_e²` | `variance`, of one step | m² |
//! | `rows` | `rows`, runs of four consecutive differences | – |
//! | `Ψ` | [`Extrapolation`]'s response of the level to an old innovation | – |
//!
//! Unlike Burg's and the Yule–Walker estimates it has no bias on short records, but it may be
//! unstable. The variance of an unstable process' forecast grows without bound, so that the caller
//! limits the horizon.
//!
//! The six distinct `c_ij` are summed again for every window, because running sums would accumulate
//! rounding errors. For 60 values this takes 600 products. `σ_e²` is summed from the residuals in a
//! second pass: for a clock with a good forecast, a difference of sums would cancel.
//!
//! References: [Ulrych1976], [Chen2009] §2.
//!
//! [Ulrych1976]: crate#references
//! [Chen2009]: crate#references

use nalgebra::Vector3;

use crate::numeric::cholesky::Cholesky;
use crate::numeric::real::Real;
use crate::numeric::space::dot;

/// Number of differences from which the next one is forecast.
pub const ORDER: usize = 3;

/// A fitted process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Autoregression<T: Real> {
    coefficients: Vector3<T>,
    variance: T,
    rows: usize,
}

impl<T: Real> Autoregression<T> {
    /// Returns the process without a fit, which forecasts the mean.
    pub fn white() -> Self {
        Self { coefficients: Vector3::zeros(), variance: T::zero(), rows: 0 }
    }

    /// Fits centred differences, oldest first. A missing one is `None`, and no run contains it.
    ///
    /// If the normal equations are singular, or their solution is no better than forecasting the
    /// mean, the coefficients are zero.
    pub fn fit(differences: impl Iterator<Item = Option<T>> + Clone) -> Self {
        let sums = LagSums::over(differences.clone());
        let white = Self { variance: sums.variance(sums.c00), rows: sums.rows, ..Self::white() };
        let Some(coefficients) = sums.solve() else { return white };
        let squares = rows(differences).fold(T::zero(), |sum, row| sum + squared_errors(&coefficients, row));
        let variance = sums.variance(squares);
        // A NaN variance fails this comparison.
        if variance < white.variance { Self { coefficients, variance, ..white } } else { white }
    }

    /// Returns `a_1, a_2, a_3`.
    pub fn coefficients(&self) -> [T; ORDER] {
        self.coefficients.into()
    }

    /// Returns the variance of one step, m².
    pub fn variance(&self) -> T {
        self.variance
    }

    /// Returns the number of runs of four consecutive differences that were fitted.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Extrapolates from the last three centred differences, latest first.
    pub fn extrapolate(&self, recent: [T; ORDER]) -> Extrapolation<T> {
        Extrapolation {
            process: *self,
            recent: recent.into(),
            response: Vector3::x(),
            level_response: T::one(),
            response_squares: T::zero(),
        }
    }
}

/// Steps of a forecast. Each item is the next centred difference, and the variance of the level
/// after it.
#[derive(Clone, Debug)]
pub struct Extrapolation<T: Real> {
    process: Autoregression<T>,
    recent: Vector3<T>,
    response: Vector3<T>,
    level_response: T,
    response_squares: T,
}

impl<T: Real> Iterator for Extrapolation<T> {
    /// Centred difference, m, and variance of the sum of all differences so far, m².
    type Item = (T, T);

    fn next(&mut self) -> Option<(T, T)> {
        self.response_squares += self.level_response * self.level_response;
        let response = dot(&self.process.coefficients, &self.response);
        self.level_response += response;
        self.response = shifted(response, &self.response);

        let difference = dot(&self.process.coefficients, &self.recent);
        self.recent = shifted(difference, &self.recent);
        Some((difference, self.process.variance * self.response_squares))
    }
}

/// Returns the latest three differences after adding one.
fn shifted<T: Real>(latest: T, recent: &Vector3<T>) -> Vector3<T> {
    Vector3::new(latest, recent.x, recent.y)
}

/// Iterates over runs of four consecutive differences, latest first: one forward and one backward
/// equation.
fn rows<T: Real>(differences: impl Iterator<Item = Option<T>>) -> impl Iterator<Item = [T; ORDER + 1]> {
    let (mut row, mut run) = ([T::zero(); ORDER + 1], 0);
    differences.filter_map(move |difference| {
        let [x0, x1, x2, _] = row;
        row = [difference.unwrap_or(T::zero()), x0, x1, x2];
        run = if difference.is_some() { run + 1 } else { 0 };
        (run > ORDER).then_some(row)
    })
}

fn squared_errors<T: Real>(coefficients: &Vector3<T>, [x0, x1, x2, x3]: [T; ORDER + 1]) -> T {
    let forward = x0 - dot(coefficients, &Vector3::new(x1, x2, x3));
    let backward = x3 - dot(coefficients, &Vector3::new(x2, x1, x0));
    forward * forward + backward * backward
}

/// The distinct sums of products. Because the two directions are symmetric, `c_22 = c_11`,
/// `c_13 = c_02`, `c_23 = c_01` and `c_33 = c_00`.
struct LagSums<T> {
    c00: T,
    c01: T,
    c02: T,
    c03: T,
    c11: T,
    c12: T,
    rows: usize,
}

impl<T: Real> LagSums<T> {
    fn over(differences: impl Iterator<Item = Option<T>>) -> Self {
        let zero = T::zero();
        let none = Self { c00: zero, c01: zero, c02: zero, c03: zero, c11: zero, c12: zero, rows: 0 };
        let mut sums = rows(differences).fold(none, Self::add);
        sums.c03 += sums.c03;
        sums.c12 += sums.c12;
        sums
    }

    fn add(mut self, [x0, x1, x2, x3]: [T; ORDER + 1]) -> Self {
        self.c00 += x0 * x0 + x3 * x3;
        self.c01 += x0 * x1 + x3 * x2;
        self.c02 += x0 * x2 + x3 * x1;
        self.c03 += x0 * x3;
        self.c11 += x1 * x1 + x2 * x2;
        self.c12 += x1 * x2;
        self.rows += 1;
        self
    }

    /// Returns `a` if it is determined.
    fn solve(&self) -> Option<Vector3<T>> {
        let Self { c00, c01, c02, c03, c11, c12, .. } = *self;
        let (zero, one) = (T::zero(), T::one());
        let normal =
            [[c11, c12, c02, zero], [c12, c11, c01, zero], [c02, c01, c00, zero], [zero, zero, zero, one]];
        let [a1, a2, a3, _] = Cholesky::new(&normal)?.solve(&[c01, c02, c03, zero]);
        (a1.is_finite() && a2.is_finite() && a3.is_finite()).then(|| Vector3::new(a1, a2, a3))
    }

    fn variance(&self, squares: T) -> T {
        squares / T::narrow(2.0 * self.rows.max(1) as f64)
    }
}
