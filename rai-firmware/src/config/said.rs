//! What is in force, said: as the answer to a key without a value, and all of it in `PRAIQ`.
//!
//! Each setting is said in the words and numbers in which it is set, so that what is said can be sent back. Fields that
//! do not apply are empty; so is what this build does not do.
//!
//! `$PRAIQ,hash,field…,n,m*CS`: the fields of all settings, one behind another, in as many sentences as they need; the last
//! two fields of each are its number and how many there are. `hash` is the CRC-32 (IEEE 802.3, as zlib has it) of all
//! fields with commas between them, 8 hexadecimal digits.
//!
//! | fields | key |
//! |---|---|
//! | 1 to 11 | `PHASE`, `HAL`, `VAL`, `PFA`, `PMD`, `PFF`, `TTA`, `POLICY`, `METHOD`, `LEVELS`, `SYSTEMS` |
//! | 12 to 14 | `MASK`, `CLOCKAID`, `CN0MASK` |
//! | 15 to 19 | `VMAX`, `HEIGHT` (two), `RECOVER` (two) |
//! | 20 to 22 | `FREQ`, `SIGMA`, `BAUD` |
//! | 23 to 30 | `IONO`: eight coefficients, or `AUTO` (what satellites broadcast) and seven empty fields |
//! | 31 to 41 | `OUTPUT`: every how many epochs, in the order of [`crate::output::schedule`] |
//! | 42 | `ISM`: the preset |
//! | 43 to 62 | `ISM`: the five values of G, C, E and R; empty where the preset's count |

use embedded_io::Write;
use heapless::String;

use super::key::Key;
use super::number::{hexadecimal, plain, signed_scientific};
use super::promises::{VALUES, say as say_support};
use super::words::{
    BIT_RATES, FREQUENCIES, LEVELS, METHODS, PHASES, POLICIES, SIGMAS, SUPPORTS, SWITCH, word,
};
use super::{Configuration, scientific};
use crate::output::nmea::{Flow, write_flow};

/// The settings, in the order in which they are said.
pub(super) const ORDER: [Key; 23] = [
    Key::Phase,
    Key::HorizontalAlertLimit,
    Key::VerticalAlertLimit,
    Key::FalseAlarm,
    Key::MissedDetection,
    Key::FaultFree,
    Key::TimeToAlert,
    Key::Policy,
    Key::Method,
    Key::Levels,
    Key::Systems,
    Key::Mask,
    Key::ClockAid,
    Key::SignalMask,
    Key::GreatestSpeed,
    Key::Heights,
    Key::Recovery,
    Key::Frequencies,
    Key::Sigma,
    Key::BitRate,
    Key::Ionosphere,
    Key::Output,
    Key::Support,
];

/// Takes one field.
type Take<'t> = &'t mut dyn FnMut(&str);

impl Configuration {
    /// CRC-32 of all settings as `PRAIQ` says them.
    pub fn hash(&self) -> u32 {
        let mut crc = Crc32::new();
        let mut is_first = true;
        self.say_all(&mut |field| {
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
        write_flow(&Flow { address: "PRAIQ", first: &hash, last: None }, &|take| self.say_all(take), host)
    }

    /// Answers a key without a value.
    pub(super) fn answer<W: Write>(&self, key: Key, host: &mut W) -> Result<(), W::Error> {
        let flow = Flow { address: "PRAIA", first: key.name(), last: Some("OK") };
        write_flow(&flow, &|take| self.say_answer(key, take), host)
    }

    fn say_all(&self, take: Take<'_>) {
        for key in ORDER {
            self.say(key, take);
        }
    }

    /// As [`Self::say`], without the fields that only keep places in `PRAIQ`.
    pub(super) fn say_answer(&self, key: Key, take: Take<'_>) {
        match (key, self.klobuchar) {
            (Key::Ionosphere, None) => take("AUTO"),
            (Key::Output, _) => {
                for (name, every) in self.outputs.rates() {
                    take(name);
                    take(&plain(f64::from(every)));
                }
            }
            (Key::Support, _) => {
                take(word(self.promises.base(), SUPPORTS));
                for (constellation, support) in self.promises.own() {
                    let Some(support) = support else { continue };
                    take(constellation.letter().encode_utf8(&mut [0; 4]));
                    say_support(&support, take);
                }
            }
            (Key::VerticalAlertLimit, _) if self.requirements.val_m.is_none() => take("OFF"),
            _ => self.say(key, take),
        }
    }

    /// Says one setting, always in the same number of fields.
    fn say(&self, key: Key, take: Take<'_>) {
        let required = &self.requirements;
        if !key.is_built() {
            let fields = if matches!(key, Key::Heights | Key::Recovery) { 2 } else { 1 };
            return (0..fields).for_each(|_| take(""));
        }
        match key {
            Key::Phase => take(word(self.phase, PHASES)),
            Key::HorizontalAlertLimit => take(&plain(required.hal_m)),
            Key::VerticalAlertLimit => take(&required.val_m.map(plain).unwrap_or_default()),
            Key::FalseAlarm => take(&scientific(required.false_alarm.get())),
            Key::MissedDetection => take(&scientific(required.missed_detection.get())),
            Key::FaultFree => take(&scientific(self.requirements.fault_free_risk.get())),
            Key::TimeToAlert => take(&plain(required.time_to_alert_s)),
            Key::Policy => take(word(self.policy, POLICIES)),
            Key::Method => take(word(self.method, METHODS)),
            Key::Levels => take(word(self.levels, LEVELS)),
            Key::Systems => {
                let mut letters = String::<5>::new();
                let kept =
                    super::Systems::LETTERS.into_iter().filter(|letter| self.systems.contains(*letter));
                // Five letters fit.
                kept.for_each(|letter| _ = letters.push(letter));
                take(&letters);
            }
            Key::Mask => take(&plain(self.mask_rad * (180.0 / core::f64::consts::PI))),
            Key::ClockAid => take(word(self.clock_aid, SWITCH)),
            Key::SignalMask => take(&plain(self.signal_mask_db_hz)),
            Key::GreatestSpeed => take(&plain(self.greatest_speed_m_s)),
            Key::Heights => {
                take(&plain(self.heights.least_m));
                take(&plain(self.heights.greatest_m));
            }
            Key::Recovery => {
                take(&plain(f64::from(self.recovery.epochs)));
                take(&plain(self.recovery.seconds));
            }
            Key::Frequencies => take(word(self.frequencies, FREQUENCIES)),
            Key::Sigma => take(word(self.sigma, SIGMAS)),
            Key::BitRate => take(word(self.bit_rate, BIT_RATES)),
            Key::Ionosphere => self.say_ionosphere(take),
            Key::Output => self.outputs.rates().for_each(|(_, every)| take(&plain(f64::from(every)))),
            Key::Support => {
                take(word(self.promises.base(), SUPPORTS));
                for (_, support) in self.promises.own() {
                    match support {
                        Some(support) => say_support(&support, take),
                        None => (0..VALUES).for_each(|_| take("")),
                    }
                }
            }
            _ => {}
        }
    }

    fn say_ionosphere(&self, take: Take<'_>) {
        match self.klobuchar {
            Some(coefficients) => coefficients.iter().for_each(|value| take(&signed_scientific(*value))),
            None => ["AUTO", "", "", "", "", "", "", ""].iter().for_each(|field| take(field)),
        }
    }
}

/// CRC-32 of IEEE 802.3, bit by bit: settings change seldom, and a table would take a kilobyte.
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
