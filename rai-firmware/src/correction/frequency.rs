//! Choice between one frequency and two: the kind with the smaller protection levels is used.
//!
//! A pair of frequencies is free of the ionosphere, but three times as noisy. One frequency has
//! little noise, but also the residual of the ionosphere's model. The better choice depends on the
//! place, the sky, the receiver, and the signals of each satellite:
//!
//! ```text
//! cost = max(HPL/HAL, VPL/VAL)      of an epoch of that kind, by its geometry and sigmas
//! κ'   = max(κ, κ₂)                 while one frequency is in use; κ₂ ← 1 + 0.95 (κ₂ − 1) with each comparison
//! ```
//!
//! | symbol | here | unit |
//! |---|---|---|
//! | `HPL`, `VPL` | [`Monitor::levels`](raim_core::monitor::Monitor::levels) | m |
//! | `HAL`, `VAL` | alert limits | m |
//! | `κ` | factor on the receiver's part of a variance, of the last minute ([`Monitor::noise`](raim_core::monitor::Monitor::noise)) | – |
//! | `κ₂` | [`Preference::noise_of_pairs`]: the same when pairs were left | – |
//!
//! Residuals of this epoch are not used, because a choice by them would prefer the set in which a
//! fault does not show. The noise of the last minute counts: walls and small antennas make pairs
//! three times as wrong as one frequency, whose larger sigmas hide the same noise. What pairs have
//! shown is therefore kept in mind for some minutes. With the feature `both-kinds` each comparison
//! also teaches what the set that is not in use shows at rest; pairs gain most by quiet minutes.
//!
//! **No oscillation.** The set in use stays until the other has been better by a twentieth for ten
//! consecutive epochs. As long as it is not better, the sets are compared more and more seldom, and
//! at last every thirtieth epoch: geometry changes slowly, and a comparison costs as much as a
//! position for each set. In the first epochs the better set is taken at once. Each change
//! moves the receiver clock by the delay between carriers. With clock aiding the set never changes,
//! because such a change looks like a clock jump.

/// Cost of the other set, relative to the set in use, below which the other set is better.
const BETTER: f32 = 0.95;

/// Consecutive epochs for which the other set must be better.
const PERSISTENT: u8 = 10;

/// Most epochs from a comparison to the next, which are not counted.
const LONGEST_PAUSE: u8 = 29;

/// Share of the noise of pairs that a comparison keeps in mind: half of it after six minutes, by
/// comparisons half a minute apart.
const KEPT: f32 = 0.95;

/// Kind of range for a satellite that offers both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ranges {
    /// Ionosphere-free pairs; one frequency for a satellite without a pair.
    Pairs,
    /// One frequency; a pair for a satellite without a single range.
    Singles,
}

impl Ranges {
    const fn other(self) -> Self {
        match self {
            Self::Pairs => Self::Singles,
            Self::Singles => Self::Pairs,
        }
    }
}

/// The set in use, with the number of epochs for which the other has been better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preference {
    ranges: Ranges,
    epochs_better: u8,
    /// Epochs until the next comparison.
    rest: u8,
    /// The same after this comparison, if the other set is not better.
    pause: u8,
    /// Factor on the receiver's part of a variance that pairs have shown, at least 1.
    noise_of_pairs: f32,
}

impl Preference {
    /// Returns the preference at start: pairs, until singles are better.
    pub const fn new() -> Self {
        Self { ranges: Ranges::Pairs, epochs_better: 0, rest: 0, pause: 0, noise_of_pairs: 1.0 }
    }

    /// Returns the set in use.
    pub const fn ranges(&self) -> Ranges {
        self.ranges
    }

    /// Makes the next epoch a comparison.
    #[cfg(feature = "both-kinds")]
    pub(crate) const fn compare_now(&mut self) {
        self.rest = 0;
    }

    /// Compares the costs of both sets and returns the set to use.
    ///
    /// `noise` is the factor on the receiver's part of a variance that the set in use has shown,
    /// `others` that which the other one has shown at rest, if it is known.
    /// `cost` is that of a set with such a factor, or `None` without a position.
    pub fn weigh(
        &mut self,
        noise: f32,
        others: Option<f32>,
        mut cost: impl FnMut(Ranges, f32) -> Option<f32>,
    ) -> Ranges {
        if let Some(rest) = self.rest.checked_sub(1) {
            self.rest = rest;
            return self.ranges;
        }
        self.noise_of_pairs = match self.ranges {
            Ranges::Pairs => noise,
            Ranges::Singles => noise.max(1.0 + KEPT * (self.noise_of_pairs - 1.0)),
        };
        let (mut pairs, mut singles) = (self.noise_of_pairs, noise);
        if let Some(others) = others {
            *(if self.ranges == Ranges::Pairs { &mut singles } else { &mut pairs }) = others;
        }
        let (pairs, singles) = (cost(Ranges::Pairs, pairs), cost(Ranges::Singles, singles));
        let (mine, others) = if self.ranges == Ranges::Pairs { (pairs, singles) } else { (singles, pairs) };
        let is_better = match (mine, others) {
            (Some(mine), Some(others)) => others < BETTER * mine,
            (mine, others) => mine.is_none() && others.is_some(),
        };
        self.epochs_better = if is_better { self.epochs_better.saturating_add(1) } else { 0 };
        let is_at_start = self.pause < PERSISTENT;
        if self.epochs_better >= PERSISTENT || is_better && is_at_start {
            (self.ranges, self.epochs_better) = (self.ranges.other(), 0);
        }
        if self.epochs_better == 0 {
            self.rest = self.pause;
            self.pause = (2 * self.pause + 1).min(LONGEST_PAUSE);
        }
        self.ranges
    }
}

impl Default for Preference {
    fn default() -> Self {
        Self::new()
    }
}
