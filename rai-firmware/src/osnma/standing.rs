//! What the authentication is worth: its state, and whether its tags are proof.

use super::{Proof, State, Summary};

/// State of the authentication, as `PRAIO` says it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Standing {
    /// There is a root of the tree and no key.
    NoKey,
    /// No root key is proved yet.
    Waiting,
    /// The root key is signed by a key with another number.
    OtherKey,
    /// The system uses functions that the module lacks.
    Unsupported,
    /// Tags are checked; how old the sky is, is not known.
    Undated,
    /// Tags with a later key are proof.
    Later,
    /// All tags are proof.
    Dated,
    /// The system says that its tags must not be used.
    DontUse,
    /// The system has ended all use.
    Stopped,
    /// Two satellites sent false words or keys.
    False,
}

impl Standing {
    pub(crate) const fn of(summary: &Summary, proof: Proof) -> Self {
        match (summary.state, proof) {
            _ if summary.is_alarm => Self::False,
            (State::NoKey, _) => Self::NoKey,
            (State::Waiting, _) => Self::Waiting,
            (State::OtherKey, _) => Self::OtherKey,
            (State::Unsupported, _) => Self::Unsupported,
            (State::Running, Proof::None) => Self::Undated,
            (State::Running, Proof::Slow) => Self::Later,
            (State::Running, Proof::All) => Self::Dated,
            (State::DontUse, _) => Self::DontUse,
            (State::Stopped, _) => Self::Stopped,
        }
    }

    /// Returns the word of `PRAIO`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::NoKey => "NOKEY",
            Self::Waiting => "WAIT",
            Self::OtherKey => "OTHERKEY",
            Self::Unsupported => "UNSUPPORTED",
            Self::Undated => "UNDATED",
            Self::Later => "LATER",
            Self::Dated => "DATED",
            Self::DontUse => "DONTUSE",
            Self::Stopped => "STOPPED",
            Self::False => "FALSE",
        }
    }
}
