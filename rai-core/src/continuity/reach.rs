//! Reach: can a receiver have moved from one position to another, and can it be expected there?
//!
//! **After a silence** longer than the time to alert, the first position must be where the receiver
//! can be expected. This is within `(1.5 u + 10 m/s) Δt` of the anchor, where `u` is the last
//! speed. If a position is farther away, the epochs must first agree for as long as the way takes
//! at the speed `v`. Otherwise, after ten minutes of silence, a position 300 km away would be
//! protected at once.

use crate::frame::Ecef;
use crate::numeric::sqrt;
use crate::report::ProtectionLevels;

/// Expected speed of a receiver: a sum of the first number, m/s, and the last speed times the
/// second, dimensionless.
const EXPECTED_M_S: (f64, f64) = (10.0, 1.5);

/// Last speed of a receiver whose velocity was never known, m/s.
const UNKNOWN_SPEED_M_S: f64 = 50.0;

/// Largest variation of the delay from an epoch to the caller's clock, s.
pub const DELAY_S: f64 = 1.0;

/// Time of an epoch by its tag and, if there is one, by the caller's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Instant {
    pub(super) epoch_s: f64,
    pub(super) own_s: Option<f64>,
}

impl Instant {
    /// Returns the time since an earlier instant, s; 0 if the time goes back.
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    pub(super) fn since_s(self, earlier: Self) -> f64 {
        let by_epochs_s = (self.epoch_s - earlier.epoch_s).max(0.0);
        match self.own_s.zip(earlier.own_s) {
            Some((own_s, earlier_s)) => by_epochs_s.min((own_s - earlier_s).max(0.0) + DELAY_S),
            None => by_epochs_s,
        }
    }
}

/// A position with the levels that bound its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BoundedPosition {
    pub(super) instant: Instant,
    pub(super) position: Ecef,
    pub(super) height_m: f64,
    pub(super) levels: ProtectionLevels,
}

impl BoundedPosition {
    /// Returns true if a receiver can have moved from `from` to this position. A NaN distance is
    /// beyond reach.
    pub(super) fn is_within_reach_of(&self, from: &Self, max_speed_m_s: f64) -> bool {
        let way_m = max_speed_m_s * self.instant.since_s(from.instant);
        let climb_m = (self.height_m - from.height_m).abs();
        let ground_m = across_m(self.position - from.position, climb_m);
        ground_m <= way_m + self.levels.hpl_m + from.levels.hpl_m
            && climb_m <= way_m + self.levels.vpl_m + from.levels.vpl_m
    }

    /// Returns the distance to an earlier position, m.
    pub(super) fn distance_m(&self, from: &Self) -> f64 {
        across_m(self.position - from.position, 0.0)
    }

    /// Returns how long the epochs must agree after a silence, s: 0 if the receiver is expected
    /// here, otherwise the time that the way takes at the highest speed. `speed_m_s` is the speed
    /// at the earlier position, if it is known.
    pub(super) fn wait_s(&self, from: &Self, speed_m_s: Option<f64>, max_speed_m_s: f64) -> f64 {
        let speed_m_s = speed_m_s.unwrap_or(UNKNOWN_SPEED_M_S);
        let (beyond_m_s, factor) = EXPECTED_M_S;
        let expected_m_s = (factor * speed_m_s + beyond_m_s).min(max_speed_m_s);
        if self.is_within_reach_of(from, expected_m_s) {
            return 0.0;
        }
        // If the highest speed is zero, the wait is infinite or NaN. It ends when the anchor is
        // forgotten.
        self.distance_m(from) / max_speed_m_s
    }
}

/// Returns the horizontal part of the way between two points, m. An accuracy of metres suffices,
/// because levels are no smaller.
fn across_m(way: Ecef, climb_m: f64) -> f64 {
    let [x, y, z, climb] = [way.x_m, way.y_m, way.z_m, climb_m].map(|length_m| length_m as f32);
    let squared = x * x + y * y + z * z - climb * climb;
    // A NaN square stays NaN, which is beyond reach.
    f64::from(sqrt(if squared < 0.0 { 0.0 } else { squared }))
}
