//! Frames of CNAV as a u-blox receiver sends them: 300 bits in ten words, the last with 20 zeros.
//!
//! References: [IS-GPS-200] figures 30-1 and 30-3, 30.3.5.

use anyhow::Result;
use raim_core::satellite::SatelliteId;
use raim_firmware::time::GpsTime;

use super::bits::{Row, crc24q};

/// Content of a frame, as far as it is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CnavMessage {
    /// Type 10: L1, L2 and L5, each true if it is out of service.
    Health([bool; 3]),
    /// Type 30: `TGD`, and `ISC` of L1 C/A, L2C, I5 and Q5, 2⁻³⁵ s.
    Delays([i16; 5]),
    /// Another type, with zeros.
    Other(u8),
}

/// Returns the words of a frame that a satellite sends before `time`.
///
/// # Errors
/// A number does not fit its field.
pub fn cnav_words(
    satellite: SatelliteId,
    message: CnavMessage,
    is_alert: bool,
    time: GpsTime,
) -> Result<Vec<u32>> {
    let kind = match message {
        CnavMessage::Health(_) => 10,
        CnavMessage::Delays(_) => 30,
        CnavMessage::Other(kind) => kind,
    };
    let head = Row::default()
        .unsigned(0x8B, 8)?
        .unsigned(u64::from(satellite.number() % 64), 6)?
        .unsigned(u64::from(kind), 6)?
        .unsigned(u64::from(time.tow_ms / 6000), 17)?
        .unsigned(u64::from(is_alert), 1)?;
    let row = match message {
        CnavMessage::Health(out) => head.unsigned(u64::from(time.week), 13)?.then(&out),
        CnavMessage::Delays(steps) => {
            steps.into_iter().try_fold(head.until(127)?, |row, steps| row.signed(f64::from(steps), 13))?
        }
        CnavMessage::Other(_) => head,
    };
    sealed(row)
}

/// Returns the words of a row of at most 276 bits with its CRC.
pub(super) fn sealed(row: Row) -> Result<Vec<u32>> {
    let row = row.until(276)?;
    let crc = crc24q(row.bits());
    Ok(row.then(&crc).words())
}
