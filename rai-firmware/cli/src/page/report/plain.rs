//! The result of a run in plain words, for a reader who knows none of the terms.
//!
//! The share of trusted epochs comes first, then the longest stretches without trust with their
//! reasons, then the satellites that were left out meanwhile.

use std::fmt::Write as _;

use super::journal::Journal;
use super::reasons::explanation;
use super::tables::{clock, duration};
use crate::page::Verdict;
use crate::satellites::Fate;

/// Most stretches and satellites that are named; further ones are counted.
const NAMED: usize = 3;

/// Time in which the position was not to be trusted, and the reason that lasted longest in it.
#[derive(Clone, Debug, PartialEq)]
struct Stretch {
    from_s: f64,
    to_s: f64,
    reason: String,
    reason_s: f64,
}

/// Returns the result.
pub(super) fn words(journal: &Journal) -> String {
    let of = |verdict: Verdict| -> u64 {
        journal.counts.iter().filter(|count| count.verdict == verdict).map(|count| count.epochs).sum()
    };
    let (all, trusted) = (journal.len(), of(Verdict::Protected));
    let mut text = match (all, trusted) {
        (0, _) => return "No epoch was judged.".to_owned(),
        (_, 0) => format!("The position was never to be trusted, in none of {all} epochs"),
        _ if all == trusted => format!("The position was to be trusted all the time, in {all} epochs"),
        _ => format!(
            "The position was to be trusted {} of the time, in {trusted} of {all} epochs",
            share(trusted, all)
        ),
    };
    let mut stretches = stretches(journal);
    let more = stretches.len().saturating_sub(NAMED);
    stretches.sort_by(|one, other| (other.to_s - other.from_s).total_cmp(&(one.to_s - one.from_s)));
    stretches.truncate(NAMED);
    stretches.sort_by(|one, other| one.from_s.total_cmp(&other.from_s));
    for stretch in &stretches {
        let _ = write!(text, "; {}", reported(journal, stretch));
    }
    if more > 0 {
        let _ = write!(text, "; and not in {more} shorter stretches");
    }
    text.push('.');
    text.push_str(&left_out(journal));
    text
}

/// Returns a share in percent that is 0 or 100 only if it is exact.
fn share(part: u64, all: u64) -> String {
    let percent = (100.0 * part as f64 / all as f64).clamp(0.1, 99.9);
    if (1.0..=99.0).contains(&percent) { format!("{percent:.0} %") } else { format!("{percent:.1} %") }
}

/// Returns the stretches without trust, in the order of time.
fn stretches(journal: &Journal) -> Vec<Stretch> {
    let mut stretches: Vec<Stretch> = Vec::new();
    let mut is_open = false;
    for (index, event) in journal.events.iter().enumerate() {
        let to_s = journal.events.get(index + 1).map_or(journal.last_s, |next| next.time_s);
        if event.verdict == Verdict::Protected {
            is_open = false;
            continue;
        }
        let (reason, reason_s) = (event.reason.clone(), to_s - event.time_s);
        match stretches.last_mut().filter(|_| is_open) {
            Some(last) => {
                last.to_s = to_s;
                if reason_s > last.reason_s {
                    (last.reason, last.reason_s) = (reason, reason_s);
                }
            }
            None => stretches.push(Stretch { from_s: event.time_s, to_s, reason, reason_s }),
        }
        is_open = true;
    }
    stretches
}

/// Returns a stretch in words, with its reason.
fn reported(journal: &Journal, stretch: &Stretch) -> String {
    let (from, to) = (clock(journal, stretch.from_s), clock(journal, stretch.to_s));
    let lasted = duration(stretch.to_s - stretch.from_s);
    let is_first = journal.events.first().is_some_and(|event| event.time_s >= stretch.from_s);
    let is_last = stretch.to_s >= journal.last_s;
    let when = match (is_first, is_last) {
        (true, true) => format!("from {from} to {to}"),
        (true, false) => format!("not until {to} ({lasted})"),
        (false, true) => format!("not from {from} on ({lasted})"),
        _ => format!("not between {from} and {to} ({lasted})"),
    };
    let why = explanation(&stretch.reason).unwrap_or("of an unknown reason");
    format!("{when}, because {why} ({})", stretch.reason)
}

/// Returns the satellites that contradicted the others, with their numbers of epochs.
fn left_out(journal: &Journal) -> String {
    let excluded = Fate::ALL.iter().position(|fate| *fate == Fate::Excluded).unwrap_or_default();
    let all = journal.satellites.all.iter();
    let mut named: Vec<_> = all
        .map(|(satellite, known)| (known.fates.get(excluded).copied().unwrap_or_default(), satellite))
        .filter(|(epochs, _)| *epochs > 0)
        .collect();
    named.sort_by_key(|(epochs, _)| std::cmp::Reverse(*epochs));
    let epochs = |epochs: u64| if epochs == 1 { "1 epoch".to_owned() } else { format!("{epochs} epochs") };
    let mut names: Vec<String> = named
        .iter()
        .take(NAMED)
        .map(|(count, satellite)| format!("{satellite} (in {})", epochs(*count)))
        .collect();
    match named.len().saturating_sub(NAMED) {
        0 => {}
        more => names.push(format!("{more} more")),
    }
    if names.is_empty() {
        return String::new();
    }
    format!(" Satellites that contradicted the others were left out: {}.", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::report::Happened;
    use crate::sentence;
    use crate::signal::checksum::nmea_line;

    /// Returns the journal of verdicts, one a second.
    fn journal(verdicts: &[(&str, usize)]) -> Journal {
        let mut journal = Journal::default();
        let all = verdicts.iter().flat_map(|(verdict, count)| std::iter::repeat_n(*verdict, *count));
        for (second, verdict) in (0_u32..).zip(all) {
            let text =
                nmea_line(&format!("PRAIS,1200{second:02}.00,{verdict},9,9,5,0.9,1.8,8.0,9.0,40.0,35.0"));
            let output = sentence::epochs(&text).unwrap().pop().unwrap();
            let time_s = f64::from(second);
            let pin_is_high = verdict.starts_with('P');
            journal.push(&Happened { time_s, output: &output, error: None, pin_is_high, view: None });
        }
        journal
    }

    #[test]
    fn words_say_how_long_when_not_and_why() {
        for (verdicts, want) in [
            (&[][..], "No epoch was judged."),
            (&[("P,OK", 4)], "The position was to be trusted all the time, in 4 epochs."),
            (
                &[("U,EPHEMERIS", 2), ("P,OK", 4), ("A,FAULT", 2), ("A,AMBIGUOUS", 1), ("P,OK", 3)],
                "The position was to be trusted 58 % of the time, in 7 of 12 epochs; not until 2.0 (2.0 s), because ranges \
                 arrived without orbits (EPHEMERIS); not between 6.0 and 9.0 (3.0 s), because a fault was detected and not \
                 isolated (FAULT).",
            ),
            (
                &[("U,NOFIX", 3)],
                "The position was never to be trusted, in none of 3 epochs; from 0.0 to 2.0, because too few satellites for \
                 a position, or no convergence (NOFIX).",
            ),
        ] {
            assert_eq!(words(&journal(verdicts)), want);
        }
    }

    #[test]
    fn nearly_all_is_not_all() {
        assert_eq!(share(86_399, 86_400), "99.9 %");
        assert_eq!(share(1, 86_400), "0.1 %");
        assert_eq!(share(96, 100), "96 %");
    }
}
