//! The upper tail of the normal distribution, also for very small probabilities.
//!
//! ```text
//! Q(u)   = P(N(0, 1) > u) = exp(−u²/2) F(u)        F is smooth and changes slowly: 0.5 … 0.4/u
//! Q⁻¹(p) = u with Q(u) = p
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `u` | argument: a distance in units of sigma, 0 or above | – |
//! | `Q(u)` | [`Tail::probability`] | – |
//! | `φ(u) = −dQ/du` | [`Tail::density`] | – |
//!
//! Protection levels are sums of such tails, each of 1e-4 to 1e-9, so that the relative error
//! matters. For both functions and probabilities from 0.5 down to 1e-30, it is below 1e-6 in `f32`
//! and below 1e-13 in `f64`.
//!
//! In `f32`, rounding `u²` would exceed this error: half a unit in the last place of 66 is 4e-6.
//! Therefore `u` is split into twelve leading bits, whose square is exact, and a rest.
//! `F(u)(u + 3)` is a polynomial in `(u − 3)/(u + 3)` with a relative error of 4e-8. In `f64`, `Q`
//! is libm's `erfc`. The inverse is [Wichura1988] in both, to seven and to sixteen digits.
//!
//! References: [Wichura1988] (AS 241), [Cody1969] for the split.
//!
//! [Wichura1988]: crate#references
//! [Cody1969]: crate#references

use super::real::Real;
use super::{sqrt, sqrt_f64};

pub use super::real::Tail;

/// Returns `Q(u)` and `φ(u)` for `u ≥ 0`. Negative numbers and NaN count as 0, which has the
/// largest probability, 0.5.
///
/// About 50 instructions on a Cortex-M4F in `f32`.
#[inline]
pub fn tail<T: Real>(u: T) -> Tail<T> {
    T::normal_tail(if u > T::zero() { u } else { T::zero() })
}

/// Returns `Q⁻¹(p)`: 0 for `p ≥ 0.5`, infinite for 0, negative numbers and NaN.
pub fn quantile<T: Real>(p: T) -> T {
    let half = T::narrow(0.5);
    if p >= half {
        T::zero()
    } else if p > T::zero() {
        T::normal_quantile(p)
    } else {
        T::narrow(f64::INFINITY)
    }
}

/// Argument above which `Q` counts as 0: it is 2e-38 there, the smallest normal single.
const SINGLE_END: f32 = 12.875;

/// Coefficients of `F(u)(u + 3)` in powers of `(u − 3)/(u + 3)`, for `u` up to 13.5. They were
/// fitted to the least relative error.
const SCALED: [f32; 9] = [
    0.729_083_66,
    -0.509_332_24,
    0.230_019_29,
    -0.047_256_906,
    -0.010_479_662,
    0.006_927_897,
    0.001_077_12,
    -0.000_909_029_56,
    -0.000_270_633_06,
];

/// Coefficients of `exp(−r)` for `|r| ≤ ln 2/2`, fitted likewise; the relative error is 2e-9.
const EXPONENTIAL: [f32; 7] =
    [1.0, -1.0, 0.499_999_9, -0.166_664_11, 0.041_668_29, -0.008_375_645, 0.001_383_580_2];

/// `ln 2` in two parts. The first has few bits, so that its product with a whole number is exact.
const LN_2: [f32; 2] = [0.693_359_4, -2.121_944_4e-4];

/// `1/√(2π)`.
const INVERSE_ROOT_2PI: f64 = 0.398_942_280_401_432_7;

/// Returns the tail in single precision, `u ≥ 0`.
pub(super) fn single_tail(u: f32) -> Tail<f32> {
    if !(u < SINGLE_END) {
        return Tail { probability: 0.0, density: 0.0 };
    }
    let leading = f32::from_bits(u.to_bits() & 0xffff_f000);
    let (half, rest) = (leading * leading * 0.5, (u - leading) * (u + leading) * 0.5);
    let doublings = (half * core::f32::consts::LOG2_E + 0.5) as u32;
    let count = doublings as f32;
    let [leading_ln, trailing_ln] = LN_2;
    let reduced = half - count * leading_ln - count * trailing_ln + rest;
    // There are at most 120 doublings, so that the result is a normal number.
    let scale = f32::from_bits((127 - doublings.min(126)) << 23);
    let exponential = polynomial(&EXPONENTIAL, reduced) * scale;
    let inverse = (u + 3.0).recip();
    Tail {
        probability: exponential * (polynomial(&SCALED, (u - 3.0) * inverse) * inverse),
        density: exponential * INVERSE_ROOT_2PI as f32,
    }
}

/// Returns the tail in double precision, `u ≥ 0`.
pub(super) fn double_tail(u: f64) -> Tail<f64> {
    Tail {
        probability: 0.5 * libm::erfc(u * core::f64::consts::FRAC_1_SQRT_2),
        density: INVERSE_ROOT_2PI * libm::exp(-0.5 * u * u),
    }
}

/// Numerator and denominator of [Wichura1988], constant term first.
///
/// [Wichura1988]: crate#references
type Quotient<T, const N: usize, const D: usize> = ([T; N], [T; D]);

/// For `p` within 0.425 of one half, in the square of the distance.
const SINGLE_CENTRE: Quotient<f32, 4, 4> =
    ([3.387_132_7, 50.434_27, 159.291_13, 59.109_375], [1.0, 17.895_17, 78.757_76, 67.187_56]);
/// For other `p`, in `√(−ln p)` up to 5.
const SINGLE_TAIL: Quotient<f32, 4, 3> =
    ([1.423_437_3, 2.756_815_4, 1.306_728_5, 0.170_238_21], [1.0, 0.737_001_64, 0.120_211_33]);
/// For other `p`, in `√(−ln p)` above 5.
const SINGLE_FAR: Quotient<f32, 4, 3> =
    ([6.657_905, 3.081_226_3, 0.428_682_94, 0.017_337_203], [1.0, 0.241_978_94, 0.012_258_202]);

/// Double-precision counterpart of [`SINGLE_CENTRE`].
const DOUBLE_CENTRE: Quotient<f64, 8, 8> = (
    [
        3.387_132_872_796_366_6,
        1.331_416_678_917_843_8e2,
        1.971_590_950_306_551_3e3,
        1.373_169_376_550_946e4,
        4.592_195_393_154_987e4,
        6.726_577_092_700_87e4,
        3.343_057_558_358_813e4,
        2.509_080_928_730_122_7e3,
    ],
    [
        1.0,
        4.231_333_070_160_091e1,
        6.871_870_074_920_579e2,
        5.394_196_021_424_751e3,
        2.121_379_430_158_659_7e4,
        3.930_789_580_009_271e4,
        2.872_908_573_572_194_3e4,
        5.226_495_278_852_854e3,
    ],
);
/// Double-precision counterpart of [`SINGLE_TAIL`].
const DOUBLE_TAIL: Quotient<f64, 8, 8> = (
    [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        0.241_780_725_177_450_6,
        2.272_384_498_926_918_4e-2,
        7.745_450_142_783_414e-4,
    ],
    [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        0.689_767_334_985_1,
        0.148_103_976_427_480_08,
        1.519_866_656_361_645_7e-2,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ],
);
/// Double-precision counterpart of [`SINGLE_FAR`].
const DOUBLE_FAR: Quotient<f64, 8, 8> = (
    [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        0.296_560_571_828_504_87,
        2.653_218_952_657_612_4e-2,
        1.242_660_947_388_078_4e-3,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    [
        1.0,
        0.599_832_206_555_888,
        0.136_929_880_922_735_8,
        1.487_536_129_085_061_5e-2,
        7.868_691_311_456_133e-4,
        1.846_318_317_510_054_8e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_8e-15,
    ],
);

/// Half the width of the central range.
const CENTRE: f64 = 0.425;
/// `√(−ln p)` above which the far range begins.
const FAR: f64 = 5.0;

/// Returns the quantile in single precision, `0 < p < 0.5`.
pub(super) fn single_quantile(p: f32) -> f32 {
    let distance = 0.5 - p;
    if distance <= CENTRE as f32 {
        return distance * quotient(&SINGLE_CENTRE, (CENTRE * CENTRE) as f32 - distance * distance);
    }
    let squared = -libm::logf(p);
    let root = sqrt(squared);
    let (near, far) = (root - 1.6, root - FAR as f32);
    if far <= 0.0 { quotient(&SINGLE_TAIL, near) } else { quotient(&SINGLE_FAR, far) }
}

/// Returns the quantile in double precision, `0 < p < 0.5`.
pub(super) fn double_quantile(p: f64) -> f64 {
    let distance = 0.5 - p;
    if distance <= CENTRE {
        return distance * quotient(&DOUBLE_CENTRE, CENTRE * CENTRE - distance * distance);
    }
    let root = sqrt_f64(-libm::log(p));
    let (near, far) = (root - 1.6, root - FAR);
    if far <= 0.0 { quotient(&DOUBLE_TAIL, near) } else { quotient(&DOUBLE_FAR, far) }
}

fn quotient<T: Real, const N: usize, const D: usize>(of: &Quotient<T, N, D>, x: T) -> T {
    polynomial(&of.0, x) / polynomial(&of.1, x)
}

/// Evaluates a polynomial by Horner's scheme, constant term first.
#[inline]
fn polynomial<T: Real, const N: usize>(coefficients: &[T; N], x: T) -> T {
    let mut sum = T::zero();
    for &coefficient in coefficients.iter().rev() {
        sum = sum * x + coefficient;
    }
    sum
}
