//! Bytes to lines: `$PRAIC,key,value…*CS`, ended by CR or LF, out of whatever else is on the wire.
//!
//! A `$` begins a line wherever it stands, so that garbage costs at most the line it is in. A
//! character that no sentence contains (NUL, other controls, anything beyond ASCII) breaks the line
//! off. Nothing grows beyond [`MAX_LINE`].

use heapless::String;

use super::fields::{Fields, cut};

/// Longest line accepted, `$` and line end not counted. Longer than a sentence may be: eight
/// ionospheric coefficients of twelve digits do not fit into 82 characters.
pub const MAX_LINE: usize = 192;

/// Longest part of an unknown key that an answer repeats.
const KEY_WIDTH: usize = 16;

/// The address of a command.
const ADDRESS: &str = "PRAIC";

/// Why there is no command in what came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineError {
    /// A line that is addressed to somebody else.
    Foreign,
    /// A line was broken off, by a character that belongs to no sentence or by the next `$`.
    Noise,
    /// A command that outgrew [`MAX_LINE`].
    TooLong,
}

/// A line in the making.
#[derive(Clone, Debug, Default)]
pub(super) struct LineAssembler {
    /// What stands after `$`.
    text: String<MAX_LINE>,
    inside: bool,
}

impl LineAssembler {
    pub(super) const fn new() -> Self {
        Self { text: String::new(), inside: false }
    }

    /// Takes a byte; a line or what was wrong with it, where the byte ends one.
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
    /// What the checksum covers.
    body: &'l str,
    /// What stands after the star; empty without one.
    checksum: &'l str,
    /// Key and values.
    fields: &'l str,
}

impl<'l> Line<'l> {
    fn new(text: &'l str) -> Result<Self, LineError> {
        let (body, checksum) = cut(text, ['*', '*']).unwrap_or((text, ""));
        let (address, fields) = cut(body, [',', ',']).unwrap_or((body, ""));
        if address == ADDRESS { Ok(Self { body, checksum, fields }) } else { Err(LineError::Foreign) }
    }

    pub(super) fn checksum_matches(&self) -> bool {
        let computed = self.body.bytes().fold(0, |sum, byte| sum ^ byte);
        let both_hexadecimal =
            self.checksum.len() == 2 && self.checksum.bytes().all(|b| b.is_ascii_hexdigit());
        both_hexadecimal && u8::from_str_radix(self.checksum, 16) == Ok(computed)
    }

    pub(super) fn key(&self) -> &'l str {
        Fields::of(self.fields).next().unwrap_or_default()
    }

    /// The key, cut so that any answer has room for it.
    pub(super) fn short_key(&self) -> &'l str {
        self.key().get(..KEY_WIDTH).unwrap_or(self.key())
    }

    pub(super) fn values(&self) -> Fields<'l> {
        let mut fields = Fields::of(self.fields);
        let _ = fields.next();
        fields
    }
}
