//! Jamming and spoofing that a receiver reports, in any format.

/// Certainty of the receiver about an interference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Suspicion {
    /// The receiver reports no state.
    #[default]
    Unknown,
    /// The receiver reports no interference.
    None,
    /// The receiver suspects interference, or suppresses it.
    Suspected,
    /// The receiver is certain.
    Sure,
}

/// Interference in one message; `None` for a kind that the message does not cover.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Jamming {
    /// Jamming: noise that hides the signals.
    pub jamming: Option<Suspicion>,
    /// Spoofing: false signals.
    pub spoofing: Option<Suspicion>,
}

/// Time for which a reported state holds, ms.
const HOLDS_MS: u64 = 60_000;

/// States that a receiver has reported in all its messages, each with its own age.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Suspicions {
    /// Jamming: noise that hides the signals.
    pub jamming: Suspicion,
    /// Spoofing: false signals.
    pub spoofing: Suspicion,
    /// True after a message that covers both kinds.
    is_told_both: bool,
    /// Time of the message with the state of jamming, ms.
    jamming_ms: u64,
    /// Time of the message with the state of spoofing, ms.
    spoofing_ms: u64,
}

impl Suspicions {
    /// States before the first message.
    pub const NONE: Self = Self {
        jamming: Suspicion::Unknown,
        spoofing: Suspicion::Unknown,
        is_told_both: false,
        jamming_ms: 0,
        spoofing_ms: 0,
    };

    /// Takes a message. A message that covers only spoofing never lowers the state of one that
    /// covers both. If a certain state is followed by an unknown one, as after a restart of the
    /// receiver, the certain state stays. A message renews the age of a state only if it reports
    /// that state.
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

    /// Sets each state to unknown that no message has renewed for a minute, except a certain state
    /// of spoofing.
    pub fn age(&mut self, now_ms: u64) {
        let is_old = |said_ms: u64| now_ms.abs_diff(said_ms) > HOLDS_MS;
        if is_old(self.jamming_ms) {
            self.jamming = Suspicion::Unknown;
        }
        if is_old(self.spoofing_ms) && !self.is_sure() {
            self.spoofing = Suspicion::Unknown;
        }
    }

    /// Returns true if no signal may be trusted.
    pub fn is_sure(&self) -> bool {
        self.spoofing == Suspicion::Sure
    }
}

impl Suspicion {
    /// Returns the number with which it is reported.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// Returns the state with this number: 0 unknown, 1 none, 2 suspected, 3 certain.
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
