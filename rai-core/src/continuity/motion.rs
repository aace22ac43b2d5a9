//! Comparison of position and clock with the integral of velocity and drift.
//!
//! Ranges and range rates are measured independently. A change of one without the other is no
//! motion of the receiver:
//!
//! ```text
//! δ_k = [p_k − Σ ½ (v_j + v_{j−1}) Δt_j,   b_k − Σ ½ (ḋ_j + ḋ_{j−1}) Δt_j]        j ≤ k
//!
//! leap    |δ_k − δ_m| > L_k + L_m                               for a mark m of the last minute
//! drift   |δ_k − δ_1| > max(floor, 6·s)  and  |δ_k − δ_1| > 6·e    for mark 1, the first of a window of 20, 30 or 60 s;
//!         of the position also  |δ_k − δ_1| > L_k/4
//! e²      = mean of |δ_m − δ_1 − (δ_k − δ_1) (t_m − t_1)/(t_k − t_1)|²  over the marks after the first
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `p`, `b` | earth-fixed position; receiver clock times the speed of light, of one constellation | m |
//! | `v`, `ḋ` | [`Velocity::east_north_up_m_s`], earth-fixed; [`Velocity::drift_m_s`] | m/s |
//! | `δ` | [`Discrepancy`], constant except for noise | m |
//! | `L` | `HPL + VPL` of an epoch | m |
//! | `e` | scatter of the marks about a straight line | m |
//! | `s` | [`Spread`]: mean of `|δ_k − δ_1|` over the epochs so far | m |
//!
//! A contradiction of the position is [`Alert::Track`], one of the clock [`Alert::Clock`]. In one
//! epoch, the clock reveals a second receiver, a repeater, and most counterfeit signals. Within a
//! minute, it also reveals a slow drag-off that all ranges share, which no test of one epoch can
//! detect.
//!
//! Reflections also change `δ`, in streets by 200 m within levels of 300 m, but rarely along a
//! straight line. A leap is therefore compared with the levels alone, and a drift also with the
//! usual spread `s`. A drift of the position counts only above a quarter of `L`, about three
//! quarters of the HPL. Below that, the level bounds it; a continuing drift is an alert before it
//! exceeds the level.
//!
//! **Figures.** Twelve replays of eight recordings with Doppler frequencies have no contradiction.
//! Their `|δ_k − δ_1|`, m:
//!
//! | recordings | clock: median, largest | position: median, largest |
//! |---|---|---|
//! | at rest, 1 Hz | 0.4 to 0.8, 2.7 | 0.6 to 1.0, 3.7 |
//! | at rest, every 30 s | 2.3, 12.5 | – |
//! | in streets | 5 to 10, 192 | 8 to 13, 229 |
//!
//! In four recordings at rest, an added drift of position or clock is detected: at 1 m/s in 12 s,
//! at 0.2 m/s within 51 s.
//!
//! **Learning.** Drifts are tested after [`super::discrepancy::LEARNED`] marks. A value above three
//! times the mean counts as three times the mean, so that a growing error needs minutes to increase
//! its bound. The bound of a leap is not learned. Epochs under an alert are not learned.
//!
//! **Contradicting rates.** If a position is far from the true one, the true rates fit no velocity.
//! If the rates of an epoch contradict each other, its position must therefore be where the last
//! velocity leads. Both levels and a change of speed by 40 m/s are allowed for. This comparison
//! ends after [`LONGEST_GAP_S`].
//!
//! **Ends.** After a leap the comparison begins anew at the new position and clock, so that one
//! leap causes one alert. An agreement is then required. A drift remains an alert until a minute
//! after its end.
//!
//! **Gaps.** After a step longer than [`LONGEST_STEP_S`] the comparison begins anew. Across a gap
//! of up to [`LONGEST_GAP_S`] the clock must still be within [`WANDER_M_S`] of its drift. For each
//! step longer than [`SMOOTH_STEP_S`], an unknown acceleration `a` increases the position's bound
//! by `a Δt²/8`. Steps of the clock by whole milliseconds are ignored, because receivers make them
//! on purpose.
//!
//! **No rates.** Without Doppler frequencies the clock is compared with its past
//! ([`super::oscillator`]), and the position is not compared.
//!
//! **Limits.** An attack is not detected here if it starts from the true position and slowly
//! changes ranges and rates consistently.

use super::discrepancy::{Discrepancy, Spread};
use super::oscillator::{Oscillator, whole_milliseconds_m};
use heapless::Deque;
use nalgebra::Vector3;

use crate::frame::{Ecef, earth_fixed};
use crate::numeric::sqrt;
use crate::report::{Alert, Report};
use crate::satellite::Constellation;
use crate::velocity::{Velocity, VelocityError};

/// Largest age of a mark, s.
const WINDOW_S: f64 = 60.0;

/// Time between two marks, s.
const SPACING_S: f64 = 5.0;

/// Number of marks: those of a window, and the one at its start.
const MARKS: usize = if cfg!(feature = "past") { (WINDOW_S / SPACING_S) as usize + 1 } else { 1 };

/// Age of the oldest mark from which the spread is learned, s.
const TEACHING_AGE_S: f64 = 50.0;

/// Longest step of the integral, s.
const LONGEST_STEP_S: f64 = 60.0;

/// Longest gap across which a clock is compared, s.
const LONGEST_GAP_S: f64 = 900.0;

/// Largest departure of a quartz from its last drift, m/s: 0.1 ppm.
const WANDER_M_S: f64 = 30.0;

/// Longest step within which an acceleration counts as constant, s.
const SMOOTH_STEP_S: f64 = 2.0;

/// Largest acceleration of a vehicle between two epochs, m/s².
const ACCELERATION_M_S2: f64 = 5.0;

/// Largest change of speed of a car while the rates contradict each other, m/s.
const FASTER_M_S: f32 = 40.0;

/// Lengths of the windows that are tested for a drift, s.
const WINDOWS_S: [f32; 3] = [20.0, 30.0, WINDOW_S as f32];

/// Smallest drift of the position, relative to `HPL + VPL`.
const LEVEL_SHARE: f32 = 0.25;

/// Smallest drift of the position and of the clock, m. The position has three components.
const FLOORS_M: [f32; 2] = [4.0, 2.0];

/// An epoch with which later ones are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mark {
    /// Time since the origin, s.
    time_s: f32,
    discrepancy: Discrepancy,
}

/// An epoch with its rates.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moment {
    time_s: f64,
    position: Ecef,
    level_m: f32,
    clock_m: f64,
    velocity_m_s: Vector3<f32>,
    drift_m_s: f64,
}

/// Integral of the rates since the origin, the first of the compared epochs.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Path {
    origin_s: f64,
    position: Ecef,
    clock_m: f64,
    unknown_m: f64,
}

/// Comparison of position and clock with the integral of velocity and drift.
#[derive(Clone, Debug)]
pub struct Motion {
    last: Option<Moment>,
    path: Option<Path>,
    marks: Deque<Mark, MARKS>,
    position: Spread,
    clock: Spread,
    reference: Constellation,
    oscillator: Oscillator,
}

impl Default for Motion {
    fn default() -> Self {
        Self::new()
    }
}

impl Motion {
    /// Returns the state before the first epoch.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            last: None,
            path: None,
            marks: Deque::new(),
            position: Spread::new(),
            clock: Spread::new(),
            reference: Constellation::Gps,
            oscillator: Oscillator::new(),
        }
    }

    /// Forgets the epochs so far, but not their spread.
    pub fn restart(&mut self) {
        self.marks.clear();
        (self.last, self.path) = (None, None);
        self.oscillator.restart();
    }

    /// Compares an epoch that passed its test with earlier ones. Returns the contradiction.
    ///
    /// An epoch without position or levels is not compared. If it has no range rates, only its
    /// clock is compared. If its rates contradict each other, its position is compared with the
    /// last one that had a velocity.
    pub fn judge<const N: usize>(
        &mut self,
        time_s: f64,
        report: &Report<N>,
        velocity: Result<&Velocity, VelocityError>,
    ) -> Option<Alert> {
        if !cfg!(feature = "past") {
            return None;
        }
        let (solution, levels) = report.solution.as_ref().zip(report.protection)?;
        let level_m = (levels.hpl_m + levels.vpl_m) as f32;
        let velocity = match velocity {
            Ok(velocity) => velocity,
            Err(VelocityError::Fault) => return self.without_velocity(time_s, solution.position, level_m),
            Err(VelocityError::Redundancy | VelocityError::Geometry) => {
                let clock_m = self.clock_m(&solution.clocks_m, &report.used)?;
                return self.oscillator.leaps(time_s, clock_m, level_m).then_some(Alert::Clock);
            }
        };
        let clock_m = self.clock_m(&solution.clocks_m, &report.used)?;
        let velocity_m_s = earth_fixed(solution.position, velocity.east_north_up_m_s);
        let drift_m_s = velocity.drift_m_s;
        // An epoch with rates is compared with their drift instead.
        self.oscillator.restart();
        let now = Moment { time_s, position: solution.position, level_m, clock_m, velocity_m_s, drift_m_s };
        let last = self.last.replace(now)?;
        let elapsed_s = time_s - last.time_s;
        // NaN fails this comparison too.
        if !(elapsed_s > 0.0 && elapsed_s <= LONGEST_STEP_S) {
            self.begin(&now, solution.position, level_m);
            return across_gap(&last, &now, level_m);
        }
        let Some(discrepancy) = self.advance(&last, &now, solution.position, level_m) else {
            self.begin(&now, solution.position, level_m);
            return None;
        };
        let leap = self.leap(time_s, &discrepancy);
        if leap.is_some() {
            self.begin(&now, solution.position, level_m);
            return leap;
        }
        self.drift(time_s, &discrepancy)
    }

    /// Compares a position whose rates contradict each other with the last position that had a
    /// velocity.
    fn without_velocity(&self, time_s: f64, position: Ecef, level_m: f32) -> Option<Alert> {
        let last = self.last.as_ref()?;
        let elapsed_s = time_s - last.time_s;
        if !(0.0..=LONGEST_GAP_S).contains(&elapsed_s) {
            return None;
        }
        let elapsed_s = elapsed_s as f32;
        let way_m = last.velocity_m_s * elapsed_s;
        let away = position - last.position;
        let away_m = Vector3::new(away.x_m as f32, away.y_m as f32, away.z_m as f32) - way_m;
        let faster_m_s = (0.5 * ACCELERATION_M_S2 as f32 * elapsed_s).min(FASTER_M_S);
        let bound_m = level_m + last.level_m + faster_m_s * elapsed_s;
        // NaN fails this comparison, so that it counts as a contradiction.
        alert(!(away_m.norm_squared() <= bound_m * bound_m), false)
    }

    /// Returns the clock of the constellation that is compared, m. If that constellation is gone,
    /// the comparison begins anew with another one.
    fn clock_m(
        &mut self,
        clocks_m: &[Option<f64>; Constellation::COUNT],
        used: &[crate::satellite::SatelliteId],
    ) -> Option<f64> {
        let clock_m = |constellation: Constellation| *clocks_m.get(constellation as usize)?;
        if let Some(clock_m) = clock_m(self.reference) {
            return Some(clock_m);
        }
        self.restart();
        self.reference = used.first()?.constellation();
        clock_m(self.reference)
    }

    /// Begins the integral at an epoch.
    fn begin(&mut self, now: &Moment, position: Ecef, level_m: f32) {
        self.marks.clear();
        let Moment { time_s, clock_m, .. } = *now;
        self.path = Some(Path { origin_s: time_s, position, clock_m, unknown_m: 0.0 });
        let nothing =
            Discrepancy { position: Vector3::new(0.0, 0.0, 0.0), clock_m: 0.0, unknown_m: 0.0, level_m };
        // Never full, because it was cleared.
        let _ = self.marks.push_back(Mark { time_s: 0.0, discrepancy: nothing });
    }

    /// Adds a step to the integral; returns the discrepancy after it.
    fn advance(&mut self, last: &Moment, now: &Moment, position: Ecef, level_m: f32) -> Option<Discrepancy> {
        let path = self.path.as_mut()?;
        let elapsed_s = now.time_s - last.time_s;
        let half_s = (0.5 * elapsed_s) as f32;
        let way_m = (now.velocity_m_s + last.velocity_m_s) * half_s;
        path.position = path.position + Ecef::new(way_m.x.into(), way_m.y.into(), way_m.z.into());
        path.clock_m += 0.5 * elapsed_s * (now.drift_m_s + last.drift_m_s);
        path.clock_m += whole_milliseconds_m(now.clock_m - last.clock_m - elapsed_s * now.drift_m_s);
        if elapsed_s > SMOOTH_STEP_S {
            path.unknown_m += ACCELERATION_M_S2 / 8.0 * elapsed_s * elapsed_s;
        }
        let away = position - path.position;
        Some(Discrepancy {
            position: Vector3::new(away.x_m as f32, away.y_m as f32, away.z_m as f32),
            clock_m: (now.clock_m - path.clock_m) as f32,
            unknown_m: path.unknown_m as f32,
            level_m,
        })
    }

    /// Returns the contradiction if a discrepancy differs from that of a mark by more than both
    /// levels.
    fn leap(&mut self, time_s: f64, now: &Discrepancy) -> Option<Alert> {
        let now_s = self.since_origin_s(time_s)?;
        while self.marks.front().is_some_and(|mark| now_s - mark.time_s > WINDOW_S as f32) {
            self.marks.pop_front();
        }
        let [track, clock] = self.marks.iter().fold([true; 2], |[track, clock], mark| {
            let level_m = now.level_m + mark.discrepancy.level_m;
            let [away_m, apart_m] = now.from(&mark.discrepancy);
            // NaN fails both comparisons, so that it counts as a contradiction.
            [track && away_m <= level_m, clock && apart_m <= level_m]
        });
        alert(!track, !clock)
    }

    /// Returns the contradiction of a change along a straight line, and learns from an epoch
    /// without a contradiction.
    fn drift(&mut self, time_s: f64, now: &Discrepancy) -> Option<Alert> {
        let now_s = self.since_origin_s(time_s)?;
        let contradiction = self.line(now_s, now);
        self.mark(now_s, now, contradiction.is_none());
        contradiction
    }

    /// Returns the contradiction of a straight line through the marks of one of the windows.
    fn line(&self, now_s: f32, now: &Discrepancy) -> Option<Alert> {
        WINDOWS_S.into_iter().find_map(|window_s| self.line_of(window_s, now_s, now))
    }

    /// Returns the contradiction of a straight line through the marks of a window, if it is full.
    fn line_of(&self, window_s: f32, now_s: f32, now: &Discrepancy) -> Option<Alert> {
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
        let [floor_m, clock_floor_m] = FLOORS_M;
        let floor_m = floor_m.max(LEVEL_SHARE * now.level_m);
        alert(
            self.position.is_drift(away_m, scatter_m, floor_m),
            self.clock.is_drift(apart_m, clock_scatter_m, clock_floor_m),
        )
    }

    fn since_origin_s(&self, time_s: f64) -> Option<f32> {
        Some((time_s - self.path.as_ref()?.origin_s) as f32)
    }

    /// Returns the oldest mark and its age, s, if the age is at least [`TEACHING_AGE_S`].
    fn oldest(&self, now_s: f32) -> Option<(&Mark, f32)> {
        let oldest = self.marks.front()?;
        let age_s = now_s - oldest.time_s;
        (age_s >= TEACHING_AGE_S as f32).then_some((oldest, age_s))
    }

    /// Makes the epoch a mark if the last mark is old enough. The spread then also learns from an
    /// epoch without a contradiction.
    fn mark(&mut self, now_s: f32, now: &Discrepancy, is_teaching: bool) {
        if self.marks.back().is_some_and(|mark| now_s - mark.time_s < SPACING_S as f32) {
            return;
        }
        if let Some((oldest, _)) = self.oldest(now_s).filter(|_| is_teaching) {
            let [away_m, apart_m] = now.from(&oldest.discrepancy);
            self.position.learn(away_m.max(0.0));
            self.clock.learn(apart_m);
        }
        if self.marks.is_full() {
            self.marks.pop_front();
        }
        let _ = self.marks.push_back(Mark { time_s: now_s, discrepancy: *now });
    }
}

/// Returns the alert of a position or a clock that contradicts its rates.
fn alert(is_off_track: bool, is_off_time: bool) -> Option<Alert> {
    match (is_off_track, is_off_time) {
        (_, true) => Some(Alert::Clock),
        (true, false) => Some(Alert::Track),
        (false, false) => None,
    }
}

/// Returns the contradiction of a clock across a gap, except for whole milliseconds.
fn across_gap(last: &Moment, now: &Moment, level_m: f32) -> Option<Alert> {
    let elapsed_s = now.time_s - last.time_s;
    if !(LONGEST_STEP_S..=LONGEST_GAP_S).contains(&elapsed_s) {
        return None;
    }
    let error_m = now.clock_m - last.clock_m - 0.5 * elapsed_s * (now.drift_m_s + last.drift_m_s);
    let error_m = libm::fabs(error_m - whole_milliseconds_m(error_m));
    // NaN fails this comparison, so that it counts as a contradiction.
    let is_explained = error_m <= WANDER_M_S * elapsed_s + f64::from(level_m);
    (!is_explained).then_some(Alert::Clock)
}
