//! Division of 64 bits by 32, for times and digits.
//!
//! The processor divides 32 bits by 32. The compiler's own division of 64 by 64 bits is fast and
//! takes a kilobyte. Most dividends here have 32 bits. For the others, a few per epoch, three
//! divisions of the processor suffice.
//!
//! Reference: [Knuth1997] 4.3.1, algorithm D.
//!
//! [Knuth1997]: crate#references

/// Returns quotient and remainder; a divisor of zero counts as 1.
#[inline(never)]
pub const fn divided(number: u64, by: u32) -> (u64, u32) {
    let by = if by == 0 { 1 } else { by };
    let (high, low) = ((number >> 32) as u32, number as u32);
    if high == 0 {
        return ((low / by) as u64, low % by);
    }
    // In digits of 16 bits, with a divisor whose first bit is set, by algorithm D.
    let shift = by.leading_zeros();
    let divisor = by << shift;
    let above = high / by;
    let shifted = (((high % by) as u64) << 32 | low as u64) << shift;
    let (upper, rest) = digit((shifted >> 32) as u32, (shifted >> 16) as u32 & 0xFFFF, divisor);
    let (lower, rest) = digit(rest, shifted as u32 & 0xFFFF, divisor);
    ((above as u64) << 32 | (upper << 16 | lower) as u64, rest >> shift)
}

/// Returns the digit of a quotient and the remainder: `(rest 2¹⁶ + next) / divisor`, for a rest
/// below the divisor, whose first bit is set.
const fn digit(rest: u32, next: u32, divisor: u32) -> (u32, u32) {
    // Sets the first bit, which is already set, so that the compiler knows that the divisor is not
    // zero.
    let (upper, lower) = (divisor >> 16 | 1 << 15, divisor & 0xFFFF);
    // The estimate is too large by two at most, so that the loop is short.
    let (mut digit, mut left) = (rest / upper, rest % upper);
    while left <= 0xFFFF && (digit > 0xFFFF || digit * lower > (left << 16 | next)) {
        digit -= 1;
        left += upper;
    }
    (digit, (rest << 16 | next).wrapping_sub(digit.wrapping_mul(divisor)))
}

#[cfg(test)]
mod tests {
    use super::divided;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn parts_are_those_of_the_processor(number: u64, shift in 0..64_u32, by in 1_u32..) {
            for (number, by) in [(number >> shift, by), (number, by >> (shift / 2) | 1), (u64::MAX - number % 3, u32::MAX)] {
                prop_assert_eq!(divided(number, by), (number / u64::from(by), (number % u64::from(by)) as u32));
            }
        }
    }

    #[test]
    fn by_nothing_is_by_one() {
        assert_eq!(divided(u64::MAX, 0), (u64::MAX, 0));
    }
}
