//! Quantiles of any number of values in bounded memory.
//!
//! Values are counted exactly until [`EXACT`] different ones have come. Then all are rounded to
//! multiples of 1 mm, and the step doubles whenever as many have come again. A few hours at one
//! epoch a second are therefore exact, and a longer run has an error of half a step: 0.5 mm if all
//! values are below 16 m.

use std::collections::BTreeMap;

/// Number of different values that are counted exactly.
const EXACT: usize = 16_384;

/// First step of the rounding, m.
const FIRST_STEP_M: f64 = 1e-3;

/// Number of occurrences of each value. Values are lengths: not negative.
#[derive(Clone, Debug, Default)]
pub(super) struct Quantiles {
    /// Counts by the bits of the value, which order lengths as their values do.
    counts: BTreeMap<u64, u64>,
    all: u64,
    squares: f64,
    most: Option<f64>,
    step_m: Option<f64>,
}

impl Quantiles {
    pub(super) fn count(&mut self, value_m: f64) {
        self.all += 1;
        self.squares += value_m * value_m;
        self.most = Some(self.most.map_or(value_m, |most| most.max(value_m)));
        *self.counts.entry(key(value_m, self.step_m)).or_default() += 1;
        while self.counts.len() > EXACT {
            self.coarsen();
        }
    }

    fn coarsen(&mut self) {
        let step_m = self.step_m.map_or(FIRST_STEP_M, |step_m| 2.0 * step_m);
        self.step_m = Some(step_m);
        for (bits, count) in std::mem::take(&mut self.counts) {
            *self.counts.entry(key(f64::from_bits(bits), self.step_m)).or_default() += count;
        }
    }

    /// Returns the number of values.
    pub(super) fn len(&self) -> usize {
        self.all as usize
    }

    /// Returns the root mean square, exact.
    pub(super) fn rms(&self) -> Option<f64> {
        (self.all > 0).then(|| (self.squares / self.all as f64).sqrt())
    }

    /// Returns the largest value, exact.
    pub(super) fn most(&self) -> Option<f64> {
        self.most
    }

    /// Returns the value below which this share of all lies.
    pub(super) fn quantile(&self, share: f64) -> Option<f64> {
        let index = (share * self.all.saturating_sub(1) as f64).round() as u64;
        let mut below = 0;
        let found = self.counts.iter().find(|(_, count)| {
            below += **count;
            below > index
        });
        found.map(|(bits, _)| f64::from_bits(*bits))
    }
}

fn key(value_m: f64, step_m: Option<f64>) -> u64 {
    step_m.map_or(value_m, |step_m| (value_m / step_m).round() * step_m).to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_values_are_exact_and_many_are_right_to_half_a_step() {
        const MANY: u32 = 600_000;
        let mut quantiles = Quantiles::default();
        assert_eq!((quantiles.quantile(0.5), quantiles.rms(), quantiles.most()), (None, None, None));
        for value in [3.0, 1.0, 2.0, 2.0] {
            quantiles.count(value);
        }
        assert_eq!((quantiles.quantile(0.5), quantiles.quantile(1.0)), (Some(2.0), Some(3.0)));
        assert_eq!((quantiles.rms(), quantiles.len()), (Some(4.5_f64.sqrt()), 4));

        // Uniform from 0 to 10 m, out of order.
        let mut quantiles = Quantiles::default();
        for number in 0..MANY {
            let shuffled = u64::from(number) * 7_919 % u64::from(MANY);
            quantiles.count(shuffled as f64 * 10.0 / f64::from(MANY));
        }
        assert!(quantiles.counts.len() <= EXACT);
        for share in [0.0, 0.05, 0.5, 0.95, 1.0] {
            let have = quantiles.quantile(share).unwrap();
            assert!((have - 10.0 * share).abs() < FIRST_STEP_M / 2.0 + 1e-4, "{share}: {have}");
        }
        let most = quantiles.most().unwrap();
        assert!((most - 10.0).abs() < 1e-4, "{most}");
    }
}
