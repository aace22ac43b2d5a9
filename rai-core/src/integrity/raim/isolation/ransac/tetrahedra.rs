//! The largest tetrahedron among unit vectors. A bound excludes most of the candidates.
//!
//! Six volumes of a tetrahedron are a determinant. Its square is a Gram determinant in the metric
//! of any positive definite `M`. Fischer's inequality bounds it by two of the four directions and
//! by the longest of all:
//!
//! ```text
//! 6 V = |det(u_2 − u_1, u_3 − u_1, u_4 − u_1)| = |det(h_1, h_2, h_3, h_4)|,   h = (u, 1)
//! (6 V)² = det M · det(g_ij) ≤ det M · (g_11 g_22 − g_12²) · g_max²,   g_ij = h_iᵀ M⁻¹ h_j,   g_max the largest g_ii
//! M = Σ w_i h_i h_iᵀ,   w_i ← w_i (g_ii / g_max)²
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `u` | unit vector to a satellite | – |
//! | `V` | volume of the tetrahedron of four unit vectors | – |
//! | `g_ii` | leverage of a direction | – |
//! | `w` | its weight in the metric, at first 1 | – |
//!
//! 1. Exchange: one corner after another is replaced by the best one, until none is better. This
//!    starts once from the first four directions, and once from the last four. The larger result is
//!    mostly the largest of all.
//! 2. The weights make the leverages of the relevant directions nearly equal, as in the design of
//!    experiments ([Kiefer1960]). The bound is true for any weights; with these it is tight.
//! 3. If the bound of two directions is below the result of the exchange, they are not both corners
//!    of the largest tetrahedron. Only tetrahedra without such a pair are computed, in
//!    lexicographic order.
//!
//! The result equals that of an exhaustive search; of several equal ones it is the first. If the
//! directions nearly lie in a plane, the metric is too inaccurate, and all tetrahedra are compared.
//!
//! **Work.** The number of compared triangles and tetrahedra is some hundreds for 40 directions
//! over a sky, and at most `C(n + 1, 4)`. If the budget is used up, the best tetrahedron so far is
//! returned, which is at most 2 % smaller than the result of the exchange.
//!
//! References: [Kiefer1960] for the weights; its equivalence theorem states when they are best.
//!
//! [Kiefer1960]: crate#references

use heapless::Vec;
use nalgebra::Vector3;

use crate::bit_set::{above, bit, members};
use crate::bounded::{fill, gather};
use crate::numeric::cholesky::{Cholesky, Matrix, ORDER, Vector, add_outer_product, dot, product, trace};
use crate::numeric::real::Real;
use crate::numeric::space::{self, cross, difference};

/// Largest number of exchanges of a corner; a sky of 40 directions mostly needs nine.
const EXCHANGES: usize = 32;

/// Least factor by which an exchange enlarges the volume, so that rounding cannot continue the
/// exchange.
const ENLARGED: f64 = 1.001;

/// Number of iterations of the weights.
const IMPROVEMENTS: usize = 2;

/// Largest condition number of `M` for which the metric is used.
///
/// The error of `M⁻¹` is then below 1 %: ten roundings of `f32`, 6e-8 each, times this number.
const MAX_CONDITION: f64 = 1e4;

/// Share of the exchange's volume that the bound of a pair must reach. It is below 1, so that
/// rounding does not exclude a larger tetrahedron.
const REACHED: f64 = 0.98;

/// A satellite's row index and direction.
pub(super) type Corner<'r, T> = (usize, &'r Vector3<T>);

/// Budget of triangles and tetrahedra that may still be compared.
pub(super) struct TetrahedronBudget {
    pub(super) left: usize,
    /// True if the budget was not sufficient.
    pub(super) cut: bool,
}

impl TetrahedronBudget {
    /// Charges the budget. Returns false if it is not sufficient.
    fn spend(&mut self, work: usize) -> bool {
        match self.left.checked_sub(work) {
            Some(left) => self.left = left,
            None => self.cut = true,
        }
        !self.cut
    }
}

/// Returns the row indices of the corners of the largest tetrahedron, or `None` if all directions
/// lie in one plane.
pub(super) fn largest<T: Real, const N: usize>(
    corners: &[Corner<'_, T>],
    work: &mut TetrahedronBudget,
) -> Option<[usize; 4]> {
    let start = start(corners);
    let volume = start.as_ref().map_or(T::zero(), |start| start.volume);
    let least = volume * T::narrow(REACHED);
    let mut search = TetrahedronSearch::<'_, T, N> {
        corners,
        companions: Vec::new(),
        largest: least,
        found: start.map(|start| start.rows),
    };
    find_companions(corners, least, &mut search.companions);
    search.run(work);
    search.found
}

/// A plane through three directions.
struct Plane<T: Real> {
    /// Normal vector, as long as twice the triangle's area.
    normal: Vector3<T>,
    level: T,
}

impl<T: Real> Plane<T> {
    fn through([a, b, c]: [&Corner<'_, T>; 3]) -> Self {
        let normal = cross(&difference(b.1, a.1), &difference(c.1, a.1));
        Self { normal, level: space::dot(&normal, a.1) }
    }

    /// Returns six volumes of the tetrahedron from the triangle to a tip.
    fn volume(&self, tip: &Corner<'_, T>) -> T {
        (space::dot(&self.normal, tip.1) - self.level).abs()
    }
}

/// Four directions that no exchange of one corner enlarges.
struct ExchangeOptimum<T> {
    volume: T,
    rows: [usize; 4],
}

/// Returns the larger result of the exchange from the first four and from the last four, or `None`
/// if all lie in one plane.
fn start<T: Real>(corners: &[Corner<'_, T>]) -> Option<ExchangeOptimum<T>> {
    let ends = [corners.first_chunk(), corners.last_chunk()];
    let ended = ends.into_iter().flatten().filter_map(|four| exchanged(corners, four.each_ref()));
    ended.reduce(|one, other| if other.volume > one.volume { other } else { one })
}

/// Exchanges corners until no exchange of one corner enlarges the volume.
fn exchanged<'c, T: Real>(
    corners: &'c [Corner<'c, T>],
    mut four: [&'c Corner<'c, T>; 4],
) -> Option<ExchangeOptimum<T>> {
    let (mut volume, mut unchanged) = (T::zero(), 0);
    for _ in 0..EXCHANGES {
        let [_, b, c, d] = four;
        let plane = Plane::through([b, c, d]);
        let volumes = corners.iter().map(|tip| (plane.volume(tip), tip));
        let best = volumes.reduce(|best, next| if next.0 > best.0 { next } else { best });
        let (reached, tip) = best?;
        unchanged = if reached > volume * T::narrow(ENLARGED) { 0 } else { unchanged + 1 };
        (volume, four) = (reached, [b, c, d, tip]);
        // The corner that was exchanged last is already the best one.
        if unchanged == 3 {
            break;
        }
    }
    (volume > T::zero()).then_some(ExchangeOptimum { volume, rows: four.map(|corner| corner.0) })
}

/// Finds for each direction the set of later ones with which it may span a volume of at least
/// `least`.
///
/// Not inlined, so that the stack of the metric is free during the search.
#[inline(never)]
fn find_companions<T: Real, const N: usize>(
    corners: &[Corner<'_, T>],
    least: T,
    companions: &mut Vec<u64, N>,
) {
    let Some(metric) = Metric::<T, N>::over(corners) else {
        return fill(companions, (0..corners.len()).map(above));
    };
    let needed = least * least / (metric.determinant * metric.largest * metric.largest);
    let later = |index: usize, row: &Vector<T>, leverage: T| {
        let gain = product(&metric.inverse, row);
        let rest = corners.iter().zip(&metric.leverages).enumerate().skip(index + 1);
        rest.fold(0, |set, (other, ((_, direction), &of_other))| {
            let shared = dot(&gain, &with_clock(direction));
            if leverage * of_other - shared * shared >= needed { set | bit(other) } else { set }
        })
    };
    let each = corners.iter().zip(&metric.leverages).enumerate();
    fill(
        companions,
        each.map(|(index, ((_, direction), &leverage))| later(index, &with_clock(direction), leverage)),
    );
}

/// Returns `h`.
pub(super) fn with_clock<T: Real>(direction: &Vector3<T>) -> Vector<T> {
    [direction.x, direction.y, direction.z, T::one()]
}

/// The metric `M⁻¹` with its leverages.
struct Metric<T: Real, const N: usize> {
    /// `M⁻¹`.
    inverse: Matrix<T>,
    determinant: T,
    leverages: Vec<T, N>,
    /// Largest of the leverages.
    largest: T,
}

impl<T: Real, const N: usize> Metric<T, N> {
    /// Returns the metric in which the relevant directions have about the same length, or `None` if
    /// they nearly lie in a plane.
    fn over(corners: &[Corner<'_, T>]) -> Option<Self> {
        let mut weights: Vec<T, N> = gather(corners.iter().map(|_| T::one()));
        for _ in 0..IMPROVEMENTS {
            let metric = Self::weighted(corners, &weights)?;
            for (weight, &leverage) in weights.iter_mut().zip(&metric.leverages) {
                let ratio = leverage / metric.largest;
                *weight *= ratio * ratio;
            }
        }
        Self::weighted(corners, &weights)
    }

    #[inline(never)]
    fn weighted(corners: &[Corner<'_, T>], weights: &[T]) -> Option<Self> {
        let rows = || corners.iter().map(|(_, direction)| with_clock(direction));
        let mut normal = [[T::zero(); ORDER]; ORDER];
        for (row, &weight) in rows().zip(weights) {
            add_outer_product(&mut normal, &row, &row.map(|entry| entry * weight));
        }
        let factor = Cholesky::new(&normal)?;
        let (inverse, determinant) = (factor.inverse(), factor.determinant());
        let is_sound = trace(&normal) * trace(&inverse) <= T::narrow(MAX_CONDITION);
        let leverages: Vec<T, N> = gather(rows().map(|row| dot(&row, &product(&inverse, &row))));
        let largest = leverages.iter().fold(T::zero(), |largest, &leverage| largest.max(leverage));
        is_sound.then_some(Self { inverse, determinant, leverages, largest })
    }
}

/// Search over the tetrahedra that no pair excludes.
struct TetrahedronSearch<'c, T: Real, const N: usize> {
    corners: &'c [Corner<'c, T>],
    companions: Vec<u64, N>,
    largest: T,
    found: Option<[usize; 4]>,
}

impl<T: Real, const N: usize> TetrahedronSearch<'_, T, N> {
    fn run(&mut self, work: &mut TetrahedronBudget) {
        for a in 0..self.corners.len() {
            let of_a = self.after(a);
            for b in members(of_a) {
                let of_both = of_a & self.after(b);
                for c in members(of_both) {
                    let tips = of_both & self.after(c);
                    if tips == 0 {
                        continue;
                    }
                    if !work.spend(1 + tips.count_ones() as usize) {
                        return;
                    }
                    self.over_triangle([a, b, c], tips);
                }
            }
        }
    }

    /// Returns the later directions that may be in a tetrahedron with this one.
    fn after(&self, index: usize) -> u64 {
        self.companions.get(index).copied().unwrap_or(0)
    }

    /// Compares the tetrahedra over one triangle.
    fn over_triangle(&mut self, [a, b, c]: [usize; 3], tips: u64) {
        let corner = |index: usize| self.corners.get(index);
        let (Some(a), Some(b), Some(c)) = (corner(a), corner(b), corner(c)) else { return };
        let plane = Plane::through([a, b, c]);
        for tip in members(tips).filter_map(corner) {
            let volume = plane.volume(tip);
            if volume > self.largest {
                self.largest = volume;
                self.found = Some([a.0, b.0, c.0, tip.0]);
            }
        }
    }
}
