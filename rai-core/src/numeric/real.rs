//! The scalar of all linearised values: `f32` or `f64`.
//!
//! Absolute values (positions, ranges, times) are `f64` everywhere. Small differences, centred on
//! their constellation's mean, are generic: the Cortex-M4F computes `f32` in hardware and emulates
//! `f64` at fifty times the cost. The constants define which values count as zero in each
//! precision.

use nalgebra::RealField;

use super::absolute::Absolute;
use super::four::Four;
use super::precision::Precision;

/// Tail of the normal distribution at a point `u`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tail<T> {
    /// `Q(u)`.
    pub probability: T,
    /// `φ(u)`.
    pub density: T,
}

/// A floating-point number in which a snapshot can be solved.
pub trait Real: RealField + Copy {
    /// Type of coordinates and ranges; their small differences are converted to this scalar.
    type Absolute: Absolute<Self>;
    /// Type of four numbers with which the processor computes at once, if it can.
    type Four: Four<Self>;

    /// Redundancy number below which a satellite counts as untestable, dimensionless.
    const UNTESTABLE: Self;
    /// Gain below which a bias counts as not moving the position, m per m.
    const UNMOVED: Self;
    /// Trace of `(HᵀH)⁻¹` (GDOP²) above which a geometry counts as singular, dimensionless.
    ///
    /// The smallest singular value of `H` is between `1/GDOP` and `√(3+C)/GDOP`.
    const SINGULAR: Self;
    /// Relative difference below which two test statistics count as equal.
    const TIE: Self;
    /// Precision of the sums of the χ² distributions.
    const CHI_SQUARE: Precision<Self>;

    /// Rounds a double.
    fn narrow(value: f64) -> Self;
    /// Converts to a double, exactly.
    fn widen(self) -> f64;
    /// Returns `√x` for `x ≥ 0`, to a few units in the last place.
    ///
    /// In single precision it is the processor's instruction, while the `sqrt` of nalgebra is
    /// libm's software.
    #[must_use]
    fn sqrt_approx(self) -> Self;
    /// Returns `1/√x` for `x > 0`, to a few units in the last place.
    #[must_use]
    fn inverse_sqrt_approx(self) -> Self;
    /// Returns sine and cosine of an angle between 0 and π/2.
    #[must_use]
    fn sine_and_cosine(self) -> (Self, Self);
    /// Returns [`tail`](super::normal::tail) for `u ≥ 0`.
    fn normal_tail(u: Self) -> Tail<Self>;
    /// Returns [`quantile`](super::normal::quantile) for `0 < p < 0.5`.
    fn normal_quantile(p: Self) -> Self;
}
