//! Angles for a processor that emulates doubles: the angle of a unit vector, to a trillionth of a
//! turn, and the sine of an angle.
//!
//! ```text
//! folded into 0 … π/4, and turned back by the nearest of 17 known directions α_k = k π/64:
//! s = sin a cos α_k − cos a sin α_k = sin(a − α_k)         |a − α_k| < 0.03 rad
//! a = α_k + s + s³ (1/6 + 3/40 s²)                         the cubic part in f32
//! ```
//!
//! The neglected term, `5/112 s⁷`, is below 1e-12 rad, as is the rounding of the cubic part.
//! Together they are less than 10 µm on the ground. The angle costs a quarter of an arc tangent in
//! doubles.

use core::f64::consts::{FRAC_PI_2, PI};

use super::sqrt;

/// `α_k`, its sine and its cosine.
#[allow(clippy::approx_constant, reason = "a table is read as one")]
const DIRECTIONS: [(f64, f64, f64); 17] = [
    (0.0, 0.0, 1.0),
    (0.049_087_385_212_340_52, 0.049_067_674_327_418_015, 0.998_795_456_205_172_4),
    (0.098_174_770_424_681_03, 0.098_017_140_329_560_6, 0.995_184_726_672_196_9),
    (0.147_262_155_637_021_55, 0.146_730_474_455_361_75, 0.989_176_509_964_781),
    (0.196_349_540_849_362_07, 0.195_090_322_016_128_28, 0.980_785_280_403_230_4),
    (0.245_436_926_061_702_6, 0.242_980_179_903_263_9, 0.970_031_253_194_544),
    (0.294_524_311_274_043_1, 0.290_284_677_254_462_4, 0.956_940_335_732_208_8),
    (0.343_611_696_486_383_6, 0.336_889_853_392_220_05, 0.941_544_065_183_020_8),
    (0.392_699_081_698_724_14, 0.382_683_432_365_089_8, 0.923_879_532_511_286_7),
    (0.441_786_466_911_064_66, 0.427_555_093_430_282_1, 0.903_989_293_123_443_3),
    (0.490_873_852_123_405_2, 0.471_396_736_825_997_64, 0.881_921_264_348_355),
    (0.539_961_237_335_745_7, 0.514_102_744_193_221_8, 0.857_728_610_000_272_1),
    (0.589_048_622_548_086_2, 0.555_570_233_019_602_2, 0.831_469_612_302_545_2),
    (0.638_136_007_760_426_8, 0.595_699_304_492_433_4, 0.803_207_531_480_644_9),
    (0.687_223_392_972_767_2, 0.634_393_284_163_645_5, 0.773_010_453_362_737),
    (0.736_310_778_185_107_8, 0.671_558_954_847_018_4, 0.740_951_125_354_959_1),
    (0.785_398_163_397_448_3, 0.707_106_781_186_547_6, 0.707_106_781_186_547_6),
];

/// Returns the sine of an angle, accurate to 2e-7. A larger angle than a quarter turn, either way,
/// counts as a quarter turn.
///
/// ```text
/// sin x = x (1 − x²/2·3 (1 − x²/4·5 (1 − x²/6·7 (1 − x²/8·9 (1 − x²/10·11)))))        the neglected terms are below 6e-8
/// ```
///
/// A library's sine, for any angle, takes 5 KB and doubles.
pub fn sine(angle_rad: f32) -> f32 {
    let x = angle_rad.clamp(-core::f32::consts::FRAC_PI_2, core::f32::consts::FRAC_PI_2);
    [110.0, 72.0, 42.0, 20.0, 6.0].iter().fold(1.0, |inner, product| 1.0 - x * x / product * inner) * x
}

/// Returns the angle with this sine, −π/2 … π/2 rad, accurate to 2e-7. A sine beyond ±1 counts as
/// ±1.
///
/// A library's arc sine takes a root in doubles.
pub fn arc_sine(sine: f32) -> f32 {
    let cosine_squared = (1.0 - sine) * (1.0 + sine);
    libm::atan2f(sine, sqrt(if cosine_squared > 0.0 { cosine_squared } else { 0.0 }))
}

/// Returns the angle with this sine and cosine, −π … π rad. Unspecified, possibly NaN, for anything
/// but a unit vector.
pub fn of_unit_vector(sine: f64, cosine: f64) -> f64 {
    let (up, across) = (sine.abs(), cosine.abs());
    let is_steep = up > across;
    let (small, large) = if is_steep { (across, up) } else { (up, across) };
    let folded = of_octant(small, large);
    let quarter = if is_steep { FRAC_PI_2 - folded } else { folded };
    let half = if cosine < 0.0 { PI - quarter } else { quarter };
    if sine < 0.0 { -half } else { half }
}

/// Returns the angle between 0 and π/4.
fn of_octant(sine: f64, cosine: f64) -> f64 {
    const PER_RADIAN: f32 = 64.0 / core::f32::consts::PI;
    let coarse = sine as f32;
    // The arc sine is accurate to 3 mrad, which suffices: either of two neighbouring directions is
    // near enough.
    let nearest = coarse * (1.0 + 0.2215 * coarse * coarse) * PER_RADIAN + 0.5;
    let [.., last] = &DIRECTIONS;
    let &(angle, sine_k, cosine_k) = DIRECTIONS.get(nearest as usize).unwrap_or(last);
    let rest = sine * cosine_k - cosine * sine_k;
    let (s, squared) = (rest as f32, (rest * rest) as f32);
    let cubic = s * squared * (1.0 / 6.0 + squared * (3.0 / 40.0));
    angle + (rest + f64::from(cubic))
}
