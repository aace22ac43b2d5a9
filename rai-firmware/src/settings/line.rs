//! Assembles bytes to lines: `$PRAIC,key,value…*CS`, ended by CR or LF, among anything else on the
//! wire.
//!
//! A `$` begins a line wherever it stands, so that garbage costs at most the line that contains it.
//! A character that no sentence contains (NUL, other controls, non-ASCII) ends the line early. No
//! line grows beyond [`MAX_LINE`].

use heapless::String;

use super::fields::{Fields, cut};

/// Longest line accepted, without `$` and line end. It exceeds the 82 characters of a sentence
/// because eight ionospheric coefficients of twelve digits do not fit into these.
pub const MAX_LINE: usize = 192;

/// Longest part of an unknown key that an answer repeats.
const KEY_WIDTH: usize = 16;

/// Address of a command.
const ADDRESS: &str = "PRAIC";

/// Defect of a line that contains no command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineError {
    /// A line with another address.
    Foreign,
    /// A line cut by a character that belongs to no sentence, or by the next `$`.
    Noise,
    /// A command longer than [`MAX_LINE`].
    TooLong,
}

/// Line that is not yet complete.
#[derive(Clone, Debug, Default)]
pub(super) struct LineAssembler {
    /// Text after `$`.
    text: String<MAX_LINE>,
    inside: bool,
}

impl LineAssembler {
    pub(super) const fn new() -> Self {
        Self { text: String::new(), inside: false }
    }

    /// Takes a byte; returns the line that it ends, or the defect of that line.
    pub(super) fn push(&mut self, byte: u8) -> Option<Result<Line<'_>, LineError>> {
        match (byte, self.inside) {
            (b'$', broken_off) => {
                self.text.clear();
                self.inside = true;
                broken_off.then_some(Err(LineError::Noise))
            }
            (_, false) => None,
            (b'\r' | b'\n', true) => {
                self.inside = false;
                Some(Line::new(&self.text))
            }
            (b' '..=b'~', true) => self.append(byte).err().map(Err),
            (_, true) => {
                self.inside = false;
                Some(Err(LineError::Noise))
            }
        }
    }

    fn append(&mut self, byte: u8) -> Result<(), LineError> {
        self.text.push(char::from(byte)).map_err(|_| {
            self.inside = false;
            if self.text.starts_with(ADDRESS) { LineError::TooLong } else { LineError::Foreign }
        })
    }
}

/// A line addressed to the module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Line<'l> {
    /// Text that the checksum covers.
    body: &'l str,
    /// Text after the star; empty without one.
    checksum: &'l str,
    key: &'l str,
    /// Values behind the key, with commas between them; `None` without a comma behind the key.
    values: Option<&'l str>,
}

impl<'l> Line<'l> {
    fn new(text: &'l str) -> Result<Self, LineError> {
        let (body, checksum) = cut(text, b'*').unwrap_or((text, ""));
        let (address, fields) = cut(body, b',').unwrap_or((body, ""));
        if address != ADDRESS {
            return Err(LineError::Foreign);
        }
        let (key, values) = cut(fields, b',').map_or((fields, None), |(key, rest)| (key, Some(rest)));
        Ok(Self { body, checksum, key, values })
    }

    /// Returns a line that did not come over a wire, and so has no checksum.
    pub(super) const fn without_checksum(key: &'l str, values: Option<&'l str>) -> Self {
        Self { body: "", checksum: "", key, values }
    }

    pub(super) fn checksum_matches(&self) -> bool {
        let computed = self.body.bytes().fold(0, |sum, byte| sum ^ byte);
        let both_hexadecimal =
            self.checksum.len() == 2 && self.checksum.bytes().all(|b| b.is_ascii_hexdigit());
        both_hexadecimal && u8::from_str_radix(self.checksum, 16) == Ok(computed)
    }

    pub(super) fn key(&self) -> &'l str {
        self.key
    }

    /// Returns the key, cut so that it fits into any answer.
    pub(super) fn short_key(&self) -> &'l str {
        self.key.get(..KEY_WIDTH).unwrap_or(self.key)
    }

    pub(super) fn values(&self) -> Fields<'l> {
        Fields::between_commas(self.values)
    }
}
