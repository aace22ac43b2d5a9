//! Evidence against the sigmas: the residuals of every tracked satellite over the last minute.
//!
//! ```text
//! σ²(κ) = σ² (1 + (κ − 1) p)          p: the receiver's part of the variance, noise and multipath
//! ratio = SSE / dof                    of an epoch weighed by σ(κ); one row counts as at most 9 times the mean of the others
//! κ_e   = κ (1 + (ratio/m − 1) / P)    m = χ²_{0.5}(dof)/dof;  P = Σ r_i κ p_i σ_i²/σ_i²(κ) / Σ r_i
//! κ     = largest of κ_0, the mean of κ_e in each span of the last minute, and, for the levels, κ_e of this epoch
//! level = level at the κ of the test, times √(1 + (κ/κ_test − 1) P)
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `κ` | [`Aided::noisier`](crate::epoch::Aided::noisier), [`EpochResiduals::noise`] | – |
//! | `κ_0` | the least one: of the strategy ([`Noise`](super::Noise)), or of quiet minutes ([`crate::weighting::adaptation`]) | – |
//! | `p_i`, `P` | [`EpochView::receivers_parts`], [`EpochResiduals::share`] | – |
//! | `SSE`, `dof` | weighted squares of the residuals, those of excluded satellites included, and their degrees of freedom | – |
//! | `r_i` | redundancy of a row | – |
//! | `χ²_p(ν)/ν` | [`Residuals::ratio_at`](crate::weighting::residuals::Residuals::ratio_at) | – |
//!
//! A protection level assumes that errors are as large as their sigmas state. Small antennas and
//! reflections make them larger. The receiver's part of each variance is then raised, and test,
//! search, exclusion and levels use the raised variances. Orbits, troposphere and ionosphere keep
//! theirs. An epoch is judged by the κ of those before it. If its residuals show more noise and it
//! passes, only its levels grow. If it fails, it is refused, and the next one is judged by what it
//! has shown.
//!
//! **A κ that is too large breaks no promise**, whatever made it so. The level contains
//! `k' √(s² + σ²)` beyond the line `X = s Y` ([`crate::integrity::raim::levels`]). `X − s Y` has
//! the mean 0 for any bias of one satellite. If its standard deviation is right or too large by
//! `√κ`, a position beyond its level lies in the half-plane `X − s Y > √κ k' √(s² + σ²)`. The
//! half-planes of larger κ lie within those of smaller ones. Together, those of all κ above the
//! true one therefore have at most the probability `Q(k')`, also if κ depends on these residuals.
//! One slow fault also raises κ. The test then detects it later, and the level has grown by then.
//! The half-planes are nested exactly if all variances grow alike. `rai-core/tests/all/noisy_receivers.rs`
//! simulates ramps of every satellite with noise of half the sigma to three times the sigma.
//!
//! **A κ that is too small breaks promises.** Multipath repeats from epoch to epoch, so that a
//! minute may be no more than one sample. `m` is therefore the median for the degrees of freedom of
//! one epoch. Reflections come and go, so that the noisiest span of the minute counts.
//!
//! **One satellite's fault must not pass for noise.** A ramp that raises κ as fast as its own
//! residual would never be excluded. The residual of one row therefore counts as at most
//! [`MOST_ONE`](epoch::MOST_ONE) times the mean square of the others, and the shift of a whole constellation
//! ([`constellation_shift`](crate::integrity::raim::hypotheses::constellation_shift)) as at most [`MOST_SHIFT`](epoch::MOST_SHIFT) times. With one degree of freedom no other row
//! contradicts, nothing can be excluded, and all of it counts. With two some row explains almost any
//! residuals, those of a fault and those of noise, and a single epoch cannot tell. A fault stays with
//! its satellite. If the next epoch blames another one, all of this epoch counts then. Excluded
//! satellites are treated in the same spirit:
//!
//! - The largest residual of the excluded satellites does not count, because a level allows for one
//!   faulty satellite. Each of the other squares counts as at most [`MOST_EXCLUDED`](epoch::MOST_EXCLUDED).
//! - The satellites of a system that was left out as a whole do not count, because they are one
//!   fault.
//! - The ratio of an epoch counts as at most [`MOST_RATIO`](epoch::MOST_RATIO).
//! - An epoch with [`Unidentified::Time`](crate::integrity::raim::isolation::exclusion::Unidentified::Time) does not count, because a wrong time tag is no error of
//!   the ranges. It also erases the evidence of earlier epochs.
//!
//! **The ionosphere instead.** On one frequency a wrong model of the ionosphere leaves residuals as
//! noise does. The levels then contain up to five sigmas of the shared errors instead of three
//! ([`shared_growth`]): a sigma is at least a fifth of the delay, so that this is the whole delay.
//!
//! **Refused.** From κ = [`MOST_NOISE`] on no position is promised. This is a noise of 30 m near
//! the zenith, a tenth of a chip, with which a receiver tracks no code. Below it the levels decide.
//!
//! **The rest after an exclusion.**
//!
//! ```text
//! refuted   SSE_r / dof_r ≥ χ²_{1−1e-2}(dof_r) / dof_r          of this epoch
//! ```
//!
//! The test's `P_fa` is small, because every healthy epoch risks a false alarm. After an exclusion
//! one fault is certain, and reflections come in groups. A rest just below the threshold is then far
//! likelier to contain another fault than to be healthy. Its bound is therefore lower, and refuses a
//! healthy rest in one of a hundred epochs that exclude satellites.
//!
//! **Several faults that stay** make one alert. After it they pass for noise, as far as the levels
//! that grow with them stay within the limits. No level is made for several faults: in
//! `noisy_receivers.rs` 70 of 39,000 promised epochs with two to four faults of 10 to 300 m are
//! beyond, as many as if levels did not grow and most of these epochs were refused.
//!
//! **Limits.** If all errors of a minute are small by chance, or the noise grows within one epoch
//! without contradiction, κ is too small. Errors that satellites share are no noise.

mod epoch;

use super::{EpochOutcome, Monitor};
use crate::epoch::{Epoch, EpochView, Observation};
use crate::integrity::raim::isolation::exclusion::leaves_enough;
use crate::least_squares::fix::Fix;
use crate::numeric::real::Real;
use crate::report::{Alert, Protected, Unavailable, Verdict};
use crate::satellite::SatelliteId;
use crate::weighting::adaptation::LEAST_NOISE;
use crate::weighting::residuals::{RecentResiduals, Residuals};

pub(super) use epoch::{EpochResiduals, residuals_of_all};

/// Length of one of the spans that make up the last minute, s.
const SPAN_S: f32 = 6.0;

/// Factor on the receiver's part of a variance from which on no position is promised:
/// `(30 m)² / (0.42 m)²`.
const MOST_NOISE: f32 = 5000.0;

/// Largest factor on the effect of shared errors: five sigmas, the whole delay, instead of the
/// three of [`COMMON_SIGMAS`].
///
/// [`COMMON_SIGMAS`]: crate::weighting::COMMON_SIGMAS
const WHOLE_DELAY: f32 = 5.0 / 3.0;

/// Receiver's share of the variance of a range of one frequency near the zenith: 0.2 m² of 3 m².
const ONE_FREQUENCY: f32 = 0.0625;

/// Residuals of the last minute.
#[derive(Clone, Debug)]
pub(super) struct Evidence {
    /// Noise of each epoch, weighted by its degrees of freedom.
    all: RecentResiduals,
    /// Satellite that explains most of the latest epoch.
    blamed: Option<SatelliteId>,
    /// The noise of that epoch if the satellite does not stay to blame.
    doubtful: Residuals,
}

impl Evidence {
    /// Returns no evidence.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { all: RecentResiduals::of(SPAN_S), blamed: None, doubtful: Residuals::NONE }
    }

    /// Forgets everything.
    pub(super) fn restart(&mut self) {
        self.all.restart();
        self.doubtful = Residuals::NONE;
    }

    /// Adds an epoch. If its time is before the last span, the evidence begins anew. An epoch with
    /// a NaN time is not added.
    pub(super) fn learn(&mut self, time_s: f64, latest: &EpochResiduals) {
        self.all.add(time_s, latest.sum());
        if latest.blamed != self.blamed {
            self.all.add(time_s, self.doubtful);
        }
        (self.blamed, self.doubtful) = (latest.blamed, latest.doubtful());
    }

    /// Returns the factor on the receiver's part of the variances that the last minute shows,
    /// [`LEAST_NOISE`] to [`MOST_NOISE`].
    #[inline(never)]
    pub(super) fn noise(&self, time_s: f64) -> f32 {
        // The ratio of a span without degrees of freedom is NaN, which `max` ignores.
        let spans = self.all.at(time_s).into_iter();
        spans.fold(LEAST_NOISE, |most: f32, span| most.max(span.ratio())).min(MOST_NOISE)
    }
}

impl<T: Real, const N: usize> Monitor<T, N> {
    /// Adds an epoch, promised or not, to the evidence against sigmas and satellites.
    pub(super) fn remember(&mut self, outcome: &EpochOutcome<N>) {
        if !cfg!(feature = "past") {
            return;
        }
        let EpochOutcome { report, update, .. } = outcome;
        if report.verdict == Verdict::Alert(Alert::Time) {
            // A wrong time also explains earlier alarms that looked like faults.
            self.evidence.restart();
        } else {
            self.evidence.learn(update.time_s, &update.evidence);
        }
        if update.is_refuting_quiet {
            self.adaptation.restart();
        }
        if update.ratio.is_some() {
            self.named.agree(update.time_s, &report.used);
            self.kept_out.learn(update.time_s, update.systems);
        }
    }

    /// Returns the factor on the levels of an epoch with these residuals, or `None` if they refute
    /// the sigmas. If epochs are judged independently, there is no evidence, and the factor is 1.
    pub(super) fn growth(&self, time_s: f64, latest: &EpochResiduals) -> Option<f32> {
        if !self.compares_residuals() {
            return Some(1.0);
        }
        // Other epochs are judged by no less than the noise of the last minute.
        let past = if self.strategy.method.uses_ism() { self.evidence.noise(time_s) } else { 0.0 };
        latest.growth(past)
    }

    /// Returns the factor on the receiver's part of the variances: the least one of the strategy, or
    /// the larger one that the last minute shows.
    ///
    /// For sigmas of an integrity support message, whose tests must find the fault of a whole
    /// constellation, the last minute raises levels only.
    #[inline(never)]
    #[doc(hidden)]
    pub fn noise(&self, time_s: f64) -> f32 {
        let least = self.strategy.noise.least();
        if !self.compares_residuals() || self.strategy.method.uses_ism() {
            return least;
        }
        let least = if self.strategy.lowers_noise() { self.adaptation.noise(time_s) } else { least };
        self.evidence.noise(time_s).max(least)
    }

    /// Returns the noise, or 1 if it is less and the epoch is not as those before it.
    pub(super) fn as_before(&self, noise: f32, epoch: &Epoch<N>) -> f32 {
        if noise < 1.0 && !self.rest.is_as_before(&epoch.view()) { 1.0 } else { noise }
    }

    fn compares_residuals(&self) -> bool {
        cfg!(feature = "past") && self.continuity_settings.is_some()
    }

    /// Returns true if a system that should be kept out takes part, because the others alone
    /// determine no position.
    fn rests_on_kept_out(&self, fix: &Fix<'_, T, N>, epoch: &EpochView<'_>) -> bool {
        let systems = self.kept_out.systems();
        let is_kept_out = |seen: &Observation| systems >> (seen.satellite.constellation() as u8) & 1 != 0;
        let mut rows = fix.snapshot().rows().zip(epoch.observations());
        systems != 0 && rows.any(|((row, _), seen)| row.weight > T::zero() && is_kept_out(seen))
    }

    /// Returns the verdict on a protected epoch after comparing it with the evidence of earlier
    /// epochs.
    pub(super) fn supported(
        &self,
        how: Protected,
        growth: Option<f32>,
        fix: &Fix<'_, T, N>,
        epoch: &EpochView<'_>,
        excluded: u8,
    ) -> Verdict {
        if growth.is_none() {
            return Verdict::Unavailable(Unavailable::Sigmas);
        }
        if self.rests_on_kept_out(fix, epoch) {
            return Verdict::Unavailable(Unavailable::Redundancy);
        }
        if !cfg!(feature = "past") || self.continuity_settings.is_none() || self.named.is_empty() {
            return Verdict::Protected(how);
        }
        let used =
            fix.snapshot().rows().zip(epoch.observations()).filter(|((row, _), _)| row.weight > T::zero());
        let doubtful = used.filter(|(_, observation)| self.named.contains(observation.satellite)).count();
        // A doubtful satellite must not count as redundancy: its degree of freedom is subtracted.
        if !leaves_enough(usize::from(excluded.max(1)) + doubtful, fix.snapshot().dof()) {
            return Verdict::Unavailable(Unavailable::Redundancy);
        }
        Verdict::Protected(how)
    }
}

/// Returns the factor on the effect of shared errors, 1 to [`WHOLE_DELAY`]: the growth of the
/// variance of a range of one frequency. Other ranges share no error.
pub(super) fn shared_growth(noise: f32) -> f32 {
    (1.0 + (noise - 1.0) * ONE_FREQUENCY).clamp(1.0, WHOLE_DELAY)
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "a factor of 1 is exact")]
mod tests {
    use super::{EpochResiduals, Evidence, LEAST_NOISE};
    use crate::satellite::{Constellation, SatelliteId};
    use crate::weighting::residuals::Residuals;

    /// `χ²_{0.5}(10)/10` (printed tables: 9.342).
    const MEDIAN_OF_TEN: f32 = 0.9342;

    /// Returns an epoch with this ratio of all satellites, judged by a factor of 1, and one of the
    /// rest far below 1.
    fn of_all(ratio: f32) -> EpochResiduals {
        EpochResiduals { ratio: ratio * MEDIAN_OF_TEN, dof: 10, ..EpochResiduals::NONE }
    }

    /// Returns an epoch whose satellites used have this ratio.
    fn of_rest(ratio: f32, is_excluding: bool) -> EpochResiduals {
        let rest = Residuals { sse: 10.0 * ratio, dof: 10 };
        EpochResiduals { rest, excluded: u8::from(is_excluding), ..of_all(0.9) }
    }

    fn after(epochs: u32, step_s: f64, latest: &EpochResiduals) -> Evidence {
        let mut evidence = Evidence::new();
        (0..epochs).for_each(|index| evidence.learn(f64::from(index) * step_s, latest));
        evidence
    }

    fn close(have: f32, want: f32) {
        assert!((have / want - 1.0).abs() < 0.01, "have {have}, want {want}");
    }

    #[test]
    fn residuals_that_the_sigmas_allow_change_nothing() {
        close(after(60, 1.0, &of_all(0.9)).noise(59.0), 0.9);
        assert_eq!((of_all(0.5)).growth(after(60, 1.0, &of_all(0.9)).noise(59.0)), Some(1.0));
        assert_eq!(Evidence::new().noise(0.0), LEAST_NOISE);
        assert_eq!((EpochResiduals::NONE).growth(Evidence::new().noise(0.0)), Some(1.0));
    }

    #[test]
    fn a_minute_of_larger_ones_raises_the_noise_by_as_much() {
        close(after(60, 1.0, &of_all(1.5)).noise(59.0), 1.5);
        close(after(2, 30.0, &of_all(4.0)).noise(30.0), 4.0);
        // If the receiver's part is half of the variance, it must grow twice as much.
        let half = EpochResiduals { share: 0.5, ..of_all(1.5) };
        close(after(60, 1.0, &half).noise(59.0), 2.0);
        // Residuals weighed by the right factor confirm it.
        let settled = EpochResiduals { noise: 8.0, share: 0.9, ..of_all(1.0) };
        close(after(60, 1.0, &settled).noise(59.0), 8.0);
    }

    #[test]
    fn the_noisiest_span_of_the_minute_counts() {
        let mut evidence = after(6, 1.0, &of_all(9.0));
        (6..60).for_each(|second| evidence.learn(f64::from(second), &of_all(0.5)));
        close(evidence.noise(59.0), 9.0);
        close(evidence.noise(60.0), 0.5);
    }

    #[test]
    fn levels_grow_by_what_the_epoch_itself_shows() {
        let quiet = after(60, 1.0, &of_all(0.5));
        close((of_all(4.0)).growth(quiet.noise(60.0)).unwrap_or(0.0), 2.0);
        // A factor in use already explains three of four parts.
        let judged = EpochResiduals { noise: 3.0, ..of_all(4.0 / 3.0) };
        close((judged).growth(quiet.noise(60.0)).unwrap_or(0.0), (4.0_f32 / 3.0).sqrt());
    }

    #[test]
    fn a_noise_that_no_receiver_can_track_refutes_the_sigmas() {
        let near = EpochResiduals { noise: 4_900.0, ..of_all(1.0) };
        assert!((near).growth(after(6, 1.0, &near).noise(5.0)).is_some());
        let beyond = EpochResiduals { noise: 4_900.0, ..of_all(1.1) };
        assert_eq!((of_all(0.5)).growth(after(6, 1.0, &beyond).noise(5.0)), None);
    }

    /// `χ²_{0.5}(2)/2` by Wilson and Hilferty: `(1 − 1/9)³`.
    const MEDIAN_OF_TWO: f32 = 0.7023;

    /// A ratio of 0.1, as the satellite to blame is limited, may be one of 4.
    #[test]
    fn two_degrees_of_freedom_are_noise_unless_the_same_satellite_is_to_blame() {
        let blaming = |number| EpochResiduals {
            ratio: 0.1 * MEDIAN_OF_TWO,
            dof: 2,
            rest: Residuals { sse: 4.0 * 2.0 * MEDIAN_OF_TWO, dof: 2 },
            blamed: SatelliteId::new(Constellation::Gps, number),
            ..EpochResiduals::NONE
        };
        let of = |numbers: [u8; 4]| {
            let mut evidence = Evidence::new();
            numbers
                .iter()
                .zip(0_u8..)
                .for_each(|(number, second)| evidence.learn(f64::from(second), &blaming(*number)));
            evidence.noise(3.0)
        };
        close(of([1, 1, 1, 1]), LEAST_NOISE);
        // Each epoch counts as it is limited; the three before the latest count once more, as 4.
        close(of([1, 2, 3, 1]), (4.0 * 0.1 + 3.0 * 4.0) / 7.0);
        // A fault of satellite 3 that stays makes no noise, and what was withheld before it does.
        close(of([1, 3, 3, 3]), (4.0 * 0.1 + 4.0) / 5.0);
    }

    #[test]
    fn evidence_ends_after_a_minute_or_if_time_goes_back() {
        let mut evidence = after(60, 1.0, &of_all(4.0));
        assert_eq!(evidence.noise(120.0), LEAST_NOISE);
        evidence.learn(f64::NAN, &of_all(0.0));
        close(evidence.noise(59.0), 4.0);
        evidence.learn(-100.0, &of_all(0.1));
        assert_eq!(evidence.noise(-100.0), LEAST_NOISE);
    }

    /// χ² of 10 degrees of freedom is above 23.21 once in a hundred times (printed table).
    #[test]
    fn rest_after_an_exclusion_must_be_as_small_as_in_99_of_100_healthy_epochs() {
        let quiet = after(60, 1.0, &of_all(0.8));
        assert_eq!((of_rest(2.2, true)).growth(quiet.noise(60.0)), Some(1.0));
        assert_eq!((of_rest(2.4, true)).growth(quiet.noise(60.0)), None);
        assert_eq!((of_rest(2.4, false)).growth(quiet.noise(60.0)), Some(1.0));
    }
}
