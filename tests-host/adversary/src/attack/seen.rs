//! Report of the module on an epoch, beside the truth.

use raim::verdict::EpochOutput;

/// The report on one epoch, and its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Sentences of the epoch.
    pub reported: EpochOutput,
    /// Horizontal distance from the truth, m; infinite without a position.
    pub horizontal_error_m: f64,
    /// Difference in height, m; infinite without a position.
    pub vertical_error_m: f64,
    /// True if the pin was high at the end.
    pub is_promised: bool,
}

impl Seen {
    /// Returns true for a promised position with an error above one of its levels.
    pub fn is_misleading(&self) -> bool {
        self.is_promised && self.reported.state.is_misleading(self.error_m())
    }

    /// Returns true for a promised position with an error above one of the limits in force.
    pub fn is_hazardous(&self) -> bool {
        self.is_promised && self.reported.state.is_hazardous(self.error_m())
    }

    fn error_m(&self) -> [f64; 2] {
        [self.horizontal_error_m, self.vertical_error_m]
    }
}
