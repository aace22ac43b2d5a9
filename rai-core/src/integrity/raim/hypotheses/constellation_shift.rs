//! Constellation-shift hypothesis: does another position of a whole constellation explain the data
//! as well as an exclusion?
//!
//! All satellites of a constellation can be wrong at once, by orbits that agree with each other.
//! The hypothesis has three more unknowns, the position of that constellation. It splits the
//! snapshot into two independent parts: the rows `s` of the constellation and all others, `o`.
//!
//! ```text
//! N_s = Σ_s w d dᵀ    N_o = N − N_s        u_s = Σ_s w d v = −u_o        (v are orthogonal to what was solved for)
//! q_s = N_s⁻¹ u_s     q_o = N_o⁻¹ u_o      SSE_s+o = SSE − u_s·q_s − u_o·q_o = Σ w (v − d·q)²       dof − 3
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `d`, `v`, `w` | centred design, residual and weight of a row, as in [`crate::least_squares`] | –, m, 1/m² |
//! | `q_s`, `q_o` | offset from the common position to that of the constellation, and to that of all others | m |
//!
//! An exclusion may leave satellites that agree on a wrong position. If a shift explains the data
//! as well, the exclusion therefore does not prove which satellites are wrong.
//!
//! Residuals that pass the global test show a shift if it explains more than `τ1(3) + 2 ln 100`.
//! With noise alone, each split does so with about a hundredth of `P_fa`: over `Δ`, the tail of
//! `χ²` with three degrees of freedom falls by nearly `e^(−Δ/2)`. The probability of a false alarm
//! thus remains that of the global test. With the threshold `τ1(3)`, each split would add another
//! `P_fa`.
//!
//! **Limits.** With two constellations the shifted one cannot be identified; with three this is not
//! attempted. Up to four satellites of one constellation always agree on some position and clock.
//! Their shift is therefore no rival for an exclusion among them. It is a rival for an exclusion of
//! others, if all others agree without it.

use core::cell::Cell;

use nalgebra::{Matrix3, Vector3};

use crate::integrity::raim::detection::threshold::Thresholds;
use crate::least_squares::equations::Row;
use crate::least_squares::{RowFit, Snapshot, infinity, invert, larger};
use crate::numeric::real::Real;
use crate::numeric::space::{add_outer_product, dot, plus_scaled, scaled, symmetric_product, zero, zeros};
use crate::satellite::Constellation;

/// Unknowns of a second position.
pub(crate) const UNKNOWNS: usize = 3;

/// Increase of the threshold, 2 ln 100, that divides the probability of a false alarm by a hundred.
const RARER: f64 = 9.210_340_371_976_184;

/// Returns true if a shifted constellation explains more of SSE than noise can, and more than any
/// single row.
pub(crate) fn shows<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    thresholds: &Thresholds<'_>,
) -> bool {
    if !cfg!(feature = "hypotheses") {
        return false;
    }
    let noise = thresholds.tau1::<T>(UNKNOWNS).map(|tau1| tau1 + T::narrow(RARER));
    let least = noise.map(|tau1| tau1.max(snapshot.statistics().worst.largest));
    let most = least.map(|least| snapshot.sse() - least).filter(|&most| most > T::zero());
    most.is_some_and(|most| least_sse(snapshot) < most)
}

/// Returns the least SSE that a shift leaves; infinite without a shift that can be tested.
#[inline(never)]
pub(crate) fn least_sse<T: Real, const N: usize>(snapshot: &Snapshot<'_, T, N>) -> T {
    let least = Cell::new(infinity::<T>());
    if cfg!(feature = "hypotheses") {
        any_split(snapshot, &|split| {
            if split.mine.is_tested() && split.others.is_tested() {
                let left = split.sse(snapshot);
                least.set(if left < least.get() { left } else { least.get() });
            }
            false
        });
    }
    least.get()
}

/// Returns true if a shift explains the residuals of all satellites as well as one excluded row, or
/// nearly as well as several.
///
/// `found` is the SSE without the excluded rows.
pub(crate) fn rivals<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    excluded: &[usize],
    found: T,
    thresholds: &Thresholds<'_>,
) -> bool {
    if !cfg!(feature = "hypotheses") {
        return false;
    }
    let Some(w_test) = thresholds.w_test::<T>(snapshot.used()) else { return false };
    let most = if excluded.len() > 1 { found + w_test * w_test } else { found };
    any_split(snapshot, &|split| {
        // An excluded row must be in a part that is tested. Otherwise a shift would rival any
        // exclusion among satellites that always agree.
        let is_told =
            |&index: &usize| snapshot.row(index).is_some_and(|(row, _)| split.part(row).is_tested());
        let threshold = thresholds.tau1::<T>(split.dof()).filter(|_| excluded.iter().any(is_told));
        threshold.is_some_and(|tau1| split.sse(snapshot) < tau1.min(most))
    })
}

/// Returns the largest squared bias of a row, in units of its variance, that a shift may explain:
/// with more, the shift fails its own test but for the probability of a missed fault. 0 without
/// such a shift.
pub(crate) fn hides<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    index: usize,
    thresholds: &Thresholds<'_>,
) -> T {
    let most = Cell::new(T::zero());
    let Some((row, fit)) = snapshot.row(index) else { return most.get() };
    any_split(snapshot, &|split| {
        let part = split.part(row);
        if part.is_tested() {
            let shown = part.redundancy(row, fit, snapshot.level_variance(row));
            most.set(larger(most.get(), thresholds.hidden(split.dof(), shown)));
        }
        false
    });
    most.get()
}

/// Returns true if a predicate is true for the shift of any constellation.
#[inline(never)]
fn any_split<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    is_so: &dyn Fn(&Split<T>) -> bool,
) -> bool {
    let systems = || Constellation::ALL.into_iter().filter(|&system| snapshot.determines(system));
    // With two constellations both shifts are the same hypothesis.
    let asked = if systems().count() == 2 { 1 } else { Constellation::COUNT };
    systems()
        .take(asked)
        .any(|shifted| Split::of(snapshot, shifted, systems().count()).is_some_and(|split| is_so(&split)))
}

/// The rows in two parts: a shifted constellation and all others.
struct Split<T: Real> {
    shifted: Constellation,
    mine: PositionPart<T>,
    others: PositionPart<T>,
}

impl<T: Real> Split<T> {
    /// Returns `None` if one part has no more rows than clocks, or if it has rows enough for a
    /// position but does not determine it.
    fn of<const N: usize>(
        snapshot: &Snapshot<'_, T, N>,
        shifted: Constellation,
        clocks: usize,
    ) -> Option<Self> {
        let (mine, others) =
            (PositionPart::with_clocks(1), PositionPart::with_clocks(clocks.saturating_sub(1)));
        let mut split = Self { shifted, mine, others };
        for (row, fit) in snapshot.rows() {
            let part = if row.clock == Some(shifted) { &mut split.mine } else { &mut split.others };
            part.add(row, fit);
        }
        (split.mine.settle() && split.others.settle()).then_some(split)
    }

    fn part(&self, row: &Row<T>) -> &PositionPart<T> {
        if row.clock == Some(self.shifted) { &self.mine } else { &self.others }
    }

    fn dof(&self) -> usize {
        self.mine.dof + self.others.dof
    }

    /// Returns the SSE that the shift leaves.
    fn sse<const N: usize>(&self, snapshot: &Snapshot<'_, T, N>) -> T {
        snapshot.rows().fold(T::zero(), |sum, (row, fit)| {
            let part = self.part(row);
            let left = fit.residual - dot(&fit.centred, &part.place);
            if part.is_tested() { sum + row.weight * left * left } else { sum }
        })
    }
}

/// Rows of one part and the position that they determine.
struct PositionPart<T: Real> {
    rows: usize,
    clocks: usize,
    normal: Matrix3<T>,
    gradient: Vector3<T>,
    dof: usize,
    /// Offset from the common position, m.
    place: Vector3<T>,
}

impl<T: Real> PositionPart<T> {
    fn with_clocks(clocks: usize) -> Self {
        let (normal, gradient) = (zeros(), zero());
        Self { rows: 0, clocks, normal, gradient, dof: 0, place: zero() }
    }

    // A row without weight adds zeros.
    #[inline]
    fn add(&mut self, row: &Row<T>, fit: &RowFit<T>) {
        self.rows += usize::from(row.weight > T::zero());
        let weighted = scaled(row.weight, &fit.centred);
        add_outer_product(&mut self.normal, &weighted, &fit.centred);
        self.gradient = plus_scaled(&self.gradient, fit.residual, &weighted);
    }

    /// Computes the position if there are rows enough to test it. Returns false if the rows do not
    /// determine it, or determine only clocks.
    #[inline(never)]
    fn settle(&mut self) -> bool {
        if self.rows <= self.clocks {
            return false;
        }
        self.dof = self.rows.saturating_sub(UNKNOWNS + self.clocks);
        if self.dof == 0 {
            return true;
        }
        // If the rows hardly determine the offset, the computed one explains less than the best
        // one, which is safe.
        let place = invert(&self.normal).map(|covariance| symmetric_product(&covariance, &self.gradient));
        self.place = place.unwrap_or_else(|_| zero());
        place.is_ok()
    }

    /// Returns the redundancy of a row among the rows of this part alone, whose clock has this
    /// variance at a known position.
    fn redundancy(&self, row: &Row<T>, fit: &RowFit<T>, clock_m2: T) -> T {
        let Ok(covariance) = invert(&self.normal) else { return T::zero() };
        let position_m2 = dot(&fit.centred, &symmetric_product(&covariance, &fit.centred));
        T::one() - row.weight * (position_m2 + clock_m2)
    }

    /// Returns true if the rows can contradict each other. Otherwise their residuals are 0 for any
    /// data.
    fn is_tested(&self) -> bool {
        self.dof > 0
    }
}
