//! Marks: the epochs of the last minute with which the present one is compared, and what they teach.
//!
//! **Learning.** Drifts are tested once the spreads are known. A value above three times the mean
//! counts as three times the mean, so that a growing error needs minutes to increase its bound. A
//! change counts as at most twice the scatter about a straight line, so that a walk in the first
//! minutes does not teach its own bound. The line of the position goes through the last 20 s, because
//! the beginning of a walk bends a longer one. That of the clock goes through the window: delays of
//! signals drift with the elevation. The bound `L_k + L_m` of a leap is not learned. Epochs under an
//! alert are not learned. What accelerations between distant epochs explain is learned too: a receiver
//! whose rates are refused now and then would else learn that its positions have no noise.
//!
//! The noise can grow within an epoch: a satellite that has just risen may be five times as noisy as
//! all others together. `s` needs minutes to learn that, and in a window of 20 s a few marks are
//! close to a line by chance, the more often the more epochs a second there are. `n` knows it at
//! once. A walk hardly raises it, because it moves little from one epoch to the next.

use super::{CLOCK_SHARE, FLOOR_M, LEVEL_SHARE, Motion};
use crate::continuity::discrepancy::Discrepancy;
use crate::continuity::steering::STAYS;
use crate::numeric::sqrt;

/// Largest age of a mark, s.
pub(super) const WINDOW_S: f64 = 60.0;

/// Time between two marks, s.
const SPACING_S: f64 = 5.0;

/// Number of marks: those of a window, and the one at its start.
pub(super) const MARKS: usize = if cfg!(feature = "past") { (WINDOW_S / SPACING_S) as usize + 1 } else { 1 };

/// Age of the oldest mark from which the spread is learned, s.
const TEACHING_AGE_S: f64 = 50.0;

/// Lengths of the windows that are tested for a drift, s.
const WINDOWS_S: [f32; 3] = [20.0, 30.0, WINDOW_S as f32];

/// An epoch with which later ones are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    /// Time since the origin, s.
    pub(super) time_s: f32,
    pub(super) discrepancy: Discrepancy,
}

impl Motion {
    /// Begins the marks with one.
    pub(super) fn mark_anew(&mut self, mark: Mark) {
        self.marks.clear();
        self.noise.follow(&mark.discrepancy);
        // Never full, because it was cleared.
        let _ = self.marks.push_back(mark);
    }

    /// Returns true if the clock stays where it was in the last minute, although its rates lead away.
    pub(super) fn stays(&self, now: &Discrepancy) -> bool {
        let moved_m = |mark: &Mark| (now.moved_m - mark.discrepancy.moved_m).abs();
        let widest_m = self.marks.iter().map(moved_m).fold(0.0, f32::max);
        let apart_m = self.marks.front().map_or(0.0, |mark| (now.clock_m - mark.discrepancy.clock_m).abs());
        apart_m > STAYS * widest_m
    }

    /// Returns whether position and clock differ from those of a mark by more than both levels, or
    /// the position from that of the last mark by more than `step_m`. A return to the usual place
    /// is no step.
    pub(super) fn leap(&self, now: &Discrepancy, step_m: f32, is_home: Option<bool>) -> [bool; 2] {
        let is_step = self.spreads.step.is_known()
            && is_home != Some(true)
            && self.marks.back().is_some_and(|mark| {
                let [away_m, _] = now.from(&mark.discrepancy);
                !(away_m <= step_m)
            });
        self.marks.iter().fold([is_step, false], |[track, clock], mark| {
            let level_m = now.level_m + mark.discrepancy.level_m;
            let [away_m, apart_m] = now.from(&mark.discrepancy);
            // NaN fails both comparisons, so that it counts as a contradiction.
            [track || !(away_m <= level_m), clock || !(apart_m <= level_m)]
        })
    }

    /// Returns whether position and clock contradict their past by a straight line through the
    /// marks of one of the windows.
    pub(super) fn line(&self, now_s: f32, now: &Discrepancy) -> [bool; 2] {
        let floor_m = FLOOR_M.max(LEVEL_SHARE * now.level_m);
        let clock_floor_m = CLOCK_SHARE * floor_m;
        let [noise_m, clock_noise_m] = self.noise.rms_m();
        let lines = WINDOWS_S.into_iter().filter_map(|window_s| self.line_of(window_s, now_s, now));
        lines.fold([false; 2], |[track, clock], [(away_m, scatter_m), (apart_m, clock_scatter_m)]| {
            [
                track || self.spreads.position.is_drift(away_m, [scatter_m, noise_m], floor_m),
                clock
                    || self.spreads.clock.is_drift(apart_m, [clock_scatter_m, clock_noise_m], clock_floor_m),
            ]
        })
    }

    /// Returns the changes of position and clock within a window, and the scatter of its marks
    /// about a straight line, m, if the window is full.
    fn line_of(&self, window_s: f32, now_s: f32, now: &Discrepancy) -> Option<[(f32, f32); 2]> {
        let marks = || self.marks.iter().filter(|mark| now_s - mark.time_s <= window_s);
        let oldest = marks().next()?;
        let (age_s, count) = (now_s - oldest.time_s, marks().count());
        // No mark may be missing, because a leap between two distant marks would look like a
        // straight line.
        let is_full = count as f32 * SPACING_S as f32 >= window_s;
        if !is_full || age_s <= window_s - 1.2 * SPACING_S as f32 {
            return None;
        }
        let squares = marks().fold([0.0; 2], |[track, clock], mark| {
            let line = oldest.discrepancy.towards(now, (mark.time_s - oldest.time_s) / age_s);
            let off_m = mark.discrepancy.position - line.position;
            let apart_m = mark.discrepancy.clock_m - line.clock_m;
            [track + off_m.norm_squared(), clock + apart_m * apart_m]
        });
        // The first mark is on the line by definition.
        let [scatter_m, clock_scatter_m] =
            squares.map(|square| sqrt(square / count.saturating_sub(1) as f32));
        let [away_m, apart_m] = now.from(&oldest.discrepancy);
        Some([(away_m, scatter_m), (apart_m, clock_scatter_m)])
    }

    /// Learns from a mark without a contradiction.
    fn learn(&mut self, now_s: f32, now: &Discrepancy) {
        self.doubt.learn(now);
        if let Some(last) = self.marks.back() {
            let [away_m, _] = now.from(&last.discrepancy);
            self.spreads.step.learn_change(away_m.max(0.0), None);
        }
        if let Some(oldest) = self.marks.front().filter(|mark| now_s - mark.time_s >= TEACHING_AGE_S as f32) {
            let away_m = now.distance_m(&oldest.discrepancy);
            let apart_m = (now.clock_m - oldest.discrepancy.clock_m).abs();
            let scatters_m = |window_s| {
                self.line_of(window_s, now_s, now).map(|line| line.map(|(_, scatter_m)| scatter_m))
            };
            let clock_scatter_m = scatters_m(WINDOW_S as f32).map(|[_, scatter_m]| scatter_m);
            // A walk with gaps has no line that would bound what it teaches.
            if let Some([scatter_m, _]) = scatters_m(WINDOWS_S[0]) {
                self.spreads.position.learn_change(away_m, Some(scatter_m));
            }
            self.spreads.clock.learn_change(apart_m, clock_scatter_m);
        }
    }

    /// Makes the epoch a mark if the last mark is old enough. The spread then also learns from an
    /// epoch without a contradiction.
    pub(super) fn mark(&mut self, now_s: f32, now: &Discrepancy, is_teaching: bool) {
        if self.marks.back().is_some_and(|mark| now_s - mark.time_s < SPACING_S as f32) {
            return;
        }
        if is_teaching {
            self.learn(now_s, now);
        }
        if self.marks.is_full() {
            self.marks.pop_front();
        }
        let _ = self.marks.push_back(Mark { time_s: now_s, discrepancy: *now });
    }
}
