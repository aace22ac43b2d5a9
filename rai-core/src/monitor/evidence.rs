//! Evidence against the sigmas: the residuals of every tracked satellite over the last minute.
//!
//! ```text
//! ratio = Σ SSE / Σ dof        of the epochs of the last minute, this one included
//! refuted   ratio ≥ max(2, χ²_{1−1e-7}(Σ dof) / Σ dof)     no position is promised
//! scaled    ratio ≥ χ²_{1−1e-3}(Σ dof) / Σ dof             protection levels times √ratio
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `SSE` | weighted squares of the residuals against the solution, those of excluded satellites included | – |
//! | `dof` | degrees of freedom of these residuals | – |
//! | `χ²_p(ν)` | Wilson and Hilferty's cube of a normal one | – |
//!
//! A protection level assumes that one satellite at most is faulty and that the others have the
//! errors of their sigmas. Exclusion alone cannot check the second assumption, because it removes
//! the residuals that contradict it. Hence the sum contains them:
//!
//! - The largest residual of the excluded satellites does not count, because a level allows for one
//!   faulty satellite. Each of the others counts with [`MOST_EXCLUDED`] at most.
//! - An epoch counts with [`MOST_RATIO`] times its degrees of freedom at most, so that a short alert
//!   does not end all promises of a minute.
//! - A wrong time tag is no error of the ranges, so that an epoch with [`Unidentified::Time`] does
//!   not count.
//!
//! An epoch that passes its own test never refutes the sigmas alone, because the bound of few
//! degrees of freedom is above the threshold of the test.
//!
//! Assumes that the epochs of a minute are independent. Multipath that repeats from epoch to epoch
//! raises the ratio's spread, not its mean.

use heapless::Deque;

use crate::integrity::Judgement;
use crate::integrity::raim::isolation::exclusion::{ExclusionOutcome, Unidentified};
use crate::least_squares::Snapshot;
use crate::numeric::real::Real;
use crate::weighting::adaptation::Residuals;

/// Number of spans that are kept.
const SPANS: usize = 6;

/// Length of one span, s.
const SPAN_S: f64 = 10.0;

/// Least ratio that refutes the sigmas, whatever the degrees of freedom.
const REFUTED: f32 = 2.0;

/// `Q⁻¹(1e-7)`: the ratio of right sigmas exceeds the bound of a refutation in one of ten million
/// minutes.
const REFUTED_QUANTILE: f32 = 5.199_338;

/// `Q⁻¹(1e-3)`, of the bound from which levels are scaled.
const SCALED_QUANTILE: f32 = 3.090_232;

/// Largest square of an excluded satellite's residual over its sigma.
const MOST_EXCLUDED: f32 = 25.0;

/// Largest SSE/dof of one epoch.
const MOST_RATIO: f32 = 4.0;

/// Belief in the sigmas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Belief {
    /// The residuals are no larger than the sigmas allow.
    Sound,
    /// The residuals are larger, and levels grow by this factor.
    Scaled(f64),
    /// The residuals contradict the sigmas.
    Refuted,
}

/// Sums of one span.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Span {
    number: f64,
    sse: f32,
    dof: u32,
}

/// Residuals of the last minute.
#[derive(Clone, Debug)]
pub(super) struct Evidence {
    spans: Deque<Span, SPANS>,
}

impl Evidence {
    /// Returns no evidence.
    pub(super) const fn new() -> Self {
        Self { spans: Deque::new() }
    }

    /// Forgets everything.
    pub(super) fn restart(&mut self) {
        self.spans.clear();
    }

    /// Learns from an epoch. A time before the last one begins anew, and a NaN time is not learned.
    pub(super) fn learn(&mut self, time_s: f64, residuals: Residuals) {
        let number = libm::floor(time_s / SPAN_S);
        if !number.is_finite() {
            return;
        }
        if self.spans.back().is_some_and(|latest| latest.number > number) {
            self.restart();
        }
        match self.spans.back_mut() {
            Some(span) if span.number >= number => {
                span.sse += residuals.sse as f32;
                span.dof = span.dof.saturating_add(residuals.dof);
            }
            _ => {
                if self.spans.is_full() {
                    self.spans.pop_front();
                }
                // Never full after the line above.
                let _ = self.spans.push_back(Span { number, sse: residuals.sse as f32, dof: residuals.dof });
            }
        }
    }

    /// Returns the belief in the sigmas after an epoch with these residuals.
    pub(super) fn belief(&self, time_s: f64, latest: Option<Residuals>) -> Belief {
        let now = libm::floor(time_s / SPAN_S);
        let is_recent = |span: &&Span| span.number <= now && span.number + SPANS as f64 > now;
        let start = latest.map_or((0.0, 0), |latest| (latest.sse as f32, latest.dof));
        let (sse, dof) = self
            .spans
            .iter()
            .filter(is_recent)
            .fold(start, |(sse, dof), span| (sse + span.sse, dof.saturating_add(span.dof)));
        if dof == 0 {
            return Belief::Sound;
        }
        let ratio = sse / dof as f32;
        // A ratio that is not a number is no evidence, and its epoch has no level either.
        if ratio >= REFUTED.max(upper_quantile(dof, REFUTED_QUANTILE)) {
            Belief::Refuted
        } else if ratio >= upper_quantile(dof, SCALED_QUANTILE) {
            Belief::Scaled(f64::from(libm::sqrtf(ratio)))
        } else {
            Belief::Sound
        }
    }
}

/// Returns the residuals of all satellites against a solution: of those used, and of those
/// excluded from it except for the largest.
pub(super) fn residuals_of_all<T: Real>(
    judgement: &Judgement<T>,
    snapshot: &Snapshot<'_, T>,
    satellites: usize,
) -> Option<Residuals> {
    if judgement.outcome == ExclusionOutcome::NotIsolated(Unidentified::Time) {
        return None;
    }
    let squares =
        judgement.excluded.iter().filter(|excluded| excluded.index < satellites).filter_map(|excluded| {
            let (row, fit) = snapshot.row(excluded.index)?;
            let normalised = (fit.residual / row.sigma).widen() as f32;
            Some((normalised * normalised).min(MOST_EXCLUDED))
        });
    let (mut sum, mut largest, mut count) = (0.0_f32, 0.0_f32, 0_u32);
    for square in squares {
        (sum, largest, count) = (sum + square, largest.max(square), count + 1);
    }
    let dof = snapshot.dof() as u32 + count.saturating_sub(1);
    let sse = snapshot.sse().widen() as f32 + sum - largest;
    let most = MOST_RATIO * dof as f32;
    // An infinite or NaN sum is the largest.
    let sse = if sse < most { sse } else { most };
    (dof > 0).then_some(Residuals { sse: f64::from(sse), dof })
}

/// Returns `χ²_p(ν)/ν`: `(1 − 2/(9ν) + z √(2/(9ν)))³`, where `z` is the normal quantile of `p`.
fn upper_quantile(dof: u32, quantile: f32) -> f32 {
    let spread = 2.0 / (9.0 * dof as f32);
    let root = 1.0 - spread + quantile * libm::sqrtf(spread);
    root * root * root
}

#[cfg(test)]
mod tests {
    use super::{Belief, Evidence, REFUTED_QUANTILE, SCALED_QUANTILE, upper_quantile};
    use crate::weighting::adaptation::Residuals;

    fn after(epochs: u32, step_s: f64, ratio: f64) -> Evidence {
        let mut evidence = Evidence::new();
        for index in 0..epochs {
            let residuals = Residuals { sse: 10.0 * ratio, dof: 10 };
            evidence.learn(f64::from(index) * step_s, residuals);
        }
        evidence
    }

    #[test]
    fn quantiles_are_those_of_chi_square() {
        // Bisected on the series of the incomplete gamma function.
        for (dof, quantile, want) in [
            (10, SCALED_QUANTILE, 29.588),
            (60, SCALED_QUANTILE, 99.607),
            (10, REFUTED_QUANTILE, 53.016_4),
            (60, REFUTED_QUANTILE, 135.867),
        ] {
            let have = upper_quantile(dof, quantile) * dof as f32;
            assert!((have / want - 1.0).abs() < 0.02, "{dof}: have {have}, want {want}");
        }
    }

    #[test]
    fn residuals_that_the_sigmas_allow_change_nothing() {
        assert_eq!(after(60, 1.0, 1.0).belief(59.0, None), Belief::Sound);
        assert_eq!(after(1, 1.0, 2.5).belief(0.0, None), Belief::Sound);
        assert_eq!(Evidence::new().belief(0.0, None), Belief::Sound);
    }

    #[test]
    fn a_minute_of_larger_ones_scales_the_levels_and_then_refutes_the_sigmas() {
        let scaled = after(60, 1.0, 1.5).belief(59.0, None);
        let is_root = |factor: f64| (factor - 1.5_f64.sqrt()).abs() < 1e-6;
        assert!(matches!(scaled, Belief::Scaled(factor) if is_root(factor)), "{scaled:?}");
        assert_eq!(after(60, 1.0, 2.1).belief(59.0, None), Belief::Refuted);
        assert_eq!(after(9, 30.0, 4.0).belief(240.0, None), Belief::Refuted);
    }

    #[test]
    fn evidence_ends_after_a_minute_or_if_time_goes_back() {
        let mut evidence = after(60, 1.0, 4.0);
        assert_eq!(evidence.belief(120.0, None), Belief::Sound);
        evidence.learn(f64::NAN, Residuals { sse: 0.0, dof: 10 });
        assert_eq!(evidence.belief(59.0, None), Belief::Refuted);
        evidence.learn(-100.0, Residuals { sse: 1.0, dof: 10 });
        assert_eq!(evidence.belief(-100.0, None), Belief::Sound);
    }
}
