//! Reach: can a receiver have moved from one position to another, and can it be expected there?
//!
//! **After a silence** longer than the time to alert, the first position must be where the receiver
//! can be expected. This is within `(1.5 u + 10 m/s) Δt` of the anchor, where `u` is the last
//! speed. If a position is farther away, the epochs must first agree for as long as the way takes
//! at the speed `v`. Otherwise, after ten minutes of silence, a position 300 km away would be
//! protected at once.

use crate::frame::Ecef;
use crate::numeric::sqrt;

/// Expected speed of a receiver: a sum of the first number, m/s, and the last speed times the
/// second, dimensionless.
const EXPECTED_M_S: (f32, f32) = (10.0, 1.5);

/// Last speed of a receiver whose velocity was never known, m/s.
const UNKNOWN_SPEED_M_S: f32 = 50.0;

/// Shortest time between two positions that tells a speed, s.
const SHORTEST_S: f32 = 0.01;

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
    pub(super) height_m: f32,
    /// Horizontal and vertical level, m.
    pub(super) levels_m: [f32; 2],
}

impl BoundedPosition {
    /// Returns true if a receiver can have moved from `from` to this position. A NaN distance is
    /// beyond reach.
    // Single precision suffices, because levels are no smaller than metres.
    pub(super) fn is_within_reach_of(&self, from: &Self, max_speed_m_s: f32) -> bool {
        let way_m = max_speed_m_s * self.instant.since_s(from.instant) as f32;
        let climb_m = self.height_m - from.height_m;
        let ground_m = across_m(self.position - from.position, climb_m);
        let ([hpl_m, vpl_m], [from_hpl_m, from_vpl_m]) = (self.levels_m, from.levels_m);
        ground_m <= way_m + hpl_m + from_hpl_m && climb_m.abs() <= way_m + vpl_m + from_vpl_m
    }

    /// Returns the distance to an earlier position, m.
    fn distance_m(&self, from: &Self) -> f32 {
        across_m(self.position - from.position, 0.0)
    }

    /// Returns true if the receiver can be expected here. `speed_m_s` is the speed at the earlier
    /// position, if it is known.
    // Not inlined, so that its two callers share one copy.
    #[inline(never)]
    pub(super) fn is_expected(&self, from: &Self, speed_m_s: Option<f32>, max_speed_m_s: f32) -> bool {
        let speed_m_s = speed_m_s.unwrap_or(UNKNOWN_SPEED_M_S);
        let (beyond_m_s, factor) = EXPECTED_M_S;
        self.is_within_reach_of(from, (factor * speed_m_s + beyond_m_s).min(max_speed_m_s))
    }

    /// Returns the speed of a receiver without range rates, m/s, from its way since an earlier
    /// position and the speed until then.
    ///
    /// In a short time the noise of two positions is a large speed, and it is averaged over a second.
    pub(super) fn speed_m_s(&self, from: &Self, before_m_s: Option<f32>) -> f32 {
        let elapsed_s = (self.instant.since_s(from.instant) as f32).max(SHORTEST_S);
        let before_m_s = before_m_s.unwrap_or(0.0);
        before_m_s + (self.distance_m(from) / elapsed_s - before_m_s) * elapsed_s.min(1.0)
    }

    /// Returns how long the epochs must agree after a silence, s: 0 if the receiver is expected
    /// here, otherwise the time that the way takes at the highest speed. `speed_m_s` is the speed
    /// at the earlier position, if it is known.
    pub(super) fn wait_s(&self, from: &Self, speed_m_s: Option<f32>, max_speed_m_s: f32) -> f32 {
        if self.is_expected(from, speed_m_s, max_speed_m_s) {
            return 0.0;
        }
        // If the highest speed is zero, the wait is infinite or NaN. It ends when the anchor is
        // forgotten.
        self.distance_m(from) / max_speed_m_s
    }
}

/// Returns the horizontal part of the way between two points, m.
fn across_m(way: Ecef, climb_m: f32) -> f32 {
    let [x, y, z] = [way.x_m, way.y_m, way.z_m].map(|length_m| length_m as f32);
    let squared = x * x + y * y + z * z - climb_m * climb_m;
    // A NaN square stays NaN, which is beyond reach.
    sqrt(if squared < 0.0 { 0.0 } else { squared })
}
