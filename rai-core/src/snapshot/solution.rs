//! One 3×3 solve over whatever rows it is given: the equations stand at the top of [`super`].
//!
//! Needs no memory beside its result, so that a search may solve for a subset of the rows, or for all but one, without a
//! copy of them.

use nalgebra::{Matrix3, Vector3};

use super::{Fit, SnapshotError};
use crate::equations::Row;
use crate::numeric::real::Real;
use crate::satellite::Constellation;

/// One constellation's weighted means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Group<T: Real> {
    pub(super) count: usize,
    weight: T,
    /// `1/W_c`.
    pub(super) variance: T,
    pub(super) design: Vector3<T>,
    pub(super) residual: T,
}

impl<T: Real> Group<T> {
    fn empty() -> Self {
        Self {
            count: 0,
            weight: T::zero(),
            variance: T::zero(),
            design: Vector3::zeros(),
            residual: T::zero(),
        }
    }

    fn add(&mut self, row: &Row<T>, weight: T) {
        self.count += 1;
        self.weight += weight;
        self.design += row.design * weight;
        self.residual += row.residual * weight;
    }

    /// Sums to means.
    fn centre(mut self) -> Self {
        if self.count > 0 {
            self.variance = self.weight.recip();
            self.design *= self.variance;
            self.residual *= self.variance;
        }
        self
    }
}

/// All constellations' means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Groups<T: Real>([Group<T>; Constellation::COUNT]);

impl<T: Real> Groups<T> {
    /// Rows of weight 0 take no part, whatever weight the others are given.
    fn of<'r>(rows: impl Iterator<Item = &'r Row<T>>, weight: impl Fn(&Row<T>) -> T) -> Self {
        let mut groups = [Group::empty(); Constellation::COUNT];
        for row in rows.filter(|row| row.weight > T::zero()) {
            if let Some(group) = row.clock.and_then(|clock| groups.get_mut(clock as usize)) {
                group.add(row, weight(row));
            }
        }
        Self(groups.map(Group::centre))
    }

    /// A constellation's, if one of its rows takes part.
    pub(super) fn of_clock(&self, clock: Constellation) -> Option<&Group<T>> {
        self.0.get(clock as usize).filter(|group| group.count > 0)
    }

    /// That of a row; one without rows has means, level and variance 0.
    pub(super) fn of_row(&self, row: &Row<T>) -> Option<&Group<T>> {
        self.0.get(row.clock? as usize)
    }

    fn clocks(&self) -> usize {
        self.0.iter().filter(|group| group.count > 0).count()
    }

    /// Trace of the covariance of all unknowns, clocks included.
    fn trace(&self, covariance: &Matrix3<T>) -> T {
        let clocks = self
            .0
            .iter()
            .filter(|group| group.count > 0)
            .map(|group| group.variance + group.design.dot(&(covariance * group.design)));
        clocks.fold(covariance.trace(), |sum, term| sum + term)
    }
}

/// What rows say of the position: everything of a snapshot but what it says of each row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Solution<T: Real> {
    pub(super) groups: Groups<T>,
    pub(super) covariance: Matrix3<T>,
    pub(super) correction: Vector3<T>,
    pub(super) used: usize,
    pub(super) dof: usize,
}

impl<T: Real> Solution<T> {
    /// Of no rows.
    pub(super) fn none() -> Self {
        Self {
            groups: Groups([Group::empty(); Constellation::COUNT]),
            covariance: Matrix3::zeros(),
            correction: Vector3::zeros(),
            used: 0,
            dof: 0,
        }
    }

    /// Solves for the rows that take part.
    ///
    /// # Errors
    /// As [`super::Workspace::solve`].
    pub(crate) fn of<'r>(rows: impl Iterator<Item = &'r Row<T>> + Clone) -> Result<Self, SnapshotError> {
        let mut solution = Self::none();
        solution.solve(rows)?;
        Ok(solution)
    }

    /// Solves in place: what is large is not moved. Writes nothing unless it succeeds.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub(super) fn solve<'r>(
        &mut self,
        rows: impl Iterator<Item = &'r Row<T>> + Clone,
    ) -> Result<(), SnapshotError> {
        let groups = Groups::of(rows.clone(), |row| row.weight);
        let equations = NormalEquations::of(rows.clone(), &groups, |row| row.weight);
        let dof = equations.used.checked_sub(3 + groups.clocks()).ok_or(SnapshotError::Insufficient)?;
        let covariance = invert(&equations.normal)?;
        if !is_determined(rows, equations.largest_weight, &groups, &covariance) {
            return Err(SnapshotError::Singular);
        }
        self.groups = groups;
        self.covariance = covariance;
        self.correction = covariance * equations.right_hand_side;
        self.used = equations.used;
        self.dof = dof;
        Ok(())
    }

    /// Covariance of the correction, m².
    pub(crate) fn covariance(&self) -> &Matrix3<T> {
        &self.covariance
    }

    /// Rows that take part.
    pub(crate) fn used(&self) -> usize {
        self.used
    }

    /// Degrees of freedom.
    pub(crate) fn dof(&self) -> usize {
        self.dof
    }

    /// True where a constellation has a row that takes part, and so a clock.
    pub(crate) fn determines(&self, clock: Constellation) -> bool {
        self.groups.of_clock(clock).is_some()
    }

    /// Variance `1/W_c` of the clock that a row touches, the position known, m²; 0 where no row determines it.
    pub(crate) fn level_variance(&self, row: &Row<T>) -> T {
        self.groups.of_row(row).map_or(T::zero(), |group| group.variance)
    }

    /// What is said of a row, whether it takes part or not.
    pub(crate) fn fit(&self, row: &Row<T>) -> Fit<T> {
        fit(row, self.groups.of_row(row), &self.covariance, &self.correction)
    }

    /// Says it of each row, in their order; the weighted sum of squared residuals.
    pub(super) fn fit_all(&self, rows: &[Row<T>], fits: &mut [Fit<T>]) -> T {
        // Copies, which the compiler keeps in registers while the fits are written.
        let (covariance, correction) = (self.covariance, self.correction);
        let mut sse = T::zero();
        for (row, slot) in rows.iter().zip(fits) {
            *slot = fit(row, self.groups.of_row(row), &covariance, &correction);
            sse += row.weight * slot.residual * slot.residual;
        }
        sse
    }
}

fn fit<T: Real>(
    row: &Row<T>,
    group: Option<&Group<T>>,
    covariance: &Matrix3<T>,
    correction: &Vector3<T>,
) -> Fit<T> {
    let (mean, level, variance) = group.map_or((Vector3::zeros(), T::zero(), T::zero()), |group| {
        (group.design, group.residual, group.variance)
    });
    let centred = row.design - mean;
    let gain = covariance * centred;
    // A lone satellite determines its clock: exactly nothing is left to test.
    let is_lone = group.is_some_and(|group| group.count == 1) && row.weight > T::zero();
    let redundancy = T::one() - row.weight * (variance + centred.dot(&gain));
    // Also the way out for what is not a number.
    let redundancy = if redundancy > T::zero() && !is_lone { redundancy } else { T::zero() };
    Fit {
        centred,
        gain,
        residual: row.residual - level - centred.dot(correction),
        redundancy,
        test_weight: if redundancy < T::UNTESTABLE { T::zero() } else { row.weight / redundancy },
    }
}

/// The geometry of the rows that take part, all with the same weight.
pub(super) struct Geometry<T: Real> {
    groups: Groups<T>,
    pub(super) covariance: Matrix3<T>,
}

impl<T: Real> Geometry<T> {
    pub(super) fn of<'r>(rows: impl Iterator<Item = &'r Row<T>> + Clone) -> Result<Self, SnapshotError> {
        let groups = Groups::of(rows.clone(), |_| T::one());
        let equations = NormalEquations::of(rows, &groups, |_| T::one());
        Ok(Self { groups, covariance: invert(&equations.normal)? })
    }

    pub(super) fn hdop_without(&self, row: &Row<T>) -> T {
        let group = self.groups.of_row(row);
        let (mean, share) =
            group.map_or((Vector3::zeros(), T::zero()), |group| (group.design, group.variance));
        let centred = row.design - mean;
        let gain = self.covariance * centred;
        let redundancy = T::one() - share - centred.dot(&gain);
        let moved = gain.x * gain.x + gain.y * gain.y;
        let increase = if redundancy > T::UNTESTABLE {
            moved / redundancy
        } else if gain.dot(&gain) > T::UNMOVED * T::UNMOVED {
            // Whichever coordinate it is: without this row there is no position at all.
            infinity()
        } else {
            T::zero()
        };
        (self.covariance.m11 + self.covariance.m22 + increase).sqrt()
    }
}

/// Infinity in the scalar at hand.
pub(crate) fn infinity<T: Real>() -> T {
    T::narrow(f64::INFINITY)
}

/// The normal equations of the rows that take part.
struct NormalEquations<T: Real> {
    normal: Matrix3<T>,
    right_hand_side: Vector3<T>,
    /// Rows that take part.
    used: usize,
    /// The largest of their own weights.
    largest_weight: T,
}

impl<T: Real> NormalEquations<T> {
    fn of<'r>(
        rows: impl Iterator<Item = &'r Row<T>>,
        groups: &Groups<T>,
        weight: impl Fn(&Row<T>) -> T,
    ) -> Self {
        let mut normal = Matrix3::zeros();
        let mut right_hand_side = Vector3::zeros();
        let (mut used, mut largest_weight) = (0, T::zero());
        for row in rows.filter(|row| row.weight > T::zero()) {
            let (mean, level) = groups
                .of_row(row)
                .map_or((Vector3::zeros(), T::zero()), |group| (group.design, group.residual));
            let centred = row.design - mean;
            let weighted = centred * weight(row);
            add_outer_product(&mut normal, &weighted, &centred);
            right_hand_side += weighted * (row.residual - level);
            used += 1;
            if row.weight > largest_weight {
                largest_weight = row.weight;
            }
        }
        Self { normal, right_hand_side, used, largest_weight }
    }
}

/// True when the trace of `(HᵀH)⁻¹`, clocks included, is below [`Real::SINGULAR`].
///
/// No weight being above `w_max`, that trace is at most `w_max` times the trace of the weighted covariance, which is
/// at hand; only where this bound does not decide is the unweighted geometry worked out.
fn is_determined<'r, T: Real>(
    rows: impl Iterator<Item = &'r Row<T>> + Clone,
    largest_weight: T,
    groups: &Groups<T>,
    covariance: &Matrix3<T>,
) -> bool {
    if largest_weight * groups.trace(covariance) < T::SINGULAR {
        return true;
    }
    // A trace that is not a number is below nothing.
    Geometry::of(rows).is_ok_and(|plain| plain.groups.trace(&plain.covariance) < T::SINGULAR)
}

/// Adds `a bᵀ`, lower triangle only: all that the inversion reads.
fn add_outer_product<T: Real>(matrix: &mut Matrix3<T>, a: &Vector3<T>, b: &Vector3<T>) {
    matrix.m11 += a.x * b.x;
    matrix.m21 += a.y * b.x;
    matrix.m22 += a.y * b.y;
    matrix.m31 += a.z * b.x;
    matrix.m32 += a.z * b.y;
    matrix.m33 += a.z * b.z;
}

/// Inverse of a symmetric matrix by `L D Lᵀ`, `P = L⁻ᵀ D⁻¹ L⁻¹`: no root, and a pivot that is not positive is singular.
///
/// Reads the lower triangle.
pub(crate) fn invert<T: Real>(normal: &Matrix3<T>) -> Result<Matrix3<T>, SnapshotError> {
    // Also the way out for a pivot that is not a number.
    let pivot = |value: T| if value > T::zero() { Ok(value.recip()) } else { Err(SnapshotError::Singular) };
    let d1 = pivot(normal.m11)?;
    let (l21, l31) = (normal.m21 * d1, normal.m31 * d1);
    let d2 = pivot(normal.m22 - l21 * normal.m21)?;
    let rest = normal.m32 - l31 * normal.m21;
    let l32 = rest * d2;
    let d3 = pivot(normal.m33 - l31 * normal.m31 - l32 * rest)?;
    // Third row of L⁻¹ below; its second row is (−l21, 1, 0).
    let (m31, m32) = (l21 * l32 - l31, -l32);
    let p21 = m31 * m32 * d3 - l21 * d2;
    let (p31, p32) = (m31 * d3, m32 * d3);
    let p11 = d1 + l21 * l21 * d2 + m31 * p31;
    let p22 = d2 + m32 * p32;
    Ok(Matrix3::new(p11, p21, p31, p21, p22, p32, p31, p32, d3))
}
