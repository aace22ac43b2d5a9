//! The reasons of a verdict: each has a word, which `PRAIS` reports, and a code, which the C library
//! reports. One table declares all three, so that a reason without a word or a code does not
//! compile. One that small builds lack has its feature in brackets.

use core::ffi::CStr;

use crate::report::Verdict;

macro_rules! reasons {
    ($($(#[$about:meta])* $state:ident $letter:literal {
        $($(#[$when:meta])* $([$feature:literal])? $reason:ident = $code:literal $word:literal,)+
    })+) => {
        $(
            $(#[$about])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            #[cfg_attr(feature = "defmt", derive(defmt::Format))]
            #[non_exhaustive]
            pub enum $state {
                $($(#[$when])* $(#[cfg(feature = $feature)])? $reason,)+
                /// No reason: a variant with a value, so that the others have no numbers, which a new
                /// row of the table would change. [`Verdict::code`] stays.
                #[doc(hidden)]
                Unnumbered(core::convert::Infallible),
            }
        )+

        impl Verdict {
            /// Every verdict that there is in this version, in the order of the codes' declaration.
            pub fn all() -> impl Iterator<Item = Self> {
                [$($($(#[cfg(feature = $feature)])? Self::$state($state::$reason),)+)+].into_iter()
            }

            /// Returns the word of the reason: `OK`, `FAULT`, `NOFIX`.
            pub const fn word(self) -> &'static str {
                self.words().1
            }

            /// Returns the letter of the state, `P`, `A` or `U`, and the word of the reason.
            #[doc(hidden)]
            pub const fn words(self) -> (&'static str, &'static str) {
                match self {
                    $($($(#[cfg(feature = $feature)])? Self::$state($state::$reason) => ($letter, $word),)+)+
                }
            }

            /// Returns the code of the reason, as the C library reports it. 0 is the code of none.
            pub const fn code(self) -> u8 {
                match self {
                    $($($(#[cfg(feature = $feature)])? Self::$state($state::$reason) => $code,)+)+
                }
            }

            /// Returns the word of a code, or `None` if no reason has it.
            #[doc(hidden)]
            pub const fn word_of(code: u8) -> Option<&'static CStr> {
                match code {
                    $($($(#[cfg(feature = $feature)])? $code => Some(const { terminated(concat!($word, "\0")) }),)+)+
                    _ => None,
                }
            }
        }
    };
}

const fn terminated(word: &'static str) -> &'static CStr {
    match CStr::from_bytes_with_nul(word.as_bytes()) {
        Ok(word) => word,
        // Evaluated while compiling.
        Err(_) => unreachable!(),
    }
}

reasons! {
    /// Reason why a position is protected.
    Protected "P" {
        /// All satellites agree.
        Ok = 1 "OK",
        /// The satellites agree after the faulty ones were left out.
        Excluded = 2 "EXCLUDED",
        /// Systems contradict each other, and the one whose navigation data are proved has decided. The
        /// levels are its own. The firmware sets this reason.
        ["authentication"]
        System = 3 "SYSTEM",
        /// A fault was detected, and several exclusions explain the data equally well. The levels hold
        /// for each of them, so that they are larger; those excluded may be healthy.
        Covered = 4 "COVERED",
    }

    /// Reason why a position must not be used.
    Alert "A" {
        /// A fault was detected and could not be isolated.
        Fault = 32 "FAULT",
        /// Several exclusions explain the data equally well, or a contradiction points to no satellite:
        /// two systems contradict each other, a height contradicts the satellites, or two receivers
        /// send.
        Ambiguous = 33 "AMBIGUOUS",
        /// A wrong time tag of all ranges explains the data, and no exclusion does better.
        Time = 37 "TIME",
        /// No epoch was judged within the time to alert. The firmware sets this reason, because it has
        /// a clock.
        Stale = 34 "STALE",
        /// Since the position was last protected, it moved farther than the receiver can. The
        /// satellites agree by chance, or they are counterfeit.
        Jump = 35 "JUMP",
        /// The receiver clock contradicts its measured drift or, if there are no range rates, its own
        /// past. The cause is a second receiver, a repeater or counterfeit signals; or, once, a receiver
        /// that started anew.
        Clock = 39 "CLOCK",
        /// The motion of the position contradicts its measured velocity.
        Track = 40 "TRACK",
        /// No epoch of the receiver in use was judged within the time to alert, while epochs of another
        /// station or in another format arrive. The firmware sets this reason.
        Source = 38 "SOURCE",
        /// The GNSS receiver reports counterfeit signals. The firmware sets this reason.
        Spoofed = 36 "SPOOFED",
        /// More than one satellite sent navigation data that its system did not make. The firmware sets
        /// this reason.
        ["authentication"]
        Forged = 41 "AUTH",
        /// The time of the epoch differs from a trusted one by more than its bound: the signals are
        /// recorded. The firmware sets this reason.
        ["authentication"]
        Replayed = 42 "REPLAY",
    }

    /// Reason why a position has no integrity.
    Unavailable "U" {
        /// Too few satellites for a position, or the fix did not converge.
        NoFix = 64 "NOFIX",
        /// There is no redundancy to test the position with.
        Redundancy = 65 "REDUNDANCY",
        /// The satellites' geometry is singular, or a satellite that moves the position cannot be
        /// tested.
        Geometry = 66 "GEOMETRY",
        /// No threshold meets the probabilities of both false alarm and missed detection (`τ1 ≥ τ2`).
        Risk = 67 "RISK",
        /// The horizontal protection level exceeds the alert limit. Under `Policy::T1`, except for
        /// ARAIM, it exceeds `guard_fraction` times the limit.
        Hpl = 68 "HPL",
        /// The vertical protection level exceeds the alert limit. Under `Policy::T1`, except for ARAIM,
        /// it exceeds `guard_fraction` times the limit.
        Vpl = 69 "VPL",
        /// The effective monitor threshold of ARAIM exceeds its limit.
        Emt = 77 "EMT",
        /// The vertical accuracy of ARAIM exceeds its limit.
        Accuracy = 78 "ACCURACY",
        /// The search ended without a result, because it exceeded its work budget.
        Budget = 70 "BUDGET",
        /// There is no position, and at least one range was refused as implausible. The firmware sets
        /// this reason.
        Input = 71 "INPUT",
        /// The satellites agree again after an alert, but not yet for long enough.
        Recovering = 72 "RECOVERING",
        /// No receiver can be at this height or place, or the position contradicts the known place.
        Place = 73 "PLACE",
        /// The residuals of the last minute contradict the sigmas. Or the satellites that remain after
        /// an exclusion hardly agree.
        Sigmas = 79 "SIGMAS",
        /// The self-test computed a wrong result. The firmware sets this reason and the next two.
        SelfTest = 74 "SELFTEST",
        /// Ranges came without orbits.
        Ephemeris = 75 "EPHEMERIS",
        /// After an unexpected restart the settings are those at start, and the user has not confirmed
        /// them. Or a command has changed a setting that a promise depends on.
        Settings = 76 "SETTINGS",
        /// Fewer than four satellites with proved ephemerides were used, although the settings demand
        /// them. The firmware sets this reason.
        ["authentication"]
        Unproved = 80 "UNPROVED",
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::vec::Vec;

    use super::*;

    #[test]
    fn every_reason_has_a_word_and_a_code_of_its_own() {
        let all: Vec<_> = Verdict::all().collect();
        let words: BTreeSet<_> = all.iter().map(|verdict| verdict.word()).collect();
        let codes: BTreeSet<_> = all.iter().map(|verdict| verdict.code()).collect();
        assert_eq!((words.len(), codes.len()), (all.len(), all.len()));
        assert!(!codes.contains(&0));
        for verdict in all {
            let word = Verdict::word_of(verdict.code()).and_then(|word| word.to_str().ok());
            assert_eq!(word, Some(verdict.word()));
        }
    }
}
