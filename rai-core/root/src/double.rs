//! Root of a double by singles, for a processor that has the instruction for those alone.
//!
//! ```text
//! x = M/2⁵² 4ᵏ,  1 ≤ M/2⁵² < 4          √x = R/2⁵² 2ᵏ
//! R ← 2⁵² √(M/2⁵²)                      by the instruction: 24 digits
//! R ← R + (2⁵² M − R²)/2R               twice, the quotient by singles
//! ```
//!
//! The first quotient leaves an error below 2⁸, so that the remainder fits into 64 bits and its
//! higher ones need not be computed. The second one leaves the integer or the one below, and the
//! last remainder shows which is nearer. No root lies in the middle of two doubles, because the
//! square of such a number has more digits than a double.
//!
//! libm's root is correctly rounded as well, and takes three times the flash.

use super::sqrt;

/// Digits of a double after the first one.
const DIGITS: u32 = f64::MANTISSA_DIGITS - 1;

const INFINITY: u64 = f64::INFINITY.to_bits();
const MINUS: u64 = 1 << 63;

/// Returns `√x`, correctly rounded: −0 for −0, NaN for other negative numbers and for NaN.
#[cfg_attr(not(test), inline(never))]
pub(super) fn root(x: f64) -> f64 {
    let bits = x.to_bits();
    // Numbers with a sign are the largest as bits.
    if bits.wrapping_sub(1) >= INFINITY - 1 {
        return if bits > MINUS { f64::NAN } else { x };
    }
    let (exponent, digits) = normal((bits >> DIGITS) as i32, bits & ((1 << DIGITS) - 1));
    // The exponent's bias, 1023, is odd.
    let odd = !exponent & 1;
    let half = (exponent + 1023 - odd) >> 1;
    f64::from_bits(nearest_root(digits << odd) + ((half as u64 - 1) << DIGITS))
}

/// Returns the exponent and all digits of a number, the first one included.
fn normal(exponent: i32, digits: u64) -> (i32, u64) {
    if exponent > 0 {
        return (exponent, 1 << DIGITS | digits);
    }
    let up = digits.leading_zeros() - (u64::BITS - f64::MANTISSA_DIGITS);
    (1 - up.cast_signed(), digits << up)
}

/// Returns the integer `R` nearest to `√(2⁵² M)`, for `M` from 2⁵² to 2⁵⁴.
fn nearest_root(m: u64) -> u64 {
    // The powers of two are 2²⁸, 2²³ and 2²¹.
    let single = sqrt((m >> 24) as u32 as f32 / 268_435_456.0);
    let first = u64::from((single * 8_388_608.0) as u32);
    // `2⁵² M − R²` by 2⁵². Its lowest two bits count for nothing.
    let left = (m.cast_signed() - ((first * first) << 6).cast_signed()) >> 2;
    let mut root =
        (first << 29).cast_signed().wrapping_add(i64::from((left as i32 as f32 / single * 2.0) as i32));
    let remainder = |root: i64| (m << DIGITS).cast_signed().wrapping_sub(root.wrapping_mul(root));
    // Rounded down from a thousandth less, so that the result is the nearest integer or the one below.
    let correction = (remainder(root) >> 32) as i32 as f32 / single / 2_097_152.0;
    root += i64::from((correction + 1023.499) as i32 - 1023);
    root += i64::from(remainder(root) > root);
    root as u64
}

#[cfg(test)]
mod tests {
    use super::root;

    fn assert_right(x: f64) {
        assert_eq!(root(x).to_bits(), x.sqrt().to_bits(), "{x:e}");
    }

    #[test]
    fn roots_of_all_exponents_are_those_of_the_processor() {
        // Digits by a sequence that fills the interval evenly.
        let digits = |step: u64| step.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 12;
        for step in 0..3_000_000 {
            assert_right(f64::from_bits((step % 2047) << 52 | digits(step)));
        }
    }

    #[test]
    fn neighbours_of_squares_and_of_middles_are_rounded_to_the_nearest() {
        for step in 0..1_000_000_u64 {
            let whole = 1.0 + (step.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 12) as f64 / (1_u64 << 52) as f64;
            for square in [whole * whole, (whole + f64::EPSILON / 2.0) * whole, whole * whole * 2.0] {
                [square.next_down(), square, square.next_up()].into_iter().for_each(assert_right);
            }
        }
        let edges = [1.0, 2.0, 4.0_f64.next_down(), 4.0, f64::MAX, f64::MIN_POSITIVE, 5e-324];
        edges.into_iter().for_each(assert_right);
    }

    #[test]
    fn zeros_and_infinity_are_their_own_roots_and_other_numbers_have_none() {
        for x in [0.0_f64, -0.0, f64::INFINITY] {
            assert_eq!(root(x).to_bits(), x.to_bits());
        }
        for x in [-1.0, -f64::MIN_POSITIVE, -5e-324, f64::NEG_INFINITY, f64::NAN, -f64::NAN] {
            assert!(root(x).is_nan(), "{x}");
        }
    }
}
