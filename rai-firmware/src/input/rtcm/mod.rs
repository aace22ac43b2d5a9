//! RTCM 3: one frame to one message.
//!
//! | messages | content |
//! |---|---|
//! | MSM4 to MSM7 of GPS, GLONASS, Galileo, QZSS, `BeiDou` | ranges |
//! | 1019, 1020, 1042, 1044, 1045, 1046 | ephemerides |
//! | 1013 | date, time of day in UTC, leap seconds |
//! | 1005, 1006 | position of the station |
//!
//! An MSM of another system only contributes its statement whether more messages follow. All other
//! messages only increment a counter.
//!
//! References: [RTCM-10403.3] 3.5.16 (MSM).
//!
//! [RTCM-10403.3]: crate#references

mod broadcast;
#[cfg(feature = "glonass")]
mod glonass;
mod msm;
mod signals;
mod transport;

use raim_core::frame::Ecef;

use super::bits::Bits;
use super::calendar::Calendar;
use super::{Message, Unread};

pub(super) use msm::Msm;
pub(super) use transport::Rtcm;

/// Reads the payload of a frame that passed its check.
fn read<'a>(payload: &'a [u8], calendar: &Calendar) -> Result<Message<'a>, Unread> {
    match message_number(payload).ok_or(Unread::Malformed)? {
        1005 => read_position(payload, 19).map(Message::Position),
        1006 => read_position(payload, 21).map(Message::Position),
        number @ (1019 | 1042 | 1044..=1046) => {
            broadcast::read(number, payload, calendar).map(Message::Broadcast)
        }
        #[cfg(feature = "glonass")]
        1013 => glonass::read_time(payload).map(|(time, leap_s)| Message::Time(time, leap_s)),
        #[cfg(feature = "glonass")]
        1020 => glonass::read(payload, calendar).map(Message::State),
        number => msm::read(number, payload, calendar).map(Message::Ranges),
    }
}

/// Returns the message number: the first twelve bits of the payload.
fn message_number(payload: &[u8]) -> Option<u16> {
    let [high, low] = *payload.first_chunk::<2>()?;
    Some(u16::from(high) << 4 | u16::from(low) >> 4)
}

/// Reads the position of the antenna in 1005 or 1006.
fn read_position(payload: &[u8], length: usize) -> Result<Ecef, Unread> {
    let bits = Bits(payload.get(..length).ok_or(Unread::Malformed)?);
    // A coordinate has 38 bits, in steps of 0.1 mm.
    let [x_m, y_m, z_m] = [34, 74, 114].map(|start| {
        let steps = i64::from(bits.signed(start, 6)) << 32 | i64::from(bits.unsigned(start + 6, 32));
        steps as f64 * 0.0001
    });
    let position = Ecef::new(x_m, y_m, z_m);
    // The range is from the deepest sea to an aircraft, with a margin.
    if (6.3e6..=6.5e6).contains(&position.radius_m()) { Ok(position) } else { Err(Unread::Position) }
}
