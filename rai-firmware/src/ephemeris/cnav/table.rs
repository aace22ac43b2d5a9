//! What CNAV has said of every satellite, each with its age.

use raim_core::satellite::{Constellation, SatelliteId};

use super::{CnavContent, CnavFrame, SignalDelays, Word, bit};
use crate::raw::Band;

/// Number of satellites that have CNAV: 32 of GPS, 10 of QZSS.
const SATELLITES: usize = 42;

/// Instant by the module's own clock, 1.024 s; 0 for never.
type Instant = u32;

/// Longest time for which delays and bad health are kept: a day.
const KEPT: u32 = 86_400_000 >> 10;

/// Longest time for which good health counts: that of an ephemeris of LNAV, 2 h and a minute.
const GOOD: u32 = 7_260_000 >> 10;

const _: () = assert!(size_of::<Cnav>() <= 1024);

/// What CNAV has said of all satellites.
#[derive(Clone, Debug)]
pub(in crate::ephemeris) struct Cnav {
    satellites: [Heard; SATELLITES],
    now: Instant,
    /// True if L5 is used only where it is called healthy.
    needs_healthy_l5: bool,
}

/// What one satellite has said, and when.
#[derive(Clone, Copy, Debug)]
struct Heard {
    delays: SignalDelays,
    /// Bands out of service, one bit each, and [`ALERT`].
    flags: u8,
    delays_at: Instant,
    health_at: Instant,
    alert_at: Instant,
}

/// Flag of an alert, beside those of the bands.
const ALERT: u8 = 1 << 7;

/// Bands that type 10 reports on, in its order.
const BANDS: [Band; 3] = [Band::L1, Band::L2, Band::L5];

impl Heard {
    const NOTHING: Self =
        Self { delays: SignalDelays::NONE, flags: 0, delays_at: 0, health_at: 0, alert_at: 0 };
}

impl Default for Cnav {
    fn default() -> Self {
        Self::new()
    }
}

impl Cnav {
    pub(in crate::ephemeris) const fn new() -> Self {
        Self { satellites: [Heard::NOTHING; SATELLITES], now: 0, needs_healthy_l5: false }
    }

    /// Takes the time by the module's own clock, and the use of L5. Returns true if the use has
    /// changed.
    pub(in crate::ephemeris) fn prepare(&mut self, now_ms: u64, needs_healthy_l5: bool) -> bool {
        self.now = instant(now_ms);
        core::mem::replace(&mut self.needs_healthy_l5, needs_healthy_l5) != needs_healthy_l5
    }

    /// Stores what a frame says.
    pub(in crate::ephemeris) fn receive(&mut self, frame: &CnavFrame, now_ms: u64) {
        let now = instant(now_ms);
        self.now = now;
        let Some(heard) = place(frame.satellite).and_then(|place| self.satellites.get_mut(place)) else {
            return;
        };
        let alert = if frame.is_alert { ALERT } else { 0 };
        (heard.flags, heard.alert_at) = (heard.flags & !ALERT | alert, now);
        match frame.content {
            CnavContent::Health { out } => {
                let bits = BANDS.into_iter().zip(out).filter(|(_, is_out)| *is_out);
                let out = bits.fold(0, |out, (band, _)| out | bit(band) as u8);
                (heard.flags, heard.health_at) = (alert | out, now);
            }
            CnavContent::Delays(delays) => (heard.delays, heard.delays_at) = (delays, now),
            CnavContent::Other => {}
        }
    }

    /// Returns what is said of a satellite now.
    pub(in crate::ephemeris) fn word(&self, satellite: SatelliteId) -> Word<'_> {
        const L5: u16 = bit(Band::L5);
        let Some(heard) = place(satellite).and_then(|place| self.satellites.get(place)) else {
            return Word::NOTHING;
        };
        if heard.alert_at == 0 {
            // Every frame renews this, so that there was none. L5 is closed as below.
            return Word { closed: if self.needs_healthy_l5 { L5 } else { 0 }, ..Word::NOTHING };
        }
        let is_within = |at: Instant, limit| at != 0 && self.now.abs_diff(at) <= limit;
        let out = if is_within(heard.health_at, KEPT) { u16::from(heard.flags & !ALERT) } else { 0 };
        let l5_is_out = out & L5 != 0;
        let closed = if heard.flags & ALERT != 0 && is_within(heard.alert_at, KEPT) {
            u16::MAX
        } else if !self.needs_healthy_l5 {
            out & !L5
        } else if is_within(heard.health_at, GOOD) {
            out
        } else {
            out | L5
        };
        let delays = is_within(heard.delays_at, KEPT).then_some(&heard.delays);
        Word { delays, closed, l5_is_out }
    }
}

/// Returns the place of a satellite; `None` for one without CNAV.
const fn place(satellite: SatelliteId) -> Option<usize> {
    match (satellite.constellation(), satellite.number()) {
        (Constellation::Gps, number @ 1..=32) => Some(number as usize - 1),
        (Constellation::Gps, number @ 193..=202) => Some(number as usize - 161),
        _ => None,
    }
}

const fn instant(now_ms: u64) -> Instant {
    (now_ms >> 10) as u32 | 1
}
