//! Comparison of position and clock with the integral of velocity and drift.
//!
//! Ranges and range rates are measured independently. A change of one without the other is no
//! motion of the receiver:
//!
//! ```text
//! δ_k = [p_k − Σ ½ (v_j + v_{j−1}) Δt_j,   b_k − Σ ½ (ḋ_j + ḋ_{j−1}) Δt_j]        j ≤ k
//!
//! leap    |δ_k − δ_m| > L_k + L_m                               for a mark m of the last minute
//! leaps   |δ_k − δ_h| > 2 L_k                                   for the mean δ_h of the last ten minutes, of the position only
//! step    |δ_k − δ_l| > max(20·t, √(L_k² + L_l²)/4)             for the last mark l, of the position only
//! drift   |δ_k − δ_1| > max(f, 6·s, 6·e, 6·n)                  for mark 1, the first of a window of 20, 30 or 60 s;
//!         f = max(4 m, L_k/4) for the position, half of it for the clock
//! e²      = mean of |δ_m − δ_1 − (δ_k − δ_1) (t_m − t_1)/(t_k − t_1)|²  over the marks after the first
//! n²      ← n² + (|δ_k − δ_{k−1}|² − n²)/8                         n counts as at most 4·s
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `p`, `b` | earth-fixed position; receiver clock times the speed of light, of one constellation | m |
//! | `v`, `ḋ` | [`Velocity::east_north_up_m_s`], earth-fixed; [`Velocity::drift_m_s`] | m/s |
//! | `δ` | [`Discrepancy`], constant except for noise | m |
//! | `L` | `HPL + VPL` of an epoch | m |
//! | `e` | scatter of the marks about a straight line | m |
//! | `n` | [`Noise`]: root mean square of the changes between the present epochs | m |
//! | `s` | [`Spreads`]: mean of `|δ_k − δ_1|` over the epochs so far | m |
//! | `t` | [`Spreads`]: mean of `|δ|` from one mark to the next | m |
//!
//! A contradiction of the position is [`Alert::Track`], one of the clock [`Alert::Clock`]. In one
//! epoch, the clock reveals a second receiver, a repeater, and most counterfeit signals. Within a
//! minute, it also reveals a slow drag-off that all ranges share, which no test of one epoch can
//! detect.
//!
//! Reflections also change `δ`, in streets by 200 m within levels of 300 m, but rarely along a
//! straight line. A step and a drift are therefore compared with their usual size, `t` and `s`. In
//! streets, the largest step of 746 was 15 times the mean. A drift of the position counts only
//! above a quarter of `L`, about three quarters of the HPL. Below that, the level bounds it; a
//! continuing drift is an alert before it exceeds the level. A clock is as uncertain as a height,
//! whose sigma is a fifth of the VPL. A drift of the clock below an eighth of `L` is therefore no
//! more than its noise: a reflection that grows for a minute, or four satellites of one system.
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
//! **Learning.** `s` and `t` are learned from the marks, `n` from each epoch ([`marks`]), for each kind of
//! ranges by itself: pairs of frequencies are three times as noisy as one.
//!
//! **Contradicting rates.** If a position is far from the true one, the true rates fit no velocity.
//! If the rates of an epoch contradict each other, its position must therefore be where the last
//! velocity leads. Both levels and a change of speed by 40 m/s are allowed for. This comparison
//! ends after [`LONGEST_GAP_S`]. Rates that contradict each other where the receiver was at rest when
//! they last agreed are to blame themselves, because the position has not moved.
//!
//! **Ends.** After a leap the marks begin anew at the new position and clock, so that one leap of a
//! clock causes one alert, as when a receiver starts anew. A position that leapt or drifted away stays
//! an alert ([`super::doubt`]).
//!
//! **Gaps.** After a step longer than [`LONGEST_STEP_S`] the comparison begins anew. Across a gap
//! the clock is still compared ([`super::path`]). Steps of the clock by whole milliseconds are
//! ignored, because receivers make them on purpose. If the system of the clock is missing, another
//! one takes its place, and the comparison of the position continues.
//!
//! **Steering.** A receiver that sets its clock back again and again is recognised by its first
//! epochs or by a clock that stays ([`super::steering`]). Its clock is compared with its own past
//! only. The comparison of the position stays.
//!
//! **No rates.** Without Doppler frequencies, or if they contradict each other, the clock is
//! compared with its past ([`super::oscillator`]). Without them the position is not compared.
//!
//! **Limits.** A step below 20 usual ones is not detected, and none in the first two minutes. An
//! attack is not detected here if it starts from the true position and slowly changes ranges and
//! rates consistently.

mod marks;

use marks::{MARKS, Mark, WINDOW_S};

use super::discrepancy::{Discrepancy, Noise, Spreads};
use super::doubt::Doubt;
use super::oscillator::Oscillator;
use super::path::{ACCELERATION_M_S2, LONGEST_GAP_S, LONGEST_STEP_S, Moment, Path, across_gap, way_m};
use super::steering::Steering;
use heapless::Deque;

use crate::frame::{Ecef, earth_fixed};
use crate::numeric::sqrt;
use crate::report::{Alert, Report};
use crate::satellite::Constellation;
use crate::velocity::{Velocity, VelocityError};

/// Largest change of speed of a car while the rates contradict each other, m/s.
const FASTER_M_S: f32 = 40.0;

/// Largest speed of a receiver at rest, m/s.
const AT_REST_M_S: f32 = 1.0;

/// Smallest drift of the position, relative to `HPL + VPL`.
const LEVEL_SHARE: f32 = 0.25;

/// Smallest drift of the position, m.
const FLOOR_M: f32 = 4.0;

/// Smallest drift of the clock relative to that of the position, which has three components.
const CLOCK_SHARE: f32 = 0.5;

/// Largest step of the position from mark to mark, relative to the mean one.
const STEPS: f32 = 20.0;

/// What contradicts its past in an epoch.
#[derive(Clone, Copy)]
struct Found {
    is_off_track: bool,
    is_off_time: bool,
    /// True if it drifted, false if it leapt.
    is_drift: bool,
}

impl Found {
    /// Returns a leap of position or clock, or none.
    const fn leap([is_off_track, is_off_time]: [bool; 2]) -> Self {
        Self { is_off_track, is_off_time, is_drift: false }
    }
}

/// Comparison of position and clock with the integral of velocity and drift.
#[derive(Clone, Debug)]
pub struct Motion {
    last: Option<Moment>,
    path: Option<Path>,
    marks: Deque<Mark, MARKS>,
    spreads: Spreads,
    /// Those of ranges of another kind.
    others: Spreads,
    noise: Noise,
    doubt: Doubt,
    reference: Constellation,
    oscillator: Oscillator,
    steering: Steering,
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
            spreads: Spreads::NONE,
            others: Spreads::NONE,
            noise: Noise::new(),
            doubt: Doubt::new(),
            reference: Constellation::Gps,
            oscillator: Oscillator::new(),
            steering: Steering::new(),
        }
    }

    /// Forgets the epochs so far, but not their spread.
    pub fn restart(&mut self) {
        if !cfg!(feature = "past") {
            return;
        }
        self.marks.clear();
        (self.last, self.path) = (None, None);
        self.doubt.release();
        self.oscillator.restart();
    }

    /// Forgets the epochs so far and their contradictions, but not their spread.
    pub(crate) fn forget(&mut self) {
        if !cfg!(feature = "past") {
            return;
        }
        (self.doubt, self.steering) = (Doubt::new(), Steering::new());
        self.restart();
    }

    /// Continues with ranges of another kind: with what they have taught before, or else with what
    /// those before have taught, times `noisier`.
    pub fn change_kind(&mut self, noisier: f32) {
        if !cfg!(feature = "past") {
            return;
        }
        core::mem::swap(&mut self.spreads, &mut self.others);
        if !self.spreads.clock.is_known() {
            self.spreads = self.others.times(noisier);
        }
    }

    /// Returns true if the rates have contradicted each other for so long that the position must
    /// not be promised.
    pub fn is_refused_for_long(&self, time_s: f64) -> bool {
        cfg!(feature = "past") && self.doubt.is_refused_for_long(time_s)
    }

    /// Returns true if a contradiction counts that epochs have to outlast: every one but a single
    /// leap of the clock.
    pub(crate) const fn is_doubted(&self) -> bool {
        cfg!(feature = "past") && self.doubt.is_contradicted()
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
        let position = solution.position;
        let (clock_m, is_of_another_clock) = self.clock_m(&solution.clocks_m, &report.used)?;
        if is_of_another_clock {
            self.oscillator.restart();
        }
        // It learns in every epoch, and judges those without a drift.
        let leaps = self.oscillator.leaps(time_s, clock_m, level_m, self.steering.is_steered());
        let velocity = match velocity {
            Ok(velocity) => velocity,
            Err(error) => {
                let is_refused = error.is_contradiction();
                let is_astray = is_refused && self.is_astray(time_s, position, level_m);
                let contradiction = alert(is_astray, leaps);
                if is_astray {
                    self.doubt.contradict(time_s, false, false);
                }
                self.doubt.is_resting = self.is_where_it_rested(position, level_m);
                let is_kept = self.doubt.keeps_without_velocity(time_s, error);
                return contradiction.or(is_kept.then_some(Alert::Track));
            }
        };
        let velocity_m_s = earth_fixed(position, velocity.east_north_up_m_s);
        // Infinite if one rate cannot be tested; a difference must stay a number.
        let velocity_level_m_s =
            ((velocity.levels_m_s.hpl_m + velocity.levels_m_s.vpl_m) as f32).min(FASTER_M_S);
        let drift_m_s = velocity.drift_m_s;
        let now = Moment {
            time_s,
            position,
            level_m,
            clock_m,
            velocity_m_s,
            velocity_level_m_s,
            drift_m_s,
            is_of_another_clock,
        };
        self.with_velocity(&now, leaps)
    }

    /// Compares an epoch with a velocity with earlier ones. `leaps` is true if its clock contradicts
    /// its own past.
    fn with_velocity(&mut self, now: &Moment, leaps: bool) -> Option<Alert> {
        let last = self.last.replace(*now)?;
        let near = Some(last).filter(|last| {
            let elapsed_s = now.time_s - last.time_s;
            elapsed_s > 0.0 && elapsed_s <= LONGEST_STEP_S
        });
        let (found, is_home) = if let (Some(last), Some(path)) = (near, &mut self.path) {
            let discrepancy = path.advance(&last, now);
            let now_s = (now.time_s - path.origin_s) as f32;
            self.compare(now_s, now, discrepancy)
        } else {
            // After a silence the place may be another. Epochs whose rates were refused are none.
            if !self.doubt.is_refused() {
                self.doubt.release();
            }
            self.begin(now);
            (Found::leap([false, !self.steering.is_steered() && across_gap(&last, now)]), None)
        };
        let Found { is_off_track, is_off_time, is_drift } = found;
        let contradiction = alert(is_off_track, is_off_time || leaps && self.steering.is_steered());
        if contradiction.is_some() {
            let is_leap = !is_off_track && !is_drift;
            self.doubt.contradict(now.time_s, is_off_track && is_home == Some(false), is_leap);
        }
        let is_kept = self.doubt.keeps_at(now.time_s, is_home == Some(true));
        contradiction.or(is_kept.then_some(Alert::Track))
    }

    /// Returns what contradicts its past, and whether the position is the usual one, if that is
    /// known.
    fn compare(&mut self, now_s: f32, now: &Moment, discrepancy: Discrepancy) -> (Found, Option<bool>) {
        while self.marks.front().is_some_and(|mark| now_s - mark.time_s > WINDOW_S as f32) {
            self.marks.pop_front();
        }
        // The noise of a difference is that of both epochs.
        let last_m = self.marks.back().map_or(now.level_m, |mark| mark.discrepancy.level_m);
        let both_m = LEVEL_SHARE * sqrt(now.level_m * now.level_m + last_m * last_m);
        let step_m = (STEPS * self.spreads.step.mean_m()).max(both_m);
        let is_home = self.doubt.is_home(&discrepancy, step_m);
        self.steering.observe(now_s, discrepancy.clock_m);
        let [leap, leap_of_clock] = self.leap(&discrepancy, step_m, is_home);
        // Small leaps add up.
        let both_m = 2.0 * now.level_m + discrepancy.unknown_m;
        let is_afar = self.doubt.is_home(&discrepancy, both_m) == Some(false);
        let leap = [leap || is_afar, leap_of_clock];
        let leap = self.unsteered(now_s, &discrepancy, leap);
        if leap != [false; 2] {
            if let Some(path) = &mut self.path {
                path.set_clock(now.clock_m);
            }
            self.steering.begin();
            self.mark_anew(Mark { time_s: now_s, discrepancy: Discrepancy { clock_m: 0.0, ..discrepancy } });
            return (Found::leap(leap), is_home);
        }
        self.noise.learn(&discrepancy);
        // A place at the edge of the bound has not returned, whatever the noise of the epoch.
        let is_home =
            if is_home == Some(true) { self.doubt.is_home(&discrepancy, 0.5 * step_m) } else { is_home };
        let drift = self.line(now_s, &discrepancy);
        let drift = self.unsteered(now_s, &discrepancy, drift);
        self.mark(now_s, &discrepancy, drift == [false; 2]);
        (Found { is_drift: drift != [false; 2], ..Found::leap(drift) }, is_home)
    }

    /// Returns contradictions of position and clock without one of the clock that steering explains.
    // Not inlined, so that its two callers share one copy.
    #[inline(never)]
    fn unsteered(&mut self, now_s: f32, now: &Discrepancy, [track, clock]: [bool; 2]) -> [bool; 2] {
        [track, clock && !self.steering.explains(now_s, now.clock_m, self.stays(now))]
    }

    /// Returns true if a position whose rates contradict each other is not where the last velocity
    /// leads.
    fn is_astray(&self, time_s: f64, position: Ecef, level_m: f32) -> bool {
        let Some(last) = &self.last else { return false };
        let elapsed_s = time_s - last.time_s;
        if !(0.0..=LONGEST_GAP_S).contains(&elapsed_s) {
            return false;
        }
        let elapsed_s = elapsed_s as f32;
        let away_m = way_m(last.position, position) - last.velocity_m_s * elapsed_s;
        let faster_m_s = (0.5 * ACCELERATION_M_S2 as f32 * elapsed_s).min(FASTER_M_S);
        let bound_m = level_m + last.level_m + faster_m_s * elapsed_s;
        // NaN fails this comparison, so that it counts as a contradiction.
        !(away_m.norm_squared() <= bound_m * bound_m)
    }

    /// Returns true if a position is where the receiver was at rest when its rates last agreed.
    fn is_where_it_rested(&self, position: Ecef, level_m: f32) -> bool {
        self.last.is_some_and(|last| {
            let bound_m = LEVEL_SHARE * level_m;
            last.velocity_m_s.norm_squared() <= AT_REST_M_S * AT_REST_M_S
                && way_m(last.position, position).norm_squared() <= bound_m * bound_m
        })
    }

    /// Returns the clock of the constellation that is compared, m, and true if it is another one
    /// than before, because that one is gone.
    fn clock_m(
        &mut self,
        clocks_m: &[Option<f64>; Constellation::COUNT],
        used: &[crate::satellite::SatelliteId],
    ) -> Option<(f64, bool)> {
        let clock_m = |constellation: Constellation| *clocks_m.get(constellation as usize)?;
        if let Some(clock_m) = clock_m(self.reference) {
            return Some((clock_m, false));
        }
        self.reference = used.first()?.constellation();
        Some((clock_m(self.reference)?, true))
    }

    /// Begins the integral at an epoch.
    fn begin(&mut self, now: &Moment) {
        self.path = Some(Path::from(now));
        self.steering.begin();
        self.doubt.leave_home();
        let level_m = now.level_m;
        self.mark_anew(Mark { time_s: 0.0, discrepancy: Discrepancy::none(level_m) });
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
