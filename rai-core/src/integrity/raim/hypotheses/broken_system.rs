//! Broken-system hypothesis: all satellites of one system are wrong, and those of all others agree.
//!
//! ```text
//! s is broken    SSE_s < τ1(dof_s)  and  dof_s ≥ 3
//!                SSE_t ≥ τ1(dof_t)  and  SSE_t ≥ SSE_s + T_d²        for every other system t
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `s`, `t` | systems with at least two satellites; at least three such systems must be in view | – |
//! | `SSE_s`, `dof_s` | sum of squares and degrees of freedom without the system | – |
//! | `τ1`, `T_d` | thresholds of the global test and of the w-test | – |
//!
//! If the orbits or the time of a system are wrong, more satellites are wrong than a search may
//! leave out. Several sets of them then explain the data equally well. If only one system is wrong,
//! all others pass the test without it. A healthy system is blamed only if its exclusion passes and
//! that of the wrong system fails. This is no likelier than a false alarm.
//!
//! **Cost.** If leaving out a system moves the position far, the solution is linearised again,
//! which is as expensive as a fix. This is skipped if the misfit about the present point is larger
//! than the distance can cause ([`curvature`]).
//!
//! **Two systems.** With two systems, whatever their sizes, a fault of either explains the data, so
//! that none is left out. A lone satellite agrees with any position and does not count as a system.
//!
//! **Limits.** The majority is believed: two counterfeit systems that agree with each other exclude
//! a third, genuine one.

use crate::bit_set::{bit, count_of};
use crate::integrity::raim::detection::Detection;
use crate::integrity::raim::detection::threshold::Thresholds;
use crate::least_squares::{Excludable, Snapshot, curvature};
use crate::numeric::real::Real;
use crate::report::MAX_EXCLUDED;
use crate::satellite::Constellation;

/// Least number of systems that contradict each other before one of them can be blamed.
const LEAST_SYSTEMS: usize = 3;

/// Least degrees of freedom without the system: as many as the rows that an exclusion may have left
/// out.
const LEAST_DOF: usize = MAX_EXCLUDED;

/// A system without which all others agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BrokenSystem<T> {
    /// The system.
    pub(crate) constellation: Constellation,
    /// Bit set of its rows.
    pub(crate) rows: u64,
    /// SSE without these rows.
    pub(crate) left: T,
}

/// Returns the system without which all others agree, if it is the only one.
///
/// `satellites` is the number of rows that are satellites. Afterwards, the solution has the same
/// rows as before.
pub(crate) fn find<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    satellites: usize,
    thresholds: &Thresholds<'_>,
) -> Option<BrokenSystem<T>> {
    let systems = Constellation::ALL.map(|constellation| rows_of(solution, satellites, constellation));
    let systems = systems.map(|rows| if count_of(rows) > 1 { rows } else { 0 });
    if systems.iter().filter(|&&rows| rows != 0).count() < LEAST_SYSTEMS {
        return None;
    }
    let threshold = thresholds.w_test::<T>(solution.snapshot().used())?;
    let mut found: Option<BrokenSystem<T>> = None;
    let mut least_rival: Option<T> = None;
    for (constellation, rows) in Constellation::ALL.into_iter().zip(systems) {
        // If the others determine no position, they confirm nothing, and the system is no rival.
        if rows == 0 || solution.set_aside_all(rows).is_err() {
            continue;
        }
        if may_agree(solution.snapshot()) {
            solution.take_back_all(rows);
            if solution.leave_out_all(rows).is_err() {
                continue;
            }
        }
        let (left, dof) = (solution.snapshot().sse(), solution.snapshot().dof());
        let passes = Detection::passes(solution.snapshot(), thresholds);
        solution.take_back_all(rows);
        if passes && (found.is_some() || dof < LEAST_DOF) {
            return None;
        }
        if passes {
            found = Some(BrokenSystem { constellation, rows, left });
        } else {
            least_rival = Some(least_rival.map_or(left, |least| least.min(left)));
        }
    }
    // NaN fails this comparison.
    let is_apart =
        |found: &BrokenSystem<T>| least_rival.is_none_or(|rival| rival >= found.left + threshold * threshold);
    found.filter(is_apart)
}

/// Returns true if the rows may agree when linearised about the solution.
fn may_agree<T: Real, const N: usize>(snapshot: &Snapshot<'_, T, N>) -> bool {
    /// SSE above every threshold.
    const NOISE: f64 = 1e4;
    curvature::may_explain(snapshot.sse(), NOISE, snapshot.equations(), &snapshot.correction())
}

/// Returns the satellites of a system that take part.
fn rows_of<T: Real, const N: usize>(
    solution: &impl Excludable<T, N>,
    satellites: usize,
    constellation: Constellation,
) -> u64 {
    let rows = solution.snapshot().equations().iter().take(satellites).enumerate();
    let members = rows.filter(|(_, row)| row.weight > T::zero() && row.clock == Some(constellation));
    members.fold(0, |set, (index, _)| set | bit(index))
}
