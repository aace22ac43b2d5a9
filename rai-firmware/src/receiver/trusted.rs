//! Time from the host, by which a recorded sky is told from a present one.
//!
//! ```text
//! |t_epoch − t_host| > b + 250 ppm × (now − came)     alert: the signals are recorded
//! ```
//!
//! | symbol | what | unit |
//! |---|---|---|
//! | `t_host` | the time of the command `TRUST`, carried on by the module's clock | s |
//! | `b` | its bound, which covers the delays of command and epoch | s |
//!
//! A tag is proof only if its words came before its key was public, 30 s later, or 330 s for a tag
//! with a later key. Within those bounds tags therefore count; beyond them they show consistency, and
//! the age of the sky is unknown.

use crate::osnma::Proof;
use crate::time::GpsTime;

/// 1980-01-06 in UNIX time, s.
const GPS_EPOCH_UNIX_S: f64 = 315_964_800.0;

/// Largest error of the module's clock.
const DRIFT: f64 = 250e-6;

/// Bounds within which all tags, and those with a later key, are proof, s.
const ALL_S: f64 = 30.0;
const SLOW_S: f64 = 330.0;

/// Time that the host has given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Trusted {
    /// UTC, s of UNIX time, and its bound, s.
    pub(super) utc_s: f64,
    pub(super) bound_s: f64,
    pub(super) came_ms: u64,
}

impl Trusted {
    /// Returns the bound at a time, s.
    pub(super) fn bound_s(&self, now_ms: u64) -> f64 {
        self.bound_s + DRIFT * self.elapsed_s(now_ms).abs()
    }

    /// Returns true if an epoch that came at `came_ms` is not of the present.
    pub(super) fn contradicts(&self, time: GpsTime, came_ms: u64, gps_minus_utc_s: u8) -> bool {
        let present_s = self.utc_s - GPS_EPOCH_UNIX_S + f64::from(gps_minus_utc_s) + self.elapsed_s(came_ms);
        let apart_s = time.to_ms() as f64 * 1e-3 - present_s;
        !(apart_s.abs() <= self.bound_s(came_ms))
    }

    /// Returns the tags that are proof.
    pub(super) fn proof(&self, now_ms: u64) -> Proof {
        let bound_s = self.bound_s(now_ms);
        if bound_s < ALL_S {
            Proof::All
        } else if bound_s < SLOW_S {
            Proof::Slow
        } else {
            Proof::None
        }
    }

    fn elapsed_s(&self, now_ms: u64) -> f64 {
        (now_ms as f64 - self.came_ms as f64) * 1e-3
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2025-02-15 12:00:00 UTC is second 561,618 of week 2353 of GPS time.
    const NOON: Trusted = Trusted { utc_s: 1_739_620_800.0, bound_s: 5.0, came_ms: 1000 };

    fn at(tow_s: f64) -> GpsTime {
        GpsTime { week: 2353, tow_ms: (tow_s * 1e3) as u32 }
    }

    #[test]
    fn a_sky_off_by_more_than_the_bound_is_no_sky_of_the_present() {
        for (tow_s, want) in
            [(561_618.0, false), (561_613.1, false), (561_622.9, false), (561_612.9, true), (561_658.0, true)]
        {
            assert_eq!(NOON.contradicts(at(tow_s), 1000, 18), want, "{tow_s} s");
            assert_eq!(NOON.contradicts(at(tow_s + 60.0), 61_000, 18), want, "{tow_s} s, a minute later");
        }
        assert!(Trusted { utc_s: f64::NAN, ..NOON }.contradicts(at(561_618.0), 1000, 18));
    }

    #[test]
    fn the_bound_grows_by_the_drift_of_the_clock() {
        // A second in 4,000.
        assert!(!NOON.contradicts(at(561_618.0 + 4005.9), 4_001_000, 18));
        for (hours, want) in
            [(0, Proof::All), (27, Proof::All), (28, Proof::Slow), (361, Proof::Slow), (362, Proof::None)]
        {
            assert_eq!(NOON.proof(1000 + hours * 3_600_000), want, "{hours} h");
        }
    }
}
