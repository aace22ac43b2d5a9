//! The instant that a message states: a week number, which rolls over, and a second of that week.
//!
//! | system | bits | week 0 is | rolls over |
//! |---|---|---|---|
//! | GPS | 10 | in the cycle nearest to the known time | every 1,024 weeks |
//! | Galileo | 12 | GPS week 1,024 | in 2078 |
//! | `BeiDou` | 13 | GPS week 1,356, 14 s later | in 2163 |
//!
//! The week number is that of transmission ([IS-GPS-200] 20.3.3.3.1.1), but many programs send the
//! week of `toe`. Near the end of a week the two differ. [`super::roll_over`] decides; this module
//! combines the two numbers as stated.
//!
//! [IS-GPS-200]: crate#references

use raim_core::satellite::Constellation;

use crate::time::{BEIDOU_OFFSET_MS, BEIDOU_WEEK_OFFSET, GALILEO_WEEK_OFFSET, GpsTime, WEEK_MS};

/// First week that a GPS ephemeris can mean if no time is known: 2019-04-07, the third cycle of GPS
/// weeks.
///
/// The choice is right until 2038-11-20. It is not needed if there is a Galileo or `BeiDou`
/// ephemeris.
pub const NOT_BEFORE_WEEK: u16 = 2048;

/// Week number of a message.
#[derive(Clone, Copy, Debug)]
pub(in crate::input) struct MessageWeek {
    pub(in crate::input) constellation: Constellation,
    pub(in crate::input) week: u16,
}

impl MessageWeek {
    /// Returns the instant at `tow_s` of the stated week, in the time of the system. `known`
    /// chooses the cycle of a GPS week.
    pub(super) fn stated(self, tow_s: u32, known: Option<GpsTime>) -> Option<GpsTime> {
        let tow_ms = tow_s.checked_mul(1000).filter(|tow_ms| *tow_ms < WEEK_MS)?;
        let own = GpsTime { week: self.full_week(known)?, tow_ms };
        Some(own.later_by_ms(behind_gps_ms(self.constellation)))
    }

    /// Returns the week without roll-over; `None` for a system that counts no weeks, as GLONASS.
    fn full_week(self, known: Option<GpsTime>) -> Option<u16> {
        match self.constellation {
            Constellation::Beidou => Some(self.week.saturating_add(BEIDOU_WEEK_OFFSET)),
            Constellation::Galileo => Some(self.week.saturating_add(GALILEO_WEEK_OFFSET)),
            Constellation::Gps => Some(gps_week(self.week % 1024, known)),
            _ => None,
        }
    }
}

/// Returns the lag of a system's time behind GPS time, ms.
pub(super) const fn behind_gps_ms(system: Constellation) -> u32 {
    match system {
        Constellation::Beidou => BEIDOU_OFFSET_MS,
        _ => 0,
    }
}

/// Returns the week that is `week` modulo 1,024 and nearest to the known one.
fn gps_week(week: u16, known: Option<GpsTime>) -> u16 {
    let first = known.map_or(NOT_BEFORE_WEEK, |known| known.week.saturating_sub(512));
    first.saturating_add(week.wrapping_sub(first) % 1024)
}

#[cfg(test)]
mod tests {
    use super::*;
    use Constellation::{Beidou, Galileo, Glonass, Gps};

    const KNOWN: GpsTime = GpsTime { week: 2111, tow_ms: WEEK_MS - 600_000 };

    fn stated(constellation: Constellation, week: u16, tow_s: u32) -> Option<GpsTime> {
        MessageWeek { constellation, week }.stated(tow_s, Some(KNOWN))
    }

    #[test]
    fn weeks_of_all_systems_are_those_of_gps() {
        let noon = GpsTime { week: 2111, tow_ms: 300_000_000 };
        assert_eq!(stated(Gps, 2111 - 2048, 300_000), Some(noon));
        assert_eq!(stated(Galileo, 2111 - 1024, 300_000), Some(noon));
        assert_eq!(stated(Beidou, 2111 - 1356, 300_000 - 14), Some(noon));
        assert_eq!(stated(Glonass, 2111, 300_000), None);
        assert_eq!(stated(Gps, 63, 604_800), None);
    }

    #[test]
    fn gps_week_is_of_the_cycle_nearest_to_the_known_time() {
        let week = |week: u16, known: Option<u16>| {
            let known = known.map(|week| GpsTime { week, tow_ms: 0 });
            MessageWeek { constellation: Gps, week }.stated(0, known).map(|stated| stated.week)
        };
        assert_eq!(week(685, Some(1700)), Some(1709));
        assert_eq!(week(685, None), Some(2733));
        assert_eq!(week(0, Some(3071)), Some(3072));
        assert_eq!(week(1023, Some(3072)), Some(3071));
        assert_eq!(week(1023, Some(2048)), Some(2047));
    }
}
