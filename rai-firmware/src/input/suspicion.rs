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

/// What a receiver has said of the signals so far, of all its messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Suspicions {
    /// Noise that hides the signals.
    pub jamming: Suspicion,
    /// Signals that are none of a satellite.
    pub spoofing: Suspicion,
    /// A message has spoken that knows of both.
    is_told_both: bool,
}

impl Suspicions {
    /// Of a receiver that has said nothing.
    pub const NONE: Self =
        Self { jamming: Suspicion::Unknown, spoofing: Suspicion::Unknown, is_told_both: false };

    /// Takes what a message says. One that knows of spoofing only never lowers what one has said that knows of both; and who
    /// was sure and now does not know, as a receiver that has begun anew, has taken nothing back.
    pub fn hear(&mut self, said: &Jamming) {
        let knows_both = said.jamming.is_some();
        if let Some(spoofing) = said.spoofing {
            let knows_less = self.is_told_both && !knows_both;
            let is_kept = knows_less || self.is_sure() && spoofing == Suspicion::Unknown;
            self.spoofing = spoofing.max(if is_kept { self.spoofing } else { Suspicion::Unknown });
        }
        self.jamming = said.jamming.unwrap_or(self.jamming);
        self.is_told_both |= knows_both;
    }

    /// Nothing was said for long: what was said last says nothing of now, unless it was sure of spoofing.
    pub fn age(&mut self) {
        self.jamming = Suspicion::Unknown;
        if !self.is_sure() {
            self.spoofing = Suspicion::Unknown;
        }
    }

    /// Whether no signal is to be trusted.
    pub fn is_sure(&self) -> bool {
        self.spoofing == Suspicion::Sure
    }
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
