//! Steering: is a clock that departs from its rates set back by the receiver itself?
//!
//! Some receivers set their clock back in every epoch, or apply its error to the ranges, while
//! their range rates show the oscillator. The discrepancy of such a clock grows without an attack. A
//! repeater moves the clock once and leaves it there. A drag-off begins in the middle, and takes
//! the clock along:
//!
//! ```text
//! a line      |r t_k| > 10·√(Σ (δ_j − r t_j)²/k)      r = Σ δ_j t_j / Σ t_j²      from the first epoch on
//! it stays    |δ_k| > 3·max |b_j − b_1|
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `δ` | discrepancy of the clock since the first epoch | m |
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

/// Least ratio of the discrepancy to the largest change of a clock that stays, dimensionless.
const STAYS: f32 = 3.0;

/// Smallest discrepancy that steering makes, m: that of a drift.
const FLOOR_M: f32 = 2.0;

/// What the epochs so far say about steering.
#[derive(Clone, Debug)]
pub(super) struct Steering {
    is_steered: bool,
    /// True if a line counts no more.
    is_settled: bool,
    count: u16,
    /// Clock of the first epoch, m.
    first_m: f64,
    /// Largest change of the clock since the first epoch, m.
    widest_m: f32,
    /// `Σ t²`, `Σ δ t` and `Σ δ²`.
    sums: [f32; 3],
}

impl Steering {
    /// Returns the state before the first epoch.
    pub(super) const fn new() -> Self {
        Self {
            is_steered: false,
            is_settled: false,
            count: 0,
            first_m: 0.0,
            widest_m: 0.0,
            sums: [0.0; 3],
        }
    }

    /// Returns true if the receiver steers its clock.
    pub(super) const fn is_steered(&self) -> bool {
        self.is_steered
    }

    /// Begins anew at a clock. What is known of the receiver stays.
    pub(super) fn begin(&mut self, clock_m: f64) {
        let Self { is_steered, is_settled, .. } = *self;
        *self = Self { is_steered, is_settled, first_m: clock_m, ..Self::new() };
    }

    /// Adds an epoch with its discrepancy, m.
    pub(super) fn observe(&mut self, now_s: f32, clock_m: f64, apart_m: f32) {
        self.count = self.count.saturating_add(1);
        self.widest_m = self.widest_m.max(((clock_m - self.first_m) as f32).abs());
        let more = [now_s * now_s, apart_m * now_s, apart_m * apart_m];
        self.sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        if now_s > LEARNING_S && self.count >= FEWEST {
            self.settle(now_s, apart_m);
        }
    }

    /// Returns true if steering explains that the clock contradicts its rates.
    pub(super) fn explains(&mut self, now_s: f32, apart_m: f32) -> bool {
        let is_early = now_s < GRACE_S || self.count < FEWEST;
        if is_early && !self.is_settled {
            return apart_m.is_finite();
        }
        self.settle(now_s, apart_m);
        self.is_steered |= apart_m.abs() > STAYS * self.widest_m;
        self.is_steered
    }

    /// Decides whether the discrepancies so far are a line.
    fn settle(&mut self, now_s: f32, apart_m: f32) {
        if core::mem::replace(&mut self.is_settled, true) {
            return;
        }
        let [times, products, squares] = self.sums;
        let rate_m_s = products / times;
        let scatter_m = sqrt((squares - rate_m_s * products) / f32::from(self.count));
        let change_m = (rate_m_s * now_s).abs();
        // NaN fails both comparisons, so that it is no steering.
        self.is_steered = change_m > STRAIGHT * scatter_m && apart_m.abs() > FLOOR_M;
    }
}
