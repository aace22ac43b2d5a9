//! The numbers of a verdict as its sentences have them, and what is known of ephemerides.

use super::{Judged, WithoutEpoch};
#[cfg(feature = "osnma")]
use crate::osnma::{Standing, Summary};
use crate::output::nmea::{Figures, TimeOfDay};

impl Judged<'_> {
    /// Returns UTC of the epoch.
    pub fn utc(&self) -> TimeOfDay {
        TimeOfDay::new(self.time(), self.statement.gps_minus_utc_s)
    }

    /// Returns the position, the test, levels and limits, rounded as in the sentences.
    pub fn figures(&self) -> Figures {
        Figures::of(self.statement)
    }

    /// Returns SSE/dof of the ranges used, under every method; `None` if they did not pass their test.
    pub fn variance_ratio(&self) -> Option<f64> {
        self.navigator.variance_ratio()
    }

    /// Returns what is known of Galileo's ephemerides, and what it is worth; `None` without a key.
    #[cfg(feature = "osnma")]
    pub fn authentication(&self) -> Option<(Standing, &Summary)> {
        let report = self.authentication.as_ref()?;
        Some((Standing::of(&report.summary, report.proof), &report.summary))
    }
}

impl WithoutEpoch<'_> {
    /// Returns UTC of the last epoch; `None` before the first.
    pub fn utc(&self) -> Option<TimeOfDay> {
        self.last.map(|last| TimeOfDay::new(last, self.gps_minus_utc_s))
    }

    /// Returns the limits in force, rounded as in the sentences; there is neither position nor test.
    pub fn figures(&self) -> Figures {
        Figures::without_epoch(&self.configuration.requirements())
    }
}
