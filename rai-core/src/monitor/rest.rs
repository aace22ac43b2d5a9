//! Rest: has anything changed since the last epoch that could end a quiet time?
//!
//! ```text
//! still      |v| < 0.5 m/s, and |p − p_0| < 10 m since the rest began
//! as before  each satellite used in the last epoch is in view, and that epoch is no minute old
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `v` | velocity by range rates; without any the position alone counts | m/s |
//! | `p`, `p_0` | position, and that of the first epoch at rest | m |
//!
//! Quiet minutes say nothing about the next second if the antenna moves, or if something moves in
//! front of it: a wall hides satellites first.

use crate::epoch::EpochView;
use crate::frame::Ecef;
use crate::satellite::{Constellation, SatelliteId};
use crate::velocity::{Velocity, VelocityError};

/// Largest speed at rest, m/s: the noise of range rates at rest is below it.
const SLOW_M_S: f32 = 0.5;

/// Largest distance from the place where the rest began, m. The scatter of a quiet receiver is
/// below it.
const NEAR_M: f32 = 10.0;

/// Largest time from one epoch to the next, s.
const LONGEST_STEP_S: f32 = 60.0;

/// Satellites of each constellation, a bit for each number.
type Satellites = [u64; Constellation::COUNT];

/// The last epoch at rest.
#[derive(Clone, Debug)]
pub(super) struct Rest {
    /// Where the rest began.
    place: Option<Ecef>,
    /// Time of the last epoch, s.
    last_s: f64,
    used: Satellites,
}

impl Rest {
    /// Returns the state before the first epoch.
    pub(super) const fn new() -> Self {
        Self { place: None, last_s: 0.0, used: [0; Constellation::COUNT] }
    }

    /// Adds an epoch without an alert. Returns true if it continues the rest.
    pub(super) fn continues(
        &mut self,
        time_s: f64,
        place: Ecef,
        used: &[SatelliteId],
        velocity: Result<&Velocity, VelocityError>,
    ) -> bool {
        let is_slow = match velocity {
            Ok(velocity) => (velocity.speed_m_s() as f32) < SLOW_M_S,
            Err(error) => !error.is_contradiction(),
        };
        let is_same = is_slow && self.is_recent(time_s) && self.is_near(place);
        if !is_same {
            self.place = Some(place);
        }
        self.last_s = time_s;
        self.used = satellites(&mut used.iter().copied());
        is_same
    }

    /// Returns true if a position is where the rest began.
    pub(super) fn is_near(&self, position: Ecef) -> bool {
        self.place.is_some_and(|place| {
            let away = position - place;
            let [x_m, y_m, z_m] = [away.x_m as f32, away.y_m as f32, away.z_m as f32];
            x_m * x_m + y_m * y_m + z_m * z_m < NEAR_M * NEAR_M
        })
    }

    /// Returns true if an epoch has the satellites of the last one, and soon after it.
    pub(super) fn is_as_before(&self, epoch: &EpochView<'_>) -> bool {
        let present = satellites(&mut epoch.observations().iter().map(|seen| seen.satellite));
        self.is_recent(epoch.time_s())
            && self.used.iter().zip(&present).all(|(used, present)| used & !present == 0)
    }

    fn is_recent(&self, time_s: f64) -> bool {
        (0.0..=LONGEST_STEP_S).contains(&((time_s - self.last_s) as f32))
    }
}

/// Returns these satellites as bits.
// Compiled once for both callers.
#[inline(never)]
fn satellites(list: &mut dyn Iterator<Item = SatelliteId>) -> Satellites {
    let mut sets = [0; Constellation::COUNT];
    for satellite in list {
        if let Some(set) = sets.get_mut(satellite.constellation() as usize) {
            *set |= 1 << (satellite.number() & 63);
        }
    }
    sets
}

#[cfg(test)]
mod tests {
    use super::Rest;
    use crate::frame::Ecef;
    use crate::report::{ProtectionLevels, TestStatistic};
    use crate::velocity::{Velocity, VelocityError};

    const PLACE: Ecef = Ecef::new(6_378_000.0, 0.0, 0.0);

    fn eastwards(speed_m_s: f64) -> Velocity {
        Velocity {
            east_north_up_m_s: [speed_m_s, 0.0, 0.0],
            covariance_m2_s2: [0.0; 6],
            drift_m_s: 0.0,
            test: TestStatistic { statistic: 0.0, threshold: 1.0, dof: 1 },
            levels_m_s: ProtectionLevels { hpl_m: 0.1, vpl_m: 0.1 },
            excluded: heapless::Vec::new(),
        }
    }

    /// Returns true if an epoch continues a rest that began a time before.
    fn continues(after_s: f64, away_m: f64, velocity: Result<&Velocity, VelocityError>) -> bool {
        let mut rest = Rest::new();
        assert!(!rest.continues(0.0, PLACE, &[], Err(VelocityError::Redundancy)), "the first epoch");
        rest.continues(after_s, PLACE + Ecef::new(0.0, away_m, 0.0), &[], velocity)
    }

    #[test]
    fn a_rest_ends_with_speed_distance_contradicting_rates_or_a_gap() {
        let none = Err(VelocityError::Redundancy);
        assert!(continues(1.0, 9.0, none) && continues(1.0, 9.0, Ok(&eastwards(0.4))));
        assert!(!continues(1.0, 9.0, Ok(&eastwards(0.6))));
        assert!(!continues(1.0, 11.0, none));
        assert!(!continues(1.0, 0.0, Err(VelocityError::Fault)));
        assert!(continues(60.0, 0.0, none) && !continues(61.0, 0.0, none) && !continues(-1.0, 0.0, none));
        assert!(!continues(f64::NAN, 0.0, none) && !continues(1.0, f64::NAN, none));
    }
}
