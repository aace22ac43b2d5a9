//! Evaluation of all modes of a set of satellites: tests, thresholds and levels.
//!
//! A mode may turn out to leave a singular geometry. It then counts as unmonitored, which changes
//! the number of modes and so all thresholds. The evaluation then runs once more.

use core::ops::ControlFlow;

use heapless::Vec;
use nalgebra::Vector3;

use super::levels::{Axis, AxisLevel, AxisMode, AxisRisk, QuantileCache, Screen};
use super::modes::{Mode, ModeBatch, RemainingRows, RowSet, Visitor};
use super::monitored::{ModeCount, MonitoredModes, SINGULAR};
use super::subsets::{Bounds, SubsetSolution, SubsetSolutions};
use super::{AraimError, Finding, MAX_MODES};
use crate::least_squares::infinity;
use crate::numeric::normal::quantile;
use crate::numeric::real::Real;
use crate::numeric::space::{products, zero};

/// Largest number of further passes with better references.
const REFINEMENTS: usize = 2;

/// Largest relative loss of a prior by rounding in single precision.
const PRIOR_ROUNDING: f64 = 1e-6;

/// Purpose of an evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// All tests and levels.
    Describe,
    /// Stops at the first alarm.
    Accept,
}

impl<T: Real> MonitoredModes<'_, T> {
    /// Judges the rows that remain without `gone`; `solutions` contains their solution.
    pub(super) fn judge<const N: usize>(
        &mut self,
        solutions: &mut SubsetSolutions<'_, T, N>,
        axes: &mut [Axis<T>; 3],
        gone: RowSet,
        purpose: Purpose,
    ) -> Result<Finding<T>, AraimError> {
        let remains = self.modes.remains(gone);
        let mut count = self.count(&remains);
        if count.modes > MAX_MODES {
            return Err(AraimError::Modes);
        }
        // The second evaluation finds no singular mode that is not counted.
        for _ in 0..2 {
            if gone == 0 {
                self.unmonitored_probability = self.modes.unmonitored_probability + count.unmonitorable;
            }
            let mut pass = Evaluation::new(self, solutions, (&remains, purpose), &count, axes);
            if let Some(finding) = pass.run() {
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
        Err(AraimError::Modes)
    }
}

/// Modes that were found to leave a singular geometry.
struct Singular<T> {
    modes: usize,
    probability: T,
    sets: Vec<RowSet, SINGULAR>,
}

/// Returns the root of a variance. A very poor geometry can make the variance negative or NaN; the
/// result is then infinite.
fn deviation<T: Real>(variance: T) -> T {
    if variance >= T::zero() { variance.sqrt_approx() } else { infinity() }
}

/// One evaluation.
struct Evaluation<'p, 'a, 'v, T: Real, const N: usize> {
    monitored: &'p MonitoredModes<'a, T>,
    solutions: &'p mut SubsetSolutions<'v, T, N>,
    remains: &'p RemainingRows,
    purpose: Purpose,
    modes: usize,
    /// Number of modes evaluated in all passes so far.
    taken: usize,
    skips_singular: bool,
    unmonitored_probability: T,
    factors: Vector3<T>,
    axes: &'p mut [Axis<T>; 3],
    screen: Screen<T>,
    quantiles: QuantileCache<T>,
    /// True if the references were raised, so that the screen can dismiss modes.
    has_reference: bool,
    levels: [AxisLevel<T>; 3],
    squared_factors: Vector3<T>,
    accuracy_m: T,
    /// Largest squared vertical threshold of a likely mode, m².
    threshold: T,
    likely: T,
    /// Largest squared separation over its squared threshold.
    worst: T,
    alarm: bool,
    singular: Singular<T>,
}

impl<'p, 'a, 'v, T: Real, const N: usize> Evaluation<'p, 'a, 'v, T, N> {
    #[inline(never)]
    fn new(
        monitored: &'p MonitoredModes<'a, T>,
        solutions: &'p mut SubsetSolutions<'v, T, N>,
        (remains, purpose): (&'p RemainingRows, Purpose),
        count: &ModeCount<T>,
        axes: &'p mut [Axis<T>; 3],
    ) -> Self {
        let allocation = monitored.allocation;
        let phmi = monitored.modes.mandatory();
        // With all satellites, the modes that cannot be monitored are part of P_nm. After an
        // exclusion, all of their risk may belong to this outcome.
        let newly = if remains.gone == 0 { T::zero() } else { count.unmonitorable };
        let left = (monitored.risk_share * (phmi - monitored.unmonitored_probability) - newly) / phmi;
        let two = T::one() + T::one();
        let vertical = left * T::narrow(allocation.integrity_vertical);
        let horizontal = left * T::narrow(allocation.integrity_horizontal) / two;
        let whole = solutions.whole();
        let bias = solutions.whole_bias();
        // Each mode has a test on both sides.
        let modes = T::narrow(count.modes.max(1) as f64);
        let tests = two * modes;
        let horizontal_factor = quantile(T::narrow(allocation.alarm_horizontal) / (two * tests));
        let vertical_factor = quantile(T::narrow(allocation.alarm_vertical) / tests);
        let factors = Vector3::new(horizontal_factor, horizontal_factor, vertical_factor);
        let mut pass = Self {
            monitored,
            solutions,
            remains,
            purpose,
            modes: count.modes,
            taken: 0,
            skips_singular: count.singular,
            unmonitored_probability: monitored.unmonitored_probability + newly,
            factors,
            squared_factors: products(&factors, &factors),
            screen: Screen::closed(),
            quantiles: QuantileCache::none(),
            has_reference: false,
            axes,
            levels: [AxisLevel::none(); 3],
            accuracy_m: deviation(whole.separation.z),
            threshold: T::zero(),
            likely: T::narrow(allocation.emt_prior) * (T::one() - T::narrow(PRIOR_ROUNDING)),
            worst: T::zero(),
            alarm: false,
            singular: Singular { modes: 0, probability: T::zero(), sets: Vec::new() },
        };
        let [east, north, up] = &mut *pass.axes;
        let [horizontal, vertical] = [horizontal, vertical].map(|risk| AxisRisk::of(risk, modes));
        east.open(&horizontal, whole.variance.x, bias.x);
        north.open(&horizontal, whole.variance.y, bias.y);
        up.open(&vertical, whole.variance.z, bias.z);
        pass.screen = Screen::of(pass.axes);
        pass
    }

    fn run(&mut self) -> Option<Finding<T>> {
        for refinement in 0..=REFINEMENTS {
            self.walk(refinement == 0);
            if self.singular.modes > 0 && !self.skips_singular {
                return None;
            }
            if self.alarm && self.purpose == Purpose::Accept {
                break;
            }
            self.solve();
            if refinement == REFINEMENTS || !self.levels.iter().any(Axis::exceeds_tolerance) {
                break;
            }
            for (axis, level) in self.axes.iter_mut().zip(&self.levels) {
                axis.restart(level.below_m);
            }
            self.screen = Screen::of(self.axes);
        }
        Some(self.finding())
    }

    /// Evaluates single satellites and constellations first, because they give approximate levels.
    fn walk(&mut self, is_first: bool) {
        let (monitored, remains) = (self.monitored, self.remains);
        let taken_before = self.taken;
        let was_monitorable = |taken: RowSet| monitored.is_monitorable(taken);
        for sizes in [1..=1, 2..=3] {
            if monitored.modes.visit(remains, &sizes, &was_monitorable, self).is_break() {
                return;
            }
            if self.taken + self.singular.modes >= taken_before + self.modes {
                // The remaining modes cannot be monitored.
                break;
            }
            if is_first && *sizes.end() == 1 {
                self.refine_reference();
            }
        }
    }

    /// Raises the references after single satellites and constellations, before the other modes.
    fn refine_reference(&mut self) {
        self.raise_reference();
        self.axes.iter_mut().filter(|axis| axis.is_open()).for_each(Axis::refine_reference);
        self.screen = Screen::of(self.axes);
    }

    /// Returns the bounds for modes of at most this batch's probability.
    fn bounds(&self, batch: &ModeBatch<T>) -> Bounds<T> {
        let limits = &self.squared_factors;
        let [least, largest] = if limits.x < limits.z { [limits.x, limits.z] } else { [limits.z, limits.x] };
        let bounds = self.screen.bounds(batch.ln_probability, limits);
        let effective =
            if self.may_be_likely(batch.probability) { self.threshold / limits.z } else { bounds.effective };
        Bounds { worst: self.worst * least, evenness: least / largest, effective, ..bounds }
    }

    /// Raises the references to the distance at which one mode alone uses up the risk.
    #[inline(never)]
    fn raise_reference(&mut self) {
        for axis in self.axes.iter_mut().filter(|axis| axis.is_open()) {
            axis.raise_reference(&mut self.quantiles);
        }
        self.screen = Screen::of(self.axes);
        self.has_reference = true;
    }

    /// Evaluates one mode. The tests compare squares, because few modes need the roots.
    #[inline]
    fn take(&mut self, mode: &Mode<T>) {
        let Some(solution) = self.solutions.without(mode.hypothesis) else {
            self.note_singular(mode);
            return;
        };
        self.taken += 1;
        let thresholds = products(&solution.separation, &self.squared_factors);
        let distances = products(&solution.shift, &solution.shift);
        let worst = self.worst;
        // Only a separation that is worse than the worst so far can raise the first alarm. NaN
        // fails this comparison, so that it counts as worse.
        let is_worse = |distance: T, threshold: T| !(distance <= worst * threshold);
        if is_worse(distances.x, thresholds.x)
            || is_worse(distances.y, thresholds.y)
            || is_worse(distances.z, thresholds.z)
        {
            self.note(&distances, &thresholds);
        }
        if thresholds.z > self.threshold && self.is_likely(mode) {
            self.threshold = thresholds.z;
        }
        if self.solutions.has_bias() {
            self.add_biased(mode, &solution, &thresholds);
        } else if !self.screen.is_clear(mode, &thresholds, &solution.variance) {
            self.add(mode, &solution, &thresholds, &zero());
        }
    }

    /// Stores the largest separation so far.
    #[inline(never)]
    fn note(&mut self, distances: &Vector3<T>, thresholds: &Vector3<T>) {
        let axes = [(distances.x, thresholds.x), (distances.y, thresholds.y), (distances.z, thresholds.z)];
        for (distance, threshold) in axes {
            // Rounding can make a zero variance slightly negative.
            let threshold = if threshold < T::zero() { T::zero() } else { threshold };
            if !(distance <= threshold) {
                self.alarm = true;
            }
            let ratio = distance / threshold;
            if ratio > self.worst {
                self.worst = ratio;
            }
        }
    }

    fn is_likely(&self, mode: &Mode<T>) -> bool {
        let monitored = self.monitored;
        self.may_be_likely(mode.probability)
            && monitored
                .modes
                .prior(mode.hypothesis, self.remains.gone, &|taken| monitored.is_monitorable(taken))
                >= self.likely
    }

    fn may_be_likely(&self, probability: T) -> bool {
        // This is a bound, because the product of the odds is no smaller than that of the
        // probabilities.
        probability >= self.likely * self.monitored.modes.healthy()
    }

    /// Adds the mode to the sum on each axis.
    #[inline(never)]
    fn add(
        &mut self,
        mode: &Mode<T>,
        solution: &SubsetSolution<T>,
        thresholds: &Vector3<T>,
        bias: &Vector3<T>,
    ) {
        if !self.has_reference && mode.hypothesis.constellations == 0 {
            self.raise_reference();
        }
        let [east, north, up] = &mut *self.axes;
        let variance = &solution.variance;
        east.add(&AxisMode::of(mode, thresholds.x, variance.x), bias.x);
        north.add(&AxisMode::of(mode, thresholds.y, variance.y), bias.y);
        up.add(&AxisMode::of(mode, thresholds.z, variance.z), bias.z);
    }

    /// Adds the mode with its biases. They are computed only if a bound on them does not suffice to
    /// dismiss the mode.
    #[inline(never)]
    fn add_biased(&mut self, mode: &Mode<T>, solution: &SubsetSolution<T>, thresholds: &Vector3<T>) {
        let bound = self.solutions.bias_bound();
        if !bound.is_some_and(|bound| self.screen.is_clear_with(mode, thresholds, &solution.variance, &bound))
        {
            let bias = self.solutions.bias();
            self.add(mode, solution, thresholds, &bias);
        }
    }

    #[inline(never)]
    fn note_singular(&mut self, mode: &Mode<T>) {
        let taken = self.remains.gone | self.monitored.modes.taken_by(mode.hypothesis);
        if self.skips_singular || !self.monitored.leaves_enough(taken, 0) {
            return;
        }
        self.singular.modes += 1;
        self.singular.probability += mode.probability;
        // Beyond the capacity, every outcome that contains the mode charges its probability again,
        // which is safe.
        let _ = self.singular.sets.push(taken & !self.remains.gone);
    }

    /// Computes the levels with all modes.
    #[inline(never)]
    fn solve(&mut self) {
        for (level, axis) in self.levels.iter_mut().zip(self.axes.iter()) {
            *level = if axis.is_open() { axis.finish() } else { AxisLevel::none() };
        }
    }

    fn finding(&self) -> Finding<T> {
        Finding {
            modes: self.modes,
            unmonitored_probability: self.unmonitored_probability,
            factors: self.factors.into(),
            levels_m: self.levels.map(|level| level.distance_m),
            effective_monitor_threshold_m: self.threshold.sqrt_approx(),
            accuracy_m: self.accuracy_m,
            alarm: self.alarm,
            ratio: self.worst.sqrt_approx(),
            dominant: self.levels.map(|level| level.dominant),
        }
    }
}

impl<T: Real, const N: usize> Visitor<T> for Evaluation<'_, '_, '_, T, N> {
    fn screen(&mut self, batch: &ModeBatch<T>) -> RowSet {
        if !self.has_reference {
            self.raise_reference();
        }
        let bounds = self.bounds(batch);
        let left = self.solutions.screen(batch.common, batch.rows, &bounds);
        self.taken += (batch.rows & !left).count_ones() as usize;
        left
    }

    fn visit(&mut self, mode: &Mode<T>) -> ControlFlow<()> {
        self.take(mode);
        let ends = self.alarm && self.purpose == Purpose::Accept;
        if ends { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
