//! Lines of a module, gathered until they belong together.
//!
//! An epoch begins with its first sentence of NMEA or with `PRAIS`, and ends with `PRAIN`. Between
//! two epochs each sentence is for itself. A verdict without an epoch, of a silence or after a
//! command, has no `PRAIN`.

use crate::sentence::{self, Sentence};

/// Longest epoch, in lines: with every sentence, every exclusion and noise between them.
const MOST_LINES: usize = 64;

/// Lines that wait for the rest of their epoch.
#[derive(Debug, Default)]
pub(super) struct Batches {
    waiting: Vec<String>,
    has_verdict: bool,
}

impl Batches {
    /// Takes a line; returns what is complete now.
    pub(super) fn push(&mut self, line: String) -> Vec<Vec<String>> {
        let parsed = sentence::parse(&line);
        let mut complete = Vec::new();
        let is_verdict = matches!(parsed, Ok(Sentence::State(_)));
        let is_new = is_verdict || matches!(parsed, Ok(Sentence::Position(_)));
        if is_new && self.has_verdict {
            // The end of the last epoch was lost.
            complete.extend(self.flush());
        }
        let stands_alone = match &parsed {
            Ok(Sentence::State(state)) => !state.has_epoch(),
            Ok(Sentence::Other) => {
                ["$PRAIN", "$PRAIV", "$PRAIQ", "$PRAIL", "$PRAIA"].iter().any(|word| line.starts_with(word))
            }
            _ => false,
        };
        let ends = line.starts_with("$PRAIN")
            || (stands_alone && self.waiting.is_empty())
            || (stands_alone && is_verdict);
        self.has_verdict |= is_verdict;
        self.waiting.push(line);
        if ends || self.waiting.len() >= MOST_LINES {
            complete.extend(self.flush());
        }
        complete
    }

    fn flush(&mut self) -> Option<Vec<String>> {
        self.has_verdict = false;
        let lines = std::mem::take(&mut self.waiting);
        (!lines.is_empty()).then_some(lines)
    }

    /// Returns what is left at the end.
    pub(super) fn end(mut self) -> Vec<String> {
        self.flush().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::checksum::nmea_line;

    fn batches(bodies: &[&str]) -> Vec<usize> {
        let mut batches = Batches::default();
        let mut have: Vec<usize> =
            bodies.iter().flat_map(|body| batches.push(nmea_line(body))).map(|lines| lines.len()).collect();
        have.push(batches.end().len());
        have
    }

    const POSITION: &str = "GNGNS,120000.00,5530.00,N,00829.00,E,A,09,1.00,53.1,0.0,,,S";
    const VERDICT: &str = "PRAIS,120000.00,P,EXCLUDED,10,9,5,0.912,1.764,12.3,18.4,40.0,35.0";
    const EXCLUDED: &str = "PRAIX,120000.00,1,G05,-23.400,81.2";
    const END: &str = "PRAIN,120000.00,0123ABCD,10,1,2";
    const STALE: &str = "PRAIS,120000.00,A,STALE,0,0,,,,,,556.0,";

    #[test]
    fn an_epoch_is_one_batch_and_a_silence_another() {
        assert_eq!(batches(&[POSITION, VERDICT, EXCLUDED, END, STALE, POSITION, VERDICT, END]), [4, 1, 3, 0]);
        assert_eq!(batches(&["PRAIV,1,2,3,4", VERDICT, "PRAIL,1,2,3,4", END]), [1, 3, 0]);
    }

    #[test]
    fn an_epoch_whose_end_is_lost_ends_where_the_next_begins() {
        assert_eq!(batches(&[POSITION, VERDICT, POSITION, VERDICT, END]), [2, 3, 0]);
        assert_eq!(batches(&[POSITION, VERDICT]), [2]);
    }
}
