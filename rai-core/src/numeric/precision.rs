//! Precision of the sums and integrals of a distribution, in each scalar.
//!
//! It is a constant of [`Real`](super::real::Real); [`chi_square`](super::chi_square) uses it.

/// Limits of the sums in one scalar.
#[derive(Clone, Copy, Debug)]
pub struct Precision<T: 'static> {
    /// Argument above which the asymptotic expansion is used.
    pub(super) asymptotic: T,
    /// Relative size of a term below which the series ends.
    pub(super) rounding: T,
    /// Relative square of a Newton step below which the iteration ends. The remaining error is
    /// smaller.
    pub(super) settled: T,
    /// Decrease of the logarithmic density beyond which the tail is neglected.
    pub(super) drop: T,
    /// Nodes and weights of Gauss–Legendre quadrature on [−1, 1]; only the positive half.
    pub(super) rule: &'static [(T, T)],
}

/// Precision of `f64`: relative error of the results below 3e-11.
pub const DOUBLE: Precision<f64> = Precision {
    asymptotic: 60.0,
    rounding: 1e-17,
    settled: 1e-14,
    drop: 38.0,
    rule: &[
        (0.064_056_892_862_605_63, 0.127_938_195_346_752_16),
        (0.191_118_867_473_616_3, 0.125_837_456_346_828_3),
        (0.315_042_679_696_163_4, 0.121_670_472_927_803_39),
        (0.433_793_507_626_045_1, 0.115_505_668_053_725_6),
        (0.545_421_471_388_839_6, 0.107_444_270_115_965_63),
        (0.648_093_651_936_975_5, 0.097_618_652_104_113_88),
        (0.740_124_191_578_554_4, 0.086_190_161_531_953_27),
        (0.820_001_985_973_903, 0.073_346_481_411_080_3),
        (0.886_415_527_004_401_1, 0.059_298_584_915_436_78),
        (0.938_274_552_002_732_8, 0.044_277_438_817_419_81),
        (0.974_728_555_971_309_5, 0.028_531_388_628_933_66),
        (0.995_187_219_997_021_3, 0.012_341_229_799_987_2),
    ],
};

/// Precision of `f32`: relative error of the results below 3e-5, at a three-hundredth of the cost
/// of emulated `f64`.
pub const SINGLE: Precision<f32> = Precision {
    asymptotic: 16.0,
    rounding: 3e-8,
    settled: 3e-5,
    drop: 13.0,
    rule: &[
        (0.183_434_64, 0.362_683_8),
        (0.525_532_4, 0.313_706_65),
        (0.796_666_5, 0.222_381_03),
        (0.960_289_84, 0.101_228_535),
    ],
};
