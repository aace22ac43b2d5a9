//! Figures of a measurement.

/// Suffix of the name of a figure of the second board.
const SECOND_BOARD: &str = ", Cortex-M7";

/// Returns the name of the second board's figure for this name.
pub(super) fn on_second_board(name: &str) -> String {
    format!("{name}{SECOND_BOARD}")
}

/// A measured figure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// Name of the quantity; unique.
    pub name: String,
    /// Instructions, or bytes.
    pub value: u64,
    /// Target of the value, if one is set.
    pub target: Option<u64>,
}

impl Figure {
    /// Returns true for a figure of the second board, which has its own column.
    pub fn is_of_second_board(&self) -> bool {
        self.name.ends_with(SECOND_BOARD)
    }
}
