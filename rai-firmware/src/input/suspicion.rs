//! What a receiver says of the signals it gets, whatever format it says it in.

/// How sure the receiver is of an interference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Suspicion {
    /// It does not say.
    #[default]
    Unknown,
    /// There is none.
    None,
    /// It suspects it, or suppresses what it notices.
    Suspected,
    /// It is sure.
    Sure,
}

/// What a receiver says of the signals it gets; nothing of what it does not say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Jamming {
    /// Noise that hides the signals.
    pub jamming: Option<Suspicion>,
    /// Signals that are none of a satellite.
    pub spoofing: Option<Suspicion>,
}

impl Suspicion {
    /// The number that it is reported with.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// By the number that it is reported with: 0 unknown, 1 none, 2 suspected, 3 sure.
    pub const fn from_number(number: u8) -> Self {
        match number {
            1 => Self::None,
            2 => Self::Suspected,
            3 => Self::Sure,
            _ => Self::Unknown,
        }
    }
}
