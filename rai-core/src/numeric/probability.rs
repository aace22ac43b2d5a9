//! Probabilities as a type. They are always tails.
//!
//! The type prevents that a probability is mistaken for a threshold. It has no complement, because
//! `1 − p` loses the significant digits of `p`.

/// A tail probability in the open interval (0, 0.5).
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Probability(f64);

impl Probability {
    /// Returns the probability if it is finite, above 0 and below 0.5; `None` otherwise.
    pub const fn new(tail: f64) -> Option<Self> {
        if tail > 0.0 && tail < 0.5 { Some(Self(tail)) } else { None }
    }

    /// Returns the tail as a number.
    pub const fn get(self) -> f64 {
        self.0
    }
}
