//! What becomes of a satellite in an epoch.

use core::fmt;

use raim_core::epoch::EpochError;

use crate::ephemeris::EphemerisError;

/// Use of a satellite in an epoch, or the reason for which it is not used.
///
/// The reasons are those of the counters of the module: each refusal adds one to a counter of
/// `STATS` and becomes the fate of its satellite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Fate {
    /// Part of the position.
    Used,
    /// Left out by the test, because it contradicts the others.
    Excluded,
    /// Its whole system is left out, because it contradicts the others.
    SystemExcluded,
    /// Below the elevation mask.
    BelowMask,
    /// No signal is as strong as `CN0MASK` and has a known delay.
    SignalUnusable,
    /// System not in `SYSTEMS`.
    SystemLeftOut,
    /// No ephemeris.
    EphemerisMissing,
    /// Stale ephemeris.
    EphemerisStale,
    /// Its last two ephemerides contradict each other.
    EphemerisDisputed,
    /// Its ephemeris is false, or not proved although the settings demand it.
    EphemerisUnproved,
    /// Reported unhealthy by itself.
    Unhealthy,
    /// The travel time of its signal is impossible.
    TravelTime,
    /// A corrected range, position or sigma is impossible.
    RangeImplausible,
    /// Its two bands differ by more than the ionosphere can explain.
    BandsApart,
    /// It appeared twice, or under two numbers.
    Twice,
    /// The epoch holds no more satellites.
    EpochFull,
    /// Not tested, because the epoch has no position.
    NoPosition,
}

impl Fate {
    /// All fates, in the order of their numbers.
    pub const ALL: [Self; 17] = [
        Self::Used,
        Self::Excluded,
        Self::SystemExcluded,
        Self::BelowMask,
        Self::SignalUnusable,
        Self::SystemLeftOut,
        Self::EphemerisMissing,
        Self::EphemerisStale,
        Self::EphemerisDisputed,
        Self::EphemerisUnproved,
        Self::Unhealthy,
        Self::TravelTime,
        Self::RangeImplausible,
        Self::BandsApart,
        Self::Twice,
        Self::EpochFull,
        Self::NoPosition,
    ];

    /// Returns true for a satellite that the test has left out, alone or with its system.
    pub const fn is_excluded(self) -> bool {
        matches!(self, Self::Excluded | Self::SystemExcluded)
    }

    /// Returns the fate in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Used => "used",
            Self::Excluded => "excluded: contradicts the others",
            Self::SystemExcluded => "excluded with its system",
            Self::BelowMask => "below the elevation mask",
            Self::SignalUnusable => "no signal above CN0MASK with a known delay",
            Self::SystemLeftOut => "system not in SYSTEMS",
            Self::EphemerisMissing => "no ephemeris",
            Self::EphemerisStale => "stale ephemeris",
            Self::EphemerisDisputed => "ephemeris disputed",
            Self::EphemerisUnproved => "ephemeris false or not proved",
            Self::Unhealthy => "unhealthy",
            Self::TravelTime => "travel time out of bounds",
            Self::RangeImplausible => "implausible range",
            Self::BandsApart => "its bands disagree",
            Self::Twice => "one satellite twice",
            Self::EpochFull => "no room in the epoch",
            Self::NoPosition => "no position",
        }
    }
}

impl fmt::Display for Fate {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.words())
    }
}

impl From<EphemerisError> for Fate {
    fn from(error: EphemerisError) -> Self {
        match error {
            EphemerisError::Missing => Self::EphemerisMissing,
            EphemerisError::Unhealthy => Self::Unhealthy,
            EphemerisError::Stale => Self::EphemerisStale,
            EphemerisError::TravelTime => Self::TravelTime,
            EphemerisError::Disputed => Self::EphemerisDisputed,
            #[cfg(feature = "osnma")]
            EphemerisError::Unproved => Self::EphemerisUnproved,
        }
    }
}

impl From<EpochError> for Fate {
    fn from(error: EpochError) -> Self {
        match error {
            EpochError::Duplicate => Self::Twice,
            EpochError::Full => Self::EpochFull,
            // A number of the range, its position or its sigma.
            _ => Self::RangeImplausible,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Fate;

    #[test]
    fn number_of_a_fate_is_its_place_and_its_words_are_its_own() {
        for (number, fate) in Fate::ALL.into_iter().enumerate() {
            assert_eq!(fate as usize, number);
            assert_eq!(Fate::ALL.iter().filter(|other| other.words() == fate.words()).count(), 1);
        }
    }
}
