//! Sentences for the host: NMEA 0183 v4.11 and the proprietary `PRAI` ones.
//!
//! An epoch consists of these sentences, in this order:
//!
//! | sentence | sent |
//! |---|---|
//! | `RMC`, `GGA`, `GNS`, `VTG` | at its rate ([`super::schedule`]) |
//! | `ZDA` | at its rate, at most once a second |
//! | `GSA` | at its rate: one for each system used, and another for each 12 further satellites, not next to each other |
//! | `GST` | at its rate |
//! | `GBS` | at its rate, if there is redundancy |
//! | `PRAIS` | always |
//! | `PRAIX` | for each excluded satellite |
//! | `PRAIM` | if ARAIM judged |
//! | `PRAIH` | if a height is known |
//! | `PRAIE` | if the receiver reports authenticated signals or its own levels |
//! | `GSV` | at its rate; off at start |
//! | `PRAIN` | always; it ends the epoch |
//!
//! `GSV` is long and follows `PRAIS`. It therefore delays no verdict, and if the port is full,
//! `GSV` is lost and not the verdict.
//!
//! | verdict | navigational status of `GNS` | fix mode of `GSA` | state of `PRAIS` |
//! |---|---|---|---|
//! | protected | `S` safe | 3 | `P` |
//! | alert | `U` unsafe, mode `N`, no position | 1: a position that must not be used is no fix | `A` |
//! | unavailable, with a position | `C` caution | 3 | `U` |
//! | unavailable, no position | `V` not valid | no `GSA` | `U` |
//!
//! Decisions where the standard leaves a choice or readers differ:
//!
//! - **Altitude** is above mean sea level, as the standard requires, with the geoid separation of
//!   [`super::geoid`]. Their sum is the height above the WGS 84 ellipsoid.
//! - **Mode of `GNS`** is one character, `A` or `N`. The standard has a character for each system.
//!   But gpsd reads only the first, and takes `N` there (no GPS) for no fix; the `nmea` crate
//!   refuses more than two. The `GSA` sentences report the systems used.
//! - **`GBS`** reports the standard deviations of `GST` as expected errors, because gpsd interprets
//!   the fields so. Its satellite is the *used* one with the worst fit; excluded satellites are in
//!   `PRAIX`.
//! - **A number that does not fit** loses decimals. If it is infinite or still too large, the field
//!   is empty: an unbounded protection level is undefined. Dilutions of precision are limited to
//!   99.99 and the test statistic to 99999 instead, because beyond these only "large" matters.
//!
//! Every sentence has at most 82 characters, the line end included. Numbers are formatted as
//! fixed-point integers, because formatting floats is large and slow on the target.
//!
//! References: [NMEA-0183] v4.11; [GPSD-NMEA].
//!
//! [GPSD-NMEA]: crate#references
//! [NMEA-0183]: crate#references

use embedded_io::Write;
use raim_core::report::Verdict;
use raim_core::requirements::Requirements;

use super::Statement;
use super::schedule::{Due, Item};
use crate::time::GpsTime;

#[cfg(feature = "osnma")]
mod authentication;
mod digits;
#[cfg(feature = "observer")]
mod figures;
mod flow;
#[cfg(feature = "gsv")]
mod in_view;
mod position;
mod proprietary;
mod sentence;
mod standard;
mod time;

#[cfg(feature = "osnma")]
pub(crate) use authentication::{AuthenticationReport, write_authentication};
#[cfg(feature = "observer")]
pub use figures::Figures;
pub(crate) use flow::{Flow, write_flow};
pub use proprietary::{Losses, write_answer, write_counters, write_losses, write_refusal, write_version};
pub use sentence::{MAX_LENGTH, Sentence, write_sentence};
pub use time::{GPS_MINUS_UTC_S, TimeOfDay};

/// Writes the sentences of an epoch: those that are due, and those that are always sent.
///
/// # Errors
/// The writer's own; sentences before the error stay written.
pub fn write_epoch<W: Write, const N: usize>(
    statement: &Statement<'_, N>,
    due: Due,
    out: &mut W,
) -> Result<(), W::Error> {
    let time = TimeOfDay::new(statement.time, statement.gps_minus_utc_s);
    position::write_position(statement, time, due, out)?;
    if due.has(Item::Vtg) {
        position::write_velocity(statement, out)?;
    }
    // Without a usable position the time is not usable either, and `ZDA` has no mode to report
    // that.
    if due.has(Item::Zda) && statement.usable_solution().is_some() {
        write_sentence(&mut standard::date_and_time(time), out)?;
    }
    if due.has(Item::Gsa) {
        standard::write_satellites(statement, out)?;
    }
    if due.has(Item::Gst) {
        standard::write_errors(statement.report, time, out)?;
    }
    if due.has(Item::Gbs) {
        standard::write_suspect(statement.report, time, statement.requirements, out)?;
    }
    proprietary::write_state(statement, time, out)?;
    proprietary::write_exclusions(statement.report, time, out)?;
    if cfg!(feature = "araim")
        && let Some(separation) = &statement.report.araim
    {
        proprietary::write_separation(separation, time, out)?;
    }
    if cfg!(feature = "aiding")
        && let Some(height) = &statement.report.height
    {
        proprietary::write_height(height, time, out)?;
    }
    if cfg!(feature = "ubx") {
        proprietary::write_evidence(&statement.interference, statement.unhealthy_l5(), time, out)?;
    }
    #[cfg(feature = "gsv")]
    if let Some(view) = statement.in_view.filter(|_| due.has(Item::Gsv)) {
        in_view::write_in_view(&view, out)?;
    }
    proprietary::write_settings_and_interference(statement, time, out)
}

/// Writes a verdict without an epoch. `last` is the time of the last epoch, if there was one.
///
/// The standard sentences are left out, because they would describe a position that does not exist.
///
/// # Errors
/// The writer's own.
pub fn write_without_epoch<W: Write>(
    verdict: Verdict,
    last: Option<GpsTime>,
    gps_minus_utc_s: u8,
    requirements: &Requirements,
    out: &mut W,
) -> Result<(), W::Error> {
    let last = last.map(|time| TimeOfDay::new(time, gps_minus_utc_s));
    proprietary::write_without_epoch(verdict, last, requirements, out)
}
