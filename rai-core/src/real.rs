//! The scalar of everything that is linearised: `f32` or `f64`.
//!
//! What is absolute (positions, ranges, times) is `f64` everywhere. What is a small difference, centred on its
//! constellation's mean, is generic: the Cortex-M4F has `f32` in hardware and emulates `f64` at fifty times the
//! cost. The constants say what "zero" means at each precision.

use nalgebra::RealField;

use crate::threshold::chi2;

/// A floating-point number that a snapshot can be solved in.
pub trait Real: RealField + Copy {
    /// Redundancy number below which a satellite counts as untestable, dimensionless.
    const UNTESTABLE: Self;
    /// Gain below which a bias counts as not moving the position, m per m.
    const UNMOVED: Self;
    /// Trace of `(HᵀH)⁻¹` (GDOP²) beyond which a geometry counts as singular, dimensionless.
    ///
    /// The smallest singular value of `H` is between `1/GDOP` and `√(3+C)/GDOP`.
    const SINGULAR: Self;
    /// Relative difference below which two test statistics count as equal.
    const TIE: Self;
    /// How far the sums of the χ² distributions are carried.
    const CHI_SQUARE: chi2::Precision<Self>;

    /// Rounds a double.
    fn narrow(value: f64) -> Self;
    /// Widens to a double, exactly.
    fn widen(self) -> f64;
}

impl Real for f64 {
    const UNTESTABLE: Self = 1e-9;
    const UNMOVED: Self = 1e-6;
    const SINGULAR: Self = 1e12;
    const TIE: Self = 1e-9;
    const CHI_SQUARE: chi2::Precision<Self> = chi2::DOUBLE;

    fn narrow(value: f64) -> Self {
        value
    }
    fn widen(self) -> f64 {
        self
    }
}

impl Real for f32 {
    // Some hundred units in the last place of the sums over 40 satellites that these are compared with.
    const UNTESTABLE: Self = 1e-5;
    const UNMOVED: Self = 1e-4;
    const SINGULAR: Self = 2e5;
    // What a w-test is good to: two satellites alone with their clock have equal |w|, and 8e-5 was seen between them.
    const TIE: Self = 1e-3;
    const CHI_SQUARE: chi2::Precision<Self> = chi2::SINGLE;

    fn narrow(value: f64) -> Self {
        value as f32
    }
    fn widen(self) -> f64 {
        f64::from(self)
    }
}
