//! The GPS week of a capture's first epoch, once for the whole file.
//!
//! | source | condition |
//! |---|---|
//! | the week of the first RXM-RAWX or `MeasEpoch` that has one | always, if there is one |
//! | the week on which the sets in the file agree in the end | the module corrected it on the way |
//! | the cycle of 1,024 weeks | the module takes a cycle in the future: the last past one |
//!
//! On a live line the module takes no week before April 2019, and decides as it reads. The
//! beginning of a file is read twice.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use raim_firmware::time::{GpsTime, WEEK_MS};

use crate::signal::pieces::{Kind, Piece};

/// The GPS epoch in Unix time: 1980-01-06 is day 3657.
const GPS_EPOCH: Duration = Duration::from_hours(24 * 3657);

/// Weeks of a cycle.
const CYCLE: u16 = 1024;

/// Returns the week of the first epoch, unless it is the one that the module takes.
pub(super) fn of(first: GpsTime, last: GpsTime, corrections: u32, stated: Option<u16>) -> Option<u16> {
    let agreed = if corrections > 0 { GpsTime::nearest(first.tow_ms, last).week } else { first.week };
    let week = stated.unwrap_or_else(|| not_after(agreed, this_week()));
    let is_steady = corrections == 0 && first.week == week;
    (!is_steady).then_some(week)
}

/// Returns the week that ranges state; `None` for another message, and for a receiver that does not
/// know it.
pub(super) fn stated(piece: &Piece<'_>) -> Option<u16> {
    // Behind six or eight bytes of header and the time of week.
    let place = match piece.kind {
        Kind::RAWX => 14..16,
        Kind::MEAS_EPOCH => 12..14,
        _ => return None,
    };
    // Behind them come the rest of the header and, of UBX, a checksum.
    let week: [u8; 2] = piece.bytes.get(..place.end + 8)?.get(place)?.try_into().ok()?;
    Some(u16::from_le_bytes(week)).filter(|&week| week > 0 && week < u16::MAX)
}

/// Returns the week or, if it is in the future, the same week of the last past cycle.
fn not_after(week: u16, present: u16) -> u16 {
    let cycles = week.saturating_sub(present).div_ceil(CYCLE);
    week.saturating_sub(cycles.saturating_mul(CYCLE))
}

/// Returns the week by the clock of this machine.
fn this_week() -> u16 {
    let since_unix = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let weeks = since_unix.saturating_sub(GPS_EPOCH).as_millis() / u128::from(WEEK_MS);
    u16::try_from(weeks).unwrap_or(u16::MAX)
}

#[cfg(test)]
mod tests {
    use super::{not_after, stated};
    use crate::signal::checksum::fletcher;
    use crate::signal::pieces::pieces;

    /// Returns an RXM-RAWX without measurements, of a receiver that states this week.
    fn rawx(week: u16) -> Vec<u8> {
        let mut checked = vec![0x02, 0x15, 16, 0];
        checked.extend(1000.0_f64.to_le_bytes());
        checked.extend(week.to_le_bytes());
        checked.extend([16, 0, 1, 1, 0, 0]);
        let check = fletcher(&checked);
        [&[0xB5, 0x62], &checked[..], &check].concat()
    }

    #[test]
    fn week_is_the_first_that_a_receiver_knows() {
        let bytes: Vec<u8> = [0, 1709, 1710].into_iter().flat_map(rawx).collect();
        assert_eq!(pieces(&bytes).find_map(|piece| stated(&piece)), Some(1709));
        assert_eq!(pieces(&rawx(0)).find_map(|piece| stated(&piece)), None);
    }

    #[test]
    fn checksum_of_a_short_message_is_no_week() {
        let checked = [&[0x02, 0x15, 9, 0][..], &[0; 9]].concat();
        let bytes = [&[0xB5, 0x62], &checked[..], &fletcher(&checked)].concat();
        assert_eq!(pieces(&bytes).find_map(|piece| stated(&piece)), None);
    }

    #[test]
    fn cycle_is_the_last_one_that_has_come() {
        // October 2012 is week 1709, and 2733 is in May 2032.
        assert_eq!([2733, 2446, 2447, 1709].map(|week| not_after(week, 2446)), [1709, 2446, 1423, 1709]);
        assert_eq!(not_after(5000, 2446), 1928);
    }
}
