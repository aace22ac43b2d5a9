//! Frames of RTCM 3.
//!
//! ```text
//! D3 | 000000 | length (10 bit) | payload (0 to 1023 bytes) | CRC-24Q over all before (24 bit)
//! ```
//!
//! Reference: [RTCM-10403.3] 4.
//!
//! [RTCM-10403.3]: crate#references

use super::Msm;
use crate::input::calendar::Calendar;
use crate::input::crc24q::crc24q;
use crate::input::protocol::{Extent, Frame, Protocol, Shared};
use crate::input::{Counters, Message, Unread};

/// Bytes before the payload.
const HEADER: usize = 3;

/// Bytes of the CRC after the payload.
const PARITY: usize = 3;

/// Format of RTCM 3.
#[derive(Debug)]
pub(in crate::input) struct Rtcm;

impl Protocol for Rtcm {
    const SYNC: &'static [u8] = &[0xD3];
    const LONGEST: usize = HEADER + 1023 + PARITY;

    type Memory = ();

    type Ranges<'a> = Msm<'a>;

    fn at_start() {}

    fn length(bytes: &[u8]) -> Extent {
        match *bytes {
            [_, high, low, ..] if high & 0b1111_1100 == 0 => {
                Extent::Bytes(HEADER + (usize::from(high) << 8 | usize::from(low)) + PARITY)
            }
            [_] | [_, _] => Extent::Unknown,
            _ => Extent::NoFrame,
        }
    }

    fn check(frame: &[u8]) -> bool {
        crc24q(frame) == 0
    }

    fn read<'a>(
        frame: &Frame<'a>,
        (): &mut (),
        _: &mut Shared,
        calendar: &Calendar,
        _: &mut Counters,
    ) -> Result<Option<Message<'a>>, Unread> {
        Self::read_alone(frame, calendar)
    }
}

impl Rtcm {
    /// Reads a frame that passed its check. No message of RTCM needs another one.
    pub(in crate::input) fn read_alone<'a>(
        frame: &Frame<'a>,
        calendar: &Calendar,
    ) -> Result<Option<Message<'a>>, Unread> {
        super::read(payload(frame), calendar).map(Some)
    }
}

/// Returns the bytes between the header and the CRC.
pub(super) fn payload<'a>(frame: &Frame<'a>) -> &'a [u8] {
    frame.between(HEADER, PARITY)
}
