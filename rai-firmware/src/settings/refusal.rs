//! Reasons for which a command changes nothing, in words that fit an answer.

use embedded_io::Write;
use raim_core::internals::integrity::raim::detection::threshold::{self, ThresholdError};
use raim_core::internals::numeric::probability::Probability;

use super::scientific;
use crate::output::nmea::write_refusal;

/// Reason for which a command changed nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Refusal {
    /// The checksum is missing or does not match.
    Checksum,
    /// The line is longer than [`super::MAX_LINE`].
    TooLong,
    /// No setting or order has this key.
    UnknownKey,
    /// A value is missing.
    MissingValue,
    /// There are more values than the key takes.
    ExtraValue,
    /// A value is not one of the key's words.
    UnknownValue,
    /// Key or word is known, but this build lacks it.
    NotInBuild,
    /// A value is not a decimal number.
    NotANumber,
    /// A number is outside the key's range.
    OutOfRange,
    /// All eight coefficients are zero. Receivers report this if they have no coefficients; it is
    /// no model of an ionosphere.
    AllZero,
    /// The probability is not in the tables.
    NotInTables {
        /// Probability in the tables with the closest ratio, in its place there, so that every
        /// outcome of a command fits two registers.
        nearest: &'static Probability,
    },
}

impl From<ThresholdError> for Refusal {
    fn from(error: ThresholdError) -> Self {
        let (tables, nearest) = match error {
            ThresholdError::FalseAlarm { nearest, .. } => (threshold::false_alarms(), nearest),
            ThresholdError::MissedDetection { nearest, .. } => (threshold::missed_detections(), nearest),
            _ => return Self::OutOfRange,
        };
        // The error names one of the tables.
        let found = tables.iter().find(|known| known.get().to_bits() == nearest.get().to_bits());
        found.map_or(Self::OutOfRange, |nearest| Self::NotInTables { nearest })
    }
}

impl Refusal {
    const fn why(self) -> &'static str {
        match self {
            Self::Checksum => "checksum",
            Self::TooLong => "too long",
            Self::UnknownKey => "unknown key",
            Self::MissingValue => "missing value",
            Self::ExtraValue => "extra value",
            Self::UnknownValue => "unknown value",
            Self::NotInBuild => "not in this build",
            Self::NotANumber => "not a number",
            Self::OutOfRange => "out of range",
            Self::AllZero => "all zero",
            Self::NotInTables { .. } => "not in the tables",
        }
    }

    pub(super) fn answer<W: Write>(self, key: &str, host: &mut W) -> Result<(), W::Error> {
        match self {
            Self::NotInTables { nearest } => {
                let mut why = heapless::String::<40>::new();
                // Both pieces fit: at most 8 and 17 characters.
                let _ = why.push_str("nearest ");
                let _ = why.push_str(&scientific(nearest.get()));
                write_refusal(key, &why, host)
            }
            other => write_refusal(key, other.why(), host),
        }
    }
}
