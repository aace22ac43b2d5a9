//! Request of the host: a stage, a scalar, and the stage's input. Little-endian.
//!
//! | bytes | what |
//! |---|---|
//! | 4 | length of the rest |
//! | 1 | stage |
//! | 1 | scalar: 0 `f32`, 1 `f64` |
//! | … | the stage's input |

use heapless::Vec;

use crate::semihosting::{self, File};

/// Most bytes of an input: a dozen epochs of 45 satellites.
const CAPACITY: usize = 24 * 1024;

/// One request.
#[derive(Clone, Copy)]
pub struct Request<'b> {
    /// Number of the stage.
    pub stage: u8,
    /// True for double precision.
    pub is_double: bool,
    /// Input of the stage.
    pub input: Input<'b>,
}

/// Bytes from which numbers are read, first to last.
#[derive(Clone, Copy)]
pub struct Input<'b>(pub &'b [u8]);

impl Input<'_> {
    /// Reads the next byte.
    pub fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    /// Reads the next double.
    pub fn double(&mut self) -> Option<f64> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(f64::from_le_bytes(*first))
    }
}

/// Reader of all requests, one at a time.
pub struct Requests {
    file: File,
    buffer: Vec<u8, CAPACITY>,
}

impl Requests {
    /// Opens the file that the host has prepared.
    pub fn open() -> Option<Self> {
        Some(Self { file: File::to_read(b"requests.bin\0")?, buffer: Vec::new() })
    }

    /// Reads the next request; `None` at the end.
    pub fn next(&mut self) -> Option<Request<'_>> {
        let mut length = [0; 4];
        if !self.file.fill(&mut length) {
            return None;
        }
        let fits = self.buffer.resize(u32::from_le_bytes(length) as usize, 0).is_ok();
        if !fits || !self.file.fill(&mut self.buffer) {
            // Half a request is an error.
            semihosting::exit(false)
        }
        let (head, input) = self.buffer.split_first_chunk()?;
        let [stage, scalar] = *head;
        Some(Request { stage, is_double: scalar == 1, input: Input(input) })
    }
}
