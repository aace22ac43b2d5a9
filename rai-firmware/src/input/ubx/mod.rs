//! UBX: what a u-blox receiver measured, and the navigation bits it heard.
//!
//! ```text
//! B5 62 | class, id | length u16 | payload | CK_A CK_B              all numbers with the low byte first
//! ```
//!
//! | message | class, id | becomes |
//! |---|---|---|
//! | RXM-RAWX | 02 15 | the ranges of an epoch ([`rawx`]) |
//! | RXM-SFRBX | 02 13 | pages of navigation messages; when a set is complete, an ephemeris ([`sfrbx`]) |
//! | SEC-SIG | 27 09 | jamming and spoofing ([`security`]) |
//! | NAV-STATUS | 01 03 | spoofing, by receivers that have no SEC-SIG |
//!
//! These receivers send no ephemerides in RTCM: the bits are where orbits come from. To be switched
//! on at the receiver: `CFG-MSGOUT-UBX_RXM_RAWX`, `-UBX_RXM_SFRBX` and, where there is one,
//! `-UBX_SEC_SIG`, and 115200 baud or more.
//!
//! References: [UBX-F9], [UBX-M8].
//!
//! [UBX-F9]: crate#references
//! [UBX-M8]: crate#references

mod beidou;
mod galileo;
#[cfg(feature = "glonass")]
mod glonass;
mod leap;
mod lnav;
mod pages;
mod parity;
mod rawx;
mod security;
mod sfrbx;
mod transport;

use super::calendar::Calendar;
use super::protocol::Frame;
use super::{Counters, Measured, Message, Ranges, Unread};
use crate::counters::count;

use rawx::Rawx;
use sfrbx::Navigation;
pub(super) use transport::Ubx;

/// Reads one frame whose check is right; `None` when it only adds to what others have said.
fn read<'a>(
    frame: &Frame<'a>,
    navigation: &mut Navigation,
    calendar: &Calendar,
    counters: &mut Counters,
) -> Result<Option<Message<'a>>, Unread> {
    let payload = transport::payload(frame);
    match *frame.bytes {
        [_, _, 0x02, 0x15, ..] => {
            let rawx = Rawx::new(payload)?;
            Ok(Some(Message::Ranges(Ranges {
                station: 0,
                series: None,
                tow_ms: Some(rawx.time.tow_ms),
                of_utc_ms: None,
                stated: Some((rawx.time, rawx.leap_s)),
                more_follow: false,
                measured: Measured::Ubx(rawx),
            })))
        }
        [_, _, 0x02, 0x13, ..] => {
            let told = navigation.read(payload, frame.came_ms, calendar);
            counters.subframes_abandoned = navigation.abandoned();
            let told = told?;
            count(&mut counters.subframes);
            Ok(told)
        }
        [_, _, 0x27, 0x09, ..] => security::sec_sig(payload).map(Message::Jamming).map(Some),
        [_, _, 0x01, 0x03, ..] => security::nav_status(payload).map(Message::Jamming).map(Some),
        _ => Err(Unread::Other),
    }
}

/// Why a frame of navigation bits leads to nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Refusal {
    /// A page that is none: wrong preamble, flags or number of words.
    Malformed,
    /// A parity or CRC is wrong.
    Parity,
    /// Pages of different issues.
    Mixed,
    /// A value that no satellite sends.
    Value,
}
