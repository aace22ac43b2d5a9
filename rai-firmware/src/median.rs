//! Median of a few numbers, without sorting.

/// Returns the middle value; the lower one of two; 0 without values. NaN values are ignored.
#[inline(never)]
pub(crate) fn median(values: &[f32]) -> f32 {
    let half = values.len().saturating_sub(1) / 2;
    let is_middle = |value: &f32| {
        let below = values.iter().filter(|other| *other < value).count();
        below <= half && half < values.iter().filter(|other| *other <= value).count()
    };
    values.iter().copied().find(is_middle).unwrap_or(0.0)
}

/// Returns the difference of the largest and the smallest value; negative infinity without values.
/// NaN values are ignored.
pub(crate) fn apart_m(values_m: &[f32]) -> f32 {
    let bounds = (f32::INFINITY, f32::NEG_INFINITY);
    let (least_m, most_m) = values_m
        .iter()
        .fold(bounds, |(least_m, most_m), value_m| (least_m.min(*value_m), most_m.max(*value_m)));
    most_m - least_m
}

#[cfg(test)]
mod tests {
    use super::{apart_m, median};

    #[allow(clippy::float_cmp, reason = "differences of small whole numbers are exact")]
    #[test]
    fn values_are_apart_by_the_largest_less_the_smallest() {
        assert_eq!(apart_m(&[5.0, -1.0, f32::NAN, 3.0]), 6.0);
        assert_eq!(apart_m(&[7.0]), 0.0);
        assert_eq!(apart_m(&[]), f32::NEG_INFINITY);
    }

    #[allow(clippy::float_cmp, reason = "a median is one of the values, bit for bit")]
    #[test]
    fn median_is_the_middle_and_the_lower_of_two() {
        assert_eq!(median(&[]), 0.0);
        assert_eq!(median(&[5.0, -1.0, 3.0]), 3.0);
        assert_eq!(median(&[5.0, 3.0, -1.0, 3.5]), 3.0);
        assert_eq!(median(&[2.0, 2.0, 2.0, 9.0]), 2.0);
    }
}
