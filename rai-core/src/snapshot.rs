//! The snapshot: weighted least squares of one linearised epoch by a single 3×3 solve.
//!
//! Each range touches exactly one receiver clock, so clocks need no columns: centring the rows of each
//! constellation eliminates them. With the weighted means `h̄_c`, `ȳ_c` over the rows of constellation `c`
//! (`W_c = Σ w_i`),
//!
//! ```text
//! d_i = h_i − h̄_c      z_i = y_i − ȳ_c
//! N   = Σ w_i d_i d_iᵀ  P   = N⁻¹            x = P Σ w_i d_i z_i        b_c = ȳ_c − h̄_c·x
//! v_i = z_i − d_i·x     g_i = P d_i          r_i = 1 − w_i (1/W_c + d_i·g_i)
//! SSE = Σ w_i v_i²      dof = n − 3 − C
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `x` | [`Snapshot::correction`] east, north, up | m |
//! | `P` | [`Snapshot::covariance`] | m² |
//! | `v_i` | [`Fit::residual`] | m |
//! | `g_i` | [`Fit::gain`] (`w_i g_i` is the row of the least-squares gain) | m² |
//! | `r_i = S_ii` | [`Fit::redundancy`] number, 0 untestable … 1 fully tested | – |
//! | `w_i / r_i` | [`Fit::test_weight`] | 1/m² |
//! | `SSE` | [`Snapshot::sse`] | – |
//!
//! Equal to least squares with 3 + C columns in `x`, `v`, `S` and the gain, to rounding. Centring is also what makes
//! `f32` safe: the clocks and their size are gone.
//!
//! A row of weight 0 is left out: it contributes nothing, keeps its index, and its residual is that of a prediction.
//! No n×n matrix is stored; [`Snapshot::projection`] gives `S_ij` on demand.
//!
//! Cost of a solve on a Cortex-M4F in `f32`: 3,400 instructions for 20 satellites of two constellations. References:
//! [Baarda1968] for the redundancy numbers; the elimination of nuisance columns is the Frisch–Waugh–Lovell theorem.
//!
//! [Baarda1968]: crate#references

use core::fmt;

use heapless::Vec;
use nalgebra::{Matrix3, Vector3};

use crate::equations::{LinearEpoch, Row};
use crate::numeric::real::Real;
use crate::satellite::Constellation;

/// Why an epoch has no position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SnapshotError {
    /// Fewer rows than unknowns.
    Insufficient,
    /// The rows do not determine the unknowns.
    Singular,
}

impl fmt::Display for SnapshotError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Insufficient => "fewer ranges than unknowns",
            Self::Singular => "geometry is singular",
        })
    }
}

impl core::error::Error for SnapshotError {}

/// What the solution says of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit<T: Real> {
    /// Centred design row `d_i`.
    pub centred: Vector3<T>,
    /// `g_i = P d_i`, m².
    pub gain: Vector3<T>,
    /// Residual `v_i`, m.
    pub residual: T,
    /// Redundancy number `r_i`: the share of a bias that shows in the row's own residual.
    pub redundancy: T,
    /// `w_i / r_i`, 1/m², by which squared residuals become squared w-tests and squared gains squared slopes; 0 for a
    /// row that cannot be tested, and for one that is left out.
    pub test_weight: T,
}

impl<T: Real> Fit<T> {
    /// The w-test of the row, dimensionless; 0 where the row is untestable or left out.
    pub fn w_test(&self) -> T {
        self.residual * self.test_weight.sqrt()
    }

    /// The w-test squared, without the root: the decrease of SSE when the row is left out.
    pub fn w_squared(&self) -> T {
        self.residual * self.residual * self.test_weight
    }

    /// Of a row about which nothing has been said.
    fn nothing() -> Self {
        Self {
            centred: Vector3::zeros(),
            gain: Vector3::zeros(),
            residual: T::zero(),
            redundancy: T::zero(),
            test_weight: T::zero(),
        }
    }
}

/// One constellation's weighted means.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Group<T: Real> {
    count: usize,
    weight: T,
    /// `1/W_c`.
    variance: T,
    design: Vector3<T>,
    residual: T,
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

type Groups<T> = [Group<T>; Constellation::COUNT];

/// A solved epoch: at most `N` rows, everything derived from one 3×3 solve.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot<T: Real, const N: usize> {
    epoch: LinearEpoch<T, N>,
    fits: Vec<Fit<T>, N>,
    groups: Groups<T>,
    covariance: Matrix3<T>,
    correction: Vector3<T>,
    sse: T,
    used: usize,
    dof: usize,
}

impl<T: Real, const N: usize> Snapshot<T, N> {
    /// Solves the epoch.
    ///
    /// # Errors
    /// [`SnapshotError::Insufficient`] with fewer rows than unknowns (an empty epoch too),
    /// [`SnapshotError::Singular`] where the rows do not determine them.
    pub fn solve(epoch: LinearEpoch<T, N>) -> Result<Self, SnapshotError> {
        let mut snapshot = Self::unsolved();
        snapshot.epoch = epoch;
        snapshot.solve_again()?;
        Ok(snapshot)
    }

    /// Room for equations and their solution: nothing in it means anything before [`Self::solve_again`] succeeds.
    #[inline(never)]
    pub(crate) fn unsolved() -> Self {
        Self {
            epoch: LinearEpoch::new(),
            fits: Vec::new(),
            groups: [Group::empty(); Constellation::COUNT],
            covariance: Matrix3::zeros(),
            correction: Vector3::zeros(),
            sse: T::zero(),
            used: 0,
            dof: 0,
        }
    }

    /// The equations, to be replaced; [`Self::solve_again`] must follow.
    pub(crate) fn epoch_mut(&mut self) -> &mut LinearEpoch<T, N> {
        &mut self.epoch
    }

    /// Leaves one more row out and solves again, in place.
    ///
    /// # Errors
    /// As [`Self::solve`]; the snapshot is then unchanged.
    pub fn leave_out(&mut self, index: usize) -> Result<(), SnapshotError> {
        self.epoch.leave_out(index);
        let solved = self.solve_again();
        if solved.is_err() {
            self.epoch.take_back(index);
        }
        solved
    }

    /// Takes a left-out row back and solves again, in place.
    ///
    /// # Errors
    /// As [`Self::solve`]; the snapshot is then unchanged.
    pub fn take_back(&mut self, index: usize) -> Result<(), SnapshotError> {
        self.epoch.take_back(index);
        let solved = self.solve_again();
        if solved.is_err() {
            self.epoch.leave_out(index);
        }
        solved
    }

    /// One 3×3 solve over the rows as they stand now; changes nothing unless it succeeds.
    pub(crate) fn solve_again(&mut self) -> Result<(), SnapshotError> {
        let rows = self.epoch.rows();
        let groups = centre(rows, |row| row.weight);
        let equations = normal_equations(rows, &groups, |row| row.weight);
        let clocks = groups.iter().filter(|group| group.count > 0).count();
        let dof = equations.used.checked_sub(3 + clocks).ok_or(SnapshotError::Insufficient)?;

        let covariance = invert(&equations.normal)?;
        if !is_determined(rows, equations.largest_weight, &groups, &covariance) {
            return Err(SnapshotError::Singular);
        }
        self.groups = groups;
        self.covariance = covariance;
        self.correction = covariance * equations.right_hand_side;
        self.used = equations.used;
        self.dof = dof;
        self.fit_rows();
        Ok(())
    }

    fn fit_rows(&mut self) {
        // Copies, which the compiler keeps in registers while the fits are written.
        let (covariance, correction) = (self.covariance, self.correction);
        let mut sse = T::zero();
        // Both vectors hold N: there is always room. One that is long enough is written over, which spares the way round
        // by the stack.
        self.fits.truncate(self.epoch.rows().len());
        while self.fits.len() < self.epoch.rows().len() && self.fits.push(Fit::nothing()).is_ok() {}
        for (row, slot) in self.epoch.rows().iter().zip(&mut self.fits) {
            let group = row.clock.and_then(|clock| self.groups.get(clock as usize));
            *slot = fit(row, group, &covariance, &correction);
            sse += row.weight * slot.residual * slot.residual;
        }
        self.sse = sse;
    }

    /// The equations, left-out ones included.
    pub fn epoch(&self) -> &LinearEpoch<T, N> {
        &self.epoch
    }

    /// Rows of the epoch, left-out ones included, each with what the solution says of it.
    pub fn rows(&self) -> impl Iterator<Item = (&Row<T>, &Fit<T>)> {
        self.epoch.rows().iter().zip(&self.fits)
    }

    /// What the solution says of each row, in their order.
    pub fn fits(&self) -> &[Fit<T>] {
        &self.fits
    }

    /// One row with what the solution says of it.
    pub fn row(&self, index: usize) -> Option<(&Row<T>, &Fit<T>)> {
        self.epoch.rows().get(index).zip(self.fits.get(index))
    }

    /// Correction of the position, east, north, up, m.
    pub fn correction(&self) -> Vector3<T> {
        self.correction
    }

    /// Covariance of the correction, m².
    pub fn covariance(&self) -> &Matrix3<T> {
        &self.covariance
    }

    /// Weighted sum of squared residuals, dimensionless.
    pub fn sse(&self) -> T {
        self.sse
    }

    /// Rows that take part.
    pub fn used(&self) -> usize {
        self.used
    }

    /// Degrees of freedom: rows that take part, less 3, less the clocks among them.
    pub fn dof(&self) -> usize {
        self.dof
    }

    /// Receiver clock of a constellation times the speed of light, m; `None` where it has no row that takes part.
    pub fn clock_m(&self, constellation: Constellation) -> Option<f64> {
        let group = self.groups.get(constellation as usize).filter(|group| group.count > 0)?;
        let relative = group.residual - group.design.dot(&self.correction);
        Some(self.epoch.reference_m(constellation)? + relative.widen())
    }

    /// True where a constellation has a row that takes part, and so a clock.
    pub fn determines(&self, constellation: Constellation) -> bool {
        self.groups.get(constellation as usize).is_some_and(|group| group.count > 0)
    }

    /// Variance of [`Self::clock_m`], m²: `1/W_c + h̄_c P h̄_cᵀ`.
    pub fn clock_variance(&self, constellation: Constellation) -> Option<T> {
        let group = self.groups.get(constellation as usize).filter(|group| group.count > 0)?;
        Some(group.variance + group.design.dot(&(self.covariance * group.design)))
    }

    /// Variance `1/W_c` of the clock that a row touches, the position known, m²; 0 where no row determines it.
    pub fn level_variance(&self, row: &Row<T>) -> T {
        let group = row.clock.and_then(|clock| self.groups.get(clock as usize));
        group.map_or(T::zero(), |group| group.variance)
    }

    /// Element `S_ij` of the matrix that projects ranges on normalised residuals; `None` outside the epoch.
    pub fn projection(&self, i: usize, j: usize) -> Option<T> {
        let (row_i, fit_i) = self.row(i)?;
        let (row_j, fit_j) = self.row(j)?;
        if i == j {
            return Some(fit_i.redundancy);
        }
        let shared = match (row_i.clock, row_j.clock) {
            (Some(a), Some(b)) if a == b => {
                self.groups.get(a as usize).map_or(T::zero(), |group| group.variance)
            }
            _ => T::zero(),
        };
        Some(-(row_i.weight * row_j.weight).sqrt() * (shared + fit_i.centred.dot(&fit_j.gain)))
    }

    /// Horizontal and vertical dilution of precision, dimensionless, of the unweighted geometry.
    pub fn dilutions(&self) -> (T, T) {
        // What was solved is not singular: the fall-back is never taken.
        let geometry = Geometry::of(self.epoch.rows());
        let covariance = geometry.map_or(self.covariance, |geometry| geometry.covariance);
        ((covariance.m11 + covariance.m22).sqrt(), covariance.m33.sqrt())
    }

    /// HDOP without one row: `√(HDOP² + (A_1i² + A_2i²)/S_ii)` of the unweighted geometry ([Lin2016] eq. 22).
    ///
    /// The lone satellite of a constellation takes its clock with it and changes nothing; a row without which the
    /// geometry is singular gives infinity. `None` for a row that takes no part.
    ///
    /// [Lin2016]: crate#references
    pub fn hdop_without(&self, index: usize) -> Option<T> {
        let (row, _) = self.row(index).filter(|(row, _)| row.weight > T::zero())?;
        Some(Geometry::of(self.epoch.rows()).ok()?.hdop_without(row))
    }
}

/// What can be tested, and solved again without one of its rows.
pub trait Reducible<T: Real, const N: usize> {
    /// The linearised epoch as it stands.
    fn snapshot(&self) -> &Snapshot<T, N>;

    /// Leaves one more row out.
    ///
    /// # Errors
    /// What is left does not determine a position; nothing has changed then.
    fn leave_out(&mut self, index: usize) -> Result<(), SnapshotError>;

    /// Takes rows back, all at once and about the same point: what is compared next are exclusions of the same epoch.
    ///
    /// # Errors
    /// As [`Self::leave_out`].
    fn take_back(&mut self, rows: &[usize]) -> Result<(), SnapshotError>;

    /// Leaves rows out again that were taken back: the solution is then what it was before.
    ///
    /// # Errors
    /// As [`Self::leave_out`].
    fn set_aside(&mut self, rows: &[usize]) -> Result<(), SnapshotError>;
}

impl<T: Real, const N: usize> Reducible<T, N> for Snapshot<T, N> {
    fn snapshot(&self) -> &Snapshot<T, N> {
        self
    }

    fn leave_out(&mut self, index: usize) -> Result<(), SnapshotError> {
        Snapshot::leave_out(self, index)
    }

    fn take_back(&mut self, rows: &[usize]) -> Result<(), SnapshotError> {
        self.epoch.take_all_back(rows);
        let solved = self.solve_again();
        if solved.is_err() {
            self.epoch.leave_all_out(rows);
        }
        solved
    }

    fn set_aside(&mut self, rows: &[usize]) -> Result<(), SnapshotError> {
        self.epoch.leave_all_out(rows);
        let solved = self.solve_again();
        if solved.is_err() {
            self.epoch.take_all_back(rows);
        }
        solved
    }
}

/// The geometry of the rows that take part, all with the same weight.
struct Geometry<T: Real> {
    groups: Groups<T>,
    covariance: Matrix3<T>,
}

impl<T: Real> Geometry<T> {
    fn of(rows: &[Row<T>]) -> Result<Self, SnapshotError> {
        let groups = centre(rows, |_| T::one());
        let equations = normal_equations(rows, &groups, |_| T::one());
        Ok(Self { groups, covariance: invert(&equations.normal)? })
    }

    fn hdop_without(&self, row: &Row<T>) -> T {
        let group = row.clock.and_then(|clock| self.groups.get(clock as usize));
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

/// Rows of weight 0 take no part, whatever weight the others are given.
fn centre<T: Real>(rows: &[Row<T>], weight: impl Fn(&Row<T>) -> T) -> Groups<T> {
    let mut groups = [Group::empty(); Constellation::COUNT];
    for row in rows.iter().filter(|row| row.weight > T::zero()) {
        if let Some(group) = row.clock.and_then(|clock| groups.get_mut(clock as usize)) {
            group.add(row, weight(row));
        }
    }
    groups.map(Group::centre)
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

fn normal_equations<T: Real>(
    rows: &[Row<T>],
    groups: &Groups<T>,
    weight: impl Fn(&Row<T>) -> T,
) -> NormalEquations<T> {
    let mut normal = Matrix3::zeros();
    let mut right_hand_side = Vector3::zeros();
    let (mut used, mut largest_weight) = (0, T::zero());
    for row in rows.iter().filter(|row| row.weight > T::zero()) {
        let group = row.clock.and_then(|clock| groups.get(clock as usize));
        let (mean, level) =
            group.map_or((Vector3::zeros(), T::zero()), |group| (group.design, group.residual));
        let centred = row.design - mean;
        let weighted = centred * weight(row);
        add_outer_product(&mut normal, &weighted, &centred);
        right_hand_side += weighted * (row.residual - level);
        used += 1;
        if row.weight > largest_weight {
            largest_weight = row.weight;
        }
    }
    NormalEquations { normal, right_hand_side, used, largest_weight }
}

/// True when the trace of `(HᵀH)⁻¹`, clocks included, is below [`Real::SINGULAR`].
///
/// No weight being above `w_max`, that trace is at most `w_max` times the trace of the weighted covariance, which is
/// at hand; only where this bound does not decide is the unweighted geometry worked out.
fn is_determined<T: Real>(
    rows: &[Row<T>],
    largest_weight: T,
    groups: &Groups<T>,
    covariance: &Matrix3<T>,
) -> bool {
    if largest_weight * trace(covariance, groups) < T::SINGULAR {
        return true;
    }
    // A trace that is not a number is below nothing.
    Geometry::of(rows).is_ok_and(|plain| trace(&plain.covariance, &plain.groups) < T::SINGULAR)
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

/// Trace of the covariance of all unknowns, clocks included.
fn trace<T: Real>(covariance: &Matrix3<T>, groups: &Groups<T>) -> T {
    let clocks = groups
        .iter()
        .filter(|group| group.count > 0)
        .map(|group| group.variance + group.design.dot(&(covariance * group.design)));
    clocks.fold(covariance.trace(), |sum, term| sum + term)
}

fn fit<T: Real>(
    row: &Row<T>,
    group: Option<&Group<T>>,
    covariance: &Matrix3<T>,
    correction: &Vector3<T>,
) -> Fit<T> {
    // An empty group has means, level and variance 0: the row stands by itself.
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
