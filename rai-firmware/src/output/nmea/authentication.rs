//! `PRAIO`: what is known of the navigation data of Galileo.
//!
//! | field | content |
//! |---|---|
//! | 1 | time |
//! | 2 | state: the word of [`Standing`] |
//! | 3, 4 | number of the public key, and of the chain in force |
//! | 5, 6, 7 | satellites in view whose ephemerides are proved, unproved, false |
//! | 8 | age of the oldest proof, s |
//! | 9 | bound of the trusted time, s |
//! | 10 | greatest distance between the places of single systems in the epoch before, m |
//!
//! The sentence comes before those of its epoch, and only while a key is set.

use embedded_io::Write;

use super::{Sentence, TimeOfDay, write_sentence};
use crate::osnma::{Proof, Standing, Summary};

/// What is known, and what it is worth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AuthenticationReport {
    pub(crate) summary: Summary,
    /// Tags that are proof.
    pub(crate) proof: Proof,
    /// Bound of the trusted time, s.
    pub(crate) bound_s: Option<f64>,
    /// Greatest distance between the places of single systems, m.
    pub(crate) apart_m: Option<f64>,
}

impl AuthenticationReport {
    /// Returns the state for autopilots: 1 until the first proof, 2 false, 3 four satellites proved.
    #[cfg(feature = "mavlink")]
    pub(crate) fn state(&self) -> u8 {
        use crate::osnma::State;
        let Summary { state, proved, false_, is_alarm, .. } = self.summary;
        match state {
            _ if is_alarm || false_ > 0 => 2,
            State::Running if proved >= 4 && self.proof != Proof::None => 3,
            State::Running if proved == 0 => 1,
            State::Waiting => 1,
            _ => 0,
        }
    }
}

/// Writes `PRAIO`.
pub(crate) fn write_authentication<W: Write>(
    report: &AuthenticationReport,
    time: TimeOfDay,
    out: &mut W,
) -> Result<(), W::Error> {
    let summary = &report.summary;
    let mut sentence = Sentence::new("PRAIO");
    sentence.time(Some(time)).text(Standing::of(summary, report.proof).word());
    match summary.key_and_chain {
        Some((key, chain)) => sentence.integer(key.into(), 1).integer(chain.into(), 1),
        None => sentence.empty().empty(),
    };
    for count in [summary.proved, summary.unproved, summary.false_] {
        sentence.integer(count.into(), 1);
    }
    match summary.oldest_proof_s {
        Some(age_s) => sentence.integer(age_s, 1),
        None => sentence.empty(),
    };
    sentence.optional(report.bound_s, 1, 7).optional(report.apart_m, 1, 9);
    write_sentence(&mut sentence, out)
}
