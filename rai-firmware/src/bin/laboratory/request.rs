//! What the host asks for: a stage, a scalar, and what to run it on. Little-endian.
//!
//! | bytes | what |
//! |---|---|
//! | 4 | length of the rest |
//! | 1 | stage |
//! | 1 | scalar: 0 `f32`, 1 `f64` |
//! | … | the stage's input |

use heapless::Vec;

use crate::semihosting::{self, File};

/// Longest input: a dozen epochs of 45 satellites.
const CAPACITY: usize = 24 * 1024;

/// One request.
#[derive(Clone, Copy)]
pub struct Request<'b> {
    /// Which stage.
    pub stage: u8,
    /// In which scalar.
    pub is_double: bool,
    /// Its input.
    pub input: Input<'b>,
}

/// Numbers that are read from the front.
#[derive(Clone, Copy)]
pub struct Input<'b>(pub &'b [u8]);

impl Input<'_> {
    /// The next byte.
    pub fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    /// The next double.
    pub fn double(&mut self) -> Option<f64> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(f64::from_le_bytes(*first))
    }
}

/// All requests, one at a time.
pub struct Requests {
    file: File,
    buffer: Vec<u8, CAPACITY>,
}

impl Requests {
    /// The file that the host has prepared.
    pub fn open() -> Option<Self> {
        Some(Self { file: File::to_read(b"requests.bin\0")?, buffer: Vec::new() })
    }

    /// The next one; `None` at the end.
    pub fn next(&mut self) -> Option<Request<'_>> {
        let mut length = [0; 4];
        if !self.file.fill(&mut length) {
            return None;
        }
        let fits = self.buffer.resize(u32::from_le_bytes(length) as usize, 0).is_ok();
        if !fits || !self.file.fill(&mut self.buffer) {
            // Half a request is no end.
            semihosting::exit(false)
        }
        let (head, input) = self.buffer.split_first_chunk()?;
        let [stage, scalar] = *head;
        Some(Request { stage, is_double: scalar == 1, input: Input(input) })
    }
}
