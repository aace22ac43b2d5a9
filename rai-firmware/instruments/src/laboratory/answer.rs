//! Answer to a request: the ticks it took, and the result in words, doubles to their last bit.
//!
//! | bytes | what |
//! |---|---|
//! | 4 | ticks, little-endian |
//! | 4 | length of the rest |
//! | … | the result in the format of `Debug` |

use core::fmt::{self, Write as _};

use heapless::String;

use crate::semihosting::File;

/// Most bytes of an answer; a report with 48 satellites takes 3,000 characters.
const CAPACITY: usize = 6144;

/// Writer of the answers, in the order of the requests.
pub struct Answers {
    file: File,
    text: String<CAPACITY>,
}

impl Answers {
    /// Opens the file that the host reads.
    pub fn open() -> Option<Self> {
        Some(Self { file: File::to_write(b"answers.bin\0")?, text: String::new() })
    }

    /// Writes one answer.
    pub fn write(&mut self, ticks: u32, result: &impl fmt::Debug) -> Option<()> {
        self.text.clear();
        write!(self.text, "{result:?}").ok()?;
        let head = [ticks.to_le_bytes(), (self.text.len() as u32).to_le_bytes()];
        (self.file.write(head.as_flattened()) && self.file.write(self.text.as_bytes())).then_some(())
    }
}
