//! Continuity between epochs: recovery after an alert, jumps, and places where no receiver can be.
//!
//! A single epoch can deceive. If a receiver tracks falsely, its ranges sometimes agree by chance.
//! If all signals are counterfeit, they agree perfectly. A comparison with earlier epochs reveals
//! this:
//!
//! ```text
//! √(|p − pₐ|² − (h − hₐ)²) ≤ v Δt + HPL + HPLₐ     and     |h − hₐ| ≤ v Δt + VPL + VPLₐ       else a jump
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `p`, `h`; `pₐ`, `hₐ` | position and height of the epoch; those of the last protected epoch, the anchor | m |
//! | `v` | [`ContinuitySettings::max_speed_m_s`] | m/s |
//! | `Δt` | time since the anchor: the shorter one of that by the epochs and that by the caller's clock, if it has one | s |
//!
//! | after | the position is protected again |
//! |---|---|
//! | an alert, a jump, an impossible place | when the satellites have agreed for [`Recovery`], at positions within reach of each other; for [`WEAK`] if one of these epochs had one degree of freedom |
//! | a contradiction between ranges and their rates (`CLOCK`, `TRACK`) | when ranges and rates have agreed for [`DOUBTED`]; for [`WEAK`] after a clock that leapt once |
//! | a jump | also when enough time has passed to reach the position, or after [`Continuity::forget`]; or when the epochs after the jump have agreed for [`WEAK`], and those that led to the anchor had not |
//!
//! **After a silence** longer than the time to alert, the first position must be where the receiver
//! can be expected. Otherwise the epochs must agree for longer ([`reach`]).
//!
//! **Another receiver** on the line is known by its place and the times of its epochs ([`rhythm`]).
//! It is never protected.
//!
//! Two kinds of epochs are weak evidence, because their satellites easily agree by chance. If an
//! epoch agrees only after an exclusion, with one degree of freedom left, it does not count for an
//! agreement. If the first epoch, or the first after a long gap, has one degree of freedom, it is
//! not protected.
//!
//! **Ends.** An anchor is forgotten after [`ANCHOR_AGE_S`]. After a gap longer than [`GAP_S`] an
//! agreement begins anew. If the time goes back, the anchor keeps its age, so that no position
//! becomes reachable by this.
//!
//! **Limits.** Counterfeit signals are not detected here if they move a position slower than `v`,
//! or if they are present from the start. A time tag that leaps ahead makes every position
//! reachable, unless the caller has a clock.

mod discrepancy;
mod doubt;
mod motion;
mod oscillator;
mod path;
mod reach;
mod rhythm;
mod settings;
mod steering;

pub use motion::Motion;
pub use reach::DELAY_S;
pub use settings::{ContinuityError, ContinuitySettings, DOUBTED, Recovery, WEAK};

use reach::{BoundedPosition, Instant};
use rhythm::Rhythm;

use crate::report::{Alert, Protected, Report, Unavailable, Verdict};

/// Longest time for which the last protected position limits the next one, s.
///
/// At the default speed the whole earth is within reach before this age.
pub const ANCHOR_AGE_S: f64 = 86_400.0;

/// Longest gap that does not end an agreement, s: three intervals of a logger with one epoch in
/// five minutes.
pub const GAP_S: f64 = 900.0;

/// Consecutive epochs that agree.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Agreement {
    first: Instant,
    last: BoundedPosition,
    epochs: u16,
    /// True if one of them had one degree of freedom.
    is_weak: bool,
}

impl Agreement {
    fn begun(place: BoundedPosition, is_weak: bool) -> Self {
        Self { first: place.instant, last: place, epochs: 1, is_weak }
    }

    fn extend(&mut self, place: BoundedPosition, is_weak: bool) {
        self.last = place;
        self.epochs = self.epochs.saturating_add(1);
        self.is_weak |= is_weak;
    }

    fn suffices(&self, recovery: Recovery) -> bool {
        recovery.is_met(self.epochs, self.last.instant.since_s(self.first), self.is_weak)
    }
}

/// State of the continuity: is an agreement required before protection?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// No earlier epoch, or a long gap.
    New,
    /// The last epoch was protected, or nothing contradicted it since.
    Good,
    /// After an alert or a contradiction. An agreement is required.
    Lost,
}

/// State of the continuity between epochs.
#[derive(Clone, Debug)]
pub struct Continuity {
    standing: Standing,
    /// Protected epochs within reach of each other that end with the last protected one.
    anchor: Option<Agreement>,
    agreement: Option<Agreement>,
    latest_s: Option<f64>,
    /// Speed at the anchor, m/s.
    speed_m_s: Option<f32>,
    /// True after a silence until the next protected epoch. An alert before that does not end the
    /// required wait.
    is_after_silence: bool,
    /// Agreement required because of a silence, s.
    wait_s: f32,
    /// True after rates contradicted position or clock, until the next protected epoch.
    has_contradicted: bool,
    /// True if it was more than a single leap of the clock.
    is_doubted: bool,
    rhythm: Rhythm,
}

impl Default for Continuity {
    fn default() -> Self {
        Self::new()
    }
}

impl Continuity {
    /// Returns the state before the first epoch.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            standing: Standing::New,
            anchor: None,
            agreement: None,
            latest_s: None,
            speed_m_s: None,
            is_after_silence: false,
            wait_s: 0.0,
            has_contradicted: false,
            is_doubted: false,
            rhythm: Rhythm::new(),
        }
    }

    /// Forgets the last position, so that the next one may be anywhere. Recovery from an alert is
    /// still required.
    pub fn forget(&mut self) {
        (self.anchor, self.agreement) = (None, None);
        (self.speed_m_s, self.wait_s) = (None, 0.0);
        (self.has_contradicted, self.is_doubted) = (false, false);
        self.rhythm = Rhythm::new();
        self.interrupt();
    }

    /// Restarts after a gap longer than the time to alert. The next position must be where the
    /// receiver can be expected, or agree for longer.
    ///
    /// Recovery from an alert is still required, and the agreement so far still counts. Otherwise a
    /// receiver whose epochs are farther apart than the time to alert would never recover.
    pub fn interrupt(&mut self) {
        if self.standing == Standing::Good {
            (self.standing, self.is_after_silence) = (Standing::New, true);
        }
    }

    /// Returns the verdict on an epoch after comparing it with earlier ones.
    ///
    /// `time_s` is the epoch's time. `own_clock_s` is its arrival time by the caller's clock, which
    /// no signal can set. A time that is not finite counts as the last one. `speed_m_s` is the
    /// speed in the epoch, if its range rates determine one. `is_doubted` is true if ranges and rates
    /// contradicted each other in a way that [`DOUBTED`] has to outlast.
    pub fn conclude<const N: usize>(
        &mut self,
        settings: &ContinuitySettings,
        time_s: f64,
        own_clock_s: Option<f64>,
        report: &Report<N>,
        speed_m_s: Option<f64>,
        is_doubted: bool,
    ) -> Verdict {
        let own_s = own_clock_s.filter(|clock_s| clock_s.is_finite());
        let instant = self.pass_time(Instant { epoch_s: time_s, own_s });
        let place =
            report.solution.as_ref().zip(report.protection).map(|(solution, levels)| BoundedPosition {
                instant,
                position: solution.position,
                height_m: solution.geodetic.height_m as f32,
                levels_m: [levels.hpl_m as f32, levels.vpl_m as f32],
            });
        // The degree of freedom that a known height adds does not count.
        let aided = u8::from(report.height.is_some_and(|height| height.is_used));
        let dof = report.test.map_or(0, |test| test.dof.saturating_sub(aided));
        match (report.verdict, place) {
            (Verdict::Protected(how), Some(place)) => {
                let speed_m_s = speed_m_s.map(|speed_m_s| speed_m_s as f32);
                self.promise(settings, how, place, dof, speed_m_s)
            }
            // An epoch without a position is never protected.
            (Verdict::Protected(_), None) => Verdict::Unavailable(Unavailable::NoFix),
            (Verdict::Alert(reason), _) => {
                self.is_doubted |= is_doubted;
                self.has_contradicted |= is_doubted || reason == Alert::Clock && speed_m_s.is_some();
                self.lose(Verdict::Alert(reason))
            }
            (Verdict::Unavailable(reason), _) => {
                // If only the levels exceed the limits, this is no evidence against the satellites.
                let is_level = matches!(
                    reason,
                    Unavailable::Hpl
                        | Unavailable::Vpl
                        | Unavailable::Emt
                        | Unavailable::Accuracy
                        | Unavailable::Risk
                );
                if !is_level {
                    self.agreement = None;
                }
                report.verdict
            }
        }
    }

    /// Returns the verdict on an epoch that is protected if judged alone.
    fn promise(
        &mut self,
        settings: &ContinuitySettings,
        how: Protected,
        place: BoundedPosition,
        dof: u8,
        speed_m_s: Option<f32>,
    ) -> Verdict {
        let (is_weak, max_m_s) = (dof <= 1, settings.max_speed_m_s as f32);
        if cfg!(feature = "past") && self.is_of_another(max_m_s, &place) {
            return self.lose(Verdict::Alert(Alert::Jump));
        }
        if self.anchor.as_ref().is_some_and(|anchor| !place.is_within_reach_of(&anchor.last, max_m_s)) {
            self.agree(max_m_s, how, place, is_weak);
            if !self.contradicts_anchor(settings) {
                self.standing = Standing::Lost;
                return Verdict::Alert(Alert::Jump);
            }
            (self.anchor, self.wait_s) = (None, 0.0);
        }
        // NaN fails this comparison, so that it counts as outside.
        if !(settings.min_height_m..=settings.max_height_m).contains(&f64::from(place.height_m)) {
            return self.lose(Verdict::Unavailable(Unavailable::Place));
        }
        if self.is_after_silence {
            self.wait_s =
                self.anchor.map_or(0.0, |anchor| place.wait_s(&anchor.last, self.speed_m_s, max_m_s));
        }
        if self.wait_s > 0.0 {
            self.standing = Standing::Lost;
        }
        if self.standing == Standing::Lost || self.standing == Standing::New && is_weak {
            self.agree(max_m_s, how, place, is_weak);
            let waited = Recovery { epochs: 1, seconds: f64::from(self.wait_s) };
            let wanted = settings.recovery.at_least(waited);
            let wanted = if self.has_contradicted {
                wanted.at_least(if self.is_doubted { DOUBTED } else { WEAK })
            } else {
                wanted
            };
            if !self.agreement.is_some_and(|agreement| agreement.suffices(wanted)) {
                return Verdict::Unavailable(Unavailable::Recovering);
            }
        }
        (self.is_after_silence, self.wait_s) = (false, 0.0);
        (self.has_contradicted, self.is_doubted) = (false, false);
        self.speed_m_s = speed_m_s
            .or_else(|| self.anchor.map(|anchor| place.speed_m_s(&anchor.last, self.speed_m_s)))
            .or(self.speed_m_s);
        // If the anchor is within reach, its agreement continues with this epoch.
        let agreement = self.agreement.take();
        match &mut self.anchor {
            Some(anchor) => anchor.extend(place, is_weak),
            None => self.anchor = agreement.or_else(|| Some(Agreement::begun(place, is_weak))),
        }
        self.standing = Standing::Good;
        Verdict::Protected(how)
    }

    /// Returns true if another receiver sent an epoch that is protected if judged alone.
    fn is_of_another(&mut self, max_m_s: f32, place: &BoundedPosition) -> bool {
        let Some(Agreement { last, .. }) = &self.anchor else {
            self.rhythm = Rhythm::new();
            return false;
        };
        let elapsed_s = (place.instant.epoch_s - last.instant.epoch_s) as f32;
        let is_expected = || place.is_expected(last, self.speed_m_s, max_m_s);
        self.rhythm.is_of_another(elapsed_s, is_expected)
    }

    /// Returns true if the epochs beyond the anchor's reach have agreed for [`WEAK`], while those
    /// that led to the anchor had not.
    fn contradicts_anchor(&self, settings: &ContinuitySettings) -> bool {
        let wanted = settings.recovery.at_least(WEAK);
        // A longer required recovery does not weaken an anchor that agreed for `WEAK`.
        self.agreement.is_some_and(|agreement| agreement.suffices(wanted))
            && !self.anchor.is_some_and(|anchor| anchor.suffices(WEAK))
    }

    /// Adds an epoch to the agreement after a contradiction.
    fn agree(&mut self, max_m_s: f32, how: Protected, place: BoundedPosition, is_weak: bool) {
        if is_weak && matches!(how, Protected::Excluded | Protected::Covered) {
            self.agreement = None;
            return;
        }
        if let Some(before) = &mut self.agreement {
            let elapsed_s = place.instant.epoch_s - before.last.instant.epoch_s;
            if elapsed_s <= GAP_S && place.is_within_reach_of(&before.last, max_m_s) {
                // An epoch of the same time counts once.
                if elapsed_s > 0.0 {
                    before.extend(place, is_weak);
                }
                return;
            }
        }
        self.agreement = Some(Agreement::begun(place, is_weak));
    }

    /// Records the loss of protection. An agreement is then required.
    fn lose(&mut self, verdict: Verdict) -> Verdict {
        (self.standing, self.agreement) = (Standing::Lost, None);
        verdict
    }

    /// Records the time of an epoch; a NaN time counts as the last one.
    fn pass_time(&mut self, mut instant: Instant) -> Instant {
        let latest_s = self.latest_s.unwrap_or(0.0);
        if !instant.epoch_s.is_finite() {
            instant.epoch_s = latest_s;
        }
        let back_s = latest_s - instant.epoch_s;
        if back_s > 0.0 && self.latest_s.is_some() {
            // The time was set back. The anchor and its age do not change.
            (self.agreement, self.rhythm) = (None, Rhythm::new());
            if let Some(anchor) = &mut self.anchor {
                anchor.first.epoch_s -= back_s;
                anchor.last.instant.epoch_s -= back_s;
            }
        }
        self.latest_s = Some(instant.epoch_s);
        self.anchor = self.anchor.filter(|anchor| instant.since_s(anchor.last.instant) <= ANCHOR_AGE_S);
        instant
    }
}
