//! What satellites say of their signals by CNAV: delays between them, and their health.

use raim_core::satellite::SatelliteId;

use super::Store;
use crate::ephemeris::Word;
#[cfg(feature = "cnav")]
use crate::ephemeris::cnav::CnavFrame;

impl Store {
    /// Stores what a frame of CNAV says, which came at `now_ms` by the module's own clock.
    #[cfg(feature = "cnav")]
    pub fn hear_cnav(&mut self, frame: &CnavFrame, now_ms: u64) {
        self.cnav.receive(frame, now_ms);
    }

    /// Takes the time by the module's own clock, and whether L5 is used only where it is called
    /// healthy. Returns true if that has changed.
    #[cfg(feature = "cnav")]
    pub(crate) fn prepare(&mut self, now_ms: u64, needs_healthy_l5: bool) -> bool {
        self.cnav.prepare(now_ms, needs_healthy_l5)
    }

    /// Returns what CNAV says of a satellite.
    #[cfg(feature = "cnav")]
    pub(crate) fn word(&self, satellite: SatelliteId) -> Word<'_> {
        self.cnav.word(satellite)
    }

    /// Returns a word that says nothing.
    #[cfg(not(feature = "cnav"))]
    pub(crate) const fn word(&self, _: SatelliteId) -> Word<'_> {
        Word::NOTHING
    }
}
