//! What one epoch says about the next: recovery after an alert, jumps, places where no receiver can be.
//!
//! An epoch by itself can deceive. Where a receiver tracks falsely, its ranges agree by chance now and then; where
//! somebody counterfeits a whole sky, they agree perfectly. What came before tells:
//!
//! ```text
//! √(|p − pₐ|² − (h − hₐ)²) ≤ v Δt + HPL + HPLₐ     and     |h − hₐ| ≤ v Δt + VPL + VPLₐ       else a jump
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `p`, `h`; `pₐ`, `hₐ` | position and height of the epoch; of the last protected one, the anchor | m |
//! | `v` | [`ContinuitySettings::max_speed_m_s`] | m/s |
//! | `Δt` | time since the anchor, by the epochs, and by the caller's own clock where it has one: the shorter | s |
//!
//! | after | the promise returns |
//! |---|---|
//! | an alert, a jump, an impossible place | when the satellites have agreed for [`Recovery`]: epochs and seconds, at positions that are within reach of each other; [`WEAK`] epochs and seconds where an epoch of them had one degree of freedom |
//! | a jump | besides, when time has made the position reachable, or [`Continuity::forget`]; or when what contradicts the anchor has agreed for [`WEAK`], and what led to the anchor had not |
//!
//! An epoch that agrees only because a satellite was left out, with one degree of freedom after that, counts for
//! nothing: among many satellites that disagree some pair is always left that does not. One epoch of one degree of
//! freedom is no promise either where nothing came before it, or nothing for too long: the satellites agree by chance too easily.
//!
//! **What has an end.** An anchor is forgotten after [`ANCHOR_AGE_S`]; agreement with a gap longer than [`GAP_S`]
//! begins anew. A time that goes back keeps the anchor's age: nothing becomes reachable by it.
//!
//! **Limits.** A counterfeit that leads a position away slower than `v` is not seen here, nor one that is there from
//! the start. A time tag that leaps ahead makes everything reachable unless the caller has a clock of its own.

use crate::frame::Ecef;
use crate::report::{Alert, Protected, ProtectionLevels, Report, Unavailable, Verdict};

/// The longest time for which the last protected position says where the next can be, s: at the start's highest speed
/// all the earth is within reach before.
pub const ANCHOR_AGE_S: f64 = 86_400.0;

/// The longest gap in an agreement that goes on, s: three epochs of a logger that says one in five minutes.
pub const GAP_S: f64 = 900.0;

/// How much later than another an epoch may have come on its way to the caller's clock, s.
pub const DELAY_S: f64 = 1.0;

/// Agreement that is asked for where an epoch of it has one degree of freedom only.
pub const WEAK: Recovery = Recovery { epochs: 10, seconds: 10.0 };

/// How long satellites must agree, both.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Recovery {
    /// Epochs in a row.
    pub epochs: u16,
    /// Time from the first of them to the last, s; by the caller's own clock no less, but for [`DELAY_S`].
    pub seconds: f64,
}

impl Recovery {
    fn at_least(self, other: Self) -> Self {
        Self { epochs: self.epochs.max(other.epochs), seconds: self.seconds.max(other.seconds) }
    }

    /// Whether so many epochs in a row, over so long, are enough; [`WEAK`] holds where one of them had one degree of freedom.
    pub fn is_met(self, epochs: u16, seconds: f64, is_weak: bool) -> bool {
        let wanted = if is_weak { self.at_least(WEAK) } else { self };
        epochs >= wanted.epochs && seconds >= wanted.seconds
    }
}

/// What a receiver can do, and how long its satellites must agree.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ContinuitySettings {
    /// Highest speed, m/s.
    pub max_speed_m_s: f64,
    /// Least height above the ellipsoid, m.
    pub min_height_m: f64,
    /// Greatest height above the ellipsoid, m.
    pub max_height_m: f64,
    /// What an alert is to be followed by.
    pub recovery: Recovery,
}

impl ContinuitySettings {
    /// Anything on the ground, on the sea and in the air: 515 m/s (1000 knots), −500 to 20,000 m, 3 epochs and 3 s.
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
    /// The first field out of its range, by name.
    pub fn validate(self) -> Result<Self, ContinuityError> {
        // A NaN is in none of these ranges.
        if !(0.0..=1e5).contains(&self.max_speed_m_s) {
            return Err(ContinuityError::Speed);
        }
        let heights = -1.2e4..=1e8;
        if !heights.contains(&self.min_height_m)
            || !heights.contains(&self.max_height_m)
            || self.min_height_m >= self.max_height_m
        {
            return Err(ContinuityError::Height);
        }
        if self.recovery.epochs == 0 || !(0.0..=3600.0).contains(&self.recovery.seconds) {
            return Err(ContinuityError::Recovery);
        }
        Ok(self)
    }
}

/// Which setting is out of its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ContinuityError {
    /// `max_speed_m_s` outside [0, 1e5].
    Speed,
    /// Heights outside [−1.2e4, 1e8], or the least not below the greatest.
    Height,
    /// No epoch, or seconds outside [0, 3600].
    Recovery,
}

impl core::fmt::Display for ContinuityError {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter.write_str(match self {
            Self::Speed => "highest speed outside [0, 1e5] m/s",
            Self::Height => "heights outside [-1.2e4, 1e8] m, or the least not below the greatest",
            Self::Recovery => "recovery of no epoch, or outside [0, 3600] s",
        })
    }
}

impl core::error::Error for ContinuityError {}

/// When an epoch was, by both clocks.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Instant {
    epoch_s: f64,
    own_s: Option<f64>,
}

impl Instant {
    /// Time that may have passed since an earlier instant, s; none where it goes back.
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
struct Place {
    instant: Instant,
    position: Ecef,
    height_m: f64,
    levels: ProtectionLevels,
}

impl Place {
    /// Whether a receiver can have come from there to here. A distance that is no number is beyond reach.
    fn is_within_reach_of(&self, from: &Self, max_speed_m_s: f64) -> bool {
        let way_m = max_speed_m_s * self.instant.since_s(from.instant);
        let climb_m = (self.height_m - from.height_m).abs();
        let ground_m = across_m(self.position - from.position, climb_m);
        ground_m <= way_m + self.levels.hpl_m + from.levels.hpl_m
            && climb_m <= way_m + self.levels.vpl_m + from.levels.vpl_m
    }
}

/// What of the way between two points is not climbed, m. Metres suffice: levels are no smaller.
fn across_m(way: Ecef, climb_m: f64) -> f64 {
    let [x, y, z, climb] = [way.x_m, way.y_m, way.z_m, climb_m].map(|length_m| length_m as f32);
    let squared = x * x + y * y + z * z - climb * climb;
    // A square that is not a number stays none, and is no distance within reach.
    f64::from(libm::sqrtf(if squared < 0.0 { 0.0 } else { squared }))
}

/// Epochs in a row that agree.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Agreement {
    first: Instant,
    last: Place,
    epochs: u16,
    /// Whether one of them had one degree of freedom.
    is_weak: bool,
}

impl Agreement {
    fn begun(place: Place, is_weak: bool) -> Self {
        Self { first: place.instant, last: place, epochs: 1, is_weak }
    }

    fn extended(self, place: Place, is_weak: bool) -> Self {
        let epochs = self.epochs.saturating_add(1);
        Self { last: place, epochs, is_weak: self.is_weak || is_weak, ..self }
    }

    fn suffices(&self, recovery: Recovery) -> bool {
        recovery.is_met(self.epochs, self.last.instant.since_s(self.first), self.is_weak)
    }
}

/// Whether a promise needs an agreement first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// Nothing came before, or too long ago.
    New,
    /// The last epoch with a position was promised, or nothing spoke against it.
    Good,
    /// After an alert, or a contradiction.
    Lost,
}

/// The memory of what was said.
#[derive(Clone, Debug)]
pub struct Continuity {
    standing: Standing,
    /// The protected epochs within reach of each other that ended with the last protected one.
    anchor: Option<Agreement>,
    agreement: Option<Agreement>,
    latest_s: Option<f64>,
}

impl Default for Continuity {
    fn default() -> Self {
        Self::new()
    }
}

impl Continuity {
    /// Nothing was said yet.
    pub const fn new() -> Self {
        Self { standing: Standing::New, anchor: None, agreement: None, latest_s: None }
    }

    /// The last position counts for nothing: the next may be anywhere. An alert still has to be recovered from.
    pub fn forget(&mut self) {
        (self.anchor, self.agreement) = (None, None);
        self.interrupt();
    }

    /// Nothing was heard for too long: the next epoch stands by itself, as the first of all. An alert still has to be recovered
    /// from, and what has agreed since counts: else a receiver whose epochs are farther apart than the time to alert never did.
    pub fn interrupt(&mut self) {
        if self.standing == Standing::Good {
            self.standing = Standing::New;
        }
    }

    /// The verdict on an epoch, in the light of those before it.
    ///
    /// `time_s` is the epoch's; `own_clock_s` is that of a clock of the caller's own, which no signal can set, when the
    /// epoch came. A time that is not finite stands still.
    pub fn conclude<const N: usize>(
        &mut self,
        settings: &ContinuitySettings,
        time_s: f64,
        own_clock_s: Option<f64>,
        report: &Report<N>,
    ) -> Verdict {
        let own_s = own_clock_s.filter(|clock_s| clock_s.is_finite());
        let instant = self.pass_time(Instant { epoch_s: time_s, own_s });
        let place = report.solution.as_ref().zip(report.protection).map(|(solution, levels)| Place {
            instant,
            position: solution.position,
            height_m: solution.geodetic.height_m,
            levels,
        });
        let dof = report.test.map_or(0, |test| test.dof);
        match (report.verdict, place) {
            (Verdict::Protected(how), Some(place)) => self.promise(settings, how, place, dof),
            // Nobody promises a position that is not there.
            (Verdict::Protected(_), None) => Verdict::Unavailable(Unavailable::NoFix),
            (Verdict::Alert(reason), _) => self.lose(Verdict::Alert(reason)),
            (Verdict::Unavailable(reason), _) => {
                // Levels too large for the limits say nothing against the satellites.
                if !matches!(reason, Unavailable::Hpl | Unavailable::Vpl | Unavailable::Risk) {
                    self.agreement = None;
                }
                report.verdict
            }
        }
    }

    /// What becomes of an epoch that by itself is protected.
    fn promise(&mut self, settings: &ContinuitySettings, how: Protected, place: Place, dof: u8) -> Verdict {
        let is_weak = dof <= 1;
        let from = self.anchor.map(|anchor| anchor.last);
        if from.is_some_and(|from| !place.is_within_reach_of(&from, settings.max_speed_m_s)) {
            self.agree(settings, how, place, is_weak);
            if !self.contradicts_anchor(settings) {
                self.standing = Standing::Lost;
                return Verdict::Alert(Alert::Jump);
            }
            self.anchor = None;
        }
        // Written so that a height which is not a number is none.
        if !(settings.min_height_m..=settings.max_height_m).contains(&place.height_m) {
            return self.lose(Verdict::Unavailable(Unavailable::Place));
        }
        if self.standing == Standing::Lost || self.standing == Standing::New && is_weak {
            self.agree(settings, how, place, is_weak);
            if !self.agreement.is_some_and(|agreement| agreement.suffices(settings.recovery)) {
                return Verdict::Unavailable(Unavailable::Recovering);
            }
        }
        // An anchor that this is within reach of is as firm as it was.
        let agreement = self.agreement.take().unwrap_or_else(|| Agreement::begun(place, is_weak));
        self.anchor = Some(self.anchor.map_or(agreement, |anchor| anchor.extended(place, is_weak)));
        self.standing = Standing::Good;
        Verdict::Protected(how)
    }

    /// Whether epochs out of the anchor's reach have agreed for [`WEAK`], while those that led to it had not: either may be wrong.
    fn contradicts_anchor(&self, settings: &ContinuitySettings) -> bool {
        let wanted = settings.recovery.at_least(WEAK);
        // Who asks for a longer recovery does not doubt what was firm without it.
        self.agreement.is_some_and(|agreement| agreement.suffices(wanted))
            && !self.anchor.is_some_and(|anchor| anchor.suffices(WEAK))
    }

    /// Counts an epoch that agrees after one that did not.
    fn agree(&mut self, settings: &ContinuitySettings, how: Protected, place: Place, is_weak: bool) {
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

    /// After this a promise has to be earned anew.
    fn lose(&mut self, verdict: Verdict) -> Verdict {
        (self.standing, self.agreement) = (Standing::Lost, None);
        verdict
    }

    /// Notes the time of an epoch; one that is no number stands still.
    fn pass_time(&mut self, mut instant: Instant) -> Instant {
        let latest_s = self.latest_s.unwrap_or(0.0);
        if !instant.epoch_s.is_finite() {
            instant.epoch_s = latest_s;
        }
        let back_s = latest_s - instant.epoch_s;
        if back_s > 0.0 && self.latest_s.is_some() {
            // The time was set back: what is remembered is as old as it was.
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
