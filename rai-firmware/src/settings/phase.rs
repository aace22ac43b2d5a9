//! Phases: named requirements, and the longest time to alert of each.
//!
//! | phase | HAL, m | VAL, m | time to alert at start, s | at most, s |
//! |---|---|---|---|---|
//! | `ENROUTE` | 3704 | – | 60 | 60 |
//! | `TERMINAL` | 1852 | – | 15 | 30 |
//! | `NPA` | 556 | – | 10 | 10 |
//! | `LPV200` | 40 | 35 | 6 | 6 |
//! | `CUSTOM` | the present one | the present one | the present one | 3600 |
//!
//! [ICAO-A10] allows an oceanic flight 300 s. The module allows less in a named phase, because an
//! earlier alert is possible; a host that wants more sets `CUSTOM`.
//!
//! [ICAO-A10]: crate#references

use raim_core::requirements::Requirements;

/// Phase of flight, which names a set of requirements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Phase {
    /// En route.
    EnRoute,
    /// Terminal area.
    Terminal,
    /// Non-precision approach.
    NonPrecisionApproach,
    /// Approach with vertical guidance down to 200 ft.
    Lpv200,
    /// Numbers set one by one.
    Custom,
}

impl Phase {
    /// Returns the requirements of a named phase; `None` for `CUSTOM`.
    // Not inlined, because flash is scarcer than time here.
    #[inline(never)]
    pub const fn requirements(self) -> Option<Requirements> {
        let mut required = match self {
            Self::EnRoute => Requirements::en_route(),
            Self::Terminal => Requirements::terminal(),
            Self::NonPrecisionApproach => Requirements::non_precision_approach(),
            Self::Lpv200 => Requirements::lpv200(),
            Self::Custom => return None,
        };
        if required.time_to_alert_s > self.longest_time_to_alert_s() {
            required.time_to_alert_s = self.longest_time_to_alert_s();
        }
        Some(required)
    }

    /// Returns the longest time to alert that a command may set in this phase, s.
    pub const fn longest_time_to_alert_s(self) -> f64 {
        match self {
            Self::EnRoute => 60.0,
            Self::Terminal => 30.0,
            Self::NonPrecisionApproach => 10.0,
            Self::Lpv200 => 6.0,
            Self::Custom => 3600.0,
        }
    }
}
