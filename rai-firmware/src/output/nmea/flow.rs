//! Fields that take more than one sentence: as many sentences as they need, each full before the
//! next begins.
//!
//! Who says the fields is asked twice, first to count the sentences, then to write them.

use embedded_io::Write;

use super::sentence::{ENDING, MAX_LENGTH, Sentence, write_sentence};

/// What each of the sentences has beside its share of the fields.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flow<'t> {
    /// Talker and formatter.
    pub(crate) address: &'t str,
    /// The field before the others.
    pub(crate) first: &'t str,
    /// The field behind the others; without one, the number of the sentence and how many there are.
    pub(crate) last: Option<&'t str>,
}

/// Whoever says fields, one call each.
pub(crate) type Say<'s> = &'s dyn Fn(&mut dyn FnMut(&str));

/// Two numbers of two digits with their commas.
const NUMBERS: usize = 6;

impl Flow<'_> {
    /// Characters that a sentence has for fields, each with its comma.
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

/// Cuts a flow of fields: true where one needs a new sentence.
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

/// Writes the fields that `say` says.
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
