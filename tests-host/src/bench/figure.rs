//! What a measurement comes to.

/// One figure: what it is of, and what it came to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// What was measured, on what; unique.
    pub name: String,
    /// Instructions, or bytes.
    pub value: u64,
    /// The most it should be, where that was set.
    pub target: Option<u64>,
}
