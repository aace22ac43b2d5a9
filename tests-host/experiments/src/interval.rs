//! Confidence intervals, of 95 % unless stated otherwise.
//!
//! | quantity | method |
//! |---|---|
//! | a probability, from a count of hits | [Wilson1927]: the values that the count does not contradict |
//! | an expected count | [Garwood1936]: exact, from the χ² distribution |
//! | a mean | the normal distribution and the sample's deviation |

use raim::second_opinion::chi_square;

/// Two-sided 95 % point of the normal distribution.
const NORMAL: f64 = 1.959_963_984_540_054;

/// Probability that an interval of 95 % misses its value.
const OUTSIDE: f64 = 0.05;

/// Interval of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// Returns the interval of a probability after `hits` in `trials`; all of 0 … 1 without trials.
    pub fn of_rate(hits: usize, trials: usize) -> Self {
        if trials == 0 {
            return Self { low: 0.0, high: 1.0 };
        }
        let (count, rate) = (trials as f64, hits as f64 / trials as f64);
        let square = NORMAL * NORMAL / count;
        let middle = (rate + square / 2.0) / (1.0 + square);
        let half = NORMAL / (1.0 + square) * (rate * (1.0 - rate) / count + square / (4.0 * count)).sqrt();
        // At the ends the formula gives 0 and 1, and rounding must not change them.
        let low = if hits == 0 { 0.0 } else { middle - half };
        let high = if hits == trials { 1.0 } else { middle + half };
        Self { low, high }
    }

    /// Returns the interval of the expectation of a count.
    pub fn of_count(count: usize) -> Self {
        Self::of_one_count_in(1, count)
    }

    /// Returns the interval of the expectation of one count of `family`. All of them together hold
    /// with 95 % (Bonferroni).
    pub fn of_one_count_in(family: usize, count: usize) -> Self {
        let tail = OUTSIDE / family as f64 / 2.0;
        let low = if count == 0 { 0.0 } else { chi_square::upper_quantile(1.0 - tail, 2 * count) / 2.0 };
        Self { low, high: chi_square::upper_quantile(tail, 2 * count + 2) / 2.0 }
    }

    /// Returns the interval of the mean of a sample; its width is zero with fewer than two values.
    pub fn of_mean(sample: &[f64]) -> Self {
        let count = sample.len() as f64;
        let mean = sample.iter().sum::<f64>() / count;
        let squares: f64 = sample.iter().map(|value| (value - mean).powi(2)).sum();
        let half = if sample.len() < 2 { 0.0 } else { NORMAL * (squares / (count - 1.0) / count).sqrt() };
        Self { low: mean - half, high: mean + half }
    }

    /// Returns the same interval of a mean if it is one of `family`, so that all intervals together
    /// hold with 95 % (Bonferroni).
    #[must_use]
    pub fn as_one_in(&self, family: usize) -> Self {
        let middle = f64::midpoint(self.low, self.high);
        let wider = chi_square::two_sided_normal_quantile(OUTSIDE / family as f64) / NORMAL;
        let half = (self.high - self.low) / 2.0 * wider;
        Self { low: middle - half, high: middle + half }
    }

    /// Returns true if the interval contains a value.
    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }
}

#[cfg(test)]
mod tests {
    use super::Interval;

    #[test]
    fn intervals_are_those_of_the_tables() {
        // Wilson: 8 of 10 by hand with the formula of [Wilson1927]. Garwood: P(k events or more)
        // and P(k or fewer) of 2.5 % solved by mpmath.
        for (have, low, high) in [
            (Interval::of_rate(8, 10), 0.4902, 0.9433),
            (Interval::of_rate(0, 100), 0.0, 0.0370),
            (Interval::of_count(0), 0.0, 3.6889),
            (Interval::of_count(5), 1.6235, 11.6683),
            (Interval::of_count(96), 77.7603, 117.2324),
        ] {
            assert!(
                (have.low - low).abs() < 1e-3 && (have.high - high).abs() < 1e-3,
                "have {have:?}, want {low} {high}"
            );
        }
    }

    #[test]
    fn intervals_of_a_family_are_wider() {
        // 2.5 % in two tails: the normal point is 2.2414, from a table. Garwood with 1.25 % per
        // tail: without an event the upper end is −ln 0.0125.
        let mean = Interval { low: 1.0 - 1.959_964, high: 1.0 + 1.959_964 }.as_one_in(2);
        assert!((mean.low + 1.2414).abs() < 1e-4 && (mean.high - 3.2414).abs() < 1e-4, "have {mean:?}");
        let count = Interval::of_one_count_in(2, 0);
        assert!(count.low == 0.0 && (count.high - 4.382_027).abs() < 1e-5, "have {count:?}");
    }

    #[test]
    fn lone_value_has_no_width() {
        assert_eq!(Interval::of_mean(&[2.5]), Interval { low: 2.5, high: 2.5 });
    }
}
