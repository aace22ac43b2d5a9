//! What the host gets for a request: the ticks it took, and the result in words, doubles to their last bit.
//!
//! | bytes | what |
//! |---|---|
//! | 4 | ticks, little-endian |
//! | 4 | length of the rest |
//! | … | the result as `Debug` writes it |

use core::fmt::{self, Write as _};

use heapless::String;

use crate::semihosting::File;

/// A report with 48 satellites takes 3,000 characters.
const CAPACITY: usize = 6144;

/// Answers, in the order of the requests.
pub struct Answers {
    file: File,
    text: String<CAPACITY>,
}

impl Answers {
    /// The file that the host will read.
    pub fn open() -> Option<Self> {
        Some(Self { file: File::to_write(b"answers.bin\0")?, text: String::new() })
    }

    /// Writes one.
    pub fn write(&mut self, ticks: u32, result: &impl fmt::Debug) -> Option<()> {
        self.text.clear();
        write!(self.text, "{result:?}").ok()?;
        let head = [ticks.to_le_bytes(), (self.text.len() as u32).to_le_bytes()];
        (self.file.write(head.as_flattened()) && self.file.write(self.text.as_bytes())).then_some(())
    }
}
