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

/// A statement of jamming or spoofing holds for so long, ms.
const HOLDS_MS: u64 = 60_000;

/// The statements of a receiver about its signals so far, from all its messages; each has an age of
/// its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Suspicions {
    /// Noise that hides the signals.
    pub jamming: Suspicion,
    /// Signals that are none of a satellite.
    pub spoofing: Suspicion,
    /// A message has come that knows of both.
    is_told_both: bool,
    /// Time of the message that the state of jamming is of, ms.
    jamming_ms: u64,
    /// Time of the message that the state of spoofing is of, ms.
    spoofing_ms: u64,
}

impl Suspicions {
    /// Of a receiver that has said nothing.
    pub const NONE: Self = Self {
        jamming: Suspicion::Unknown,
        spoofing: Suspicion::Unknown,
        is_told_both: false,
        jamming_ms: 0,
        spoofing_ms: 0,
    };

    /// Takes what a message says. One that knows of spoofing only never lowers what one has said
    /// that knows of both; and who was sure and now does not know, as a receiver that has begun
    /// anew, has taken nothing back. A message renews the age of a state only if the state is the
    /// one that the message says.
    pub fn hear(&mut self, said: &Jamming, now_ms: u64) {
        let knows_both = said.jamming.is_some();
        if let Some(spoofing) = said.spoofing {
            let knows_less = self.is_told_both && !knows_both;
            let is_kept = knows_less || self.is_sure() && spoofing == Suspicion::Unknown;
            self.spoofing = spoofing.max(if is_kept { self.spoofing } else { Suspicion::Unknown });
            if self.spoofing == spoofing {
                self.spoofing_ms = now_ms;
            }
        }
        if let Some(jamming) = said.jamming {
            (self.jamming, self.jamming_ms) = (jamming, now_ms);
        }
        self.is_told_both |= knows_both;
    }

    /// Sets each state to unknown that no message has renewed for a minute, unless it is sure of
    /// spoofing.
    pub fn age(&mut self, now_ms: u64) {
        let is_old = |said_ms: u64| now_ms.abs_diff(said_ms) > HOLDS_MS;
        if is_old(self.jamming_ms) {
            self.jamming = Suspicion::Unknown;
        }
        if is_old(self.spoofing_ms) && !self.is_sure() {
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

#[cfg(test)]
mod tests {
    use super::*;

    const NAV_STATUS: Jamming = Jamming { jamming: None, spoofing: Some(Suspicion::None) };

    fn sec_sig(jamming: Suspicion, spoofing: Suspicion) -> Jamming {
        Jamming { jamming: Some(jamming), spoofing: Some(spoofing) }
    }

    /// [UBX-F9] NAV-STATUS has no field of jamming, and so cannot renew its state.
    ///
    /// [UBX-F9]: crate#references
    #[test]
    fn message_without_jamming_does_not_renew_its_state() {
        let mut said = Suspicions::NONE;
        said.hear(&sec_sig(Suspicion::Sure, Suspicion::None), 0);
        for second in 1..=120 {
            said.hear(&NAV_STATUS, 1000 * second);
            said.age(1000 * second);
            let want = if second <= 60 { Suspicion::Sure } else { Suspicion::Unknown };
            assert_eq!(said.jamming, want, "{second} s");
            assert_eq!(said.spoofing, Suspicion::None, "renewed by its own message, {second} s");
        }
    }

    #[test]
    fn message_that_says_less_does_not_renew_what_it_cannot_lower() {
        let mut said = Suspicions::NONE;
        said.hear(&sec_sig(Suspicion::None, Suspicion::Suspected), 0);
        for second in 1..=60 {
            said.hear(&NAV_STATUS, 1000 * second);
            said.age(1000 * second);
            assert_eq!(said.spoofing, Suspicion::Suspected, "{second} s");
        }
        said.age(61_000);
        said.hear(&NAV_STATUS, 61_000);
        assert_eq!(said.spoofing, Suspicion::None);
    }
}
