//! Result of a replay on the emulated board.

/// Result of a run on the emulated board.
#[derive(Clone, Debug, Default)]
pub struct BoardRun {
    /// Target instructions of each epoch, if the board logged them.
    pub instructions: Vec<u64>,
    /// Counters of the board at the end, by name.
    pub counters: Vec<(String, u32)>,
    /// Number of times that the board logged lost bytes or sentences.
    pub losses: usize,
    /// First sentence of the host that the board did not send, and the board's sentence instead;
    /// the shorter side is empty.
    pub difference: Option<(String, String)>,
}
