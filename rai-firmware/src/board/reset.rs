//! Cause of a reset: flags of the chip, and the record that a failed program leaves.
//!
//! A program that has failed cannot report it. It leaves a [`Record`] in memory that start-up does
//! not clear, and resets the chip. The next start reads the record and reports the fault. After
//! power-on the memory has random contents, so that a record counts only if its seal fits: `seal =
//! magic ⊕ kind ⊕ rotl(place, 8) ⊕ rotl(line, 16)`.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `kind` | kind of failure | 1 panic, 2 hard fault, 3 clock failure |
//! | `place` | address of the instruction, or FNV-1a hash of the source file's name | – |
//! | `line` | line of the source file, 0 if there is none | – |

use heapless::String;

use crate::settings::hexadecimal;

/// Mark of a record, chosen to be improbable in memory after power-on.
const MAGIC: u32 = 0x5241_4921;

/// Largest number of characters in the name of a cause.
pub const WORD_BYTES: usize = 16;

/// Cause of the last reset, written in at most [`WORD_BYTES`] characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ResetCause {
    /// The supply came up.
    PowerOn,
    /// The reset line was pulled, by a button or a debug probe.
    Pin,
    /// The program requested it.
    Software,
    /// The epoch loop did not feed the watchdog in time.
    Watchdog,
    /// The supply dipped.
    Brownout,
    /// A low-power mode was entered against the option bytes.
    LowPower,
    /// The program before this one failed.
    Fault(Fault),
    /// The chip has no flag set.
    Unknown,
}

/// Failure of the previous program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// A panic in a source file, at a line.
    Panic {
        /// [`hash`] of the source file's name.
        file: u32,
        /// Line in the file.
        line: u32,
    },
    /// The processor refused an instruction.
    Hard {
        /// Program counter at the fault; 0 if the stack frame was not valid.
        address: u32,
    },
    /// The crystal stopped while the module ran from it.
    Clock,
}

impl ResetCause {
    /// Returns the name of the cause.
    pub fn word(self) -> String<WORD_BYTES> {
        let (word, number) = match self {
            Self::PowerOn => ("POWERON", None),
            Self::Pin => ("PIN", None),
            Self::Software => ("SOFTWARE", None),
            Self::Watchdog => ("WATCHDOG", None),
            Self::Brownout => ("BROWNOUT", None),
            Self::LowPower => ("LOWPOWER", None),
            Self::Unknown => ("UNKNOWN", None),
            Self::Fault(Fault::Clock) => ("CLOCKFAIL", None),
            Self::Fault(Fault::Panic { file, .. }) => ("PANIC-", Some(file)),
            Self::Fault(Fault::Hard { address }) => ("FAULT-", Some(address)),
        };
        let mut text = String::new();
        // This never fails, because every cause fits.
        let _ = text.push_str(word);
        let _ = number.map(|number| text.push_str(&hexadecimal(number)));
        text
    }
}

/// A fault as stored in memory across a reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Record {
    kind: u32,
    place: u32,
    line: u32,
    seal: u32,
}

impl Record {
    /// Record without a fault, which start-up leaves.
    pub const EMPTY: Self = Self { kind: 0, place: 0, line: 0, seal: 0 };

    /// Returns the sealed record of `fault`.
    pub const fn of(fault: Fault) -> Self {
        let (kind, place, line) = match fault {
            Fault::Panic { file, line } => (1, file, line),
            Fault::Hard { address } => (2, address, 0),
            Fault::Clock => (3, 0, 0),
        };
        Self { kind, place, line, seal: seal(kind, place, line) }
    }

    /// Returns the fault, if the seal fits.
    pub const fn fault(self) -> Option<Fault> {
        if self.seal != seal(self.kind, self.place, self.line) {
            return None;
        }
        match self.kind {
            1 => Some(Fault::Panic { file: self.place, line: self.line }),
            2 => Some(Fault::Hard { address: self.place }),
            3 => Some(Fault::Clock),
            _ => None,
        }
    }
}

const fn seal(kind: u32, place: u32, line: u32) -> u32 {
    MAGIC ^ kind ^ place.rotate_left(8) ^ line.rotate_left(16)
}

/// Returns the FNV-1a hash of a source file's name, which gives the place of a panic in four bytes.
pub const fn hash(name: &str) -> u32 {
    let mut hash = 0x811C_9DC5_u32;
    let mut rest = name.as_bytes();
    while let [byte, tail @ ..] = rest {
        hash = (hash ^ *byte as u32).wrapping_mul(0x0100_0193);
        rest = tail;
    }
    hash
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn record_survives_and_noise_is_no_record() {
        let faults = [
            Fault::Panic { file: 0xDEAD_BEEF, line: 321 },
            Fault::Hard { address: 0x0800_1234 },
            Fault::Clock,
        ];
        for want in faults {
            assert_eq!(Record::of(want).fault(), Some(want));
        }
        for noise in [0, u32::MAX, 0xCCCC_CCCC, 0x5555_AAAA] {
            let record = Record { kind: noise, place: noise, line: noise, seal: noise };
            assert_eq!(record.fault(), None, "memory full of {noise:#010x}");
        }
        assert_eq!(Record::EMPTY.fault(), None);
    }

    #[test]
    fn one_flipped_bit_voids_a_record() {
        for bit in 0..32 {
            let mut record = Record::of(Fault::Hard { address: 0x0800_1234 });
            record.place ^= 1 << bit;
            assert_eq!(record.fault(), None, "bit {bit}");
        }
    }

    #[test]
    fn hash_is_fnv_1a() {
        // Test vectors of the FNV reference distribution.
        assert_eq!(hash(""), 0x811C_9DC5);
        assert_eq!(hash("a"), 0xE40C_292C);
        assert_eq!(hash("foobar"), 0xBF9C_F968);
    }

    #[test]
    fn words_fit_a_field_of_a_sentence() {
        let panic = ResetCause::Fault(Fault::Panic { file: 0xBF9C_F968, line: 99_999 }).word();
        assert_eq!(panic, "PANIC-BF9CF968");
        let hard = ResetCause::Fault(Fault::Hard { address: 0x0800_1234 }).word();
        assert_eq!(hard, "FAULT-08001234");
        assert!(panic.len().max(hard.len()) <= WORD_BYTES);
    }
}
