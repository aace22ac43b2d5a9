//! From one raw epoch to one report: satellites located, ranges corrected, integrity judged.
//!
//! Corrections depend on where the receiver is, and that is what they are for. The last position is the first
//! guess; without one, a coarse fix without atmosphere finds it. An epoch whose position turns out to be far from
//! the guess is corrected once more about what was found.

use rai_core::frame::Ecef;
use rai_core::monitor::MonitorError;
use rai_core::report::{Report, Unavailable, Verdict};
use rai_core::requirements::Requirements;
use rai_core::single::{self, Monitor};

use crate::config::Configuration;
use crate::correction::{CAPACITY, Site, Sky, Tally, coarse, locate};
use crate::ephemeris::{Ephemeris, Insertion, Store};
use crate::rtcm::RawEpoch;
use crate::time::GpsTime;

/// Within this distance corrections hold: 1 km changes an elevation by 0.003° and the zenith delay by at most 0.25 m.
const GUESS_HOLDS_M: f64 = 1e3;

/// Closer to the centre of the earth than this is no receiver: the position is unknown.
const UNKNOWN_RADIUS_M: f64 = 6e6;

/// Guess, better guess, and one more after a gross fault bent the first.
const MAX_PASSES: usize = 3;

/// Orbits, monitor and counters: everything between a raw epoch and its report.
#[derive(Debug)]
pub struct Navigator {
    store: Store,
    monitor: Monitor,
    tally: Tally,
}

impl Navigator {
    /// A navigator without ephemerides.
    ///
    /// # Errors
    /// [`MonitorError`] names the requirement that cannot be met.
    pub fn new(requirements: Requirements) -> Result<Self, MonitorError> {
        Ok(Self { store: Store::new(), monitor: Monitor::new(requirements)?, tally: Tally::default() })
    }

    /// Takes an ephemeris that was received at `now`.
    pub fn learn(&mut self, ephemeris: Ephemeris, now: Option<GpsTime>) -> Insertion {
        self.store.insert(ephemeris, now)
    }

    /// Takes a first guess of the position. It counts for nothing once there is a fix.
    pub fn guess(&mut self, point: Ecef) {
        if is_unknown(self.monitor.start()) {
            self.monitor.start_from(point);
        }
    }

    /// Takes the requirements and the strategy of a configuration.
    ///
    /// # Errors
    /// As [`Self::new`]; nothing has changed then.
    pub fn configure(&mut self, configuration: &Configuration) -> Result<(), MonitorError> {
        self.monitor.require(configuration.requirements)?;
        self.monitor.pursue(configuration.strategy());
        Ok(())
    }

    /// What is judged by.
    pub fn requirements(&self) -> &Requirements {
        self.monitor.requirements()
    }

    /// What became of the satellites so far.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Judges one epoch.
    ///
    /// Not inlined: it needs the stack that the sentences need later.
    #[inline(never)]
    pub fn judge(&mut self, raw: &RawEpoch, configuration: &Configuration) -> Report<CAPACITY> {
        let sky = locate(raw, &self.store, &mut self.tally);
        let mut guess = self.monitor.start();
        if is_unknown(guess) {
            guess = look_around(&sky, raw.time);
        }
        let before = self.tally.ranges;
        let mut report = self.judge_about(guess, &sky, raw.time, configuration);
        for _ in 1..MAX_PASSES {
            let found = report.solution.as_ref().map(|solution| solution.position);
            if found.is_some_and(|found| found.distance_m(guess) <= GUESS_HOLDS_M) {
                break;
            }
            guess = found.unwrap_or_else(|| look_around(&sky, raw.time));
            // What was refused about the poorer point does not count.
            self.tally.ranges = before;
            report = self.judge_about(guess, &sky, raw.time, configuration);
        }
        let implausible = self.tally.ranges.range_implausible != before.range_implausible;
        if report.solution.is_none() && implausible {
            report.verdict = Verdict::Unavailable(Unavailable::Input);
        }
        report.tracked = raw.satellites.len().min(255) as u8;
        report
    }

    /// Corrects and judges the sky as seen from a point.
    ///
    /// Not inlined: so the epoch leaves the stack with the judgement.
    #[inline(never)]
    fn judge_about(
        &mut self,
        point: Ecef,
        sky: &Sky,
        time: GpsTime,
        configuration: &Configuration,
    ) -> Report<CAPACITY> {
        let site = Site::new(point, time, configuration.mask_rad, configuration.klobuchar);
        let epoch = site.correct(sky, &mut self.tally.ranges);
        self.monitor.start_from(point);
        single::process(&mut self.monitor, &epoch)
    }
}

fn is_unknown(point: Ecef) -> bool {
    point.radius_m() < UNKNOWN_RADIUS_M
}

/// Roughly where a receiver is that sees this sky; the centre of the earth if that cannot be told.
fn look_around(sky: &Sky, time: GpsTime) -> Ecef {
    single::position(&coarse(sky, time), Ecef::CENTRE).unwrap_or(Ecef::CENTRE)
}
