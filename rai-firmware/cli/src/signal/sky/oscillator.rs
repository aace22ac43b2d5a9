//! A receiver clock with the three noises of a crystal: white, flicker and random walk of
//! frequency.
//!
//! ```text
//! S_y(f) = h₀ + h₋₁/f + h₋₂/f²            x(t+τ) = x(t) + τ ȳ
//! σ_y²(τ) = h₀/(2τ) + 2 ln2 h₋₁ + (2π²/3) τ h₋₂      (Allan variance)
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `h₀` | `white_s` | s |
//! | `h₋₁` | `flicker` | 1 |
//! | `h₋₂` | `walk_hz` | 1/s |
//! | `y₀` | `frequency_offset` | 1 |
//!
//! Each noise of slope `α` is white noise through the filter `(1 − z⁻¹)^(−α/2)` of [Kasdin1995]:
//! none for white frequency, [`FLICKER_TAPS`] taps for flicker, a sum for the random walk. Flicker
//! noise therefore ends at `1/(FLICKER_TAPS τ)`, below which it is white.
//!
//! References: [Kasdin1995] for the filters, [Riley2008] for the Allan variance.
//!
//! [Kasdin1995]: crate#references
//! [Riley2008]: crate#references

use std::collections::VecDeque;

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Memory of the flicker filter, steps.
const FLICKER_TAPS: usize = 2048;

/// Noise of an oscillator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillator {
    /// White frequency noise `h₀`, s.
    pub white_s: f64,
    /// Flicker frequency noise `h₋₁`, dimensionless.
    pub flicker: f64,
    /// Random walk of frequency `h₋₂`, 1/s.
    pub walk_hz: f64,
    /// Constant fractional frequency offset, dimensionless.
    pub frequency_offset: f64,
}

impl Oscillator {
    /// Returns an oven-controlled crystal, quiet enough to forecast its clock over ten seconds, as
    /// [Chen2009] does.
    ///
    /// [Chen2009]: crate#references
    pub const fn oven_controlled() -> Self {
        Self { white_s: 1e-21, flicker: 2e-22, walk_hz: 2e-22, frequency_offset: 1e-7 }
    }

    /// Returns the temperature-compensated crystal of an ordinary receiver ([Brown1997] table
    /// 10.2).
    ///
    /// [Brown1997]: crate#references
    pub const fn temperature_compensated() -> Self {
        Self { white_s: 2e-19, flicker: 7e-21, walk_hz: 2e-20, frequency_offset: 1e-7 }
    }
}

/// A running clock: its offset from true time, step by step.
#[derive(Debug)]
pub struct ReceiverClock {
    oscillator: Oscillator,
    step_s: f64,
    rng: ChaCha8Rng,
    flicker_taps: Vec<f64>,
    flicker_inputs: VecDeque<f64>,
    walk: f64,
    offset_s: f64,
    fractional_frequency: f64,
}

impl ReceiverClock {
    /// Returns a clock that is read every `step_s`, starting from `offset_s`.
    pub fn new(oscillator: Oscillator, step_s: f64, offset_s: f64, seed: u64) -> Self {
        Self {
            oscillator,
            step_s,
            rng: ChaCha8Rng::seed_from_u64(seed),
            flicker_taps: flicker_taps(),
            flicker_inputs: VecDeque::with_capacity(FLICKER_TAPS),
            walk: 0.0,
            offset_s,
            fractional_frequency: oscillator.frequency_offset,
        }
    }

    /// Returns the present offset, s.
    pub fn offset_s(&self) -> f64 {
        self.offset_s
    }

    /// Returns the mean fractional frequency of the last step, dimensionless.
    pub fn fractional_frequency(&self) -> f64 {
        self.fractional_frequency
    }

    /// Lets the clock jump, s.
    pub fn jump(&mut self, jump_s: f64) {
        self.offset_s += jump_s;
    }

    /// Advances by one step and reads the offset, s.
    pub fn advance(&mut self) -> f64 {
        self.fractional_frequency =
            self.oscillator.frequency_offset + self.white() + self.flicker() + self.random_walk();
        self.offset_s += self.fractional_frequency * self.step_s;
        self.offset_s
    }

    fn normal(&mut self, variance: f64) -> f64 {
        let normal: f64 = StandardNormal.sample(&mut self.rng);
        normal * libm::sqrt(variance)
    }

    fn white(&mut self) -> f64 {
        self.normal(self.oscillator.white_s / (2.0 * self.step_s))
    }

    fn flicker(&mut self) -> f64 {
        let input = self.normal(core::f64::consts::PI * self.oscillator.flicker);
        self.flicker_inputs.truncate(FLICKER_TAPS - 1);
        self.flicker_inputs.push_front(input);
        self.flicker_taps.iter().zip(&self.flicker_inputs).map(|(tap, input)| tap * input).sum()
    }

    fn random_walk(&mut self) -> f64 {
        let variance =
            2.0 * core::f64::consts::PI * core::f64::consts::PI * self.oscillator.walk_hz * self.step_s;
        self.walk += self.normal(variance);
        self.walk
    }
}

/// Returns the expansion of `(1 − z⁻¹)^(−1/2)`.
fn flicker_taps() -> Vec<f64> {
    let next = |&(index, tap): &(u32, f64)| {
        let index = index + 1;
        Some((index, tap * (f64::from(index) - 0.5) / f64::from(index)))
    };
    std::iter::successors(Some((0, 1.0)), next).map(|(_, tap)| tap).take(FLICKER_TAPS).collect()
}
