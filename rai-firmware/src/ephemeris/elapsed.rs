//! Time from a reference time, in 2⁻⁴⁶ s.

use super::fixed::{Turns, mul_high};

/// Time since a reference, 2⁻⁴⁶ s, at most 36 h either way. In 1.4e-14 s no orbit and no clock
/// changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Elapsed(i64);

impl Elapsed {
    /// Longest accepted time from the reference, ms: a day.
    pub(super) const LIMIT_MS: u64 = 86_400_000;

    /// Converts whole milliseconds, limited to [`Self::LIMIT_MS`].
    pub(super) fn of_ms(ms: i64) -> Self {
        const PER_MS: i64 = 70_368_744_178;
        let limit_ms = Self::LIMIT_MS.cast_signed();
        let ms = ms.clamp(-limit_ms, limit_ms) as i32;
        // Whole seconds are exact, and each further millisecond is rounded by less than 2⁻⁴⁶ s.
        Self((i64::from(ms / 1000) << 46) + i64::from(ms % 1000) * PER_MS)
    }

    /// Returns the time `by_2_46` earlier, 2⁻⁴⁶ s.
    pub(super) const fn earlier(self, by_2_46: i64) -> Self {
        Self(self.0.saturating_sub(by_2_46))
    }

    /// Converts to 2⁻⁴⁴ s, which has room for four times as much.
    pub(super) const fn units_2_44(self) -> i64 {
        self.0 >> 2
    }

    /// Converts to seconds.
    pub fn to_s(self) -> f64 {
        const SECONDS: f64 = 1.0 / (1_u64 << 46) as f64;
        self.0 as f64 * SECONDS
    }

    /// Returns the turn at this rate, 2⁻⁷⁶ turns/s.
    pub(super) const fn turned(self, rate_2_76: i64) -> Turns {
        Turns::new(mul_high(rate_2_76, self.0) << 6)
    }
}
