//! The position fix: Gauss–Newton in ECEF, whose last pass is the snapshot.
//!
//! ```text
//! y_i = ρ_i − |s_i − p| − ω/c (x_s y_p − y_s x_p)        residuals in f64
//! p  ← p + R x                                            x from the 3×3 solve in T
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `ρ_i` | [`crate::epoch::Observation::range_m`] | m |
//! | `s_i` | [`crate::epoch::Observation::position`] | m |
//! | `p` | linearisation point | m |
//!
//! A correction of length `d` leaves a linearisation error of `d²/2ρ`: 2.5 cm after 1 km, 3 µm after 10 m. A pass
//! whose correction is below 10 m is therefore the last one, and nothing is solved again for the test.
//!
//! From the centre of the earth it converges in five or six passes, from the last position in one or two.

use core::fmt;

use crate::epoch::{Aiding, Epoch};
use crate::frame::{Ecef, Enu, LocalFrame};
use crate::identification::baarda::Reducible;
use crate::linear::LinearEpoch;
use crate::real::Real;
use crate::snapshot::{Snapshot, SnapshotError};

/// A pass whose correction is below this is the last one, m.
const CONVERGED_M: f64 = 10.0;

/// An exclusion that moves the position by more than this is solved again from there, m.
const RELINEARISE_M: f64 = 300.0;

/// From the centre of the earth six passes suffice; twice that is divergence.
const MAX_PASSES: usize = 12;

/// Farthest a correction may carry from the earth's centre, m: beyond any satellite.
const MAX_RADIUS_M: f64 = 1e8;

/// Why there is no position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FixError {
    /// The linearised epoch could not be solved.
    Snapshot(SnapshotError),
    /// The corrections did not become small.
    NotConverged,
}

impl fmt::Display for FixError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Snapshot(error) => error.fmt(formatter),
            Self::NotConverged => formatter.write_str("position did not converge"),
        }
    }
}

impl core::error::Error for FixError {}

/// A converged position together with the linearised epoch it came from.
#[derive(Clone, Debug)]
pub struct Fix<'e, T: Real, const N: usize> {
    epoch: &'e Epoch<N>,
    point: Ecef,
    frame: LocalFrame,
    snapshot: Snapshot<T, N>,
}

impl<'e, T: Real, const N: usize> Fix<'e, T, N> {
    /// Solves an epoch, starting at a point within sight of the position, or at [`Ecef::CENTRE`].
    ///
    /// # Errors
    /// [`FixError`] says what is missing.
    pub fn solve(epoch: &'e Epoch<N>, start: Ecef) -> Result<Self, FixError> {
        converge(epoch, start, 0)
    }

    /// The position.
    pub fn position(&self) -> Ecef {
        self.point + self.displacement()
    }

    /// The tangent frame in which the snapshot's east, north, up are.
    pub fn frame(&self) -> &LocalFrame {
        &self.frame
    }

    /// The linearised epoch at the position.
    pub fn snapshot(&self) -> &Snapshot<T, N> {
        &self.snapshot
    }

    fn displacement(&self) -> Ecef {
        let correction = self.snapshot.correction();
        let (east, north, up) = (correction.x.widen(), correction.y.widen(), correction.z.widen());
        self.frame.unrotate(Enu { east, north, up })
    }

    /// Rows of weight 0, as a bit set.
    fn left_out(&self) -> u64 {
        let rows = self.snapshot.rows().enumerate();
        rows.fold(0, |set, (index, (row, _))| if row.weight > T::zero() { set } else { set | bit(index) })
    }

    /// After a change of the rows: solves again from the new position if that is far from the linearisation point.
    fn follow(&mut self) -> Result<(), SnapshotError> {
        if self.displacement().radius_m() <= RELINEARISE_M {
            return Ok(());
        }
        match converge(self.epoch, self.position(), self.left_out()) {
            Ok(fix) => *self = fix,
            Err(FixError::Snapshot(error)) => return Err(error),
            Err(FixError::NotConverged) => return Err(SnapshotError::Singular),
        }
        Ok(())
    }
}

impl<T: Real, const N: usize> Reducible<T, N> for Fix<'_, T, N> {
    fn snapshot(&self) -> &Snapshot<T, N> {
        &self.snapshot
    }

    fn leave_out(&mut self, index: usize) -> Result<(), SnapshotError> {
        self.snapshot.leave_out(index)?;
        self.follow()
    }

    fn take_back(&mut self, index: usize) -> Result<(), SnapshotError> {
        // The point stays: what is compared next are exclusions of the same epoch about the same point.
        self.snapshot.take_back(index)
    }
}

/// A row's bit in a set; a row beyond the set is in no set.
fn bit(index: usize) -> u64 {
    1u64.checked_shl(index as u32).unwrap_or(0)
}

/// Not inlined: it is called from several places, and each would hold the equations on its own stack.
#[inline(never)]
fn converge<T: Real, const N: usize>(
    epoch: &Epoch<N>,
    start: Ecef,
    left_out: u64,
) -> Result<Fix<'_, T, N>, FixError> {
    let mut point = if start.is_finite() { start } else { Ecef::CENTRE };
    for _ in 0..MAX_PASSES {
        let frame = LocalFrame::at(point);
        let mut linear = linearise(epoch, point, &frame).ok_or(FixError::NotConverged)?;
        for index in (0..N).filter(|&index| left_out & bit(index) != 0) {
            linear.leave_out(index);
        }
        let snapshot = Snapshot::solve(linear).map_err(FixError::Snapshot)?;
        let fix = Fix { epoch, point, frame, snapshot };
        let displacement_m = fix.displacement().radius_m();
        if displacement_m < CONVERGED_M {
            return Ok(fix);
        }
        point = fix.position();
        // Also the way out for a position that is not a number.
        if !(point.radius_m() < MAX_RADIUS_M) {
            return Err(FixError::NotConverged);
        }
    }
    Err(FixError::NotConverged)
}

/// The equations of an epoch about a point: row `i` is observation `i`, aiding rows follow.
///
/// `None` where a row cannot be formed, as at a point that coincides with a satellite: rows never move up.
fn linearise<T: Real, const N: usize>(
    epoch: &Epoch<N>,
    point: Ecef,
    frame: &LocalFrame,
) -> Option<LinearEpoch<T, N>> {
    let mut linear = LinearEpoch::new();
    for observation in epoch.observations() {
        let sight = frame.sight(point, observation.position);
        let residual_m = observation.range_m - sight.range_m;
        let constellation = observation.satellite.constellation();
        linear.satellite(constellation, sight.line_of_sight, residual_m, observation.sigma_m).ok()?;
    }
    for aiding in epoch.aiding() {
        match *aiding {
            Aiding::Clock { constellation, value_m, sigma_m } => {
                linear.clock(constellation, value_m, sigma_m).ok()?;
            }
            Aiding::Height { value_m, sigma_m } => {
                linear.height(value_m - frame.height_m(), sigma_m).ok()?;
            }
        }
    }
    Some(linear)
}
