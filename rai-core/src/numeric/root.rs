//! Roots and inverse roots without a division: 20 instructions, instead of 76 in a software
//! library.
//!
//! ```text
//! y ← y (3 − x y²)/2
//! ```
//!
//! from half the exponent, by which `y` is within 3.5 % of `1/√x`: three steps leave rounding
//! alone. The result is within 2e-7 of `1/√x`, relatively, and the same on every machine. Roots
//! that must be correctly rounded use libm.
//!
//! Reference: [Lomont2003] for the constant.
//!
//! [Lomont2003]: crate#references

/// Returns `1/√x` for `x > 0`; for 0 and numbers that are not normal the result of libm.
#[inline]
pub(super) fn single_inverse(x: f32) -> f32 {
    if is_normal(x) { inverse_of_normal(x) } else { libm::sqrtf(x).recip() }
}

/// Returns `√x` for `x ≥ 0`; for 0 and numbers that are not normal the result of libm.
#[inline]
pub(super) fn single(x: f32) -> f32 {
    if is_normal(x) { x * inverse_of_normal(x) } else { libm::sqrtf(x) }
}

/// Returns true if half of it is a normal number too.
fn is_normal(x: f32) -> bool {
    // The patterns of positive numbers are in order; those of negative ones are beyond.
    (2 * f32::MIN_POSITIVE.to_bits()..=f32::MAX.to_bits()).contains(&x.to_bits())
}

#[inline]
fn inverse_of_normal(x: f32) -> f32 {
    const MAGIC: u32 = 0x5f37_5a86;
    let half = 0.5 * x;
    let mut root = f32::from_bits(MAGIC.wrapping_sub(x.to_bits() >> 1));
    for _ in 0..3 {
        root *= 1.5 - half * root * root;
    }
    root
}

#[cfg(test)]
mod tests {
    use super::{single, single_inverse};

    #[test]
    fn roots_are_good_to_a_few_units_in_the_last_place() {
        // Every exponent, and mantissas on both sides of each.
        for bits in (f32::MIN_POSITIVE.to_bits()..f32::MAX.to_bits()).step_by(4_099) {
            let x = f32::from_bits(bits);
            let want = libm::sqrt(f64::from(x));
            let error = (f64::from(single_inverse(x)) * want - 1.0).abs();
            assert!(error < 2e-7, "{x}: {error}");
            let error = (f64::from(single(x)) / want - 1.0).abs();
            assert!(error < 3e-7, "{x}: {error}");
        }
    }

    #[test]
    fn what_is_no_normal_number_is_as_libm_has_it() {
        for x in [0.0, 1e-40, f32::INFINITY] {
            assert_eq!(single_inverse(x).to_bits(), libm::sqrtf(x).recip().to_bits(), "{x}");
            assert_eq!(single(x).to_bits(), libm::sqrtf(x).to_bits(), "{x}");
        }
        assert!(single_inverse(f32::NAN).is_nan() && single_inverse(-1.0).is_nan());
        assert!(single(f32::NAN).is_nan() && single(-1.0).is_nan());
    }
}
