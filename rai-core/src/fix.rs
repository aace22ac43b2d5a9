//! The position fix: Gauss–Newton in ECEF, whose last pass is the snapshot.
//!
//! ```text
//! y_i = ρ_i − |s_i − p| − ω/c (x_s y_p − y_s x_p)        by differences of absolute lengths
//! p  ← p + R x                                            x from the 3×3 solve in T, p in f64
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

use crate::epoch::{Aided, Aiding, Epoch};
use crate::equations::LinearEpoch;
use crate::frame::{Ecef, LocalFrame, Lookout};
use crate::integrity::separation::{Removable, View};
use crate::numeric::real::Real;
use crate::snapshot::{Reducible, Snapshot, SnapshotError};

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

/// Memory for the equations of a fix and their solution, used again from pass to pass: what is large is never moved.
#[derive(Clone, Debug)]
pub struct Workspace<T: Real, const N: usize>(Snapshot<T, N>);

impl<T: Real, const N: usize> Default for Workspace<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const N: usize> Workspace<T, N> {
    /// Nothing solved yet.
    pub fn new() -> Self {
        Self(Snapshot::unsolved())
    }

    /// Solves an epoch, starting at a point near the position, or at [`Ecef::CENTRE`].
    ///
    /// A start far from the truth may lead astray. The centre of the earth is the same distance from all places, and is
    /// tried where the start leads nowhere.
    ///
    /// # Errors
    /// [`FixError`] says what is missing.
    pub fn fix<'r>(&'r mut self, epoch: &'r Epoch<N>, start: Ecef) -> Result<Fix<'r, T, N>, FixError> {
        Fix::about(&mut self.0, Aided::alone(epoch), start)
    }
}

/// A converged position together with the linearised epoch it came from.
#[derive(Debug)]
pub struct Fix<'r, T: Real, const N: usize> {
    aided: Aided<'r, N>,
    /// The linearisation point.
    lookout: Lookout<T>,
    snapshot: &'r mut Snapshot<T, N>,
}

impl<'r, T: Real, const N: usize> Fix<'r, T, N> {
    /// As [`Workspace::fix`], with a forecast beside the epoch and in any workspace.
    pub(crate) fn about(
        snapshot: &'r mut Snapshot<T, N>,
        aided: Aided<'r, N>,
        start: Ecef,
    ) -> Result<Self, FixError> {
        let lookout =
            converge(snapshot, &aided, start, 0).or_else(|_| converge(snapshot, &aided, Ecef::CENTRE, 0))?;
        Ok(Self { aided, lookout, snapshot })
    }

    /// The row of a clock's forecast, or of one that the epoch came with.
    pub fn clock_row(&self) -> Option<usize> {
        let is_clock = |aiding: &Aiding| matches!(aiding, Aiding::Clock { .. });
        Some(self.aided.epoch().observations().len() + self.aided.aiding().position(is_clock)?)
    }

    /// The position.
    pub fn position(&self) -> Ecef {
        self.lookout.beside(&self.snapshot.correction())
    }

    /// The linearised epoch at the position.
    pub fn snapshot(&self) -> &Snapshot<T, N> {
        self.snapshot
    }

    /// Rows of weight 0, as a bit set.
    fn left_out(&self) -> u64 {
        let rows = self.snapshot.rows().enumerate();
        rows.fold(0, |set, (index, (row, _))| if row.weight > T::zero() { set } else { set | bit(index) })
    }

    /// After a change of the rows: solves again from the new position if that is far from the linearisation point.
    fn follow(&mut self) -> Result<(), SnapshotError> {
        if is_within(self.snapshot, RELINEARISE_M) {
            return Ok(());
        }
        let (position, left_out) = (self.position(), self.left_out());
        let found = converge(self.snapshot, &self.aided, position, left_out);
        self.lookout = found.map_err(|error| match error {
            FixError::Snapshot(error) => error,
            FixError::NotConverged => SnapshotError::Singular,
        })?;
        Ok(())
    }

    /// Back to rows that have been solved before, about the same point.
    fn restore(&mut self, left_out: u64) {
        // What could be formed and solved once can be so again.
        let _ = linearise(self.snapshot.epoch_mut(), &self.aided, &self.lookout, left_out);
        let _ = self.snapshot.solve_again();
    }
}

impl<T: Real, const N: usize> Reducible<T, N> for Fix<'_, T, N> {
    fn snapshot(&self) -> &Snapshot<T, N> {
        self.snapshot
    }

    fn leave_out(&mut self, index: usize) -> Result<(), SnapshotError> {
        let before = self.left_out();
        self.snapshot.leave_out(index)?;
        let followed = self.follow();
        if followed.is_err() {
            self.restore(before);
        }
        followed
    }

    fn take_back(&mut self, rows: &[usize]) -> Result<(), SnapshotError> {
        Reducible::take_back(self.snapshot, rows)
    }

    fn set_aside(&mut self, rows: &[usize]) -> Result<(), SnapshotError> {
        Reducible::set_aside(self.snapshot, rows)
    }
}

impl<T: Real, const N: usize> Removable<T> for Fix<'_, T, N> {
    fn view(&self) -> View<'_, T> {
        self.snapshot.view()
    }

    fn leave_out_all(&mut self, rows: u64) -> Result<(), SnapshotError> {
        let before = self.left_out();
        self.snapshot.leave_out_all(rows)?;
        let followed = self.follow();
        if followed.is_err() {
            self.restore(before);
        }
        followed
    }

    fn take_back_all(&mut self, rows: u64) {
        self.snapshot.take_back_all(rows);
    }
}

/// Whether the correction is no longer than this, m: its length is the same in every frame, and needs no double.
fn is_within<T: Real, const N: usize>(snapshot: &Snapshot<T, N>, limit_m: f64) -> bool {
    let correction = snapshot.correction();
    correction.dot(&correction) <= T::narrow(limit_m * limit_m)
}

/// A row's bit in a set; a row beyond the set is in no set.
fn bit(index: usize) -> u64 {
    1u64.checked_shl(index as u32).unwrap_or(0)
}

/// Gauss–Newton: the solution is in the snapshot, the point that it is relative to is returned.
#[inline(never)]
fn converge<T: Real, const N: usize>(
    snapshot: &mut Snapshot<T, N>,
    aided: &Aided<'_, N>,
    start: Ecef,
    left_out: u64,
) -> Result<Lookout<T>, FixError> {
    let mut point = if start.is_finite() { start } else { Ecef::CENTRE };
    for _ in 0..MAX_PASSES {
        let lookout = Lookout::at(point);
        linearise(snapshot.epoch_mut(), aided, &lookout, left_out).ok_or(FixError::NotConverged)?;
        snapshot.solve_again().map_err(FixError::Snapshot)?;
        if is_within(snapshot, CONVERGED_M) {
            return Ok(lookout);
        }
        point = lookout.beside(&snapshot.correction());
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
    linear: &mut LinearEpoch<T, N>,
    aided: &Aided<'_, N>,
    lookout: &Lookout<T>,
    left_out: u64,
) -> Option<()> {
    linear.clear();
    for observation in aided.epoch().observations() {
        let sight = lookout.sight(observation.position);
        let constellation = observation.satellite.constellation();
        linear.sighted(constellation, &sight, observation.range_m, aided.sigma_m(observation)).ok()?;
    }
    for aiding in aided.aiding() {
        match *aiding {
            Aiding::Clock { constellation, value_m, sigma_m } => {
                linear.clock(constellation, value_m, sigma_m).ok()?;
            }
            Aiding::Height { value_m, sigma_m } => {
                linear.height(value_m - LocalFrame::at(lookout.point()).height_m(), sigma_m).ok()?;
            }
        }
    }
    if left_out != 0 {
        (0..N).filter(|&index| left_out & bit(index) != 0).for_each(|index| linear.leave_out(index));
    }
    Some(())
}
