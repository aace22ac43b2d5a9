//! UBX: ranges that a u-blox receiver measured, and the navigation bits that it received.
//!
//! ```text
//! B5 62 | class, id | length u16 | payload | CK_A CK_B              all numbers with the low byte first
//! ```
//!
//! | message | class, id | content |
//! |---|---|---|
//! | RXM-RAWX | 02 15 | ranges of an epoch ([`rawx`]) |
//! | RXM-SFRBX | 02 13 | navigation bits ([`sfrbx`]), which [`super::navigation`] reads |
//! | SEC-SIG | 27 09 | jamming and spoofing ([`security`]) |
//! | SEC-SIGLOG | 27 10 | log of jamming and spoofing |
//! | MON-RF | 0a 38 | jamming |
//! | NAV-STATUS | 01 03 | spoofing, from receivers without SEC-SIG |
//! | NAV-SIG | 01 43 | number of authenticated signals |
//! | NAV-PL | 01 62 | protection levels of the receiver |
//!
//! These receivers send no ephemerides in RTCM, so that the navigation bits are the only source of
//! orbits. Enable at the receiver: `CFG-MSGOUT-UBX_RXM_RAWX`, `-UBX_RXM_SFRBX` and, if available,
//! `-UBX_SEC_SIG`, and 115200 baud or more.
//!
//! References: [UBX-F9], [UBX-M8].
//!
//! [UBX-F9]: crate#references
//! [UBX-M8]: crate#references

mod rawx;
mod security;
mod sfrbx;
mod transport;

use super::calendar::Calendar;
use super::navigation::Navigation;
use super::protocol::Frame;
use super::{Counters, Measured, Message, Ranges, Unread};
use crate::counters::count;

use rawx::Rawx;
pub(super) use transport::Ubx;

/// Reads one frame that passed its check. The result is `None` if the frame is one part of a
/// message whose other parts have not all come.
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
                #[cfg(feature = "sbf")]
                clock_jumps_ms: None,
                measured: Measured::Ubx(rawx),
            })))
        }
        [_, _, 0x02, 0x13, ..] => {
            let told = sfrbx::read(payload, navigation, frame.came_ms, calendar);
            counters.subframes_abandoned = navigation.abandoned();
            let told = told?;
            count(&mut counters.subframes);
            Ok(told)
        }
        [_, _, class, id, ..] => {
            let report = match (class, id) {
                (0x27, 0x09) => security::sec_sig(payload),
                (0x27, 0x10) => security::sec_siglog(payload),
                (0x0A, 0x38) => security::mon_rf(payload),
                (0x01, 0x03) => security::nav_status(payload),
                (0x01, 0x43) => security::nav_sig(payload),
                (0x01, 0x62) => security::nav_pl(payload),
                _ => Err(Unread::Other),
            };
            report.map(Message::SelfReport).map(Some)
        }
        _ => Err(Unread::Other),
    }
}
