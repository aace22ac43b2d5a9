//! Reports of the settings in force: the answer to a key without a value, and all of them in
//! `PRAIQ`.
//!
//! Each setting is reported in the words and numbers that set it, so that a host can send them
//! back. Fields that do not apply are empty.
//!
//! `$PRAIQ,hash,field…,n,m*CS`: the fields of all settings in the order of the table, in as many
//! sentences as they need. The last two fields of a sentence are its number and the number of
//! sentences. `hash` is the CRC-32 (IEEE 802.3, as in zlib) of all fields with commas between them,
//! as 8 hexadecimal digits.

use embedded_io::Write;

use super::number::hexadecimal;
use super::value::{Take, tell};
use super::{Configuration, Setting};
use crate::output::nmea::{Flow, write_flow};

impl Configuration {
    /// Returns the CRC-32 of all settings as `PRAIQ` reports them.
    pub fn hash(&self) -> u32 {
        self.hash_of(|_| true)
    }

    /// Returns the CRC-32 of the settings that affect a verdict of protected.
    pub fn promise_hash(&self) -> u32 {
        self.hash_of(|setting| setting.row().bears_on_promise)
    }

    #[inline(never)]
    fn hash_of(&self, counts: fn(Setting) -> bool) -> u32 {
        let mut crc = Crc32::new();
        let mut is_first = true;
        self.say_all(counts, &mut |field| {
            if !core::mem::take(&mut is_first) {
                crc.push(b',');
            }
            field.bytes().for_each(|byte| crc.push(byte));
        });
        crc.value()
    }

    /// Writes `PRAIQ`.
    ///
    /// # Errors
    /// The writer's own.
    pub fn write<W: Write>(&self, host: &mut W) -> Result<(), W::Error> {
        let hash = hexadecimal(self.hash());
        let flow = Flow { address: "PRAIQ", first: &hash, last: None };
        write_flow(&flow, &|take| self.say_all(|_| true, take), host)
    }

    /// Answers a key without a value.
    pub(super) fn answer<W: Write>(&self, setting: Setting, host: &mut W) -> Result<(), W::Error> {
        let flow = Flow { address: "PRAIA", first: setting.key(), last: Some("OK") };
        write_flow(&flow, &|take| tell(self.value(setting), take), host)
    }

    fn say_all(&self, counts: fn(Setting) -> bool, take: Take<'_>) {
        for setting in Setting::ALL.iter().filter(|setting| counts(**setting)) {
            self.value(*setting).say(take);
        }
    }

    /// Passes the fields of one setting in `PRAIQ` to `take`.
    pub fn fields(&self, setting: Setting, take: &mut dyn FnMut(&str)) {
        self.value(setting).say(take);
    }
}

/// CRC-32 of IEEE 802.3, bit by bit, because settings rarely change and a table would take a
/// kilobyte.
pub(super) struct Crc32(u32);

impl Crc32 {
    pub(super) const fn new() -> Self {
        Self(!0)
    }

    pub(super) fn push(&mut self, byte: u8) {
        self.0 ^= u32::from(byte);
        for _ in 0..8 {
            self.0 = self.0 >> 1 ^ (0xEDB8_8320 & (self.0 & 1).wrapping_neg());
        }
    }

    pub(super) const fn value(&self) -> u32 {
        !self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksum_is_that_of_the_standard_example() {
        let mut crc = Crc32::new();
        b"123456789".iter().for_each(|byte| crc.push(*byte));
        assert_eq!(hexadecimal(crc.value()).as_str(), "CBF43926");
    }
}
