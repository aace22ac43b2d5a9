//! RTCM 3: one frame to one message.
//!
//! What is read: MSM4 to MSM7 of GPS, GLONASS, Galileo, QZSS and `BeiDou`; 1019, 1020, 1042, 1044, 1045, 1046; 1005 and 1006. MSM of
//! the other systems are counted, and still say when an epoch is complete. Everything else is counted.
//!
//! The small messages are read by `rtcm-rs`, which checks them once more on the way.
//!
//! References: [RTCM-10403.3] 3.5.16 (MSM).
//!
//! [RTCM-10403.3]: crate#references

mod broadcast;
#[cfg(feature = "glonass")]
mod glonass;
mod msm;
mod qzss;
mod signals;

use rai_core::frame::Ecef;
use rtcm_rs::{Message as Small, MessageFrame};

use super::calendar::Calendar;
use super::{Message, Unread};

pub(super) use msm::Msm;

/// Reads one frame whose check is right.
pub(super) fn read<'a>(frame: &[u8], payload: &'a [u8], calendar: &Calendar) -> Result<Message<'a>, Unread> {
    match message_number(payload).ok_or(Unread::Malformed)? {
        1005 | 1006 => read_position(frame).map(Message::Position),
        1019 | 1042 | 1045 | 1046 => broadcast::read(&small(frame), calendar).map(Message::Broadcast),
        #[cfg(feature = "glonass")]
        1020 => glonass::read(payload, calendar).map(Message::State),
        1044 => qzss::read(payload, calendar).map(Message::Broadcast),
        number => msm::read(number, payload, calendar).map(Message::Ranges),
    }
}

/// The message number: the first twelve bits of the payload.
fn message_number(payload: &[u8]) -> Option<u16> {
    let [high, low] = *payload.first_chunk::<2>()?;
    Some(u16::from(high) << 4 | u16::from(low) >> 4)
}

/// The decoded message, by value: small while only the small messages are compiled in.
fn small(frame: &[u8]) -> Small {
    MessageFrame::new(frame).map_or(Small::Empty, |frame| frame.get_message())
}

#[inline(never)]
fn read_position(frame: &[u8]) -> Result<Ecef, Unread> {
    let position = match small(frame) {
        Small::Msg1005(m) => Ecef::new(
            m.antenna_ref_point_ecef_x_m,
            m.antenna_ref_point_ecef_y_m,
            m.antenna_ref_point_ecef_z_m,
        ),
        Small::Msg1006(m) => Ecef::new(
            m.antenna_ref_point_ecef_x_m,
            m.antenna_ref_point_ecef_y_m,
            m.antenna_ref_point_ecef_z_m,
        ),
        _ => return Err(Unread::Malformed),
    };
    // From the deepest sea to an aircraft, with room: farther out it is no receiver's place.
    if (6.3e6..=6.5e6).contains(&position.radius_m()) { Ok(position) } else { Err(Unread::Position) }
}
