//! Residuals of the kind of ranges that is not in use.
//!
//! Quiet minutes lower the noise of the ranges in use
//! ([`adaptation`](raim_core::internals::weighting::adaptation)), and pairs gain more by it than one
//! frequency, whose levels come from the ionosphere. A choice by the noise in use therefore keeps
//! one frequency where pairs would soon be better. Each comparison of both kinds computes the
//! position of both, and its residuals teach the noise of the other as well.
//!
//! The same conditions apply as in use: an epoch whose test fails is none to learn from, and ends
//! what was learned. So does the end of the rest. If the kind changes, both exchange what they know,
//! so that pairs that were left for one epoch need not be learned again.

use raim_core::internals::weighting::adaptation::{Adaptation, Residuals};

use crate::correction::Ranges;
use crate::settings::Systems;

/// Residuals of the other kind at rest.
#[derive(Debug)]
pub(super) struct Others {
    pub(super) adaptation: Adaptation,
}

impl Others {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { adaptation: Adaptation::new() }
    }

    /// Learns from an epoch of the other kind; `residuals` is `None` if it failed its test. `in_use`
    /// are the residuals of the kind in use, which begin anew when a rest ends.
    pub(super) fn learn(&mut self, time_s: f64, residuals: Option<Residuals>, in_use: &Adaptation) {
        if residuals.is_none() || !self.adaptation.is_within(in_use) {
            self.adaptation.restart();
        }
        if let Some(residuals) = residuals {
            self.adaptation.learn(time_s, residuals);
        }
    }

    /// Gives what is known to the monitor, whose kind of ranges has changed, and keeps what the kind
    /// that it has `left` had taught. Nothing is known of other systems.
    pub(super) fn take_over(
        &mut self,
        before: Option<(Ranges, Systems)>,
        now: (Ranges, Systems),
        left: Adaptation,
        in_use: &mut Adaptation,
    ) {
        if before.is_some_and(|(_, systems)| systems == now.1) {
            *in_use = core::mem::replace(&mut self.adaptation, left);
            self.adaptation.follow(in_use);
        } else {
            self.adaptation.restart();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Adaptation, Others, Ranges, Residuals, Systems};

    /// Residuals of a third of the sigmas, with ten degrees of freedom.
    const QUIET: Option<Residuals> = Some(Residuals { sse: 10.0 / 9.0, dof: 10 });

    fn after(seconds: u32, in_use: &Adaptation) -> Others {
        let mut others = Others::new();
        (0..seconds).for_each(|second| others.learn(f64::from(second), QUIET, in_use));
        others
    }

    /// Returns what a kind in use has learned from a time on.
    fn since(time_s: f64) -> Adaptation {
        let mut in_use = Adaptation::new();
        in_use.learn(time_s, Residuals { sse: 10.0, dof: 10 });
        in_use
    }

    #[test]
    fn ten_quiet_minutes_lower_the_noise_of_the_other_kind() {
        assert!(after(700, &since(0.0)).adaptation.noise(699.0) < 0.2);
        assert!(after(500, &since(0.0)).adaptation.noise(499.0) >= 1.0, "less than ten minutes");
    }

    #[test]
    fn a_failed_test_and_the_end_of_a_rest_end_it() {
        let mut others = after(700, &since(0.0));
        others.learn(700.0, None, &since(0.0));
        assert!(others.adaptation.noise(700.0) >= 1.0);
        let mut others = after(700, &since(0.0));
        others.learn(700.0, QUIET, &since(699.5));
        assert!(others.adaptation.noise(700.0) >= 1.0);
        assert!(after(700, &Adaptation::new()).adaptation.noise(699.0) >= 1.0, "no rest");
    }

    #[test]
    fn kinds_exchange_what_they_know_until_the_rest_ends() {
        let (pairs, singles) = ((Ranges::Pairs, Systems::AT_START), (Ranges::Singles, Systems::AT_START));
        let quiet = || {
            let mut quiet = Adaptation::new();
            (0..700).for_each(|second| quiet.learn(f64::from(second), Residuals { sse: 2.5, dof: 10 }));
            quiet
        };
        let mut in_use = Adaptation::new();
        let mut others = after(700, &since(0.0));
        others.take_over(Some(pairs), singles, quiet(), &mut in_use);
        assert!(in_use.noise(699.0) < 0.2 && (0.2..0.4).contains(&others.adaptation.noise(699.0)));
        // The rest goes on, and then ends.
        in_use.learn(700.0, Residuals { sse: 1.0, dof: 10 });
        others.learn(700.0, QUIET, &in_use);
        assert!(others.adaptation.noise(700.0) < 0.4);
        in_use.restart();
        in_use.learn(701.0, Residuals { sse: 1.0, dof: 10 });
        others.learn(701.0, QUIET, &in_use);
        assert!(others.adaptation.noise(701.0) >= 1.0);
        // Without knowledge of this rest, the end of the rest would not show.
        let mut unknown = Adaptation::new();
        let mut others = Others::new();
        others.take_over(Some(pairs), singles, quiet(), &mut unknown);
        assert!(unknown.noise(699.0) >= 1.0 && others.adaptation.noise(699.0) >= 1.0);
        // Nothing is known of other systems.
        let mut others = after(700, &since(0.0));
        let mut unknown = Adaptation::new();
        others.take_over(None, singles, quiet(), &mut unknown);
        assert!(unknown.noise(699.0) >= 1.0 && others.adaptation.noise(699.0) >= 1.0);
    }
}
