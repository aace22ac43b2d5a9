//! Choice between one frequency and two: the kind with the smaller protection levels is used.
//!
//! A pair of frequencies is free of the ionosphere, but three times as noisy. One frequency has
//! little noise, but also the residual of the ionosphere's model. The better choice depends on the
//! place, the sky, the receiver, and the signals of each satellite:
//!
//! ```text
//! cost   = HPL/HAL, or max(HPL/HAL, VPL/VAL) with a vertical limit, by geometry and sigmas
//! better   cost < cost'/1.05, or, after quiet minutes, cost ≤ 1.05 cost' and the other level is smaller by as much
//! κ'     = max(κ, κ₂)               while one frequency is in use; κ₂ ← 1 + 0.95 (κ₂ − 1) with each comparison
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
//! The two levels may disagree: pairs, free of the ionosphere, often have the larger HPL and the
//! smaller VPL. The level that decides about the position then chooses, and the other one remains
//! the larger of the two. Between sets that are alike in it, the other level chooses only if quiet
//! minutes have lowered the noise: on foot or on wheels the levels of pairs hide how wrong they are.
//!
//! **No oscillation.** The set in use stays until the other has been better by a twentieth for ten
//! seconds, or for ten consecutive epochs if they come faster. As long as it is not better, the
//! sets are compared more and more seldom, and at last twice a minute: geometry changes slowly, and
//! a comparison costs as much as a position for each set. Epochs half a minute apart are all
//! compared, and the better set is taken at once. So it is in the first epochs. Each change
//! moves the receiver clock by the delay between carriers. With clock aiding the set never changes,
//! because such a change looks like a clock jump.

/// Factor by which a cost must exceed that of the other set, which is then better.
const WORSE: f32 = 1.05;

/// Time for which the other set must be better, s.
const PERSISTENT_S: u8 = 10;

/// Longest time from a comparison to the next, and for which an epoch counts, s.
const LONGEST_PAUSE_S: u8 = 30;

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

/// Cost of a set of ranges: what its levels take of the alert limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// The share that decides about the position: the largest of the limits that apply.
    pub decisive: f32,
    /// The share of the other axis.
    pub other: f32,
}

impl Cost {
    /// Returns true if a set with this cost is better than one with the other cost.
    fn is_below(self, other: Self, is_quiet: bool) -> bool {
        WORSE * self.decisive < other.decisive
            || is_quiet && self.decisive <= WORSE * other.decisive && WORSE * self.other < other.other
    }
}

/// The set in use, with the time for which the other has been better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preference {
    ranges: Ranges,
    /// Time of the last epoch, in whole seconds that wrap around.
    last_s: u16,
    /// Time for which the last epoch counts, s: at least one second.
    step_s: u8,
    better_s: u8,
    /// Time until the next comparison, s.
    rest_s: u8,
    /// The same after this comparison, if the other set is not better.
    pause_s: u8,
    /// Factor on the receiver's part of a variance that pairs have shown, at least 1.
    noise_of_pairs: f32,
}

impl Preference {
    /// Returns the preference at start: pairs, until singles are better.
    pub const fn new() -> Self {
        Self {
            ranges: Ranges::Pairs,
            last_s: 0,
            step_s: 0,
            better_s: 0,
            rest_s: 0,
            pause_s: 1,
            noise_of_pairs: 1.0,
        }
    }

    /// Returns the set in use.
    pub const fn ranges(&self) -> Ranges {
        self.ranges
    }

    /// Counts an epoch at a time within the week. Returns true if both sets should be compared in it.
    pub fn is_due(&mut self, tow_ms: u32) -> bool {
        let now_s = (tow_ms / 1000) as u16;
        // A week that begins, and a time that goes back, count as the longest pause.
        self.step_s = now_s.wrapping_sub(self.last_s).clamp(1, LONGEST_PAUSE_S.into()) as u8;
        self.last_s = now_s;
        self.rest_s = self.rest_s.saturating_sub(self.step_s);
        self.rest_s == 0
    }

    /// Returns the noise to expect of pairs and of singles. `noise` is the factor on the receiver's
    /// part of a variance that the set in use has shown, `others` that which the other one has shown
    /// at rest, if it is known.
    pub fn noises(&mut self, noise: f32, others: Option<f32>) -> [f32; 2] {
        match self.ranges {
            Ranges::Pairs => {
                self.noise_of_pairs = noise;
                [noise, others.unwrap_or(noise)]
            }
            Ranges::Singles => {
                self.noise_of_pairs = noise.max(1.0 + KEPT * (self.noise_of_pairs - 1.0));
                [others.unwrap_or(self.noise_of_pairs), noise]
            }
        }
    }

    /// Compares the costs of pairs and of singles; `None` is a set without a position. `is_quiet` is
    /// true if quiet minutes have lowered the noise of one of them.
    pub fn compare(&mut self, [pairs, singles]: [Option<Cost>; 2], is_quiet: bool) {
        let (mine, others) = if self.ranges == Ranges::Pairs { (pairs, singles) } else { (singles, pairs) };
        let is_better = match (mine, others) {
            (Some(mine), Some(others)) => others.is_below(mine, is_quiet),
            (mine, others) => mine.is_none() && others.is_some(),
        };
        self.better_s = if is_better { self.better_s.saturating_add(self.step_s) } else { 0 };
        let is_at_start = self.pause_s < PERSISTENT_S;
        if self.better_s >= PERSISTENT_S || is_better && is_at_start {
            (self.ranges, self.better_s) = (self.ranges.other(), 0);
        }
        if self.better_s == 0 {
            self.rest_s = self.pause_s;
            self.pause_s = (2 * self.pause_s).min(LONGEST_PAUSE_S);
        }
    }
}

impl Default for Preference {
    fn default() -> Self {
        Self::new()
    }
}
