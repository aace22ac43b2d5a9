//! Fields that may take more than one sentence. Each sentence is filled before the next begins.
//!
//! The source of the fields is called twice: first to count the sentences, then to write them.

use embedded_io::Write;

use super::sentence::{ENDING, MAX_LENGTH, Sentence, write_sentence};

/// Fields that each sentence has in addition to its share of the flow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flow<'t> {
    /// Talker and formatter.
    pub(crate) address: &'t str,
    /// First field.
    pub(crate) first: &'t str,
    /// Last field. If it is missing, the number of the sentence and the number of sentences follow.
    pub(crate) last: Option<&'t str>,
}

/// Source of the fields, one call for each.
pub(crate) type Say<'s> = &'s dyn Fn(&mut dyn FnMut(&str));

/// Width of two numbers of two digits with their commas, characters.
const NUMBERS: usize = 6;

impl Flow<'_> {
    /// Returns the number of characters that a sentence has for fields, each with its comma.
    fn room(&self) -> usize {
        let around =
            self.address.len() + self.first.len() + 2 + self.last.map_or(NUMBERS, |last| last.len() + 1);
        (MAX_LENGTH - ENDING).saturating_sub(around)
    }

    fn begin(&self) -> Sentence {
        let mut sentence = Sentence::new(self.address);
        sentence.text(self.first);
        sentence
    }

    fn end(&self, sentence: &mut Sentence, number: u32, count: u32) {
        match self.last {
            Some(last) => sentence.text(last),
            None => sentence.integer(number, 1).integer(count, 1),
        };
    }
}

/// Cutter of a flow into sentences.
struct Cutter {
    room: usize,
    left: usize,
}

impl Cutter {
    fn cuts_before(&mut self, field: &str) -> bool {
        let width = field.len() + 1;
        let cuts = width > self.left;
        self.left = if cuts { self.room } else { self.left }.saturating_sub(width);
        cuts
    }
}

/// Writes the fields of `say`.
///
/// # Errors
/// The writer's own, of the first sentence that it did not take.
pub(crate) fn write_flow<W: Write>(flow: &Flow<'_>, say: Say<'_>, out: &mut W) -> Result<(), W::Error> {
    let room = flow.room();
    let mut count = 1;
    let mut cutter = Cutter { room, left: room };
    say(&mut |field| count += u32::from(cutter.cuts_before(field)));

    let (mut number, mut written) = (1, Ok(()));
    let mut cutter = Cutter { room, left: room };
    let mut sentence = flow.begin();
    say(&mut |field| {
        if cutter.cuts_before(field) {
            flow.end(&mut sentence, number, count);
            if written.is_ok() {
                written = write_sentence(&mut sentence, out);
            }
            sentence = flow.begin();
            number += 1;
        }
        sentence.text(field);
    });
    flow.end(&mut sentence, number, count);
    written.and_then(|()| write_sentence(&mut sentence, out))
}
