//! Mean of the weights of draws, with its interval.

use crate::{Finding, Interval};

/// A mean of weights, and the variance of the mean.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Estimate {
    pub(super) mean: f64,
    pub(super) variance: f64,
}

impl Estimate {
    pub(super) fn of(weights: &[f64]) -> Self {
        let count = weights.len() as f64;
        let mean = weights.iter().sum::<f64>() / count;
        let squares: f64 = weights.iter().map(|weight| (weight - mean).powi(2)).sum();
        Self { mean, variance: squares / (count * (count - 1.0).max(1.0)) }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self { mean: self.mean + other.mean, variance: self.variance + other.variance }
    }

    pub(super) fn times(self, factor: f64) -> Self {
        Self { mean: factor * self.mean, variance: factor * factor * self.variance }
    }

    pub(super) fn larger(self, other: Self) -> Self {
        if other.mean > self.mean { other } else { self }
    }

    pub(super) fn finding(self) -> Finding {
        let half = 1.96 * self.variance.sqrt();
        let interval = Interval { low: (self.mean - half).max(0.0), high: self.mean + half };
        Finding::Number { value: self.mean, decimals: 6, interval: Some(interval) }
    }
}
