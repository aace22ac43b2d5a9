//! What a measurement comes to.

/// What the name of a figure of the second board ends with.
const SECOND_BOARD: &str = ", Cortex-M7";

/// The name of the figure that the second board has for this one.
pub(super) fn on_second_board(name: &str) -> String {
    format!("{name}{SECOND_BOARD}")
}

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

impl Figure {
    /// Whether it is one of the second board, which stands in its own column beside the first one's.
    pub fn is_of_second_board(&self) -> bool {
        self.name.ends_with(SECOND_BOARD)
    }
}
