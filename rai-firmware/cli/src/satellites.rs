//! Satellites of an epoch, one by one, by the module's own account.
//!
//! ```text
//! module ─► Views ─► table of satellites, report, pages, dashboard
//! ```
//!
//! Nothing here is computed beside the module but [`View::misfit`], a sum over its residuals.

use raim_core::report::Verdict;
use raim_core::satellite::Constellation;
pub use raim_firmware::observer::{Account, Fate};
use raim_firmware::observer::{Judged, Observer};
use raim_firmware::time::GpsTime;

use crate::sentence::EpochOutput;

/// The module's view of an epoch beyond its sentences.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct View {
    /// Time tag of the epoch.
    pub time: Option<GpsTime>,
    /// Receiver clock times the speed of light, m: that of the first system with one.
    pub clock_m: Option<f64>,
    /// Satellites of the epoch, in the order of their names.
    pub satellites: Vec<Account>,
}

impl View {
    /// Returns the view of an epoch that has just been judged.
    pub fn of(judged: &Judged<'_>) -> Self {
        let solution = judged.report().solution.as_ref();
        let mut satellites: Vec<Account> = judged.accounts().collect();
        satellites.sort_by_key(|account| account.satellite);
        Self {
            time: Some(judged.time()),
            clock_m: solution.and_then(|solution| solution.clocks_m.iter().copied().flatten().next()),
            satellites,
        }
    }

    /// Returns √(SSE/dof) of the ranges used: the residuals relative to their standard deviations,
    /// whatever the method that tested them. `None` without redundancy.
    pub fn misfit(&self) -> Option<f64> {
        let used = || self.satellites.iter().filter(|account| account.fate == Fate::Used);
        let square = |account: &Account| Some((account.residual_m? / account.sigma_m?).powi(2));
        let sse: f64 = used().filter_map(square).sum();
        let is_in =
            |system: &Constellation| used().any(|account| account.satellite.constellation() == *system);
        let systems = Constellation::all().filter(is_in).count();
        let dof = used().count().checked_sub(3 + systems).filter(|dof| *dof > 0)?;
        Some((sse / dof as f64).sqrt())
    }
}

/// Views of the epochs that a module has judged, until they are taken.
#[derive(Debug)]
pub struct Views {
    is_wanted: bool,
    views: Vec<View>,
}

impl Views {
    /// Returns an observer that stores views if they are wanted.
    pub const fn new(is_wanted: bool) -> Self {
        Self { is_wanted, views: Vec::new() }
    }

    /// Returns the views of the epochs since the last call.
    pub fn take(&mut self) -> Vec<View> {
        std::mem::take(&mut self.views)
    }
}

impl Observer for Views {
    fn epoch(&mut self, judged: &Judged<'_>) {
        if self.is_wanted {
            self.views.push(View::of(judged));
        }
    }

    fn without_epoch(&mut self, _: Verdict) {}
}

/// Returns for each output of the module its view of the epoch; `None` for a silence. The last view
/// belongs to the last epoch, and so on, because sentences may be rarer than epochs.
pub fn views_of<'v>(outputs: &[EpochOutput], views: &'v [View]) -> Vec<Option<&'v View>> {
    let mut views = views.iter().rev();
    let mut found: Vec<_> = outputs
        .iter()
        .rev()
        .map(|output| if output.state.has_epoch() { views.next() } else { None })
        .collect();
    found.reverse();
    found
}

/// Heading of a table with a row for each satellite of each epoch.
pub const HEADING: &str =
    "week,tow,satellite,azimuth_deg,elevation_deg,cn0_dbhz,residual_m,sigma_m,w_test,used,reason";

/// Returns the row of a satellite in the columns of [`HEADING`]. Unknown values are empty.
pub fn row(account: &Account, time: GpsTime) -> String {
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or_else(String::new, |value| format!("{value:.decimals$}"))
    };
    let degrees = |radians: Option<f64>| number(radians.map(f64::to_degrees), 2);
    format!(
        "{},{:.3},{},{},{},{},{},{},{},{},{}",
        time.week,
        f64::from(time.tow_ms) * 1e-3,
        account.satellite,
        degrees(account.azimuth_rad),
        degrees(account.elevation_rad),
        number(account.cn0_dbhz, 2),
        number(account.residual_m, 3),
        number(account.sigma_m, 3),
        number(account.w_test, 3),
        u8::from(account.fate == Fate::Used),
        account.fate
    )
}
