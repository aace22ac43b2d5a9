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
//! A correction of length `d` leaves a linearisation error of `d²/2ρ`: 2.5 cm after 1 km, 3 µm
//! after 10 m. If a correction is below 10 m, its pass is therefore the last one, and the global
//! test uses its solution.
//!
//! From the centre of the earth the fix converges in five or six passes, from the last position in
//! one or two.

use core::fmt;

use nalgebra::Vector3;

use crate::bit_set::bit;
use crate::bounded::MAX_ROWS;
use crate::epoch::{Aided, Aiding, Epoch};
use crate::frame::{Ecef, LinearisationPoint, LocalFrame};
use crate::least_squares::equations::{References, Row};
use crate::least_squares::{Excludable, Snapshot, SnapshotError, Workspace};
use crate::numeric::real::Real;
use crate::numeric::space::dot;

/// Correction below which a pass is the last one, m.
const CONVERGED_M: f64 = 10.0;

/// Change of the position above which the solution after an exclusion is linearised again, m.
const RELINEARISE_M: f64 = 300.0;

/// Distance of a clock from its reference above which `f32` residuals lose a centimetre, m.
///
/// The distance is that large only if a constellation's first satellite, its reference, was left
/// out because of its error.
const REFERENCE_M: f64 = 1e5;

/// Maximum number of passes: twice the six that suffice from the centre of the earth.
const MAX_PASSES: usize = 12;

/// Largest distance from the earth's centre that a correction may lead to, m: beyond any satellite.
const MAX_RADIUS_M: f64 = 1e8;

/// Reason why there is no position.
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

impl<T: Real, const N: usize> Workspace<T, N> {
    /// Solves an epoch from a start near the position, or from [`Ecef::CENTRE`].
    ///
    /// From a start far from the truth the fix may not converge. A second try then starts at the
    /// centre of the earth, which is equally far from all places.
    ///
    /// # Errors
    /// [`FixError`] names what is missing.
    pub fn fix<'r>(&'r mut self, epoch: &'r Epoch<N>, start: Ecef) -> Result<Fix<'r, T, N>, FixError> {
        Fix::about(self, Aided::alone(epoch), start)
    }
}

/// A converged position, together with the linearised epoch that determined it.
#[derive(Debug)]
pub struct Fix<'r, T: Real, const N: usize = MAX_ROWS> {
    aided: Aided<'r>,
    /// The linearisation point.
    linearisation: LinearisationPoint<T>,
    snapshot: Snapshot<'r, T, N>,
}

impl<'r, T: Real, const N: usize> Fix<'r, T, N> {
    /// Works like [`Workspace::fix`], from an epoch with a clock forecast.
    pub(crate) fn about(
        workspace: &'r mut Workspace<T, N>,
        aided: Aided<'r>,
        start: Ecef,
    ) -> Result<Self, FixError> {
        let mut solve_about = |linearisation: &LinearisationPoint<T>| {
            let equations = workspace.equations_mut();
            let written = equations.refill(|references, put| write(references, &aided, linearisation, put));
            written.ok_or(FixError::NotConverged)?;
            workspace.solve_rows().map_err(FixError::Snapshot)
        };
        let linearisation =
            converge(start, &mut solve_about).or_else(|_| converge(Ecef::CENTRE, &mut solve_about))?;
        Ok(Self { aided, linearisation, snapshot: workspace.lend() })
    }

    /// Returns the row of a clock forecast, or of a clock among the epoch's aiding.
    pub fn clock_row(&self) -> Option<usize> {
        let is_clock = |aiding: &Aiding| matches!(aiding, Aiding::Clock { .. });
        Some(self.aided.observations().len() + self.aided.aiding().position(is_clock)?)
    }

    /// Returns the position.
    pub fn position(&self) -> Ecef {
        self.linearisation.beside(&self.snapshot.correction())
    }

    /// Returns the linearised epoch at the position.
    pub fn snapshot(&self) -> &Snapshot<'r, T, N> {
        &self.snapshot
    }

    /// Returns the rows of weight 0, as a bit set.
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    fn left_out(&self) -> u64 {
        let rows = self.snapshot.equations().iter().enumerate();
        rows.fold(0, |set, (index, row)| if row.weight > T::zero() { set } else { set | bit(index) })
    }

    /// Solves again from the new position in two cases: a change of the rows moved it far from the
    /// linearisation point, or a clock is far from the reference of its residuals.
    fn follow(&mut self) -> Result<(), SnapshotError> {
        let is_near = is_within(&self.snapshot.correction(), RELINEARISE_M);
        if is_near && !self.snapshot.is_far_from_references(REFERENCE_M) {
            return Ok(());
        }
        let (position, left_out) = (self.position(), self.left_out());
        let mut solve_about = |linearisation: &LinearisationPoint<T>| {
            let references = self.snapshot.clocks_as_references();
            rewrite(&mut self.snapshot, references, &self.aided, linearisation, left_out)
                .map_err(FixError::Snapshot)?;
            Ok(self.snapshot.correction())
        };
        self.linearisation = converge(position, &mut solve_about).map_err(|error| match error {
            FixError::Snapshot(error) => error,
            FixError::NotConverged => SnapshotError::Singular,
        })?;
        Ok(())
    }

    /// Restores rows that were solved before, about the same point.
    fn restore(&mut self, left_out: u64) {
        // This succeeds, because these rows were formed and solved before.
        let references = References::none();
        let _ = rewrite(&mut self.snapshot, references, &self.aided, &self.linearisation, left_out);
    }
}

impl<T: Real, const N: usize> Excludable<T, N> for Fix<'_, T, N> {
    fn snapshot(&self) -> &Snapshot<'_, T, N> {
        &self.snapshot
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

    fn leave_out_all(&mut self, rows: u64) -> Result<(), SnapshotError> {
        let before = self.left_out();
        self.snapshot.leave_out_all(rows)?;
        let followed = self.follow();
        if followed.is_err() {
            self.restore(before);
        }
        followed
    }

    fn take_back(&mut self, rows: &[usize]) -> Result<(), SnapshotError> {
        Excludable::take_back(&mut self.snapshot, rows)
    }

    fn take_back_all(&mut self, rows: u64) {
        self.snapshot.take_back_all(rows);
    }

    fn set_aside(&mut self, rows: &[usize]) -> Result<(), SnapshotError> {
        Excludable::set_aside(&mut self.snapshot, rows)
    }

    fn set_aside_all(&mut self, rows: u64) -> Result<(), SnapshotError> {
        self.snapshot.leave_out_all(rows)
    }
}

/// Returns true if the length of a correction does not exceed a limit, m. The length is the same in
/// every frame and needs no double.
fn is_within<T: Real>(correction: &Vector3<T>, limit_m: f64) -> bool {
    dot(correction, correction) <= T::narrow(limit_m * limit_m)
}

/// Solves about a point and returns the correction.
type Solve<'s, T> = dyn FnMut(&LinearisationPoint<T>) -> Result<Vector3<T>, FixError> + 's;

/// Gauss–Newton: solves about successive points until the correction is small. Returns the last
/// point.
#[inline(never)]
fn converge<T: Real>(start: Ecef, solve_about: &mut Solve<'_, T>) -> Result<LinearisationPoint<T>, FixError> {
    let mut point = if start.is_finite() { start } else { Ecef::CENTRE };
    for _ in 0..MAX_PASSES {
        let linearisation = LinearisationPoint::at(point);
        let correction = solve_about(&linearisation)?;
        if is_within(&correction, CONVERGED_M) {
            return Ok(linearisation);
        }
        point = linearisation.beside(&correction);
        // A NaN position also returns here.
        if !(point.radius_m() < MAX_RADIUS_M) {
            return Err(FixError::NotConverged);
        }
    }
    Err(FixError::NotConverged)
}

/// Writes the equations about another point, relative to `references`. The rows of a set are left
/// out.
fn rewrite<T: Real, const N: usize>(
    snapshot: &mut Snapshot<'_, T, N>,
    references: References<T>,
    aided: &Aided<'_>,
    linearisation: &LinearisationPoint<T>,
    left_out: u64,
) -> Result<(), SnapshotError> {
    snapshot.rewrite(references, |references, put| {
        let mut set = left_out;
        write(references, aided, linearisation, &mut |mut row| {
            if set & 1 != 0 {
                row.leave_out();
            }
            set >>= 1;
            put(row)
        })
    })
}

/// Writes the equations of an epoch about a point: row `i` is observation `i`, aiding rows follow.
///
/// Returns `None` if a row cannot be formed, because the point coincides with a satellite. Skipping
/// the row would shift the indices of the others.
fn write<T: Real>(
    references: &mut References<T>,
    aided: &Aided<'_>,
    linearisation: &LinearisationPoint<T>,
    put: &mut dyn FnMut(Row<T>) -> Option<()>,
) -> Option<()> {
    for (observation, sigma_m) in aided.weighed() {
        let sight = linearisation.sight(observation.position);
        let constellation = observation.satellite.constellation();
        put(references.sighted(constellation, &sight, observation.range_m, sigma_m).ok()?)?;
    }
    for aiding in aided.aiding() {
        let row = match *aiding {
            Aiding::Clock { constellation, value_m, sigma_m } => {
                references.clock(constellation, value_m, sigma_m)
            }
            Aiding::Height { value_m, sigma_m } => {
                Row::height(value_m - LocalFrame::at(linearisation.point()).height_m(), sigma_m)
            }
        };
        put(row.ok()?)?;
    }
    Some(())
}
