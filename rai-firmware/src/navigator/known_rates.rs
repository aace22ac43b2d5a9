//! Range rates of a receiver at rest, which distinguish a wrong time from faulty satellites.
//!
//! `ρ̇ = l·v`, m/s: `l` is the unit vector from the receiver to the satellite and `v` the velocity
//! of the satellite in the earth-fixed frame. `v` comes from the last epoch, or from two places on
//! the orbit.

use core::cell::Cell;

use nalgebra::Vector3;
use raim_core::frame::Ecef;
use raim_core::internals::numeric::absolute::{Absolute as _, Grid};
use raim_core::internals::numeric::real::Real;

use crate::correction::{CAPACITY, Located};
use crate::ephemeris::{Store, difference_m};
use crate::rates::Rates;
use crate::time::GpsTime;

/// Range rates of the satellites of a sky, m/s; NaN until they are needed.
pub(super) type KnownRates = [Cell<f32>; CAPACITY];

/// Time between the two places of a satellite whose difference gives its velocity, ms.
const APART_MS: u32 = 128;

/// Returns the range rate of a receiver at rest to a satellite of the sky, m/s.
///
/// `index` is the satellite's index in the sky. If the last epoch does not have its velocity, a
/// second place on the orbit is computed, which is expensive.
#[inline(never)]
pub(super) fn range_rate(
    (located, index): (&Located, usize),
    last: &Rates,
    store: &Store,
    point: Ecef,
    time: GpsTime,
) -> Option<f32> {
    let velocity_m_s =
        last.of_satellite(located, index, time).or_else(|| velocity_m_s(located, store, time))?;
    let point = [point.x_m, point.y_m, point.z_m].map(Grid::of);
    let way_m = Vector3::from(difference_m(located.place(), point));
    Some(way_m.dot(&velocity_m_s) * way_m.dot(&way_m).inverse_sqrt_approx())
}

/// Returns the velocity of a satellite in the earth-fixed frame, m/s, from two places on its orbit.
fn velocity_m_s(located: &Located, store: &Store, time: GpsTime) -> Option<Vector3<f32>> {
    let ephemeris = store.get(located.satellite(), time).ok()?;
    let later = ephemeris.seen_at(time.later_by_ms(APART_MS), located.measured_m()?).ok()?;
    let moved_m = Vector3::from(difference_m(later.place(), located.place()));
    Some(moved_m * (1e3 / APART_MS as f32))
}
