//! Selection: deals the satellites into disjoint subsets of good geometry.
//!
//! Each subset begins with the four free satellites that span the largest tetrahedron. If it lacks
//! a constellation, a satellite of that constellation is added. Then the smallest subset receives,
//! again and again, the free satellite that improves its geometry most:
//!
//! ```text
//! 6 V = |det(u_2 − u_1, u_3 − u_1, u_4 − u_1)|
//! ΔGDOP_i² = |G h_i|² / (1 + h_iᵀ G h_i),   G = (Σ h hᵀ)⁻¹ over the subset,   h = (−LOS, 1)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `u` | unit vector to a satellite | – |
//! | `V` | volume of the tetrahedron of four unit vectors | – |
//! | `ΔGDOP_i²` | exact decrease of `tr G` when satellite `i` joins (Sherman–Morrison) | – |
//!
//! The first of equal tetrahedra, satellites or subsets is chosen. Geometry is compared with one
//! common clock and without weights, as in [Tian2024]. The clocks of several constellations matter
//! only when a subset is solved.
//!
//! **Work.** The largest tetrahedron is found exactly, but most are never computed: a bound on two
//! directions excludes them (`tetrahedra.rs`). Every computed one counts as work. [`MAX_WORK`]
//! suffices for 24 satellites in any geometry. In 300 random skies of 40 satellites the mean work
//! was 1,400, the largest 8,700. If the budget is used up, [`Selection::cut`] is true. The number
//! of subsets is then the same, and no exchange of one corner enlarges a tetrahedron by much.
//!
//! The result depends on the geometry alone, which hardly changes in minutes. It can be stored as
//! long as the same satellites are visible.
//!
//! [Tian2024]: crate#references

use heapless::Vec;
use nalgebra::Vector3;

use super::tetrahedra::{Corner, TetrahedronBudget, largest, with_clock};
use crate::bit_set::bit;
use crate::bounded::{fill, gather};
use crate::least_squares::equations::{MAX_ROWS, Row};
use crate::numeric::cholesky::{Cholesky, Matrix, ORDER, Vector, add_outer_product, dot, product};
use crate::numeric::real::Real;
use crate::numeric::space::is_zero;
use crate::satellite::Constellation;

/// Most subsets, of four rows each: as many as [`MAX_ROWS`] of one constellation give.
pub const MAX_SUBSETS: usize = MAX_ROWS / 4;

/// Number of triangles and tetrahedra of all subsets of 24 satellites.
pub const MAX_WORK: usize = work_for(24);
const _: () = assert!(MAX_WORK == 21_861);

/// Returns `Σ C(s, 3) + C(s, 4) = Σ C(s + 1, 4)`, where `s` is the number of free satellites before
/// each subset.
const fn work_for(satellites: usize) -> usize {
    let (mut work, mut free) = (0, satellites);
    while free >= 4 {
        work += (free + 1) * free * (free - 1) * (free - 2) / 24;
        free -= 4;
    }
    work
}

/// Assignment of the rows of an epoch to subsets.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection<const N: usize = MAX_ROWS> {
    members: Vec<Option<u8>, N>,
    subsets: usize,
    work: usize,
    cut: bool,
}

impl<const N: usize> Selection<N> {
    /// Returns the selection for no rows.
    pub const fn none() -> Self {
        Self { members: Vec::new(), subsets: 0, work: 0, cut: false }
    }

    /// Deals the rows of an epoch that take part; aiding rows are in no subset.
    ///
    /// `work` is the budget of the search for tetrahedra: [`MAX_WORK`], or less if time is short.
    pub fn choose<T: Real>(rows: &[Row<T>], work: usize) -> Self {
        let mut selection = Self::none();
        selection.deal(rows, work);
        selection
    }

    /// Works like [`Self::choose`], in place of the previous selection.
    #[inline(never)]
    pub(super) fn deal<T: Real>(&mut self, rows: &[Row<T>], work: usize) {
        let mut dealer = Dealer::<T, N>::new(work);
        dealer.take_candidates(rows);
        dealer.span_tetrahedra();
        dealer.complete_constellations();
        dealer.deal_the_rest();
        self.members.clear();
        // Never full, because there are at most [`MAX_ROWS`] rows.
        let _ = self.members.resize(rows.len(), None);
        for candidate in &dealer.candidates {
            if let Some(member) = self.members.get_mut(candidate.index) {
                *member = candidate.subset;
            }
        }
        self.subsets = dealer.subsets.len();
        self.work = work - dealer.work.left;
        self.cut = dealer.work.cut;
    }

    /// Returns the number of subsets.
    pub fn subsets(&self) -> usize {
        self.subsets
    }

    /// Returns the number of rows of the epoch that the selection was made for.
    pub fn rows(&self) -> usize {
        self.members.len()
    }

    /// Returns true if a row belongs to a subset.
    pub fn contains(&self, subset: usize, row: usize) -> bool {
        self.members.get(row).is_some_and(|member| member.map(usize::from) == Some(subset))
    }

    /// Returns the rows of a subset.
    pub(super) fn set(&self, subset: usize) -> u64 {
        let members = (0..self.members.len()).filter(|&row| self.contains(subset, row));
        members.fold(0, |set, row| set | bit(row))
    }

    /// Returns the number of triangles and tetrahedra compared.
    pub fn work(&self) -> usize {
        self.work
    }

    /// Returns true if the work was used up before every tetrahedron was compared.
    pub fn cut(&self) -> bool {
        self.cut
    }
}

/// A satellite to deal.
struct DealtSatellite<T: Real> {
    index: usize,
    clock: Constellation,
    design: Vector3<T>,
    subset: Option<u8>,
}

impl<T: Real> DealtSatellite<T> {
    /// Returns `h`, with the common clock.
    fn row(&self) -> Vector<T> {
        with_clock(&self.design)
    }
}

/// Geometry of a subset, by which its next member is chosen.
struct Subset<T: Real> {
    size: usize,
    /// `G`; zero if the first four lie in a plane. No further row changes it then.
    covariance: Matrix<T>,
}

impl<T: Real> Subset<T> {
    #[inline(never)]
    fn of(rows: impl Iterator<Item = Vector<T>>) -> Self {
        let nothing = [[T::zero(); ORDER]; ORDER];
        let (mut size, mut normal) = (0, nothing);
        for row in rows {
            size += 1;
            add_outer_product(&mut normal, &row, &row);
        }
        let covariance = Cholesky::new(&normal).map_or(nothing, |factor| factor.inverse());
        Self { size, covariance }
    }

    /// Returns `ΔGDOP²` of one more row.
    fn contribution(&self, row: &Vector<T>) -> T {
        let gain = product(&self.covariance, row);
        dot(&gain, &gain) / (T::one() + dot(row, &gain))
    }

    fn add(&mut self, row: &Vector<T>) {
        let gain = product(&self.covariance, row);
        let length = T::one() + dot(row, &gain);
        for (column, &of_column) in self.covariance.iter_mut().zip(&gain) {
            for (entry, &of_row) in column.iter_mut().zip(&gain) {
                *entry -= of_row * of_column / length;
            }
        }
        self.size += 1;
    }
}

/// The satellites, the subsets so far, and the remaining budget.
struct Dealer<T: Real, const N: usize> {
    candidates: Vec<DealtSatellite<T>, N>,
    subsets: Vec<Subset<T>, MAX_SUBSETS>,
    work: TetrahedronBudget,
}

impl<T: Real, const N: usize> Dealer<T, N> {
    fn new(work: usize) -> Self {
        Self {
            candidates: Vec::new(),
            subsets: Vec::new(),
            work: TetrahedronBudget { left: work, cut: false },
        }
    }

    fn take_candidates(&mut self, rows: &[Row<T>]) {
        let satellites = rows.iter().enumerate().filter_map(|(index, row)| {
            let takes_part = row.weight > T::zero() && !is_zero(&row.design);
            let clock = row.clock.filter(|_| takes_part)?;
            Some(DealtSatellite { index, clock, design: row.design, subset: None })
        });
        fill(&mut self.candidates, satellites);
    }

    fn constellations(&self) -> impl Iterator<Item = Constellation> {
        let occurs = |clock| self.candidates.iter().any(|candidate| candidate.clock == clock);
        Constellation::ALL.into_iter().filter(move |&clock| occurs(clock))
    }

    fn span_tetrahedra(&mut self) {
        let unknowns = 3 + self.constellations().count();
        let subsets = self.candidates.len().checked_div(unknowns).unwrap_or(0);
        for _ in 0..subsets.min(MAX_SUBSETS) {
            let Some(corners) = self.largest_tetrahedron() else { return };
            let number = self.subsets.len() as u8;
            for candidate in &mut self.candidates {
                if corners.contains(&candidate.index) {
                    candidate.subset = Some(number);
                }
            }
            let members = self.candidates.iter().filter(|candidate| candidate.subset == Some(number));
            // Never full, because there are at most MAX_SUBSETS rounds.
            let _ = self.subsets.push(Subset::of(members.map(DealtSatellite::row)));
        }
    }

    /// Returns the row indices of the four free satellites that span the largest tetrahedron.
    fn largest_tetrahedron(&mut self) -> Option<[usize; 4]> {
        let free = self.candidates.iter().filter(|candidate| candidate.subset.is_none());
        let mut corners = Vec::<Corner<'_, T>, N>::new();
        fill(&mut corners, free.map(|candidate| (candidate.index, &candidate.design)));
        largest::<T, N>(&corners, &mut self.work)
    }

    fn complete_constellations(&mut self) {
        let present: Vec<Constellation, { Constellation::COUNT }> = gather(self.constellations());
        for number in 0..self.subsets.len() {
            for &clock in &present {
                let known = |candidate: &DealtSatellite<T>| {
                    candidate.clock == clock && candidate.subset == Some(number as u8)
                };
                if !self.candidates.iter().any(known) {
                    self.take_best(number, Some(clock));
                }
            }
        }
    }

    fn deal_the_rest(&mut self) {
        for _ in 0..self.candidates.len() {
            let smallest = self.subsets.iter().enumerate().min_by_key(|(_, subset)| subset.size);
            let Some((number, _)) = smallest else { return };
            self.take_best(number, None);
        }
    }

    /// Assigns to a subset the free satellite that improves it most, of one clock or of any.
    #[inline(never)]
    fn take_best(&mut self, number: usize, clock: Option<Constellation>) {
        let Some(subset) = self.subsets.get_mut(number) else { return };
        let free = self.candidates.iter_mut().filter(|candidate| candidate.subset.is_none());
        let mut best: Option<(T, &mut DealtSatellite<T>)> = None;
        for candidate in free.filter(|candidate| clock.is_none_or(|clock| candidate.clock == clock)) {
            let contribution = subset.contribution(&candidate.row());
            if best.as_ref().is_none_or(|(largest, _)| contribution > *largest) {
                best = Some((contribution, candidate));
            }
        }
        if let Some((_, candidate)) = best {
            subset.add(&candidate.row());
            candidate.subset = Some(number as u8);
        }
    }
}
