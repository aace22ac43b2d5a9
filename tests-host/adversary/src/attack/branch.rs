//! Branches of the fault tree (`evidence`), below which each attack is a leaf.

/// Cause of the hazard that an attack tries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// Ranges of one satellite are wrong.
    OneSatellite,
    /// Ranges of several satellites are wrong.
    Several,
    /// Ranges of all satellites are wrong.
    All,
    /// Ranges are wrong by more than their sigmas describe.
    Sigmas,
    /// Signals are counterfeit.
    Counterfeit,
    /// Orbits or clocks are wrong.
    Orbits,
    /// The date or the time tag is wrong.
    Time,
    /// The line carries what the receiver did not send.
    Line,
    /// A command or a setting makes the promise wrong.
    Settings,
    /// The promise comes too late or is not taken back.
    Late,
}
