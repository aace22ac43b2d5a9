//! Sums of squared residuals over the last spans of time, and the bounds on them if the sigmas are
//! right.
//!
//! ```text
//! χ²_p(ν) / ν = (1 − 2/(9ν) + z √(2/(9ν)))³        Wilson and Hilferty; z is the normal quantile of p
//! ```
//!
//! The cube is accurate to 1e-4 for at least 600 degrees of freedom, and to 2 % for at least 10.

use crate::numeric::sqrt;

/// Residuals of an epoch, or of several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residuals {
    /// Weighted sum of squared residuals, by the sigmas of each epoch.
    pub sse: f32,
    /// Degrees of freedom.
    pub dof: u32,
}

impl Residuals {
    /// The residuals of no epoch.
    pub(crate) const NONE: Self = Self { sse: 0.0, dof: 0 };

    /// Returns the sum with another.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { sse: self.sse + other.sse, dof: self.dof.saturating_add(other.dof) }
    }

    /// Returns the mean square of a normalised residual; NaN without degrees of freedom.
    pub(crate) fn ratio(self) -> f32 {
        self.sse / self.dof as f32
    }

    /// Returns `χ²_p(ν)/ν` for these degrees of freedom, where `normal` is the normal quantile of
    /// `p`. It is NaN without degrees of freedom.
    #[inline(never)]
    pub(crate) fn ratio_at(self, normal: f32) -> f32 {
        let spread = 2.0 / (9.0 * self.dof as f32);
        let root = 1.0 - spread + normal * sqrt(spread);
        root * root * root
    }

    /// Returns the factor on the sigmas for which these residuals would be at the median, at least 1.
    pub(crate) fn growth(self) -> f32 {
        // NaN without degrees of freedom, which `max` ignores.
        sqrt((self.ratio() / self.ratio_at(0.0)).max(1.0))
    }

    /// Returns the mean square if it is at least `χ²_p(ν)/ν`; otherwise, and without degrees of
    /// freedom, 0.
    // Compiled once for all callers.
    #[inline(never)]
    pub(crate) fn excess(self, normal: f32) -> f32 {
        let ratio = self.ratio();
        // Without degrees of freedom both are NaN, which fails the comparison.
        if ratio >= self.ratio_at(normal) { ratio } else { 0.0 }
    }
}

/// Number of spans that are stored.
const SPANS: i32 = 10;

/// Residuals of the last ten spans of time.
#[derive(Clone, Debug)]
pub(crate) struct RecentResiduals {
    /// Length of a span, s.
    span_s: f32,
    /// Number of the latest span.
    latest: i32,
    /// Sum of each span. The index is the remainder of its number.
    spans: [Residuals; SPANS as usize],
}

impl RecentResiduals {
    /// Returns no residuals, for spans of this length in seconds.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(crate) const fn of(span_s: f32) -> Self {
        Self { span_s, latest: 0, spans: [Residuals::NONE; SPANS as usize] }
    }

    /// Forgets everything.
    pub(crate) fn restart(&mut self) {
        self.spans = [Residuals::NONE; SPANS as usize];
    }

    /// Adds residuals. If the time is before the latest span, all sums begin anew. Residuals are
    /// ignored if their time or sum is NaN or infinite, or if the sum is negative.
    #[inline(never)]
    pub(crate) fn add(&mut self, time_s: f64, residuals: Residuals) {
        // NaN fails this comparison.
        if !(residuals.sse >= 0.0 && residuals.sse.is_finite()) {
            return;
        }
        let Some(number) = self.number(time_s) else { return };
        // As an unsigned number a step back is large, so that all spans are cleared.
        let step = number.wrapping_sub(self.latest).cast_unsigned();
        for back in (0..SPANS).take(step as usize) {
            self.put(number.wrapping_sub(back), |_| Residuals::NONE);
        }
        self.latest = number;
        self.put(number, |sum| sum.plus(residuals));
    }

    /// Returns the residuals of the spans that are recent at a time, and none for the others. Later
    /// spans are not recent.
    // Compiled once for all callers.
    #[inline(never)]
    pub(crate) fn at(&self, time_s: f64) -> [Residuals; SPANS as usize] {
        let mut recent = self.spans;
        let now = self.number(time_s);
        for back in 0..SPANS {
            let number = self.latest.wrapping_sub(back);
            let is_recent = now.is_some_and(|now| (0..SPANS).contains(&now.wrapping_sub(number)));
            if let Some(span) = recent.get_mut(place(number)).filter(|_| !is_recent) {
                *span = Residuals::NONE;
            }
        }
        recent
    }

    /// Returns the number of the span that contains a time.
    #[inline(never)]
    fn number(&self, time_s: f64) -> Option<i32> {
        // A product, because a division in double precision takes ten times as long.
        let spans = time_s * f64::from(1.0 / self.span_s);
        // The conversion rounds towards zero.
        let number = spans as i32;
        let number = number.saturating_sub(i32::from(f64::from(number) > spans));
        // NaN fails this comparison.
        (spans.abs() < f64::from(i32::MAX)).then_some(number)
    }

    fn put(&mut self, number: i32, change: impl Fn(Residuals) -> Residuals) {
        if let Some(span) = self.spans.get_mut(place(number)) {
            *span = change(*span);
        }
    }
}

/// Returns the place of a span, the remainder of its number.
fn place(number: i32) -> usize {
    number.rem_euclid(SPANS).cast_unsigned() as usize
}

#[cfg(test)]
mod tests {
    use super::Residuals;

    #[test]
    fn quantiles_are_those_of_chi_square() {
        // Bisected on the series of the incomplete gamma function: p = 1 − 1e-3, 1 − 1e-7 and 1e-3.
        for (dof, normal, want, share) in [
            (10, 3.090_232, 29.588, 0.02),
            (60, 3.090_232, 99.607, 0.02),
            (10, 5.199_338, 53.016_4, 0.02),
            (60, 5.199_338, 135.867, 0.02),
            (600, -3.090_232, 498.622_87, 1e-4),
        ] {
            let have = Residuals { sse: 0.0, dof }.ratio_at(normal) * dof as f32;
            assert!((have / want - 1.0).abs() < share, "{dof}: have {have}, want {want}");
        }
    }
}
