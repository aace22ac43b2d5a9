//! CNAV of GPS and QZSS, on L2C and L5: frames of 300 bits. Each is complete by itself.
//!
//! | type | fields |
//! |---|---|
//! | all | preamble 0 (8), PRN 8 (6), type 14 (6), alert 37 (1), CRC-24Q 276 (24) |
//! | 10 | L1, L2, L5 out of service 51, 52, 53 (1 each) |
//! | 30 | TGD, ISC of L1 C/A, L2C, I5, Q5 from 127 on (13 each), 2⁻³⁵ s |
//!
//! A number of QZSS has the lower six bits of its PRN, 193 to 202. Orbits and clocks of types 10,
//! 11 and 30 to 37 are not read, because LNAV has them.
//!
//! References: [IS-GPS-200] 30.3, figures 30-1 to 30-13; [IS-GPS-705] 20.3; [IS-QZSS-PNT] 4.3.
//!
//! [IS-GPS-200]: crate#references
//! [IS-GPS-705]: crate#references
//! [IS-QZSS-PNT]: crate#references

use super::Refusal;
use super::message::{NavigationMessage, Reader};
use crate::ephemeris::{CnavContent, CnavFrame, SignalDelays};
use crate::input::bits::{Bits, Packed};
use crate::input::crc24q::crc24q;
use crate::input::{Message, Unread};

/// First eight bits of every frame.
const PREAMBLE: u32 = 0x8B;

/// Zeros in front of a frame, which fill whole bytes and do not change the CRC.
const FILL: usize = 4;

/// Bits of the last word that belong to the frame.
const LAST: usize = 12;

/// CNAV.
pub(super) struct Cnav;

impl NavigationMessage for Cnav {
    const WORDS: usize = 10;
    const PAGE_BYTES: usize = 38;
    const PAGES: usize = 1;

    fn read<'a>(reader: &mut Reader<'_>) -> Result<Option<Message<'a>>, Unread> {
        let satellite = reader.transmission.satellite;
        let bytes = frame(reader.words()?);
        if crc24q(&bytes) != 0 {
            return Err(Refusal::Parity.into());
        }
        let at = |start, width| Bits(&bytes).unsigned(FILL + start, width);
        // A receiver that mixes its channels would give one satellite the delays of another.
        if at(0, 8) != PREAMBLE || at(8, 6) != u32::from(satellite.number() & 63) {
            return Err(Refusal::Malformed.into());
        }
        let is_set = |position| at(position, 1) == 1;
        let content = match at(14, 6) {
            10 => CnavContent::Health { out: [51, 52, 53].map(is_set) },
            30 => CnavContent::Delays(SignalDelays {
                steps: [127, 140, 153, 166, 179].map(|start| Bits(&bytes).signed(FILL + start, 13) as i16),
            }),
            _ => CnavContent::Other,
        };
        Ok(Some(Message::Cnav(CnavFrame { satellite, is_alert: is_set(37), content })))
    }
}

/// Returns the 300 bits behind zeros.
fn frame(words: &[u32; Cnav::WORDS]) -> [u8; Cnav::PAGE_BYTES] {
    let mut packed = Packed::new();
    packed.push(0, FILL);
    for (index, &word) in words.iter().enumerate() {
        let unused = if index + 1 == Cnav::WORDS { 32 - LAST } else { 0 };
        packed.push(word >> unused, 32 - unused);
    }
    packed.bytes
}
