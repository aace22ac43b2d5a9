//! Sentences for the host: NMEA 0183 v4.11 and the proprietary `PRAI` ones.
//!
//! One epoch is, in this order, `GNS`, `GSA` (one per system used, and another where it has more than 12
//! satellites), `GST`, `GBS` (where there is redundancy), `PRAIS`, and one `PRAIX` per excluded satellite.
//! `PRAIS` ends what every epoch has; without exclusions nothing follows it.
//!
//! | verdict | navigational status of `GNS` | fix mode of `GSA` | state of `PRAIS` |
//! |---|---|---|---|
//! | protected | `S` safe | 3 | `P` |
//! | alert | `U` unsafe | 1: a position that must not be used is no fix | `A` |
//! | unavailable, with a position | `C` caution | 3 | `U` |
//! | unavailable, no position | `V` not valid | no `GSA` | `U` |
//!
//! Decisions where the standard leaves room or its readers differ:
//!
//! - **Altitude** is the height above the WGS 84 ellipsoid, and the geoid separation is `0.0`. The module holds
//!   no geoid model; with an empty separation a reader (gpsd) would add its own and report a wrong height
//!   above the ellipsoid.
//! - **Mode of `GNS`** is one character, `A` or `N`. The standard gives each system its character, but gpsd reads
//!   the first only, and takes `N` there (no GPS) for no fix; the `nmea` crate refuses more than two. Which
//!   systems are used is told by the `GSA` sentences.
//! - **`GBS`** gives as expected errors the standard deviations of `GST`, which is how gpsd reads them. The
//!   satellite named is the one *used* that fits worst; what was left out is in `PRAIX`.
//! - **A number that does not fit** loses decimals; one that is infinite, or beyond its field, leaves the field
//!   empty (a protection level without bound is not defined), except that the dilutions of precision stop at
//!   99.99 and the test statistic at 99999, where only "large" matters.
//!
//! Every sentence has at most 82 characters, the line end included; numbers are formatted as fixed-point
//! integers, since formatting floats is large and slow on the target.
//!
//! References: NMEA 0183 v4.11; [GPSD-NMEA] "NMEA Revealed", gpsd project.

use embedded_io::Write;
use rai_core::report::{Report, Verdict};
use rai_core::requirements::Requirements;

use crate::time::GpsTime;

mod proprietary;
mod sentence;
mod standard;

pub use proprietary::{write_answer, write_counters, write_refusal, write_version};

pub use sentence::{MAX_LENGTH, Sentence, write_sentence};

/// GPS time minus UTC, s: the leap seconds since 1980. 18 since 2017-01-01 (IERS Bulletin C 52); none is announced.
pub const GPS_MINUS_UTC_S: u8 = 18;

/// Milliseconds in a day.
const DAY_MS: u64 = 86_400_000;

/// Time of day in UTC, rounded to a hundredth of a second, as the field `hhmmss.ss` needs it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeOfDay {
    centiseconds: u32,
}

impl TimeOfDay {
    /// The time of day in UTC at an instant of GPS time; `gps_minus_utc_s` is [`GPS_MINUS_UTC_S`] until the next
    /// leap second. A time that rounds up to midnight is midnight.
    pub fn new(time: GpsTime, gps_minus_utc_s: u8) -> Self {
        let utc_ms = time.to_ms().saturating_sub(u64::from(gps_minus_utc_s) * 1000);
        let centiseconds = ((utc_ms + 5) % DAY_MS) / 10;
        Self { centiseconds: centiseconds as u32 }
    }

    /// Hours, minutes, seconds, hundredths.
    pub const fn parts(self) -> [u32; 4] {
        let seconds = self.centiseconds / 100;
        [seconds / 3600, seconds / 60 % 60, seconds % 60, self.centiseconds % 100]
    }
}

/// Writes all sentences of one epoch.
///
/// # Errors
/// The writer's own; what was written before stays written.
pub fn write_epoch<W: Write, const N: usize>(
    report: &Report<N>,
    time: GpsTime,
    gps_minus_utc_s: u8,
    requirements: &Requirements,
    out: &mut W,
) -> Result<(), W::Error> {
    let time = TimeOfDay::new(time, gps_minus_utc_s);
    standard::write_position(report, time, out)?;
    standard::write_satellites(report, out)?;
    standard::write_errors(report, time, out)?;
    standard::write_suspect(report, time, requirements, out)?;
    proprietary::write_state(report, time, requirements, out)?;
    proprietary::write_exclusions(report, time, out)
}

/// Writes that no epoch came within the time to alert. `last` is the time of the last epoch, if there was one.
///
/// The standard sentences are left out: they would have to speak of a position that does not exist.
///
/// # Errors
/// The writer's own.
pub fn write_stale<W: Write>(
    last: Option<GpsTime>,
    gps_minus_utc_s: u8,
    requirements: &Requirements,
    out: &mut W,
) -> Result<(), W::Error> {
    let last = last.map(|time| TimeOfDay::new(time, gps_minus_utc_s));
    proprietary::write_staleness(last, requirements, out)
}

/// True for the verdict that the position must not be used.
fn is_alert(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Alert(_))
}
