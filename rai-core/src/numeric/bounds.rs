//! Comparison of doubles by their bits. On a processor that emulates doubles, an ordinary
//! comparison is a library call.

use core::ops::RangeInclusive;

/// Returns true if a number is within a range whose ends are not negative.
///
/// Positive doubles have the order of their bits. Those of negative numbers, infinity and NaN are
/// above.
pub fn is_within(value: f64, range: &RangeInclusive<f64>) -> bool {
    (range.start().to_bits()..=range.end().to_bits()).contains(&value.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_within_are_those_that_comparisons_let_in() {
        let range = 1e-3..=1e9;
        let values =
            [0.0, 1e-3, 1e-300, 0.000_999, 1.0, 1e9, 1.000_000_1e9, f64::MAX, f64::INFINITY, f64::NAN];
        for value in values.into_iter().flat_map(|value| [value, -value]) {
            assert_eq!(is_within(value, &range), range.contains(&value), "{value}");
        }
    }
}
