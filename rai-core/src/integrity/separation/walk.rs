//! One walk through the modes of a set of satellites: tests, thresholds, levels.
//!
//! Modes that the remaining geometry cannot do without are met on the way. They count as not watched, which changes the
//! number of modes and so all thresholds: the walk is then done once more.

use core::ops::ControlFlow;

use heapless::Vec;
use nalgebra::Vector3;

use super::levels::{Axis, Candidate, Level};
use super::modes::{Mode, Modes, Set, members, row};
use super::solutions::{Solution, Solutions};
use super::{Finding, MAX_MODES, SeparationError};
use crate::allocation::Allocation;
use crate::numeric::normal::quantile;
use crate::numeric::real::Real;

/// Modes that are kept in mind because the geometry cannot do without them, though enough satellites would be left.
const SINGULAR: usize = 16;

/// Walks for better references, at most.
const REFINEMENTS: usize = 2;

/// What of a prior the rounding of a single may take away.
const PRIOR_ROUNDING: f64 = 1e-6;

/// The choice of modes, and what is known of them with all satellites in view.
#[derive(Clone, Debug)]
pub(super) struct Watch<'a, T: Real> {
    pub(super) modes: Modes<T>,
    pub(super) allocation: &'a Allocation,
    /// `ρ`.
    pub(super) share: T,
    /// Rows whose loss leaves a geometry that determines no position.
    pub(super) singular: Vec<Set, SINGULAR>,
    /// `P_nm` with all satellites in view.
    pub(super) not_watched: T,
}

/// How a walk is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Tests and levels, whatever the tests say.
    Describe,
    /// Nothing beyond the first alarm.
    Accept,
}

impl<T: Real> Watch<'_, T> {
    /// Whether enough satellites are left without a set of rows, and are known to determine a position.
    pub(super) fn is_monitorable(&self, taken: Set) -> bool {
        self.leaves_enough(taken, 0) && !self.singular.contains(&taken)
    }

    /// Whether a position and the clocks are left, and so many satellites more.
    pub(super) fn leaves_enough(&self, taken: Set, more: u32) -> bool {
        let clocks = self.modes.members.iter().filter(|&&members| members & !taken != 0).count() as u32;
        (self.modes.satellites & !taken).count_ones() >= 3 + clocks + more
    }

    /// Rows of which each by itself is watched without `gone`, where that leaves one satellite more than unknowns.
    pub(super) fn singles(&self, gone: Set) -> Set {
        let watched = |&index: &usize| self.modes.watches(index) && self.is_monitorable(row(index));
        let left = self.modes.not_alone(gone) & !gone;
        members(left).filter(watched).fold(0, |set, index| set | row(index))
    }

    /// Judges what is left without `gone`, of which `solutions` is the solution.
    pub(super) fn judge(
        &mut self,
        solutions: &mut Solutions<'_, T>,
        gone: Set,
        purpose: Purpose,
    ) -> Result<Finding<T>, SeparationError> {
        let mut count = self.count(gone);
        if count.modes > MAX_MODES {
            return Err(SeparationError::Modes);
        }
        // The second time nothing is found that is not counted already.
        for _ in 0..2 {
            if gone == 0 {
                self.not_watched = self.modes.not_watched + count.unmonitorable;
            }
            let mut pass = Pass::new(self, solutions, gone, &count);
            if let Some(finding) = pass.run(purpose) {
                return Ok(finding);
            }
            let Singular { modes, probability, sets } = pass.singular;
            count.unmonitorable += probability;
            count.modes -= modes.min(count.modes);
            count.singular = true;
            if gone == 0 {
                self.singular = sets;
            }
        }
        Err(SeparationError::Modes)
    }

    /// Counts what can be watched, by the number of satellites alone.
    #[inline(never)]
    fn count(&self, gone: Set) -> Count<T> {
        let mut count = Count { modes: 0, unmonitorable: T::zero(), singular: false };
        let clocks = self.modes.members.iter().filter(|&&members| members & !gone != 0).count();
        let ample = ((self.modes.satellites & !gone).count_ones() as usize).saturating_sub(3 + clocks);
        let _ = self.modes.visit(gone, &(1..=3), &|taken| self.is_monitorable(taken), &mut |mode| {
            if mode.taken <= ample || self.leaves_enough(gone | self.modes.taken_by(mode.hypothesis), 0) {
                count.modes += 1;
            } else {
                count.unmonitorable += mode.probability;
            }
            ControlFlow::Continue(())
        });
        count
    }
}

/// Modes that are watched, and the probability of those that cannot be.
#[derive(Clone, Debug)]
struct Count<T> {
    modes: usize,
    unmonitorable: T,
    /// Whether modes that the geometry cannot do without are counted out already.
    singular: bool,
}

/// Modes that turned out to leave no position.
struct Singular<T> {
    modes: usize,
    probability: T,
    sets: Vec<Set, SINGULAR>,
}

/// One walk.
struct Pass<'p, 'a, 'v, T: Real> {
    watch: &'p Watch<'a, T>,
    solutions: &'p mut Solutions<'v, T>,
    gone: Set,
    modes: usize,
    skips_singular: bool,
    not_watched: T,
    factors: Vector3<T>,
    axes: [Axis<T>; 3],
    levels: [Level<T>; 3],
    accuracy_m: T,
    threshold_m: T,
    likely: T,
    worst: (T, T),
    alarm: bool,
    singular: Singular<T>,
}

impl<'p, 'a, 'v, T: Real> Pass<'p, 'a, 'v, T> {
    #[inline(never)]
    fn new(
        watch: &'p Watch<'a, T>,
        solutions: &'p mut Solutions<'v, T>,
        gone: Set,
        count: &Count<T>,
    ) -> Self {
        let allocation = watch.allocation;
        let phmi = T::narrow(allocation.integrity());
        // With all satellites what cannot be watched is part of P_nm; after an exclusion it can fall on this outcome whole.
        let newly = if gone == 0 { T::zero() } else { count.unmonitorable };
        let left = (watch.share * (phmi - watch.not_watched) - newly) / phmi;
        let vertical = left * T::narrow(allocation.integrity_vertical);
        let horizontal = left * T::narrow(allocation.integrity_horizontal / 2.0);
        let whole = solutions.whole();
        let bias = if solutions.has_bias() { solutions.whole_bias() } else { Vector3::zeros() };
        let axis = |risk: T, variance: T, bias: T| Axis::new(risk, count.modes, variance.sqrt(), bias);
        let modes = count.modes.max(1) as f64;
        let horizontal_factor = quantile(T::narrow(allocation.alarm_horizontal / (4.0 * modes)));
        let vertical_factor = quantile(T::narrow(allocation.alarm_vertical / (2.0 * modes)));
        Self {
            watch,
            solutions,
            gone,
            modes: count.modes,
            skips_singular: count.singular,
            not_watched: watch.not_watched + newly,
            factors: Vector3::new(horizontal_factor, horizontal_factor, vertical_factor),
            axes: [
                axis(horizontal, whole.variance.x, bias.x),
                axis(horizontal, whole.variance.y, bias.y),
                axis(vertical, whole.variance.z, bias.z),
            ],
            levels: [Level::none(); 3],
            accuracy_m: whole.separation.z.sqrt(),
            threshold_m: T::zero(),
            likely: T::narrow(allocation.effective_prior * (1.0 - PRIOR_ROUNDING)),
            worst: (T::zero(), T::one()),
            alarm: false,
            singular: Singular { modes: 0, probability: T::zero(), sets: Vec::new() },
        }
    }

    fn run(&mut self, purpose: Purpose) -> Option<Finding<T>> {
        for refinement in 0..=REFINEMENTS {
            self.walk(refinement == 0, purpose);
            if self.singular.modes > 0 && !self.skips_singular {
                return None;
            }
            if self.alarm && purpose == Purpose::Accept {
                break;
            }
            self.solve();
            if refinement == REFINEMENTS || !self.levels.iter().any(Axis::is_dear) {
                break;
            }
            for (axis, level) in self.axes.iter_mut().zip(&self.levels) {
                axis.restart(level.below_m);
            }
        }
        Some(self.finding())
    }

    /// Singles and constellations first: they say where the levels are, about.
    fn walk(&mut self, is_first: bool, purpose: Purpose) {
        let (watch, gone) = (self.watch, self.gone);
        let was_monitorable = |taken: Set| watch.is_monitorable(taken);
        for sizes in [1..=1, 2..=3] {
            let walked = watch.modes.visit(gone, &sizes, &was_monitorable, &mut |mode| {
                self.take(mode);
                if self.alarm && purpose == Purpose::Accept {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            });
            if walked.is_break() {
                return;
            }
            if is_first && *sizes.end() == 1 {
                self.axes.iter_mut().filter(|axis| axis.is_open()).for_each(Axis::settle);
            }
        }
    }

    #[inline]
    fn take(&mut self, mode: &Mode<T>) {
        let Some(solution) = self.solutions.without(mode.hypothesis) else {
            self.note_singular(mode);
            return;
        };
        let sigma = solution
            .separation
            .map(|variance| if variance > T::zero() { variance.sqrt() } else { T::zero() });
        let threshold = sigma.component_mul(&self.factors);
        for (shift, threshold) in solution.shift.iter().zip(&threshold) {
            let distance = shift.abs();
            // Written so that what is not a number alarms.
            if !(distance <= *threshold) {
                self.alarm = true;
            }
            if distance * self.worst.1 > self.worst.0 * *threshold {
                self.worst = (distance, *threshold);
            }
        }
        if threshold.z > self.threshold_m && self.is_likely(mode) {
            self.threshold_m = threshold.z;
        }
        self.add(mode, &solution, &threshold);
    }

    fn is_likely(&self, mode: &Mode<T>) -> bool {
        // The product of the odds is no smaller than that of the probabilities.
        let watch = self.watch;
        mode.probability >= self.likely * watch.modes.healthy()
            && watch.modes.prior(mode.hypothesis, self.gone, &|taken| watch.is_monitorable(taken))
                >= self.likely
    }

    #[inline]
    fn add(&mut self, mode: &Mode<T>, solution: &Solution<T>, threshold: &Vector3<T>) {
        let candidate = |(&threshold_m, &variance): (&T, &T)| Candidate {
            probability: mode.probability,
            ln_probability: mode.ln_probability,
            threshold_m,
            variance,
            hypothesis: mode.hypothesis,
        };
        let has_bias = self.solutions.has_bias();
        let bound = if has_bias { self.solutions.bias_bound() } else { Some(Vector3::zeros()) };
        let candidates = threshold.iter().zip(&solution.variance).map(candidate);
        let is_clear = |axis: &Axis<T>, candidate: &Candidate<T>, bias_m: T| {
            !axis.is_open() || axis.is_clear(candidate, bias_m)
        };
        if let Some(bound) = &bound {
            let mut all = self.axes.iter().zip(candidates.clone()).zip(bound);
            if all.all(|((axis, candidate), &bias_m)| is_clear(axis, &candidate, bias_m)) {
                return;
            }
        }
        let bias = if has_bias { self.solutions.bias() } else { Vector3::zeros() };
        for ((axis, candidate), &bias_m) in self.axes.iter_mut().zip(candidates).zip(&bias) {
            if !is_clear(axis, &candidate, bias_m) {
                axis.add(&candidate, bias_m);
            }
        }
    }

    #[inline(never)]
    fn note_singular(&mut self, mode: &Mode<T>) {
        let taken = self.gone | self.watch.modes.taken_by(mode.hypothesis);
        if self.skips_singular || !self.watch.leaves_enough(taken, 0) {
            return;
        }
        self.singular.modes += 1;
        self.singular.probability += mode.probability;
        // Beyond the room it is charged to whichever outcome meets it: more, never less.
        let _ = self.singular.sets.push(taken & !self.gone);
    }

    /// The levels with all modes.
    #[inline(never)]
    fn solve(&mut self) {
        for (level, axis) in self.levels.iter_mut().zip(&self.axes) {
            *level = if axis.is_open() { axis.finish() } else { Level::none() };
        }
    }

    fn finding(&self) -> Finding<T> {
        let (distance, threshold) = self.worst;
        Finding {
            modes: self.modes,
            not_watched: self.not_watched,
            factors: self.factors.into(),
            levels_m: self.levels.map(|level| level.distance_m),
            effective_monitor_threshold_m: self.threshold_m,
            accuracy_m: self.accuracy_m,
            alarm: self.alarm,
            ratio: distance / threshold,
            dominant: self.levels.map(|level| level.dominant),
        }
    }
}
