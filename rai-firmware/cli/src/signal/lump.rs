//! One lump: the bytes that a receiver would send for an epoch.

use raim_firmware::time::GpsTime;

/// Bytes of one epoch.
#[derive(Clone, Debug, PartialEq)]
pub struct Lump {
    /// Time tag of the epoch.
    pub time: GpsTime,
    /// Seconds after the first epoch of the recording.
    pub elapsed_s: f64,
    /// New ephemerides, then ranges, in any format that the module reads.
    pub bytes: Vec<u8>,
}

impl Lump {
    /// Returns the time after the first epoch of the recording, ms.
    pub fn elapsed_ms(&self) -> u64 {
        (self.elapsed_s * 1e3).round() as u64
    }
}
