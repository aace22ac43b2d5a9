//! Errors that all ranges of an epoch share.

/// Part of one range's error that all ranges of the epoch share, at one sigma.
///
/// It consists of three independent errors with one value each for the whole epoch: an offset, and
/// slopes to the east and to the north ([`crate::integrity::raim::shared_errors`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SharedError {
    /// Effect of the offset on the range, m.
    pub common_m: f32,
    /// Effect of a slope on the range, m per unit of the line of sight's component in its
    /// direction.
    pub slope_m: f32,
}

impl SharedError {
    /// No error is shared.
    pub const NONE: Self = Self { common_m: 0.0, slope_m: 0.0 };

    /// Returns true if both numbers are within 0 to 1e6 m.
    pub(crate) fn is_valid(self) -> bool {
        // NaN fails this comparison.
        [self.common_m, self.slope_m].iter().all(|error_m| (0.0..=1e6).contains(error_m))
    }
}
