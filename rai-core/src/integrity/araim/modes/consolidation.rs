//! Consolidation: counts rare faults within a constellation with its loss. The other probabilities
//! are summed by the number of satellites taken.

use core::ops::ControlFlow;

use super::Modes;
use super::combination::{Combination, combinations_backwards};
use super::sets::ROWS;
use crate::numeric::real::Real;
use crate::satellite::Constellation;

/// Sums of probability by the number of satellites taken.
pub(super) type ProbabilityBySize<T> = [T; ROWS + 1];

impl<T: Real> Modes<'_, T> {
    /// Returns the constellation with whose loss a combination is counted, if any.
    #[inline]
    pub(super) fn consolidates(&self, combination: &Combination<T>, probability: T) -> Option<usize> {
        let odds = *self.constellations.get(combination.constellation)?;
        // If the loss has probability 0, this comparison fails, so that nothing is counted with it.
        let rare = probability < self.consolidation * (self.healthy * odds);
        (rare && !combination.is_whole_constellation()).then_some(combination.constellation)
    }

    /// Sums the probability of combinations that are not mandatory, except for single losses, and
    /// the consolidated probability.
    #[inline(never)]
    pub(super) fn sum_one_by_one(&mut self, sums: &mut ProbabilityBySize<T>) {
        let events = self.gathered();
        let mut added = [T::zero(); Constellation::COUNT];
        for size in 1..=self.limit {
            let _ = combinations_backwards(&events, size, &mut |combination| {
                let probability = self.healthy * combination.odds;
                if let Some(constellation) = self.consolidates(&combination, probability) {
                    if let Some(sum) = added.get_mut(constellation) {
                        *sum += probability;
                    }
                } else if !combination.is_whole_constellation() && !(probability > self.mandatory) {
                    add_to(sums, combination.size, probability);
                }
                ControlFlow::<()>::Continue(())
            });
        }
        self.added = added;
    }

    /// Works like [`Self::sum_one_by_one`] for homogeneous constellations: of each, all pairs are
    /// consolidated or none, and no pair is mandatory. Returns `None` for others; the sums are then
    /// unspecified.
    #[inline(never)]
    pub(super) fn sum_by_constellation(
        &mut self,
        alike: &[OddsRange<T>; Constellation::COUNT],
        sums: &mut ProbabilityBySize<T>,
    ) -> Option<()> {
        if self.limit != 2 {
            return None;
        }
        if !self.must_monitor_all_singles() {
            for fallible in self.odds.iter().filter(|fallible| fallible.odds > T::zero()) {
                let probability = self.healthy * fallible.odds;
                if !(probability > self.mandatory) {
                    add_to(sums, 1, probability);
                }
            }
        }
        let largest = |list: T, odds: T| if odds > list { odds } else { list };
        let of_satellites = alike.iter().fold(T::zero(), |most, alike| largest(most, alike.largest));
        let of_losses = self.constellations.into_iter().fold(T::zero(), largest);
        // No pair is likelier than the squared odds of the likeliest event.
        let most = largest(of_satellites, of_losses);
        if self.healthy * (most * most) > self.mandatory {
            return None;
        }
        let mut added = [T::zero(); Constellation::COUNT];
        let losses = self.constellations;
        for (id, (here, &loss)) in alike.iter().zip(&losses).enumerate() {
            // Neither a satellite nor the constellation can fail.
            if !(here.sum > T::zero() || loss > T::zero()) {
                continue;
            }
            let bar = self.consolidation * (self.healthy * loss);
            let is_below = |least: T, most: T| is_all_below(self.healthy * least, self.healthy * most, bar);
            if is_below(here.least, here.largest)? && here.sum > T::zero() {
                return None;
            }
            // Pairs of satellites, and the loss of the constellation with one of its satellites.
            let pair = is_below(here.least * here.least, here.largest * here.largest)?;
            let nested = is_below(here.least * loss, here.largest * loss)?;
            let (pairs, with_loss) = (self.healthy * here.pairs(), self.healthy * (loss * here.sum));
            let (slot, size) = (added.get_mut(id)?, *self.sizes.get(id)?);
            if pair {
                *slot += pairs;
            } else {
                add_to(sums, 2, pairs);
            }
            if nested {
                *slot += with_loss;
            } else {
                add_to(sums, size, with_loss);
            }
            self.consolidates_all |= u8::from(nested) << id;
            self.consolidates_pairs |= u8::from(pair) << id;
            for (other, (there, &other_loss)) in alike.iter().zip(&losses).enumerate() {
                if other != id {
                    add_to(sums, size + 1, self.healthy * (loss * there.sum));
                }
                if other > id {
                    let other_size = *self.sizes.get(other)?;
                    add_to(sums, 2, self.healthy * (here.sum * there.sum));
                    add_to(sums, size + other_size, self.healthy * (loss * other_loss));
                }
            }
        }
        self.added = added;
        Some(())
    }
}

/// Adds a probability to the sum of a size.
pub(super) fn add_to<T: Real>(sums: &mut ProbabilityBySize<T>, size: usize, probability: T) {
    if let Some(sum) = sums.get_mut(size) {
        *sum += probability;
    }
}

/// Sums and limits of the odds of one constellation's satellites.
#[derive(Clone, Copy)]
pub(super) struct OddsRange<T> {
    sum: T,
    squares: T,
    largest: T,
    least: T,
}

impl<T: Real> OddsRange<T> {
    pub(super) fn none() -> Self {
        Self { sum: T::zero(), squares: T::zero(), largest: T::zero(), least: T::zero() }
    }

    /// Adds a number of satellites with equal odds.
    pub(super) fn add(&mut self, odds: T, count: usize) {
        if !(self.sum > T::zero()) || odds < self.least {
            self.least = odds;
        }
        if odds > self.largest {
            self.largest = odds;
        }
        for _ in 0..count {
            self.sum += odds;
            self.squares += odds * odds;
        }
    }

    /// Returns the sum over all pairs.
    fn pairs(&self) -> T {
        let twice = self.sum * self.sum - self.squares;
        if twice > T::zero() { twice * T::narrow(0.5) } else { T::zero() }
    }
}

/// Returns true if all numbers from `least` to `largest` are below a bar, `None` if only some are.
fn is_all_below<T: Real>(least: T, largest: T, bar: T) -> Option<bool> {
    if largest < bar {
        Some(true)
    } else if least < bar {
        None
    } else {
        Some(false)
    }
}
