//! Satellites of an epoch, one by one, by the module's own account, and its verdicts.
//!
//! ```text
//! module ─► Views ─► table of satellites, report, pages, dashboard
//! ```
//!
//! Nothing here is computed beside the module.

pub use raim_firmware::observer::{Account, Fate};
use raim_firmware::observer::{Judged, Observer, WithoutEpoch};
use raim_firmware::time::GpsTime;

use crate::verdict::EpochOutput;

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
}

/// A verdict of the module, as its observer saw it.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Verdict with its numbers.
    pub output: EpochOutput,
    /// SSE/dof of the ranges used, under every method; `None` without an epoch that passed its test.
    pub variance_ratio: Option<f64>,
    /// View of the epoch; `None` of a silence, and if nobody wants it.
    pub view: Option<View>,
    /// When the first byte of its ranges came, ms of the module's clock; `None` without an epoch.
    pub came_ms: Option<u64>,
}

/// Verdicts of a module, until they are taken.
#[derive(Debug)]
pub struct Views {
    is_watched: bool,
    seen: Vec<Seen>,
}

impl Views {
    /// Returns an observer that stores verdicts, and the satellites of their epochs if it watches
    /// them.
    pub const fn new(is_watched: bool) -> Self {
        Self { is_watched, seen: Vec::new() }
    }

    /// Stores satellites from now on.
    pub const fn watch(&mut self) {
        self.is_watched = true;
    }

    /// Returns the verdicts since the last call.
    pub fn take(&mut self) -> Vec<Seen> {
        std::mem::take(&mut self.seen)
    }
}

impl Observer for Views {
    fn epoch(&mut self, judged: &Judged<'_>) {
        self.seen.push(Seen {
            output: judged.into(),
            variance_ratio: judged.variance_ratio(),
            view: self.is_watched.then(|| View::of(judged)),
            came_ms: Some(judged.came_ms()),
        });
    }

    fn without_epoch(&mut self, judged: &WithoutEpoch<'_>) {
        self.seen.push(Seen { output: judged.into(), variance_ratio: None, view: None, came_ms: None });
    }
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

#[cfg(all(test, feature = "commands"))]
mod tests {
    use std::sync::Arc;

    use raim_firmware::receiver::{Boot, Receiver};

    use super::*;
    use crate::replay::{Window, encode};
    use crate::run::pin::{Pin, Place, Wire};
    use crate::signal::encode::{Frequency, Selection};
    use crate::signal::sky::raw::Simulation;

    /// The end of each epoch comes late, and the next one at once behind it, as on a busy line.
    #[test]
    fn epoch_came_with_the_first_byte_of_its_ranges() {
        let recording = Simulation::above_xian(3600.0, 5, 5).record();
        let selection = Selection::new("GC", Frequency::Dual).unwrap();
        let lumps = encode(&recording, &selection, &[], &Window::ALL).unwrap();
        let pin = Pin::new(Arc::new(Wire::open(&Place::Nowhere).unwrap()));
        let mut receiver = Receiver::observed(pin, Views::new(false), Boot::on_host("a test")).unwrap();
        let mut came = Vec::new();
        for (lump, now_ms) in lumps.iter().zip((1000..).step_by(1000)) {
            let (begin, end) = lump.bytes.split_at(lump.bytes.len() - 10);
            for (bytes, now_ms) in [(begin, now_ms), (end, now_ms + 990)] {
                receiver.gnss(bytes, now_ms, &mut Vec::new());
                came.extend(receiver.observer_mut().take().iter().filter_map(|seen| seen.came_ms));
            }
        }
        assert_eq!(came, [1000, 2000, 3000, 4000, 5000]);
    }
}
