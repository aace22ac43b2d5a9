//! Probabilities as a type, always given as tails.
//!
//! A probability mixed up with a threshold is the costly error in integrity monitoring, and `1 − p`
//! loses every significant digit. Therefore the type exists, and no complement.

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
