//! A receiver's reports of jamming, spoofing, authentication and its own protection levels, in any
//! format.
//!
//! ```text
//! state = max of the states of all reporters, each for at most 3 s after its last message
//! certain from the first message that affirms spoofing, until all reporters deny it
//! distrust while certain, and for 10 s after a certainty of at least 1 s
//! ```
//!
//! | constant | meaning | unit |
//! |---|---|---|
//! | [`HOLDS_MS`] | time for which a message counts | ms |
//! | [`AFFIRMED_MS`] | least duration of a certainty that is followed by distrust | ms |
//! | [`AFTER_MS`] | duration of distrust after a certainty | ms |
//! | [`ONSET_MS`] | largest time between the onset of a suspicion and a sign | ms |
//!
//! A denial lasts from message to message, so that a receiver that reports seldom can end a
//! certainty: the last denial must come more than [`AFTER_MS`] after the first.
//!
//! Silence is no denial: if a receiver that was certain restarts, it knows nothing, and the
//! certainty stays. The state *suspected* alone is no reason for distrust: a receiver at rest
//! behind an attenuator reported it in 571 of 581 clean epochs. It counts only together with a sign
//! that the module's own tests found, and only if it began within [`ONSET_MS`] of that sign
//! ([`Suspicions::confirms`]): a suspicion that lasts for hours says nothing about the present.
//!
//! These reports only take promises back. None of them makes a position usable or excludes a
//! satellite.

/// Certainty of the receiver about an interference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
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

/// Part of the receiver that reports interference. Each has its own state and age, so that no part
/// cancels the report of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reporter {
    /// Detector of jamming and spoofing.
    Detector,
    /// Navigation engine.
    Navigation,
    /// Radio front end.
    FrontEnd,
}

/// Interference in one message; `None` for a kind that the message does not cover.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Jamming {
    /// Part that reports.
    pub reporter: Reporter,
    /// Jamming: noise that hides the signals.
    pub jamming: Option<Suspicion>,
    /// Spoofing: false signals.
    pub spoofing: Option<Suspicion>,
}

/// Latest events in the receiver's log of interference: seconds since each, or `None` without one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoggedEvents {
    /// Age of the latest event of jamming, s.
    pub jamming_s: Option<u32>,
    /// Age of the latest event of spoofing, s.
    pub spoofing_s: Option<u32>,
}

/// Protection levels that the receiver computes. The module forwards them, but never uses them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReceiverLevels {
    /// Number of the frame of the axes, as the receiver states it.
    pub frame: u8,
    /// Level along each axis of the frame, mm.
    pub axes_mm: [u32; 3],
    /// Risk of misleading information per hour: coefficient and power of ten.
    pub risk: (u8, i8),
}

/// One report of the receiver, as one message brings it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SelfReport {
    /// Interference at present.
    Interference(Jamming),
    /// Log of interference.
    Log(LoggedEvents),
    /// Number of signals whose navigation message is authenticated.
    Authentication(u8),
    /// Number of satellites whose navigation message is authentic, and what those whose is not mean.
    #[cfg(feature = "sbf")]
    Authenticity(u8, Suspicion),
    /// Protection levels of the receiver; `None` if it has no valid ones.
    Levels(Option<ReceiverLevels>),
}

/// Time for which a message counts, ms.
const HOLDS_MS: u64 = 3_000;

/// Least duration of a certainty that is followed by distrust, ms.
const AFFIRMED_MS: u64 = 1_000;

/// Duration of distrust after a certainty, ms. A logged event, or a sign that the module's own
/// tests found, counts for as long.
const AFTER_MS: u64 = 10_000;

/// Largest time between the onset of a suspicion and a sign that confirm each other, ms. A suspicion
/// begins anew after a denial, and after a silence.
const ONSET_MS: u64 = 60_000;

/// Interference that one part of the receiver reports, with the time of each state, ms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Reported {
    jamming: (Suspicion, u64),
    spoofing: (Suspicion, u64),
}

/// Reports of a receiver in all its messages, each with its own age.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Suspicions {
    /// Jamming: noise that hides the signals.
    pub jamming: Suspicion,
    /// Spoofing: false signals.
    pub spoofing: Suspicion,
    reported: [Reported; 3],
    /// Time of the latest logged event of jamming and of spoofing, ms.
    logged_ms: [Option<u64>; 2],
    /// Beginning of the present certainty of spoofing, ms.
    affirmed_ms: Option<u64>,
    /// True after a certainty of at least [`AFFIRMED_MS`], until it has been denied for
    /// [`AFTER_MS`].
    is_held: bool,
    /// Time since which spoofing is denied, ms.
    denied_ms: Option<u64>,
    /// Time at which the present suspicion of spoofing began, ms.
    suspected_ms: Option<u64>,
    /// Number of authenticated signals, and the time of the message, ms.
    authenticated: Option<(u8, u64)>,
    /// Levels of the receiver, and the time of the message, ms.
    levels: Option<(ReceiverLevels, u64)>,
}

/// Returns true while something of this time counts.
// Not inlined, so that its many callers share one copy.
#[inline(never)]
fn is_within(hold_ms: u64, said_ms: u64, now_ms: u64) -> bool {
    now_ms.abs_diff(said_ms) <= hold_ms
}

impl Suspicions {
    /// State before the first message.
    pub const NONE: Self = {
        const REPORTED: Reported =
            Reported { jamming: (Suspicion::Unknown, 0), spoofing: (Suspicion::Unknown, 0) };
        Self {
            jamming: Suspicion::Unknown,
            spoofing: Suspicion::Unknown,
            reported: [REPORTED; 3],
            logged_ms: [None; 2],
            affirmed_ms: None,
            is_held: false,
            denied_ms: None,
            suspected_ms: None,
            authenticated: None,
            levels: None,
        }
    };

    /// Takes a message.
    #[inline(never)]
    pub fn receive(&mut self, said: &SelfReport, now_ms: u64) {
        match said {
            SelfReport::Interference(said) => {
                if let Some(reported) = self.reported.get_mut(said.reporter as usize) {
                    reported.jamming = said.jamming.map_or(reported.jamming, |state| (state, now_ms));
                    reported.spoofing = said.spoofing.map_or(reported.spoofing, |state| (state, now_ms));
                }
            }
            SelfReport::Log(events) => {
                let ages_s = [events.jamming_s, events.spoofing_s];
                for (logged_ms, age_s) in self.logged_ms.iter_mut().zip(ages_s) {
                    let came_ms = age_s.and_then(|age_s| now_ms.checked_sub(u64::from(age_s) * 1000));
                    *logged_ms = came_ms.max(*logged_ms);
                }
            }
            SelfReport::Authentication(signals) => self.authenticated = Some((*signals, now_ms)),
            #[cfg(feature = "sbf")]
            SelfReport::Authenticity(signals, spoofing) => {
                self.authenticated = Some((*signals, now_ms));
                if let Some(reported) = self.reported.get_mut(Reporter::Navigation as usize) {
                    reported.spoofing = (*spoofing, now_ms);
                }
            }
            SelfReport::Levels(levels) => self.levels = levels.map(|levels| (levels, now_ms)),
        }
        self.age(now_ms);
    }

    /// Discards every state that no message has renewed for [`HOLDS_MS`], and updates the distrust.
    #[inline(never)]
    pub fn age(&mut self, now_ms: u64) {
        let fresh = |(state, said_ms)| {
            if is_within(HOLDS_MS, said_ms, now_ms) { state } else { Suspicion::Unknown }
        };
        let logged = self.logged_ms.map(|logged_ms| match logged_ms {
            Some(logged_ms) if is_within(AFTER_MS, logged_ms, now_ms) => Suspicion::Suspected,
            _ => Suspicion::Unknown,
        });
        [self.jamming, self.spoofing] = logged;
        for reported in &self.reported {
            self.jamming = self.jamming.max(fresh(reported.jamming));
            self.spoofing = self.spoofing.max(fresh(reported.spoofing));
        }
        self.authenticated = self.authenticated.filter(|(_, said_ms)| is_within(HOLDS_MS, *said_ms, now_ms));
        self.levels = self.levels.filter(|(_, said_ms)| is_within(HOLDS_MS, *said_ms, now_ms));
        self.hold(now_ms);
    }

    /// Begins, continues or ends the distrust and the suspicion.
    fn hold(&mut self, now_ms: u64) {
        match self.spoofing {
            Suspicion::Suspected | Suspicion::Sure => {
                self.suspected_ms.get_or_insert(now_ms);
            }
            Suspicion::None | Suspicion::Unknown => self.suspected_ms = None,
        }
        match self.spoofing {
            Suspicion::Sure => {
                self.affirmed_ms.get_or_insert(now_ms);
                self.denied_ms = None;
            }
            Suspicion::None | Suspicion::Suspected => {
                self.affirmed_ms = None;
                self.denied_ms.get_or_insert(now_ms);
            }
            // Silence neither affirms nor denies.
            Suspicion::Unknown => {}
        }
        self.is_held |= self.affirmed_ms.is_some_and(|since_ms| now_ms.abs_diff(since_ms) >= AFFIRMED_MS);
        // Only a denial ends the distrust, and no silence after one.
        let is_denied = matches!(self.spoofing, Suspicion::None | Suspicion::Suspected);
        let is_over =
            is_denied && self.denied_ms.is_some_and(|since_ms| !is_within(AFTER_MS, since_ms, now_ms));
        self.is_held &= !is_over;
    }

    /// Returns true if no signal may be trusted: the receiver is certain of spoofing, or was until
    /// a short time ago.
    pub fn is_sure(&self) -> bool {
        self.is_held || self.affirmed_ms.is_some()
    }

    /// Returns true if the receiver suspects spoofing and the module's own tests found a sign of it
    /// (`sign_ms`) at about the time at which the suspicion began. Together they are a reason for
    /// distrust.
    pub fn confirms(&self, sign_ms: Option<u64>, now_ms: u64) -> bool {
        let Some((sign_ms, onset_ms)) = sign_ms.zip(self.suspected_ms) else { return false };
        is_within(AFTER_MS, sign_ms, now_ms)
            && is_within(ONSET_MS, onset_ms, sign_ms)
            && self.spoofing >= Suspicion::Suspected
    }

    /// Returns the number of signals whose navigation message is authenticated, if the receiver
    /// states it.
    pub fn authenticated(&self) -> Option<u8> {
        self.authenticated.map(|(signals, _)| signals)
    }

    /// Returns the protection levels of the receiver, if it has valid ones.
    pub fn levels(&self) -> Option<ReceiverLevels> {
        self.levels.map(|(levels, _)| levels)
    }
}

impl Suspicion {
    /// Returns the number of the state in reports.
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
mod tests;
