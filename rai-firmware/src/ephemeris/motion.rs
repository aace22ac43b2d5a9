//! Where a satellite is at one instant, and what its speed does to its clock.

use rai_core::frame::Ecef;

/// Position and relativity of one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Where it is, earth-fixed.
    pub position: Ecef,
    /// Periodic relativistic part of the clock, 2⁻⁶² s.
    pub relativity_s62: i64,
}
