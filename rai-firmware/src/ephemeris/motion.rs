//! Place of a satellite at one instant, with the relativistic effect on its clock.

use raim_core::frame::Ecef;

/// Position and relativity of one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Earth-fixed position.
    pub position: Ecef,
    /// Periodic relativistic part of the clock, 2⁻⁶² s.
    pub relativity_s62: i64,
}
