//! Integer trigonometry: angles that wrap, sines to 2⁻⁵⁰, products in a few instructions.
//!
//! The sine of the nearest 1/256 turn comes from a table, and the rest turns it:
//!
//! ```text
//! sin(a + x) = sin a (1 − v) + cos a s        s = sin x = x − x (x²/6 − x⁴/120)
//! cos(a + x) = cos a (1 − v) − sin a s        v = 1 − cos x = x²/2 − x⁴/24 + x⁶/720
//! |x| ≤ π/256
//! ```
//!
//! | quantity | type or suffix | unit | range |
//! |---|---|---|---|
//! | angle | [`Turns`] | 2⁻⁶⁴ turns | one turn; wraps, so that it cannot overflow |
//! | sine, cosine, ratio | `…_q62` | 2⁻⁶² | ±2 |
//! | small angle | `…_q62` | 2⁻⁶² rad | ±2 |
//!
//! A core without double precision multiplies 32 by 32 bits in one cycle. The upper half of a
//! product of 64 by 64 bits therefore costs a tenth of a soft-float multiplication. Integers are
//! also the same on every machine. Only the four products of the turn and `x²` need 64 bits. The
//! other terms of the series are small, and 32 bits of them reach below 2⁻⁵⁰, which is 25 nm at a
//! satellite.

mod host;

/// True on a processor with doubles in hardware. The functions in [`host`] then replace those of this
/// file, and give the same bits.
const ON_HOST: bool = cfg!(not(target_os = "none"));

/// True if that processor has products of 128 bits, too. A browser calls a function for each.
const ON_WIDE_HOST: bool = ON_HOST && cfg!(target_pointer_width = "64");

/// The number 1 in 2⁻⁶².
pub(super) const ONE_Q62: i64 = 1 << 62;

/// The number 2π in 2⁻⁶⁰.
const TURN_RAD_Q60: i64 = 7_244_019_458_077_122_842;

/// Returns the upper half of a product, `a b / 2⁶⁴`, within one unit of its floor, for factors
/// below `2⁶³ − 2³¹`.
///
/// The lower halves have signs, because this processor multiplies and adds those in one
/// instruction. Their product, a quarter of a unit at most, is left out.
pub(crate) const fn mul_high(a: i64, b: i64) -> i64 {
    if ON_WIDE_HOST { host::mul_high(a, b) } else { mul_high_of_halves(a, b) }
}

const fn mul_high_of_halves(a: i64, b: i64) -> i64 {
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    a_high * b_high + ((a_high * b_low + a_low * b_high) >> 32)
}

/// Splits a number into its nearest multiple of 2³², in units of it, and the rest.
const fn halves(number: i64) -> (i64, i64) {
    let low = number as i32;
    let high = ((number >> 32) as i32).wrapping_add(low.is_negative() as i32);
    (high as i64, low as i64)
}

/// Returns the product of a quantity with a ratio in 2⁻⁶², in the unit of the quantity.
///
/// The quantity loses two bits. Both are at most 2⁶² in size, or their product fits.
pub(super) const fn times_q62(quantity: i64, ratio_q62: i64) -> i64 {
    mul_high(quantity, ratio_q62) << 2
}

/// Returns `units · 2^exponent`, rounded like the conversion of the integer, if the result is a
/// normal number.
///
/// The double is composed of its words, because the conversion is a call of twice the cost.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) const fn scaled(units: i64, exponent: i32) -> f64 {
    if ON_HOST { host::scaled(units, exponent) } else { scaled_by_words(units, exponent) }
}

const fn scaled_by_words(units: i64, exponent: i32) -> f64 {
    const DROPPED_BITS: u32 = 11;
    const HALF: u32 = 1 << (DROPPED_BITS - 1);
    let size = units.unsigned_abs();
    let (mut high, mut low) = ((size >> 32) as u32, size as u32);
    let mut power = 1022 + 63 + exponent;
    if high == 0 {
        if low == 0 {
            return 0.0;
        }
        (high, low, power) = (low, 0, power - 32);
    }
    let zeros = high.leading_zeros();
    (high, low) = shifted(high, low, zeros);
    let (kept, dropped) = (high << (32 - DROPPED_BITS) | low >> DROPPED_BITS, low & (2 * HALF - 1));
    // Ties go to the even neighbour, and a carry raises the exponent.
    let is_up = dropped + (kept & 1) > HALF;
    let upper = ((power - zeros.cast_signed()) as u32) << 20;
    let bits = ((upper + (high >> DROPPED_BITS)) as u64) << 32 | kept as u64;
    f64::from_bits((bits + is_up as u64) | (units as u64 & 1 << 63))
}

/// Returns two words shifted to the left by fewer bits than a word has.
///
/// The compiler's shift of 64 bits also covers more.
const fn shifted(high: u32, low: u32, by: u32) -> (u32, u32) {
    (high << by | low >> 1 >> (31 - by), low << by)
}

/// Returns `value · 2^exponent`, if neither is beyond the normal numbers.
///
/// The power is added to the exponent, because a multiplication is a call.
pub(crate) const fn times_power_of_two(value: f64, exponent: i32) -> f64 {
    let bits = value.to_bits();
    // Zero has no exponent to add to.
    let by = if bits << 1 == 0 { 0 } else { exponent as i64 };
    f64::from_bits(bits.wrapping_add_signed(by << 52))
}

/// Returns `value · 2^exponent` rounded to the nearest integer, halves away from zero, and limited
/// to ±2⁶². NaN gives ±2⁶².
///
/// It is the inverse of [`scaled`]. The significand is shifted, because a multiplication, a
/// rounding and a conversion are calls.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) const fn nearest(value: f64, exponent: i32) -> i64 {
    if ON_HOST { host::nearest(value, exponent) } else { nearest_by_shift(value, exponent) }
}

/// Limit of [`nearest`].
const LARGEST: i64 = 1 << 62;

const fn nearest_by_shift(value: f64, exponent: i32) -> i64 {
    const SIGNIFICAND_BITS: i32 = 52;
    let bits = value.to_bits();
    let significand = (bits & ((1 << SIGNIFICAND_BITS) - 1) | 1 << SIGNIFICAND_BITS).cast_signed();
    let power = (bits >> SIGNIFICAND_BITS & 0x7FF) as i32 - (1023 + SIGNIFICAND_BITS) + exponent;
    let size = match power {
        ..-53 => 0,
        -53..0 => ((significand >> (-power - 1)) + 1) >> 1,
        0..10 => {
            let (high, low) = ((significand >> 32) as u32, significand as u32);
            let (high, low) = shifted(high, low, power as u32);
            ((high as u64) << 32 | low as u64).cast_signed()
        }
        10.. => LARGEST,
    };
    if value.is_sign_negative() { -size } else { size }
}

/// Returns the same as [`nearest`], limited to 32 bits.
// Not inlined, so that its many callers share one copy.
#[inline(never)]
pub(super) const fn nearest_i32(value: f64, exponent: i32) -> i32 {
    let units = nearest(value, exponent);
    if units > i32::MAX as i64 {
        i32::MAX
    } else if units < i32::MIN as i64 {
        i32::MIN
    } else {
        units as i32
    }
}

/// An angle in 2⁻⁶⁴ turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Turns(i64);

impl Turns {
    /// Returns an angle in 2⁻⁶⁴ turns.
    pub(super) const fn new(turns_2_64: i64) -> Self {
        Self(turns_2_64)
    }

    /// Returns a broadcast angle of 2⁻³² turns, which is 2⁻³¹ semicircles.
    pub(super) const fn of_broadcast(turns_2_32: i32) -> Self {
        Self((turns_2_32 as i64) << 32)
    }

    /// Returns a small angle in rad.
    pub(super) const fn of_radians(radians_q62: i64) -> Self {
        // 1/2π.
        const TURNS_PER_RAD_Q65: i64 = 5_871_781_006_564_002_453;
        Self(mul_high(radians_q62, TURNS_PER_RAD_Q65) << 1)
    }

    /// Returns the sum, modulo a turn.
    pub(super) const fn plus(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }

    /// Returns the difference, modulo a turn.
    pub(super) const fn minus(self, other: Self) -> Self {
        Self(self.0.wrapping_sub(other.0))
    }

    /// Returns an angle of at most 1/8 turn, rad.
    pub(super) const fn to_radians_q62(self) -> i64 {
        mul_high(self.0 << 1, TURN_RAD_Q60) << 1
    }

    /// Returns the number of 2⁻⁶⁴ turns, from −½ to ½ turn.
    pub(super) const fn units(self) -> i64 {
        self.0
    }

    /// Returns sine and cosine.
    pub(super) const fn direction(self) -> Direction {
        // The nearest 1/256 turn, and the rest in 2⁻⁷² turns.
        let nearest = self.0.wrapping_add(1 << 55) >> 56;
        let (quarter, step) = ((nearest >> 6) & 3, (nearest & 63) as usize);
        let x_q68 = mul_high(self.0.wrapping_sub(nearest << 56) << 7, TURN_RAD_Q60) << 1;
        Direction { sin_q62: SINES_Q62[step], cos_q62: SINES_Q62[64 - step] }
            .turned_by(x_q68)
            .quarters(quarter)
    }
}

/// Sines of the first quarter in steps of 1/256 turn.
const SINES_Q62: [i64; 65] = {
    let (mut sines, mut step) = ([0; 65], 0);
    while step < 65 {
        // In the upper half of the quarter, beyond the reach of the series, sines are cosines from
        // its end.
        let (from_end, is_upper) = (64 - step, step > 32);
        let steps = (if is_upper { from_end } else { step } as u64) << 57;
        let x_q62 = mul_high(steps.cast_signed(), TURN_RAD_Q60) << 1;
        let square_q62 = times_q62(x_q62, x_q62);
        sines[step] = if is_upper {
            series(&COSINE_Q62, square_q62)
        } else {
            times_q62(x_q62, series(&SINE_Q62, square_q62))
        };
        step += 1;
    }
    sines
};

/// Terms `(−1)^k / (2k + 1)!` from the highest power to the lowest.
const SINE_Q62: [i64; 8] = alternating_factorials(1);

/// Terms `(−1)^k / (2k)!` from the highest power to the lowest.
const COSINE_Q62: [i64; 9] = alternating_factorials(0);

/// Returns `(−1)^k / (2k + first)!` for `k` from `N − 1` down to 0, in 2⁻⁶², rounded.
const fn alternating_factorials<const N: usize>(first: i64) -> [i64; N] {
    let mut terms = [0; N];
    let (mut k, mut factorial, mut power, mut sign) = (N, 1, first, 1);
    while k > 0 {
        k -= 1;
        terms[k] = sign * ((ONE_Q62 + factorial / 2) / factorial);
        factorial *= (power + 1) * (power + 2);
        (power, sign) = (power + 2, -sign);
    }
    terms
}

/// Returns a polynomial of the square by Horner's rule, for the table.
const fn series<const N: usize>(terms_q62: &[i64; N], square_q62: i64) -> i64 {
    let (mut sum_q62, mut index) = (0, 0);
    while index < N {
        sum_q62 = times_q62(sum_q62, square_q62) + terms_q62[index];
        index += 1;
    }
    sum_q62
}

/// Returns the upper half of a product of 32 by 32 bits.
const fn upper(a: u32, b: u32) -> u32 {
    ((a as u64 * b as u64) >> 32) as u32
}

/// An angle as its sine and cosine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Direction {
    pub(super) sin_q62: i64,
    pub(super) cos_q62: i64,
}

impl Direction {
    /// Returns the direction of the negative angle.
    pub(super) const fn reversed(self) -> Self {
        Self { sin_q62: -self.sin_q62, ..self }
    }

    /// Returns the direction turned by this many quarters, 0 to 3.
    const fn quarters(self, quarter: i64) -> Self {
        let Self { sin_q62, cos_q62 } = self;
        match quarter {
            0 => self,
            1 => Self { sin_q62: cos_q62, cos_q62: -sin_q62 },
            2 => Self { sin_q62: -sin_q62, cos_q62: -cos_q62 },
            _ => Self { sin_q62: -cos_q62, cos_q62: sin_q62 },
        }
    }

    /// Returns the direction turned by at most 1/512 turn, in 2⁻⁶⁸ rad.
    const fn turned_by(self, x_q68: i64) -> Self {
        /// Factors 1/6, 1/24, 1/120 and 1/720 in 2⁻³².
        const OVER: [u32; 4] = [715_827_883, 178_956_971, 35_791_394, 5_965_232];
        // The product can be low by a unit, which must not make a square negative.
        let square_q72 = mul_high(x_q68, x_q68) + 1;
        let square_q44 = (square_q72 >> 28) as u32;
        let fourth_q56 = upper(square_q44, square_q44);
        let sixth_q68 = upper(fourth_q56, square_q44);
        let versine_q66 = (square_q72 >> 7) - ((upper(fourth_q56, OVER[1]) as i64) << 10)
            + (upper(sixth_q68, OVER[3]) >> 2) as i64;
        let lacking_q44 = upper(square_q44, OVER[0]) - (upper(fourth_q56, OVER[2]) >> 12);
        let lacking_of_x_q66 = ((x_q68 >> 31) * lacking_q44 as i64) >> 15;
        let sine_q66 = (x_q68 >> 2) - lacking_of_x_q66;
        Self {
            sin_q62: self.sin_q62
                + ((mul_high(self.cos_q62, sine_q66) - mul_high(self.sin_q62, versine_q66)) >> 2),
            cos_q62: self.cos_q62
                - ((mul_high(self.sin_q62, sine_q66) + mul_high(self.cos_q62, versine_q66)) >> 2),
        }
    }

    /// Returns the direction turned by another.
    pub(super) const fn plus(self, other: Self) -> Self {
        Self {
            sin_q62: times_q62(self.sin_q62, other.cos_q62) + times_q62(self.cos_q62, other.sin_q62),
            cos_q62: times_q62(self.cos_q62, other.cos_q62) - times_q62(self.sin_q62, other.sin_q62),
        }
    }

    /// Returns the direction turned by a small angle, |d| below 2⁻¹³ rad. The neglected term d³/6
    /// is below 2⁻⁴¹.
    pub(super) const fn plus_small(self, d_q62: i64) -> Self {
        let lost_q62 = times_q62(d_q62, d_q62) >> 1;
        let (sin_q62, cos_q62) = (self.sin_q62, self.cos_q62);
        Self {
            sin_q62: sin_q62 + times_q62(cos_q62, d_q62) - times_q62(sin_q62, lost_q62),
            cos_q62: cos_q62 - times_q62(sin_q62, d_q62) - times_q62(cos_q62, lost_q62),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const Q62: f64 = ONE_Q62 as f64;
    const TURN: f64 = 18_446_744_073_709_551_616.0;

    #[test]
    fn nearest_rounds_as_the_library_does_and_ends_at_the_largest() {
        let values = [
            0.0,
            -0.0,
            0.5,
            -0.5,
            0.499_999_999_999_999_94,
            1.5,
            2.5,
            -2.5,
            1e-300,
            -1e-9,
            123_456.789,
            5e15,
        ];
        for (value, exponent) in
            values.iter().flat_map(|value| [-40, -1, 0, 1, 9, 31, 66].map(|e| (*value, e)))
        {
            let want = libm::round(value * libm::exp2(f64::from(exponent)));
            let want = if want.abs() < 4.6e18 { want as i64 } else { (1 << 62) * want.signum() as i64 };
            assert_eq!(nearest(value, exponent), want, "{value} · 2^{exponent}");
            assert_eq!(
                i64::from(nearest_i32(value, exponent)),
                want.clamp(i64::from(i32::MIN), i64::from(i32::MAX))
            );
        }
        assert_eq!([f64::INFINITY, f64::NEG_INFINITY].map(|value| nearest(value, 0)), [1 << 62, -(1 << 62)]);
    }

    #[test]
    fn a_power_of_two_is_added_to_the_exponent() {
        for (value, exponent) in [(0.0, -66), (-0.0, 5), (1.0, -66), (-3.25, 16), (2_147_483_647.0, -43)] {
            let want: f64 = value * libm::exp2(f64::from(exponent));
            assert_eq!(times_power_of_two(value, exponent).to_bits(), want.to_bits());
        }
    }

    #[test]
    fn products_are_within_a_unit() {
        const LARGEST: i64 = i64::MAX - (1 << 31);
        let edges = [0, 1, -1, 1 << 31, -1 << 31, LARGEST, i64::MIN, ONE_Q62, -ONE_Q62, -0xFFFF_FFFF];
        let lattice = (0..60_i64).map(|index| index.wrapping_mul(922_337_203_685_477_581).min(LARGEST));
        let factors: std::vec::Vec<_> = edges.into_iter().chain(lattice).collect();
        for (a, b) in factors.iter().flat_map(|a| factors.iter().map(move |b| (*a, *b))) {
            let want = (i128::from(a) * i128::from(b)) >> 64;
            let off = want - i128::from(mul_high(a, b));
            assert!((-1..=1).contains(&off), "{a} × {b}: {off}");
        }
    }

    #[test]
    fn integers_become_doubles_as_by_a_conversion() {
        let powers = (0..63).flat_map(|power| (-2..=2).map(move |by| (1_i64 << power) + by));
        // Ties of 53 bits, to even both ways, and their neighbours.
        let ties = [0x20_0000_0000_0001, 0x20_0000_0000_0003].into_iter();
        let ties =
            ties.flat_map(|tie| (0..9).flat_map(move |shift| (-1..=1).map(move |by| (tie << shift) + by)));
        let lattice = (0..1_000_i64).map(|index| index.wrapping_mul(922_337_203_685_477_581));
        for units in powers.chain(ties).chain(lattice).chain([i64::MAX, i64::MIN]) {
            for (units, exponent) in
                [-62, -36, 0, 9].into_iter().flat_map(|e| [(units, e), (units.wrapping_neg(), e)])
            {
                let want = units as f64 * libm::exp2(f64::from(exponent));
                assert_eq!(scaled(units, exponent).to_bits(), want.to_bits(), "{units} · 2^{exponent}");
            }
        }
    }

    #[test]
    fn sines_of_all_octants_are_those_of_double_precision() {
        // Every boundary of an octant, both sides of it, and a lattice that matches no pattern of
        // bits.
        let edges = (0..8_i64).flat_map(|octant| [-1, 0, 1].map(|by| (octant << 61).wrapping_add(by)));
        let lattice = (0..20_000_i64).map(|index| index.wrapping_mul(922_337_203_685_477_581));
        for units in edges.chain(lattice) {
            let have = Turns::new(units).direction();
            let (sin, cos) = libm::sincos(units as f64 / TURN * core::f64::consts::TAU);
            let error = (have.sin_q62 as f64 / Q62 - sin).abs().max((have.cos_q62 as f64 / Q62 - cos).abs());
            // 2⁻⁵⁰, and three units of the last place of the reference's angle and sine.
            assert!(error < 1.3e-15, "{units:#x}: {error:e}");
        }
    }

    #[test]
    fn quarter_turns_are_exact() {
        for (quarter, (sin, cos)) in [(0, (0, 1)), (1, (1, 0)), (2, (0, -1)), (3, (-1, 0))] {
            let have = Turns::new(quarter << 62).direction();
            assert_eq!((have.sin_q62, have.cos_q62), (sin * ONE_Q62, cos * ONE_Q62), "{quarter}");
        }
    }

    #[test]
    fn a_small_turn_is_the_turn() {
        for d in [-1.2e-4, -1e-9, 0.0, 3e-7, 1.2e-4] {
            let have = Turns::of_broadcast(123_456_789).direction().plus_small((d * Q62) as i64);
            let (sin, cos) = libm::sincos(123_456_789.0 / 4_294_967_296.0 * core::f64::consts::TAU + d);
            let error = (have.sin_q62 as f64 / Q62 - sin).abs().max((have.cos_q62 as f64 / Q62 - cos).abs());
            // Bound: the neglected third power, and rounding.
            assert!(error < d.abs().powi(3) / 6.0 + 1e-15, "{d}: {error:e}");
        }
    }
}
