//! The door for orbit models: one form for each way in which satellites describe their motion.
//!
//! A new form is a variant here and a module beside [`super::kepler`]; what does not depend on the form (age, health,
//! clock, group delays) is [`Ephemeris`](super::Ephemeris)'s, and nothing else needs to know. There is no form that
//! stands for another.

use super::EphemerisError;
use super::elapsed::Elapsed;
use super::kepler::Kepler;
use super::motion::Motion;
#[cfg(feature = "glonass")]
use super::state_vector::StateVector;

/// How a satellite describes its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orbit {
    /// Sixteen elements of an ellipse with corrections: GPS, Galileo, `BeiDou`, QZSS.
    Kepler(Kepler),
    /// Position, velocity and the pull of sun and moon at one instant: GLONASS, SBAS.
    #[cfg(feature = "glonass")]
    StateVector(StateVector),
}

impl Orbit {
    /// The motion at an instant of system time, counted from the reference time.
    pub(super) fn at(&self, since_toe: Elapsed) -> Result<Motion, EphemerisError> {
        match self {
            Self::Kepler(kepler) => Ok(kepler.at(since_toe)),
            #[cfg(feature = "glonass")]
            Self::StateVector(state) => state.at(since_toe).ok_or(EphemerisError::Stale),
        }
    }

    /// Works out ahead what instants soon after this one have in common. It changes no motion.
    pub(super) fn advance(&mut self, received_s: f64) {
        match self {
            // All at once: an instant of an ellipse has nothing in common with another.
            Self::Kepler(_) => _ = received_s,
            #[cfg(feature = "glonass")]
            Self::StateVector(state) => state.advance(received_s),
        }
    }
}
