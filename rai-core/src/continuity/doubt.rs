//! Memory of contradictions: how long they count, and where the receiver was before them.
//!
//! After a contradiction an alert stays in these epochs, for at most [`HELD_S`]:
//!
//! | epoch | until |
//! |---|---|
//! | its rates contradict each other, or it has none | rates have agreed for [`SETTLED_S`] |
//! | its place is not where it was before, if that is known | it returns to that place |
//!
//! A walk-off with true rates needs the first row: once it is some kilometres long, the rates fit
//! no velocity at the false place. The second row keeps a leap, and a walk that ended, from being
//! believed after a short while. Where the receiver was is the mean discrepancy over the last
//! [`MEMORY`] marks without a contradiction. It is known after as many marks as a spread.
//!
//! **Starts.** The clock of a receiver that starts anew leaps once. Such a leap keeps no alert. Another
//! one within [`SETTLED_S`] counts as every contradiction, as clocks that are drawn off leap again
//! and again.
//!
//! **Refused rates.** If rates contradict each other for [`REFUSED_S`], the position is not
//! promised, unless this is usual: in streets, a cheap receiver has such rates for minutes. They
//! are unusual if at most [`UNUSUAL`] of the last minutes had them. They then also renew a
//! contradiction. This too ends after [`HELD_S`]. Rates that are only noisier than their sigmas
//! ([`VelocityError::Noise`]), as of a car that drives off, are no reason against a promise, nor is any
//! rate while the position stays where the receiver rested.
//!
//! **Limits.** A receiver whose rates contradict each other often, or that has none, is believed
//! without them. An attack can teach this within a minute, before it moves the position.

use nalgebra::Vector3;

use super::discrepancy::{Discrepancy, LEARNED, MEMORY};
use crate::velocity::VelocityError;

/// Time with velocities and without a contradiction after which an earlier one is forgotten, s. A
/// drift is detected again within it, and so is a walk at 1 m/s that taught its own bound, as a leap
/// by twice a level of 60 m.
pub(super) const SETTLED_S: f64 = 130.0;

/// Longest time for which a contradiction counts without a new one, s.
const HELD_S: f64 = 3600.0;

/// Longest time for which rates that contradict each other are no reason against a promise, s.
const REFUSED_S: f64 = 5.0;

/// Largest share of refused rates that is unusual, relative to those that agreed.
const UNUSUAL: f32 = 0.05;

/// Time with rates that agreed after which refused ones can be unusual, s: that of
/// [`super::WEAK`].
const AGREED_S: f32 = 10.0;

/// Time after which the share of refused rates is halved in weight, s.
const SHARE_S: f32 = 240.0;

/// A contradiction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Contradiction {
    /// Time of the last one, s.
    last_s: f64,
    /// Time of the last epoch that keeps it, s.
    kept_s: f64,
    /// True if the place of the receiver was known before.
    is_held: bool,
    /// True if it is a leap of the clock that happened once, which keeps nothing.
    is_single_leap: bool,
}

/// Memory of contradictions.
#[derive(Clone, Debug)]
pub(super) struct Doubt {
    contradiction: Option<Contradiction>,
    /// First of the consecutive epochs whose rates contradict each other, s.
    refused_s: Option<f64>,
    /// True if the position of the last epoch without a velocity is where the receiver rested.
    pub(super) is_resting: bool,
    /// Last epoch whose rates agreed or were noisy, s.
    rated_s: f64,
    /// Time with rates that agreed, and with rates that were refused, s.
    shares_s: [f32; 2],
    /// Mean discrepancy of the position, m.
    home_m: Vector3<f32>,
    /// Number of marks in the mean.
    count: u16,
}

impl Doubt {
    /// Returns the state before the first epoch.
    pub(super) const fn new() -> Self {
        Self {
            contradiction: None,
            refused_s: None,
            is_resting: false,
            rated_s: 0.0,
            shares_s: [0.0; 2],
            home_m: Vector3::new(0.0, 0.0, 0.0),
            count: 0,
        }
    }

    /// Forgets where the receiver was, because discrepancies before and after are not comparable.
    pub(super) fn leave_home(&mut self) {
        self.count = 0;
    }

    /// Forgets where the receiver was, and that it was elsewhere after a contradiction.
    pub(super) fn release(&mut self) {
        self.leave_home();
        if let Some(contradiction) = &mut self.contradiction {
            contradiction.is_held = false;
        }
    }

    /// Learns a discrepancy without a contradiction as the place of the receiver.
    pub(super) fn learn(&mut self, now: &Discrepancy) {
        if self.contradiction.is_none_or(|contradiction| !contradiction.is_held) {
            self.count = (self.count + 1).min(MEMORY);
            self.home_m += (now.position - self.home_m) / f32::from(self.count);
        }
    }

    /// Returns whether the discrepancy is within `bound_m` of the usual one, if that is known.
    pub(super) fn is_home(&self, now: &Discrepancy, bound_m: f32) -> Option<bool> {
        let is_near = (now.position - self.home_m).norm_squared() <= bound_m * bound_m;
        (self.count >= LEARNED).then_some(is_near)
    }

    /// Notes a contradiction of an epoch. `is_leap` is true if it is no more than a leap of the clock.
    pub(super) fn contradict(&mut self, time_s: f64, is_away: bool, is_leap: bool) {
        if self.count < LEARNED {
            // A mean of places before and after is none of them.
            self.count = 0;
        }
        let before = self.contradiction;
        // NaN fails this comparison, so that it counts as another leap.
        let is_first =
            before.is_none_or(|before| before.is_single_leap && time_s - before.last_s > SETTLED_S);
        self.contradiction = Some(Contradiction {
            last_s: time_s,
            kept_s: time_s,
            is_held: is_away || before.is_some_and(|before| before.is_held),
            is_single_leap: is_leap && is_first,
        });
    }

    /// Returns true if a contradiction counts that is more than a single leap of the clock.
    pub(super) const fn is_contradicted(&self) -> bool {
        matches!(self.contradiction, Some(Contradiction { is_single_leap: false, .. }))
    }

    /// Notes an epoch with a velocity and without a contradiction. Returns true if an earlier
    /// contradiction keeps the alert.
    pub(super) fn keeps_at(&mut self, time_s: f64, is_home: bool) -> bool {
        // A longer gap counts as a second.
        self.end_run(time_s, 1.0);
        let Some(contradiction) = &mut self.contradiction else { return false };
        let is_old = time_s - contradiction.last_s > HELD_S;
        if contradiction.is_held && is_old {
            self.count = 0;
        }
        contradiction.is_held &= !is_old && !is_home;
        if contradiction.is_held {
            contradiction.kept_s = time_s;
            return true;
        }
        if time_s - contradiction.kept_s > SETTLED_S {
            self.contradiction = None;
        }
        false
    }

    /// Notes an epoch without a velocity. Returns true if an earlier contradiction keeps the alert.
    pub(super) fn keeps_without_velocity(&mut self, time_s: f64, error: VelocityError) -> bool {
        let is_refused = error == VelocityError::Fault;
        if is_refused {
            self.refused_s.get_or_insert(time_s);
        } else if error == VelocityError::Noise {
            self.end_run(time_s, 0.0);
        }
        let is_renewed = is_refused && self.is_unusual();
        let kept = self.contradiction.as_mut().filter(|contradiction| !contradiction.is_single_leap);
        let Some(contradiction) = kept else { return false };
        contradiction.kept_s = time_s;
        if is_renewed {
            contradiction.last_s = time_s;
        }
        if time_s - contradiction.last_s > HELD_S {
            self.contradiction = None;
        }
        self.contradiction.is_some()
    }

    /// Ends a run of refused rates, if there is one. The time since the last epoch whose rates agreed
    /// or were noisy counts as agreement, `most_s` of it at most.
    fn end_run(&mut self, time_s: f64, most_s: f32) {
        let since_s = |before_s: f64| ((time_s - before_s) as f32).max(0.0);
        let agreed_s = since_s(self.rated_s).min(most_s);
        // A run counts when it is over, so that it is not usual by itself.
        let refused_s =
            self.refused_s.take().map_or(0.0, |refused_s| since_s(refused_s).min(REFUSED_S as f32));
        self.rated_s = time_s;
        self.share([agreed_s, refused_s]);
    }

    /// Adds times with rates that agreed and that were refused, s.
    fn share(&mut self, more_s: [f32; 2]) {
        let ([agreed_s, refused_s], [more_agreed_s, more_refused_s]) = (self.shares_s, more_s);
        let all_s = [agreed_s + more_agreed_s, refused_s + more_refused_s];
        let is_full = all_s.iter().sum::<f32>() > SHARE_S;
        self.shares_s = if is_full { all_s.map(|time_s| 0.5 * time_s) } else { all_s };
    }

    /// Returns true if rates that contradict each other are unusual for the receiver.
    pub(super) fn is_unusual(&self) -> bool {
        let [agreed_s, refused_s] = self.shares_s;
        agreed_s >= AGREED_S && refused_s <= UNUSUAL * agreed_s
    }

    /// Returns true if the rates of the last epochs contradicted each other.
    pub(super) const fn is_refused(&self) -> bool {
        self.refused_s.is_some()
    }

    /// Returns true if the rates have contradicted each other for too long, which is unusual, and the
    /// position is not where the receiver rested.
    pub(super) fn is_refused_for_long(&self, time_s: f64) -> bool {
        let Some(refused_s) = self.refused_s else { return false };
        let elapsed_s = time_s - refused_s;
        // NaN fails this comparison, so that it counts as long.
        !self.is_resting && self.is_unusual() && !(elapsed_s <= REFUSED_S || elapsed_s > HELD_S)
    }
}

#[cfg(test)]
mod tests {
    use super::{AGREED_S, Doubt, REFUSED_S};
    use crate::velocity::VelocityError::{Fault, Noise};

    /// Returns the state after a minute of rates that agree, and its end, s.
    fn quiet() -> (Doubt, f64) {
        let mut doubt = Doubt::new();
        let end_s = 6.0 * f64::from(AGREED_S);
        for second in 0..end_s as u32 {
            assert!(!doubt.keeps_at(second.into(), true));
        }
        (doubt, end_s)
    }

    #[test]
    fn noise_is_never_refused_and_does_not_make_contradictions_usual() {
        let (mut doubt, mut now_s) = quiet();
        for _ in 0..600 {
            now_s += 1.0;
            assert!(!doubt.keeps_without_velocity(now_s, Noise));
            assert!(!doubt.is_refused_for_long(now_s));
        }
        assert!(doubt.is_unusual());
        let noise_ends_s = now_s;
        while now_s < noise_ends_s + REFUSED_S + 2.0 {
            now_s += 1.0;
            assert!(!doubt.keeps_without_velocity(now_s, Fault));
        }
        assert!(doubt.is_refused_for_long(now_s));
        assert!(!doubt.keeps_without_velocity(now_s + 1.0, Noise));
        assert!(!doubt.is_refused_for_long(now_s + 1.0));
    }

    #[test]
    fn a_contradiction_stays_among_noise() {
        let (mut doubt, mut now_s) = quiet();
        doubt.contradict(now_s, false, false);
        for _ in 0..600 {
            now_s += 1.0;
            assert!(doubt.keeps_without_velocity(now_s, Noise));
        }
    }
}
