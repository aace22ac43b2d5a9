//! Discrepancy between two measurements of a receiver's motion, and its usual size.

use nalgebra::Vector3;

use crate::numeric::sqrt;

/// Number of marks after which a spread is known: those of two minutes.
pub(super) const LEARNED: u16 = 24;

/// Number of marks over which a spread is averaged: those of ten minutes.
pub(super) const MEMORY: u16 = 120;

/// Least ratio of a drift to the mean discrepancy, and to the scatter, dimensionless.
const DRIFT: f32 = 6.0;

/// Ratio to the mean at which a new value is cut off, dimensionless.
const TEACHING_BOUND: f32 = 3.0;

/// Largest change along a straight line that is learned, relative to the scatter about the line.
const ON_A_LINE: f32 = 2.0;

/// Largest noise that counts, relative to the mean discrepancy. An attacker who lets the position
/// tremble hides a walk no longer than that.
const GROWTH: f32 = 4.0;

/// Share of an epoch in the present noise. Above 1/36, one epoch far from all others is no drift, up to
/// the noise that counts.
const NOISE_GAIN: f32 = 0.125;

/// Mean of the absolute changes of a discrepancy within a minute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spread {
    mean_m: f32,
    count: u16,
}

impl Spread {
    pub(super) const fn new() -> Self {
        Self { mean_m: 0.0, count: 0 }
    }

    /// Adds a change within a minute, m. One along a straight line is no noise, and counts as at most
    /// twice its scatter about the line.
    pub(super) fn learn_change(&mut self, change_m: f32, scatter_m: Option<f32>) {
        self.learn(scatter_m.map_or(change_m, |scatter_m| change_m.min(ON_A_LINE * scatter_m)));
    }

    /// Adds a discrepancy, m, unless it is infinite or NaN.
    fn learn(&mut self, discrepancy_m: f32) {
        let value_m =
            if self.is_known() { discrepancy_m.min(TEACHING_BOUND * self.mean_m) } else { discrepancy_m };
        if value_m.is_finite() {
            self.count = (self.count + 1).min(MEMORY);
            self.mean_m += (value_m - self.mean_m) / f32::from(self.count);
        }
    }

    /// Returns the mean, m.
    pub(super) const fn mean_m(self) -> f32 {
        self.mean_m
    }

    /// Returns true if the mean is known.
    pub(super) const fn is_known(self) -> bool {
        self.count >= LEARNED
    }

    /// Returns true if a change along a straight line is large enough for a drift, or NaN.
    pub(super) fn is_drift(self, change_m: f32, [scatter_m, noise_m]: [f32; 2], floor_m: f32) -> bool {
        let noise_m = noise_m.min(GROWTH * self.mean_m);
        let explained_m = (DRIFT * self.mean_m.max(scatter_m).max(noise_m)).max(floor_m);
        self.is_known() && !(change_m <= explained_m)
    }
}

/// What the marks have taught about ranges of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spreads {
    pub(super) position: Spread,
    pub(super) clock: Spread,
    /// Changes of the position from one mark to the next.
    pub(super) step: Spread,
}

impl Spreads {
    pub(super) const NONE: Self = Self { position: Spread::new(), clock: Spread::new(), step: Spread::new() };

    /// Returns the same with all means multiplied.
    pub(super) fn times(self, factor: f32) -> Self {
        let times = |spread: Spread| Spread { mean_m: factor * spread.mean_m, ..spread };
        Self { position: times(self.position), clock: times(self.clock), step: times(self.step) }
    }
}

/// Noise of position and clock in the present epochs: the changes between successive ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Noise {
    last: Discrepancy,
    /// Mean squares of the changes of position and clock, m².
    squares_m2: [f32; 2],
}

impl Noise {
    pub(super) const fn new() -> Self {
        Self { last: Discrepancy::none(0.0), squares_m2: [0.0; 2] }
    }

    /// Takes an epoch as the one with which the next one is compared.
    pub(super) const fn follow(&mut self, now: &Discrepancy) {
        self.last = *now;
    }

    /// Adds an epoch that contradicts none before it.
    pub(super) fn learn(&mut self, now: &Discrepancy) {
        for (square_m2, change_m) in self.squares_m2.iter_mut().zip(now.from(&self.last)) {
            let change_m = change_m.max(0.0);
            *square_m2 += NOISE_GAIN * (change_m * change_m - *square_m2);
        }
        self.last = *now;
    }

    /// Returns the root mean squares of the changes of position and clock, m.
    pub(super) fn rms_m(&self) -> [f32; 2] {
        self.squares_m2.map(sqrt)
    }
}

/// Discrepancy between measured and integrated motion since the origin, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Discrepancy {
    /// Discrepancy of the position, earth-fixed, m.
    pub(super) position: Vector3<f32>,
    /// Discrepancy of the clock, m.
    pub(super) clock_m: f32,
    /// Change of the clock since the origin, m.
    pub(super) moved_m: f32,
    /// Largest displacement since the origin that unknown accelerations explain, m.
    pub(super) unknown_m: f32,
    /// Square of the largest change of the clock since the origin that an unknown walk of its drift
    /// explains, m².
    pub(super) unknown_clock_m2: f32,
    /// `HPL + VPL` of the epoch, m.
    pub(super) level_m: f32,
}

impl Discrepancy {
    /// Returns the discrepancy of an origin.
    pub(super) const fn none(level_m: f32) -> Self {
        let position = Vector3::new(0.0, 0.0, 0.0);
        Self { position, clock_m: 0.0, moved_m: 0.0, unknown_m: 0.0, unknown_clock_m2: 0.0, level_m }
    }

    /// Returns the distance of the position from an earlier one, m.
    // Not inlined, so that its callers share one copy.
    #[inline(never)]
    pub(super) fn distance_m(&self, other: &Self) -> f32 {
        sqrt((self.position - other.position).norm_squared())
    }

    /// Returns the distances of position and clock from an earlier discrepancy, m, less what
    /// accelerations and walks between the epochs explain.
    pub(super) fn from(&self, other: &Self) -> [f32; 2] {
        let unknown_m = self.unknown_m - other.unknown_m;
        let away_m = self.distance_m(other) - unknown_m;
        let unknown_clock_m = sqrt(self.unknown_clock_m2 - other.unknown_clock_m2);
        [away_m, (self.clock_m - other.clock_m).abs() - unknown_clock_m]
    }

    /// Interpolates linearly between this discrepancy and another one, at a share of the way.
    pub(super) fn towards(&self, other: &Self, share: f32) -> Self {
        let Self { position, clock_m, .. } = *self;
        Self {
            position: position + (other.position - position) * share,
            clock_m: clock_m + (other.clock_m - clock_m) * share,
            ..*self
        }
    }
}
