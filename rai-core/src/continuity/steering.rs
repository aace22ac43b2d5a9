//! Steering: is a clock that departs from its rates set back by the receiver itself?
//!
//! Some receivers set their clock back in every epoch, or apply its error to the ranges, while
//! their range rates show the oscillator. The discrepancy of such a clock grows without an attack. A
//! repeater moves the clock once and leaves it there. A drag-off begins in the middle, and takes
//! the clock along:
//!
//! ```text
//! a line      |r| t_k > 10·√(Σ (δ_j − r t_j)²/k)  and  |r| > 1/30 m/s     r = Σ δ_j t_j / Σ t_j²
//! it stays    |δ_k − δ_1| > 3·max |b_k − b_m|                              for the marks m of the last minute
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `δ` | [`Discrepancy::clock_m`](super::discrepancy::Discrepancy), since the first epoch | m |
//! | `b` | receiver clock times the speed of light | m |
//! | `t` | time since the first epoch | s |
//!
//! A line counts until the first contradiction, and at most for [`LEARNING_S`], before drifts are
//! tested. If a drag-off begins within its first fifth, it is taken for steering. A clock that stays
//! counts always. In the first [`GRACE_S`] a contradiction is not judged, because steering once a
//! second is then no line yet. It is judged after them, within the time to alert.
//!
//! The clock of a receiver that steers is compared with its own past ([`super::oscillator`]).
//!
//! **Limits.** An attack that stops a drifting clock looks like steering after its first alert.

use crate::numeric::sqrt;

/// Time after which the first epochs show no line any more, s: the drift is tested from then on.
const LEARNING_S: f32 = 170.0;

/// Time from the first epoch on in which no contradiction is judged, s, and least number of epochs.
const GRACE_S: f32 = 8.0;

/// Least number of epochs after the first that make a line.
const FEWEST: u16 = 4;

/// Least ratio of the change along a line to the scatter about it, dimensionless.
const STRAIGHT: f32 = 10.0;

/// Least rate of steering, m/s: the smallest drift in a minute.
const SLOWEST_M_S: f32 = 2.0 / 60.0;

/// Least ratio of the discrepancy to the largest change of a clock that stays, dimensionless.
pub(super) const STAYS: f32 = 3.0;

/// What the epochs so far say about steering.
#[derive(Clone, Debug)]
pub(super) struct Steering {
    is_steered: bool,
    /// True if a line counts no more.
    is_settled: bool,
    count: u16,
    /// `Σ t²`, `Σ δ t` and `Σ δ²`.
    sums: [f32; 3],
}

impl Steering {
    /// Returns the state before the first epoch.
    pub(super) const fn new() -> Self {
        Self { is_steered: false, is_settled: false, count: 0, sums: [0.0; 3] }
    }

    /// Returns true if the receiver steers its clock.
    pub(super) const fn is_steered(&self) -> bool {
        self.is_steered
    }

    /// Begins anew at another epoch. What is known of the receiver stays.
    pub(super) fn begin(&mut self) {
        (self.count, self.sums) = (0, [0.0; 3]);
    }

    /// Adds an epoch with its discrepancy, m.
    pub(super) fn observe(&mut self, now_s: f32, apart_m: f32) {
        self.count = self.count.saturating_add(1);
        let more = [now_s * now_s, apart_m * now_s, apart_m * apart_m];
        self.sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        if now_s > LEARNING_S && self.count >= FEWEST {
            self.settle(now_s);
        }
    }

    /// Returns true if steering explains that the clock contradicts its rates. `stays` is true if
    /// the clock stays where it was.
    pub(super) fn explains(&mut self, now_s: f32, apart_m: f32, stays: bool) -> bool {
        let is_early = now_s < GRACE_S || self.count < FEWEST;
        if is_early && !self.is_settled {
            return apart_m.is_finite();
        }
        self.settle(now_s);
        self.is_steered |= stays;
        self.is_steered
    }

    /// Decides, once, whether the discrepancies so far are a line.
    // Not inlined, so that its two callers share one copy.
    #[inline(never)]
    fn settle(&mut self, now_s: f32) {
        if core::mem::replace(&mut self.is_settled, true) {
            return;
        }
        let [times, products, squares] = self.sums;
        let rate_m_s = products / times;
        // Rounding makes the square of a perfect line negative. NaN stays NaN.
        let square_m2 = squares - rate_m_s * products;
        let scatter_m = sqrt(if square_m2 < 0.0 { 0.0 } else { square_m2 } / f32::from(self.count));
        let rate_m_s = rate_m_s.abs();
        // NaN fails these comparisons, so that it is no steering.
        self.is_steered = rate_m_s * now_s > STRAIGHT * scatter_m && rate_m_s > SLOWEST_M_S;
    }
}
