//! Output: the sentences and messages for the host, and their rates.
//!
//! | module | readers |
//! |---|---|
//! | [`nmea`] | readers of sentences |
//! | [`mavlink`] | autopilots |
//! | [`geoid`] | altitude above mean sea level, for both |
//! | [`nic`] | aviation: the integrity category of a level |
//! | [`InView`], [`Places`] | the satellites of an epoch, for `GSV` |
//! | [`schedule`] | rate of each sentence and message |
//!
//! [`crate::publisher`] sends the sentences and messages when they are due.
//!
//! One [`Statement`] describes one epoch. In an alert no output carries a coordinate, a height, a
//! speed or a protection level of the module, and every mode reports the alert. Outputs therefore
//! take the position from `Statement::usable_solution`, the velocity from
//! `Statement::usable_motion` and the levels from `Statement::levels_m`. Only the GNSS receiver's
//! levels are still forwarded in an alert (`PRAIE`).

use raim_core::internals::numeric::sqrt;
use raim_core::internals::velocity::Velocity;
use raim_core::report::{Report, Solution, Verdict};
use raim_core::requirements::Requirements;

use crate::input::{ReceiverLevels, Suspicions};
use crate::time::GpsTime;

pub use in_view::{InView, Places};

pub mod geoid;
mod in_view;
#[cfg(feature = "mavlink")]
pub mod mavlink;
pub mod nic;
pub mod nmea;
pub mod schedule;

/// Velocity of the antenna that passed its own test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// East component, m/s.
    pub east_m_s: f32,
    /// North component, m/s.
    pub north_m_s: f32,
    /// Up component, m/s.
    pub up_m_s: f32,
    /// Standard deviation of the horizontal velocity along its worst direction, m/s.
    pub sigma_m_s: f32,
}

impl Motion {
    /// Converts a velocity of the core to single precision.
    pub fn of(velocity: &Velocity) -> Self {
        let [east_m_s, north_m_s, up_m_s] = velocity.east_north_up_m_s.map(|component| component as f32);
        let [east, covariance, _, north, _, _] = velocity.covariance_m2_s2.map(|element| element as f32);
        let (mean, difference) = (0.5 * (east + north), 0.5 * (east - north));
        let spread = sqrt(difference * difference + covariance * covariance);
        Self { east_m_s, north_m_s, up_m_s, sigma_m_s: sqrt((mean + spread).max(0.0)) }
    }

    /// Returns the speed over ground, m/s.
    pub fn speed_m_s(&self) -> f32 {
        sqrt(self.east_m_s * self.east_m_s + self.north_m_s * self.north_m_s)
    }
}

/// The receiver's reports of jamming, spoofing, authentication and its own levels. Jamming and
/// spoofing have the values of `PRAIN`: 0 unknown, 1 none, 2 suspected or mitigated, 3 certain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Interference {
    /// Jamming: noise that hides the signals.
    pub jamming: u8,
    /// Spoofing: false signals.
    pub spoofing: u8,
    /// Number of signals whose navigation message is authenticated, if the receiver states it.
    pub authenticated: Option<u8>,
    /// Protection levels that the receiver reports, if they are valid.
    pub levels: Option<ReceiverLevels>,
}

impl Interference {
    /// Returns the reports in force.
    pub fn of(word: &Suspicions) -> Self {
        Self {
            jamming: word.jamming.number(),
            spoofing: word.spoofing.number(),
            authenticated: word.authenticated(),
            levels: word.levels(),
        }
    }
}

/// Everything that is reported about one epoch.
#[derive(Clone, Copy, Debug)]
pub struct Statement<'r, const N: usize> {
    /// Report of the core.
    pub report: &'r Report<N>,
    /// The receiver's time tag.
    pub time: GpsTime,
    /// GPS time minus UTC, s.
    pub gps_minus_utc_s: u8,
    /// Requirements in force.
    pub requirements: &'r Requirements,
    /// Velocity, if it passed its test.
    pub motion: Option<Motion>,
    /// The receiver's reports of jamming, spoofing, authentication and its own levels.
    pub interference: Interference,
    /// Hash of the settings in force.
    pub settings_hash: u32,
    /// Number of satellites whose L5 is in use although they call it unhealthy.
    #[cfg(feature = "cnav")]
    pub unhealthy_l5: u8,
    /// Satellites in view; `None` if they are not known.
    pub in_view: Option<InView<'r>>,
}

impl<const N: usize> Statement<'_, N> {
    /// Returns the number of satellites whose L5 is in use although they call it unhealthy.
    #[cfg(feature = "cnav")]
    const fn unhealthy_l5(&self) -> u8 {
        self.unhealthy_l5
    }

    /// Returns 0: a build without CNAV does not know.
    #[cfg(not(feature = "cnav"))]
    #[allow(clippy::unused_self, reason = "as in a build with CNAV")]
    const fn unhealthy_l5(&self) -> u8 {
        0
    }

    /// Returns true if the position must not be used.
    fn is_alert(&self) -> bool {
        matches!(self.report.verdict, Verdict::Alert(_))
    }

    /// Returns the solution; `None` without one or in an alert.
    fn usable_solution(&self) -> Option<&Solution> {
        self.report.solution.as_ref().filter(|_| !self.is_alert())
    }

    /// Returns the velocity; `None` unless the solution may be used.
    fn usable_motion(&self) -> Option<Motion> {
        self.motion.filter(|_| self.usable_solution().is_some())
    }

    /// Returns the horizontal and vertical protection level, m; `None` in an alert.
    fn levels_m(&self) -> (Option<f64>, Option<f64>) {
        match self.report.protection.filter(|_| !self.is_alert()) {
            Some(levels) => (Some(levels.hpl_m), Some(levels.vpl_m)),
            None => (None, None),
        }
    }
}
