//! Time from the host, by which a recorded sky is told from a present one.
//!
//! ```text
//! |t_epoch − t_host| > b + 250 ppm × (now − came) + s     alert: the signals are recorded
//! ```
//!
//! | symbol | what | unit |
//! |---|---|---|
//! | `t_host` | the time of the command `TRUST`, carried on by the module's clock | s |
//! | `b` | its bound, which covers the delays of command and epoch | s |
//! | `s` | a second within half a day of a midnight at which one may be inserted, else zero | s |
//!
//! Where a second is inserted, UTC says one time twice, clocks of hosts differ in how they tell it, and
//! the receiver may say GPS time minus UTC late.
//!
//! A tag is proof only if its words came before its key was public, 30 s later, or 330 s for a tag
//! with a later key. Within those bounds tags therefore count; beyond them they show consistency, and
//! the age of the sky is unknown.

use crate::input::begins_half_year;
use crate::osnma::Proof;
use crate::time::GpsTime;

/// 1980-01-06 in UNIX time, s.
const GPS_EPOCH_UNIX_S: f64 = 315_964_800.0;

const DAY_MS: u32 = 86_400_000;

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
        // The day whose first midnight is nearest.
        let nearest_day = 7 * u32::from(time.week) + (time.tow_ms + DAY_MS / 2) / DAY_MS;
        let inserted_s = if begins_half_year(nearest_day) { 1.0 } else { 0.0 };
        !(apart_s.abs() <= self.bound_s(came_ms) + inserted_s)
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
        now_ms.wrapping_sub(self.came_ms).cast_signed() as f64 * 1e-3
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

    /// UNIX time of 2027-07-01 00:00 UTC (`date -u -d 2027-07-01 +%s`), before which a second may be
    /// inserted. GPS time is 18 s ahead of UTC before it and 19 s behind it.
    const MIDNIGHT_UNIX_S: f64 = 1_814_400_000.0;

    #[test]
    fn an_inserted_second_is_no_replay() {
        /// UNIX time of the order, s after midnight; its coming, s after the inserted second; when the
        /// receiver knows of that; age of the sky, s.
        struct Case(f64, f64, f64, f64, bool);
        for (number, Case(trust_s, ordered_s, known_s, late_s, want)) in [
            // Ordered before, known at once and late.
            Case(-300.0, -301.0, 0.0, 0.0, false),
            Case(-300.0, -301.0, 200.0, 0.0, false),
            // Ordered in it, by clocks that repeat 23:59:59 and 00:00:00.
            Case(-0.5, -0.5, 0.0, 0.0, false),
            Case(0.5, -0.5, 0.0, 0.0, false),
            // Ordered behind it, known late.
            Case(60.0, 60.0, 200.0, 0.0, false),
            // A smeared clock, which is half a second off.
            Case(-300.5, -301.0, 0.0, 0.0, false),
            // Skies of another time, near it and a day off.
            Case(-300.0, -301.0, 0.0, 3.0, true),
            Case(-300.0, -301.0, 0.0, -4.0, true),
            Case(86_400.0, 86_400.0, 0.0, 1.5, true),
            Case(-86_400.0, -86_401.0, 0.0, 1.5, true),
        ]
        .into_iter()
        .enumerate()
        {
            // The least bound that the order takes, and the delay of an epoch.
            let trusted = Trusted { utc_s: MIDNIGHT_UNIX_S + trust_s, bound_s: 1.0, came_ms: 1000 };
            for second in 0_u32..600 {
                let after_s = ordered_s + f64::from(second);
                let gps_s = MIDNIGHT_UNIX_S - GPS_EPOCH_UNIX_S + 19.0 + after_s - 0.3 - late_s;
                let time = GpsTime::from_ms((gps_s * 1e3) as u64);
                let leap_s = if after_s >= known_s { 19 } else { 18 };
                let came_ms = 1000 + 1000 * u64::from(second);
                let have = trusted.contradicts(time, came_ms, leap_s);
                assert_eq!(have, want, "case {number}, {after_s} s");
            }
        }
    }
}
