//! Keys of the owner for the authentication of navigation data, and what follows from a verdict.
//!
//! At start there is none, and the settings report no field for them, so that their hash is that of a
//! build without authentication. A key that is set is reported by its number and its first four
//! bytes.

use core::fmt::Write as _;

use heapless::String;

use super::Refusal;
use super::number::hexadecimal;
use super::read::{Values, next, next_whole};
use super::value::{Commands, Ranges, Spelled, Take, Value, range};

/// Word for a key that is not set.
const OFF: &str = "OFF";

/// Longest field of hexadecimal digits in an answer, bytes. A command may divide a key as it likes.
const PART: usize = 17;

/// Order of the field of P-256, which the first coordinate of a point is less than.
const FIELD: [u8; 32] = [
    0xff, 0xff, 0xff, 0xff, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 0xff,
    0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff,
];

/// First bytes of the key that the tests sign with. Anybody can read its secret, so that only builds with
/// the feature `test-key` take it.
const TEST_KEY: [u8; 8] = [0x89, 0xd1, 0x12, 0x40, 0x29, 0x58, 0x3d, 0x36];

/// Public key of OSNMA.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PublicKey {
    /// Number of the key, 1 to 15.
    pub number: u8,
    /// Point of the curve P-256, in the compressed form of SEC 1.
    pub point: [u8; 33],
}

/// Root of the tree that proves new keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TreeRoot(pub [u8; 32]);

/// What follows from the verdict on an ephemeris.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Authentication {
    /// Nothing is checked.
    Off,
    /// Verdicts are reported, and change nothing.
    Say,
    /// Ephemerides that are false are not used.
    Prefer,
    /// Of Galileo only proved ephemerides are used, and a promise takes four of them.
    Only,
}

impl Spelled for Option<PublicKey> {
    const RANGES: usize = 1;
    const WORDS: &'static [&'static str] = &[OFF];
}

impl Value for Option<PublicKey> {
    fn change(&mut self, values: Values<'_, '_>, ranges: &Ranges) -> Result<(), Refusal> {
        let first = next(values)?;
        *self = None;
        if first != OFF {
            let number = next_whole(&mut core::iter::once(first), range(ranges, 0))?;
            let mut point = [0; 33];
            read_bytes(values, &mut point)?;
            let [form, x @ ..] = &point;
            if !matches!(form, 2 | 3) || *x >= FIELD {
                return Err(Refusal::OutOfRange);
            }
            if cfg!(not(feature = "test-key")) && x.starts_with(&TEST_KEY) {
                return Err(Refusal::NotInBuild);
            }
            *self = Some(PublicKey { number, point });
        }
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        if let Some(PublicKey { number, point: [_, a, b, c, d, ..] }) = self {
            take("KEY");
            take(&whole(*number));
            take(&hexadecimal(u32::from_be_bytes([*a, *b, *c, *d])));
        }
    }

    fn tell(&self, take: Take<'_>) -> bool {
        match self {
            Some(PublicKey { number, point }) => {
                take(&whole(*number));
                tell_bytes(point, take);
            }
            None => take(OFF),
        }
        true
    }

    fn commands(&self) -> Commands {
        if self.is_some() { Commands::One } else { Commands::None }
    }
}

impl Spelled for Option<TreeRoot> {
    const RANGES: usize = 0;
    const WORDS: &'static [&'static str] = &[OFF];
}

impl Value for Option<TreeRoot> {
    fn change(&mut self, values: Values<'_, '_>, _: &Ranges) -> Result<(), Refusal> {
        let first = next(values)?;
        *self = None;
        if first != OFF {
            let mut root = [0; 32];
            read_bytes(&mut core::iter::once(first).chain(values), &mut root)?;
            *self = Some(TreeRoot(root));
        }
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        if let Some(TreeRoot([a, b, c, d, ..])) = self {
            take("ROOT");
            take(&hexadecimal(u32::from_be_bytes([*a, *b, *c, *d])));
        }
    }

    fn tell(&self, take: Take<'_>) -> bool {
        match self {
            Some(TreeRoot(root)) => tell_bytes(root, take),
            None => take(OFF),
        }
        true
    }

    fn commands(&self) -> Commands {
        if self.is_some() { Commands::One } else { Commands::None }
    }
}

impl Authentication {
    /// Words, in the order of the variants.
    const ALL: [(&'static str, Self); 4] =
        [(OFF, Self::Off), ("SAY", Self::Say), ("PREFER", Self::Prefer), ("ONLY", Self::Only)];

    fn word(self) -> &'static str {
        let found = Self::ALL.iter().find(|(_, meaning)| *meaning == self);
        found.map_or("", |(word, _)| word)
    }
}

impl Spelled for Authentication {
    const RANGES: usize = 0;
    const WORDS: &'static [&'static str] = &[OFF, "SAY", "PREFER", "ONLY"];
}

impl Value for Authentication {
    fn change(&mut self, values: Values<'_, '_>, _: &Ranges) -> Result<(), Refusal> {
        let word = next(values)?;
        let found = Self::ALL.iter().find(|(known, _)| *known == word);
        *self = found.map(|(_, meaning)| *meaning).ok_or(Refusal::UnknownValue)?;
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        if *self != Self::Say {
            take("AUTH");
            take(self.word());
        }
    }

    fn tell(&self, take: Take<'_>) -> bool {
        take(self.word());
        true
    }

    fn commands(&self) -> Commands {
        if *self == Self::Say { Commands::None } else { Commands::One }
    }
}

/// Returns a number of at most two digits as text.
fn whole(number: u8) -> String<3> {
    let mut text = String::new();
    for digit in [number / 10, number % 10] {
        if digit > 0 || !text.is_empty() {
            let _ = text.push(char::from(b'0' + digit % 10));
        }
    }
    text
}

/// Reads bytes from fields of hexadecimal digits, two digits a byte.
fn read_bytes(values: Values<'_, '_>, bytes: &mut [u8]) -> Result<(), Refusal> {
    let mut places = bytes.iter_mut();
    while places.len() > 0 {
        let (pairs, rest) = next(values)?.as_bytes().as_chunks::<2>();
        if !rest.is_empty() {
            return Err(Refusal::OutOfRange);
        }
        for [upper, lower] in pairs {
            let digit = |byte: &u8| char::from(*byte).to_digit(16).ok_or(Refusal::NotANumber);
            let byte = digit(upper)? << 4 | digit(lower)?;
            *places.next().ok_or(Refusal::OutOfRange)? = byte as u8;
        }
    }
    Ok(())
}

fn tell_bytes(bytes: &[u8], take: Take<'_>) {
    let mut rest = bytes;
    while !rest.is_empty() {
        let (part, behind) = rest.split_at(rest.len().min(PART));
        let mut text = String::<{ 2 * PART }>::new();
        for byte in part {
            for digit in [byte >> 4, byte & 15] {
                let _ = text
                    .write_char(char::from_digit(u32::from(digit), 16).unwrap_or('0').to_ascii_uppercase());
            }
        }
        take(&text);
        rest = behind;
    }
}
