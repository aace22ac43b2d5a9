//! Place of a satellite at one instant, with the relativistic effect on its clock.

/// Position and relativity of one instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Motion {
    /// Earth-fixed position, 2⁻³⁶ m.
    pub position_m36: [i64; 3],
    /// Periodic relativistic part of the clock, 2⁻⁶² s.
    pub relativity_s62: i64,
}
