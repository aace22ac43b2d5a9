//! Division of 64 bits by 32, shared by everything that divides times and digits.
//!
//! The processor divides 32 bits by 32. The compiler's own division of 64 by 64 bits is fast and
//! takes a kilobyte. Most dividends here have 32 bits. For the others, a few per epoch, the
//! processor divides the upper half, and a loop divides the lower half bit by bit.

/// Returns quotient and remainder; a divisor of zero counts as 1.
#[inline(never)]
pub const fn divided(number: u64, by: u32) -> (u64, u32) {
    let by = if by == 0 { 1 } else { by };
    let (high, mut low) = ((number >> 32) as u32, number as u32);
    if high == 0 {
        return ((low / by) as u64, low % by);
    }
    let (above, mut rest) = (high / by, high % by);
    let mut bits = u32::BITS;
    while bits > 0 {
        let (carry, next) = (rest >> 31, low >> 31);
        (rest, low) = (rest << 1 | next, low << 1);
        if carry > 0 || rest >= by {
            rest = rest.wrapping_sub(by);
            low |= 1;
        }
        bits -= 1;
    }
    ((above as u64) << 32 | low as u64, rest)
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
