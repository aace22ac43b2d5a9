//! Comparison of square roots by the processor's instruction with those of libm, bit by bit.
//!
//! | numbers | patterns |
//! |---|---|
//! | of either sign, every exponent, subnormal to infinite and NaN | every 16,381st |
//! | about each power of two | 4 below, 4 from it on |
//! | squares of whole numbers and their neighbours | those up to 4,096² |

use core::hint::black_box;

use raim_core::internals::numeric::sqrt;

/// Distance of the patterns: a prime, so that all digits vary.
const STEP: usize = 16_381;

/// Returns the number of compared numbers, and of those whose roots differ.
///
/// All NaN count as one value, because libm computes them from its argument.
pub fn compare() -> (u32, u32) {
    let everywhere = (0..=u32::MAX).step_by(STEP);
    let powers = (0..=u8::MAX).flat_map(|exponent| {
        let power = u32::from(exponent) << 23;
        (0..8).map(move |after| power.wrapping_add(after).wrapping_sub(4))
    });
    let squares = (0..=4_096_u32).flat_map(|root| {
        let square = (root * root) as f32;
        (0..3).map(move |after| square.to_bits().wrapping_add(after).wrapping_sub(1))
    });
    let mut wrong = 0;
    let mut cases = 0;
    for bits in everywhere.chain(powers).chain(squares) {
        let x = black_box(f32::from_bits(bits));
        let (have, want) = (sqrt(x), libm::sqrtf(x));
        let is_equal = have.to_bits() == want.to_bits() || have.is_nan() && want.is_nan();
        cases += 1;
        wrong += u32::from(!is_equal);
    }
    (cases, wrong)
}
