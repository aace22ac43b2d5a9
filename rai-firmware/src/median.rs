//! Median of a few numbers, without sorting.

/// Returns the middle value, of two the lower; 0 without values. NaN is no value.
#[inline(never)]
pub(crate) fn median(values: &[f32]) -> f32 {
    let half = values.len().saturating_sub(1) / 2;
    let is_middle = |value: &f32| {
        let below = values.iter().filter(|other| *other < value).count();
        below <= half && half < values.iter().filter(|other| *other <= value).count()
    };
    values.iter().copied().find(is_middle).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::median;

    #[allow(clippy::float_cmp, reason = "a median is one of the values, bit for bit")]
    #[test]
    fn median_is_the_middle_and_the_lower_of_two() {
        assert_eq!(median(&[]), 0.0);
        assert_eq!(median(&[5.0, -1.0, 3.0]), 3.0);
        assert_eq!(median(&[5.0, 3.0, -1.0, 3.5]), 3.0);
        assert_eq!(median(&[2.0, 2.0, 2.0, 9.0]), 2.0);
    }
}
