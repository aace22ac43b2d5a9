//! The functions of the parent module, by the instructions of a host.
//!
//! A microcontroller without doubles composes its results of words. A host converts and multiplies
//! in one instruction each. Tests compare both on random patterns, bit for bit, because a replay on
//! a host must give the bits of the chip.

use super::LARGEST;

/// Returns the same as [`mul_high`](super::mul_high): the product of the lower halves is taken out
/// of the whole one.
pub(super) const fn mul_high(a: i64, b: i64) -> i64 {
    let left_out = a as i32 as i64 * b as i32 as i64;
    ((a as i128 * b as i128 - left_out as i128) >> 64) as i64
}

/// Returns the same as [`scaled`](super::scaled).
pub(super) const fn scaled(units: i64, exponent: i32) -> f64 {
    units as f64 * power_of_two(exponent)
}

/// Returns the same as [`nearest`](super::nearest).
pub(super) const fn nearest(value: f64, exponent: i32) -> i64 {
    /// The double below ½: a half itself would raise the number below ½ to 1.
    const BELOW_HALF: f64 = 0.5 - f64::EPSILON / 4.0;
    let units = value * power_of_two(exponent);
    // NaN leaves here, too.
    if !(units.abs() < LARGEST as f64) {
        return if value.is_sign_negative() { -LARGEST } else { LARGEST };
    }
    (units + BELOW_HALF.copysign(units)) as i64
}

/// Returns a power of two that is a normal number.
const fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::super::{mul_high_of_halves, nearest_by_shift, scaled_by_words};
    use super::{mul_high, nearest, scaled};

    /// Patterns of bits that repeat only after 2⁶⁴ (`SplitMix64`).
    fn patterns() -> impl Iterator<Item = u64> {
        let mut state = 2026_u64;
        core::iter::from_fn(move || {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mixed = (state ^ state >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
            Some(mixed ^ mixed >> 31)
        })
    }

    /// Integers of every size, positive and negative.
    fn integers() -> impl Iterator<Item = i64> {
        patterns().map(|bits| bits.cast_signed() >> (bits % 63))
    }

    #[test]
    fn products_are_those_of_the_halves() {
        // The factors for which the halves are defined.
        let allowed = |factor: &i64| *factor < i64::MAX - (1 << 31) && *factor > i64::MIN + (1 << 31);
        let (mut a, mut b) = (integers().filter(allowed), integers().skip(1).filter(allowed));
        for (a, b) in a.by_ref().zip(b.by_ref()).take(1_000_000) {
            assert_eq!(mul_high(a, b), mul_high_of_halves(a, b), "{a} × {b}");
        }
    }

    #[test]
    fn doubles_are_those_of_the_words() {
        for (units, bits) in integers().zip(patterns().skip(7)).take(1_000_000) {
            let exponent = (bits % 160) as i32 - 80;
            let (have, want) = (scaled(units, exponent), scaled_by_words(units, exponent));
            assert_eq!(have.to_bits(), want.to_bits(), "{units} · 2^{exponent}");
        }
    }

    #[test]
    fn integers_are_those_of_the_shift() {
        let agree = |value: f64, exponent: i32| {
            for value in [value, -value] {
                let (have, want) = (nearest(value, exponent), nearest_by_shift(value, exponent));
                assert_eq!(have, want, "{value:e} · 2^{exponent}");
            }
        };
        for (bits, more) in patterns().zip(patterns().skip(7)).take(1_000_000) {
            let exponent = (more % 160) as i32 - 80;
            agree(f64::from_bits(bits), exponent);
            // Results from below a half to beyond the limit, and halves with their neighbours.
            let power = (1023 - 3 + i64::from(bits as u32 % 68) - i64::from(exponent)).cast_unsigned();
            agree(f64::from_bits(power << 52 | bits >> 12), exponent);
            let half = scaled(((more >> (12 + bits % 51)) | 1).cast_signed(), -1 - exponent);
            for value in [half.next_down(), half, half.next_up()] {
                agree(value, exponent);
            }
        }
        for value in [0.0, f64::INFINITY, f64::NAN, f64::from_bits(u64::MAX)] {
            agree(value, 32);
        }
    }
}
