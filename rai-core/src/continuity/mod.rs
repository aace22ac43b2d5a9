//! Continuity between epochs: recovery after an alert, jumps, and places where no receiver can be.
//!
//! A single epoch can deceive. In a receiver that tracks falsely, ranges sometimes agree by chance;
//! in a counterfeit sky they agree perfectly. The epochs before reveal it:
//!
//! ```text
//! √(|p − pₐ|² − (h − hₐ)²) ≤ v Δt + HPL + HPLₐ     and     |h − hₐ| ≤ v Δt + VPL + VPLₐ       else a jump
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `p`, `h`; `pₐ`, `hₐ` | position and height of the epoch; of the last protected one, the anchor | m |
//! | `v` | [`ContinuitySettings::max_speed_m_s`] | m/s |
//! | `Δt` | time since the anchor, by the epochs or by the caller's own clock if it has one: the shorter | s |
//!
//! | after | the position is protected again |
//! |---|---|
//! | an alert, a jump, an impossible place | when the satellites have agreed for [`Recovery`]: epochs and seconds, at positions that are within reach of each other; for [`WEAK`] if an epoch of them had one degree of freedom |
//! | a contradiction between ranges and their rates (`CLOCK`, `TRACK`) | when they have agreed for [`DOUBTED`] |
//! | a jump | also when time has made the position reachable, or after [`Continuity::forget`]; or when the contradicting epochs have agreed for [`WEAK`], and those that led to the anchor had not |
//!
//! **After a silence** longer than the time to alert, the first position must be where the receiver
//! can be expected: within `(1.5 u + 10 m/s) Δt` of the anchor, `u` the last speed. A position
//! farther away must first agree for as long as the way to it takes at `v`: ten minutes of silence
//! would otherwise make a place 300 km away good enough at once.
//!
//! An epoch that agrees only after an exclusion, with one degree of freedom left, does not count,
//! because among many satellites that disagree some pair always remains that agrees. A first epoch
//! with one degree of freedom, or the first after a long gap, is not protected either: satellites
//! agree by chance too easily.
//!
//! **Ends.** An anchor is forgotten after [`ANCHOR_AGE_S`]; agreement with a gap longer than
//! [`GAP_S`] begins anew. A time that goes back keeps the anchor's age, so that nothing becomes
//! reachable by it.
//!
//! **Limits.** A counterfeit that moves a position slower than `v` is not detected here, nor one
//! that is there from the start. A time tag that leaps ahead makes everything reachable unless the
//! caller has its own clock.

mod motion;

pub use motion::Motion;

use crate::frame::Ecef;
use crate::numeric::sqrt;
use crate::report::{Alert, Protected, ProtectionLevels, Report, Unavailable, Verdict};

/// Longest time for which the last protected position limits the next one, s.
///
/// At the default speed the whole earth is within reach before.
pub const ANCHOR_AGE_S: f64 = 86_400.0;

/// Longest gap in an agreement that continues, s: three epochs of a logger with one epoch in five
/// minutes.
pub const GAP_S: f64 = 900.0;

/// Speed that is expected of a receiver beyond its last one, m/s, and the factor on that.
const EXPECTED_M_S: (f64, f64) = (10.0, 1.5);

/// Speed that is expected of a receiver whose velocity was never known, m/s.
const UNKNOWN_SPEED_M_S: f64 = 50.0;

/// Largest variation of the delay from an epoch to the caller's clock, s.
pub const DELAY_S: f64 = 1.0;

/// Required agreement if one of its epochs has only one degree of freedom.
pub const WEAK: Recovery = Recovery { epochs: 10, seconds: 10.0 };

/// Required agreement after rates contradicted position or clock: longer than a drift needs to show
/// again.
pub const DOUBTED: Recovery = Recovery { epochs: 10, seconds: 30.0 };

/// Required length of an agreement, in epochs and in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Recovery {
    /// Epochs in a row.
    pub epochs: u16,
    /// Time from the first epoch to the last, s; no less by the caller's own clock, up to
    /// [`DELAY_S`].
    pub seconds: f64,
}

impl Recovery {
    fn at_least(self, other: Self) -> Self {
        Self { epochs: self.epochs.max(other.epochs), seconds: self.seconds.max(other.seconds) }
    }

    unstable! {
        /// Returns true if an agreement of this length suffices; [`WEAK`] applies if one of its
        /// epochs had one degree of freedom.
        pub fn is_met(self, epochs: u16, seconds: f64, is_weak: bool) -> bool {
            let wanted = if is_weak { self.at_least(WEAK) } else { self };
            epochs >= wanted.epochs && seconds >= wanted.seconds
        }
    }
}

/// Limits of the receiver's motion, and the required agreement.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ContinuitySettings {
    /// Highest speed, m/s.
    pub max_speed_m_s: f64,
    /// Least height above the ellipsoid, m.
    pub min_height_m: f64,
    /// Greatest height above the ellipsoid, m.
    pub max_height_m: f64,
    /// Required agreement after an alert.
    pub recovery: Recovery,
}

impl ContinuitySettings {
    /// Returns limits for the ground, the sea and the air: 515 m/s (1000 knots), −500 to 20,000 m,
    /// 3 epochs and 3 s.
    pub const fn anywhere() -> Self {
        Self {
            max_speed_m_s: 515.0,
            min_height_m: -500.0,
            max_height_m: 20_000.0,
            recovery: Recovery { epochs: 3, seconds: 3.0 },
        }
    }

    /// Checks every field once.
    ///
    /// # Errors
    /// [`ContinuityError`] names the first field that is out of its range, with its value.
    pub fn validate(self) -> Result<Self, ContinuityError> {
        // NaN fails each of these comparisons.
        if !(0.0..=1e5).contains(&self.max_speed_m_s) {
            return Err(ContinuityError::Speed(self.max_speed_m_s));
        }
        let heights = -1.2e4..=1e8;
        if !heights.contains(&self.min_height_m)
            || !heights.contains(&self.max_height_m)
            || self.min_height_m >= self.max_height_m
        {
            let Self { min_height_m, max_height_m, .. } = self;
            return Err(ContinuityError::Height { min_height_m, max_height_m });
        }
        if self.recovery.epochs == 0 || !(0.0..=3600.0).contains(&self.recovery.seconds) {
            return Err(ContinuityError::Recovery(self.recovery));
        }
        Ok(self)
    }
}

/// The setting that is out of its range.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(not(feature = "unstable"), non_exhaustive)]
pub enum ContinuityError {
    /// `max_speed_m_s` is outside [0, 1e5].
    Speed(f64),
    /// The heights are outside [−1.2e4, 1e8], or the least is not below the greatest.
    Height {
        /// Least height, m.
        min_height_m: f64,
        /// Greatest height, m.
        max_height_m: f64,
    },
    /// The recovery has no epoch, or seconds outside [0, 3600].
    Recovery(Recovery),
}

impl core::fmt::Display for ContinuityError {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter.write_str(match self {
            Self::Speed(_) => "highest speed must be within 0 to 1e5 m/s",
            Self::Height { .. } => "height limits must be within -12000 to 1e8 m, minimum below maximum",
            Self::Recovery(_) => "recovery needs at least 1 epoch and 0 to 3600 s",
        })
    }
}

impl core::error::Error for ContinuityError {}

/// Time of an epoch, by both clocks.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Instant {
    epoch_s: f64,
    own_s: Option<f64>,
}

impl Instant {
    /// Returns the time since an earlier instant, s; 0 if it goes back.
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    fn since_s(self, earlier: Self) -> f64 {
        let by_epochs_s = (self.epoch_s - earlier.epoch_s).max(0.0);
        match self.own_s.zip(earlier.own_s) {
            Some((own_s, earlier_s)) => by_epochs_s.min((own_s - earlier_s).max(0.0) + DELAY_S),
            None => by_epochs_s,
        }
    }
}

/// A position with the levels that bound its error.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BoundedPosition {
    instant: Instant,
    position: Ecef,
    height_m: f64,
    levels: ProtectionLevels,
}

impl BoundedPosition {
    /// Returns true if a receiver can have moved from there to here. A NaN distance is beyond
    /// reach.
    fn is_within_reach_of(&self, from: &Self, max_speed_m_s: f64) -> bool {
        let way_m = max_speed_m_s * self.instant.since_s(from.instant);
        let climb_m = (self.height_m - from.height_m).abs();
        let ground_m = across_m(self.position - from.position, climb_m);
        ground_m <= way_m + self.levels.hpl_m + from.levels.hpl_m
            && climb_m <= way_m + self.levels.vpl_m + from.levels.vpl_m
    }
}

impl BoundedPosition {
    /// Returns the distance to an earlier position, m.
    fn distance_m(&self, from: &Self) -> f64 {
        across_m(self.position - from.position, 0.0)
    }

    /// Returns how long this position must agree after a silence, s: 0 if the receiver is expected
    /// here, otherwise the time of the way at the highest speed.
    fn wait_s(&self, from: &Self, speed_m_s: f64, max_speed_m_s: f64) -> f64 {
        let (beyond_m_s, factor) = EXPECTED_M_S;
        let expected_m_s = (factor * speed_m_s + beyond_m_s).min(max_speed_m_s);
        if self.is_within_reach_of(from, expected_m_s) {
            return 0.0;
        }
        // A highest speed of zero makes the wait infinite or NaN, which the age of an anchor ends.
        self.distance_m(from) / max_speed_m_s
    }
}

/// Returns the horizontal part of the way between two points, m. Metres suffice, because levels are
/// no smaller.
fn across_m(way: Ecef, climb_m: f64) -> f64 {
    let [x, y, z, climb] = [way.x_m, way.y_m, way.z_m, climb_m].map(|length_m| length_m as f32);
    let squared = x * x + y * y + z * z - climb * climb;
    // A NaN square stays NaN, which is beyond reach.
    f64::from(sqrt(if squared < 0.0 { 0.0 } else { squared }))
}

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

    fn extended(self, place: BoundedPosition, is_weak: bool) -> Self {
        let epochs = self.epochs.saturating_add(1);
        Self { last: place, epochs, is_weak: self.is_weak || is_weak, ..self }
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
    /// The last epoch with a position was protected, or nothing contradicted it.
    Good,
    /// After an alert or a contradiction, so that an agreement is required.
    Lost,
}

/// State of the verdicts so far.
#[derive(Clone, Debug)]
pub struct Continuity {
    standing: Standing,
    /// Protected epochs within reach of each other that end with the last protected one.
    anchor: Option<Agreement>,
    agreement: Option<Agreement>,
    latest_s: Option<f64>,
    /// Speed at the anchor, m/s.
    speed_m_s: Option<f64>,
    /// Agreement required because of a silence, s.
    wait_s: f64,
    /// True after rates contradicted position or clock, until a promise.
    is_doubted: bool,
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
            wait_s: 0.0,
            is_doubted: false,
        }
    }

    /// Forgets the last position, so that the next may be anywhere. Recovery from an alert is still
    /// required.
    pub fn forget(&mut self) {
        (self.anchor, self.agreement) = (None, None);
        (self.speed_m_s, self.wait_s, self.is_doubted) = (None, 0.0, false);
        self.interrupt();
    }

    /// Restarts after a gap longer than the time to alert: the next epoch is judged as if it were
    /// the first.
    ///
    /// Recovery from an alert is still required, and agreement so far counts; otherwise a receiver
    /// whose epochs are farther apart than the time to alert would never recover.
    pub fn interrupt(&mut self) {
        if self.standing == Standing::Good {
            self.standing = Standing::New;
        }
    }

    /// Returns the verdict on an epoch in the light of those before it.
    ///
    /// `time_s` is the epoch's time. `own_clock_s` is the time of its arrival by the caller's own
    /// clock, which no signal can set. A time that is not finite counts as the last one.
    /// `speed_m_s` is that of the epoch, if its range rates gave one.
    pub fn conclude<const N: usize>(
        &mut self,
        settings: &ContinuitySettings,
        time_s: f64,
        own_clock_s: Option<f64>,
        report: &Report<N>,
        speed_m_s: Option<f64>,
    ) -> Verdict {
        let own_s = own_clock_s.filter(|clock_s| clock_s.is_finite());
        let instant = self.pass_time(Instant { epoch_s: time_s, own_s });
        let place =
            report.solution.as_ref().zip(report.protection).map(|(solution, levels)| BoundedPosition {
                instant,
                position: solution.position,
                height_m: solution.geodetic.height_m,
                levels,
            });
        // A known height is no witness for the satellites.
        let aided = u8::from(report.height.is_some_and(|height| height.is_used));
        let dof = report.test.map_or(0, |test| test.dof.saturating_sub(aided));
        match (report.verdict, place) {
            (Verdict::Protected(how), Some(place)) => self.promise(settings, how, place, dof, speed_m_s),
            // A missing position is never protected.
            (Verdict::Protected(_), None) => Verdict::Unavailable(Unavailable::NoFix),
            (Verdict::Alert(reason), _) => self.lose(Verdict::Alert(reason)),
            (Verdict::Unavailable(reason), _) => {
                // Levels above the limits are no evidence against the satellites.
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

    /// Returns the verdict on an epoch that is protected on its own.
    fn promise(
        &mut self,
        settings: &ContinuitySettings,
        how: Protected,
        place: BoundedPosition,
        dof: u8,
        speed_m_s: Option<f64>,
    ) -> Verdict {
        let is_weak = dof <= 1;
        let from = self.anchor.map(|anchor| anchor.last);
        if from.is_some_and(|from| !place.is_within_reach_of(&from, settings.max_speed_m_s)) {
            self.agree(settings, how, place, is_weak);
            if !self.contradicts_anchor(settings) {
                self.standing = Standing::Lost;
                return Verdict::Alert(Alert::Jump);
            }
            (self.anchor, self.wait_s) = (None, 0.0);
        }
        // NaN fails this comparison, so that it counts as outside.
        if !(settings.min_height_m..=settings.max_height_m).contains(&place.height_m) {
            return self.lose(Verdict::Unavailable(Unavailable::Place));
        }
        if self.standing == Standing::New || self.wait_s > 0.0 {
            self.wait_s = self.wait_at(&place, settings.max_speed_m_s);
        }
        if self.wait_s > 0.0 {
            self.standing = Standing::Lost;
        }
        if self.standing == Standing::Lost || self.standing == Standing::New && is_weak {
            self.agree(settings, how, place, is_weak);
            let waited = Recovery { epochs: 1, seconds: self.wait_s };
            let wanted = settings.recovery.at_least(waited);
            let wanted = if self.is_doubted { wanted.at_least(DOUBTED) } else { wanted };
            if !self.agreement.is_some_and(|agreement| agreement.suffices(wanted)) {
                return Verdict::Unavailable(Unavailable::Recovering);
            }
        }
        (self.wait_s, self.is_doubted) = (0.0, false);
        let implied_m_s = self.anchor.map(|anchor| {
            place.distance_m(&anchor.last) / place.instant.since_s(anchor.last.instant).max(1.0)
        });
        self.speed_m_s = speed_m_s.or(implied_m_s).or(self.speed_m_s);
        // An anchor within reach makes this epoch as firm as it was.
        let agreement = self.agreement.take().unwrap_or_else(|| Agreement::begun(place, is_weak));
        self.anchor = Some(self.anchor.map_or(agreement, |anchor| anchor.extended(place, is_weak)));
        self.standing = Standing::Good;
        Verdict::Protected(how)
    }

    /// Returns the agreement that a place requires after a silence, s.
    fn wait_at(&self, place: &BoundedPosition, max_speed_m_s: f64) -> f64 {
        let speed_m_s = self.speed_m_s.unwrap_or(UNKNOWN_SPEED_M_S);
        self.anchor.map_or(0.0, |anchor| place.wait_s(&anchor.last, speed_m_s, max_speed_m_s))
    }

    /// Returns true if epochs out of the anchor's reach have agreed for [`WEAK`], while those that
    /// led to it had not.
    fn contradicts_anchor(&self, settings: &ContinuitySettings) -> bool {
        let wanted = settings.recovery.at_least(WEAK);
        // A longer required recovery does not weaken an anchor that was firm without it.
        self.agreement.is_some_and(|agreement| agreement.suffices(wanted))
            && !self.anchor.is_some_and(|anchor| anchor.suffices(WEAK))
    }

    /// Counts an epoch that agrees after one that did not.
    fn agree(
        &mut self,
        settings: &ContinuitySettings,
        how: Protected,
        place: BoundedPosition,
        is_weak: bool,
    ) {
        self.agreement = match self.agreement {
            _ if is_weak && how == Protected::Excluded => None,
            // Counted before.
            Some(before) if before.last == place => Some(before),
            Some(before)
                if place.instant.epoch_s - before.last.instant.epoch_s <= GAP_S
                    && place.is_within_reach_of(&before.last, settings.max_speed_m_s) =>
            {
                Some(before.extended(place, is_weak))
            }
            _ => Some(Agreement::begun(place, is_weak)),
        };
    }

    /// Records the loss of protection, which then requires an agreement.
    fn lose(&mut self, verdict: Verdict) -> Verdict {
        self.is_doubted |= matches!(verdict, Verdict::Alert(Alert::Clock | Alert::Track));
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
            // The time was set back: the anchor and its age stay.
            self.agreement = None;
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
