//! The interface of orbit models, with one form for each way in which satellites describe their
//! motion.
//!
//! A new form is a variant here and a module next to [`super::kepler`]. The parts common to all
//! forms (age, health, clock, group delays) belong to [`Ephemeris`](super::Ephemeris), and no other
//! module knows the forms. No form is converted into another.

use super::EphemerisError;
use super::elapsed::Elapsed;
use super::kepler::Kepler;
use super::motion::Motion;
#[cfg(feature = "glonass")]
use super::state_vector::StateVector;

/// Description of a satellite's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orbit {
    /// Sixteen elements of an ellipse with corrections: GPS, Galileo, `BeiDou`, QZSS.
    Kepler(Kepler),
    /// Position, velocity and the acceleration by sun and moon at one instant: GLONASS, SBAS.
    #[cfg(feature = "glonass")]
    StateVector(StateVector),
}

impl Orbit {
    /// Returns the motion at an instant of system time, counted from the reference time.
    pub(super) fn at(&self, since_toe: Elapsed) -> Result<Motion, EphemerisError> {
        match self {
            Self::Kepler(kepler) => Ok(kepler.at(since_toe)),
            #[cfg(feature = "glonass")]
            Self::StateVector(state) => state.at(since_toe).ok_or(EphemerisError::Stale),
        }
    }

    /// Computes in advance the common part of instants soon after this one. It changes no motion.
    pub(super) fn advance(&mut self, received_s: f64) {
        match self {
            // The instants of an ellipse have no common part.
            Self::Kepler(_) => _ = received_s,
            #[cfg(feature = "glonass")]
            Self::StateVector(state) => state.advance(received_s),
        }
    }
}
