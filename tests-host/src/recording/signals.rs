//! Conversion of the fields of a satellite's record to signals.
//!
//! Codes become those of RINEX 3.05, see [`Field::new`].
//! References: [RINEX-2.11] table A1, [RINEX-3.05] tables 12 to 18.
//!
//! [RINEX-2.11]: crate#references
//! [RINEX-3.05]: crate#references

use anyhow::{Result, ensure};
use raim_core::satellite::Constellation;

use super::header::Header;
use super::text::{columns, number};
use crate::measurement::MeasuredSignal;

/// Fields of the records of each system, by the system's letter.
pub(super) struct Fields(Vec<(char, Vec<Option<Field>>)>);

impl Fields {
    /// Letters of the systems that are read; a QZSS satellite has the signals of GPS.
    const SYSTEMS: [(char, Constellation); 5] = [
        ('G', Constellation::Gps),
        ('C', Constellation::Beidou),
        ('E', Constellation::Galileo),
        ('R', Constellation::Glonass),
        ('J', Constellation::Gps),
    ];

    /// Returns the fields that the header lists.
    pub(super) fn of(header: &Header) -> Self {
        let fields = |(letter, constellation)| {
            let codes = header.codes.of(letter).ok()?;
            let field = |code: &String| Field::new(constellation, code, header.version);
            Some((letter, codes.iter().map(field).collect()))
        };
        Self(Self::SYSTEMS.into_iter().filter_map(fields).collect())
    }

    /// Returns true for the letter of a system that is read.
    pub(super) fn is_read(letter: char) -> bool {
        Self::SYSTEMS.iter().any(|(system, _)| *system == letter)
    }

    /// Returns the fields of a system; `None` if the header lists none.
    pub(super) fn of_system(&self, letter: char) -> Option<&[Option<Field>]> {
        self.0.iter().find(|(system, _)| *system == letter).map(|(_, fields)| fields.as_slice())
    }
}

/// Signals of one satellite, and the number of unreadable values beside their pseudoranges.
pub(super) struct Signals {
    pub(super) signals: Vec<MeasuredSignal>,
    pub(super) damaged: u64,
}

/// Returns the signals of one satellite that have a pseudorange; blank and zero mean none.
///
/// # Errors
/// A pseudorange is not a number with a decimal point, so that the fields after it may have moved.
pub(super) fn signals(fields: &[Option<Field>], values: &str) -> Result<Signals> {
    let mut found = Signals { signals: Vec::new(), damaged: 0 };
    let mut others: Vec<(Field, f64)> = Vec::new();
    for (index, field) in fields.iter().enumerate() {
        let (Some(field), column) = (field, 16 * index) else { continue };
        let text = columns(values, column, column + 14);
        let value = match (measured(text), field.quantity) {
            (Err(error), Quantity::Pseudorange) => return Err(error),
            (Err(_), _) => {
                found.damaged += 1;
                None
            }
            (Ok(value), _) => value.filter(|value| *value != 0.0),
        };
        match (value, field.quantity) {
            (None, _) => {}
            (Some(range_m), Quantity::Pseudorange) => {
                found.signals.extend(field.signal(range_m, columns(values, column + 15, column + 16)));
            }
            (Some(value), _) => others.push((*field, value)),
        }
    }
    for (field, value) in others {
        found
            .signals
            .iter_mut()
            .filter(|signal| field.belongs_to(signal))
            .for_each(|signal| field.complete(signal, value));
    }
    Ok(found)
}

/// Reads a measured value, which always has a decimal point, because a number without one was cut.
fn measured(text: &str) -> Result<Option<f64>> {
    ensure!(text.is_empty() || text.contains('.'), "`{text}` has no decimal point");
    number(text)
}

/// Quantity that a field measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Pseudorange,
    CarrierPhase,
    SignalToNoise,
    Doppler,
}

/// One field of a satellite's record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Field {
    quantity: Quantity,
    band: u8,
    /// Attribute; `None` if RINEX 2 has a quantity per band only.
    attribute: Option<char>,
}

impl Field {
    /// Returns the field of a code as RINEX 3.05 names signals; `None` if RAI does not use it.
    ///
    /// `BeiDou`'s B1I at 1561.098 MHz has been band 2 since RINEX 3.03 and was band 1 in 3.02.
    /// RINEX 2 names the band alone, so that the attribute is the one in common use there.
    fn new(constellation: Constellation, code: &str, version: u16) -> Option<Self> {
        let mut letters = code.chars();
        let letter = letters.next()?;
        let quantity = match letter {
            'C' | 'P' => Quantity::Pseudorange,
            'L' => Quantity::CarrierPhase,
            'S' => Quantity::SignalToNoise,
            'D' => Quantity::Doppler,
            _ => return None,
        };
        let band = letters.next()?.to_digit(10)? as u8;
        let attribute = letters.next();
        let is_b1i = constellation == Constellation::Beidou
            && band == 1
            && (version < 303 || matches!(attribute, Some('I' | 'Q')));
        let band = if is_b1i { 2 } else { band };
        match (version < 300, quantity) {
            (false, _) => attribute.map(|attribute| Self { quantity, band, attribute: Some(attribute) }),
            (true, Quantity::Pseudorange) => {
                Some(Self { quantity, band, attribute: Some(attribute_2(constellation, letter, band)) })
            }
            (true, _) => Some(Self { quantity, band, attribute: None }),
        }
    }

    fn belongs_to(self, signal: &MeasuredSignal) -> bool {
        self.band == signal.band && self.attribute.is_none_or(|attribute| attribute == signal.attribute)
    }

    /// Returns a signal with this pseudorange. Until a field has C/N0, it is the middle of the
    /// class that the digit beside the value names: class `k` of 2 to 9 goes from `6 k` to
    /// `6 k + 6` dB-Hz.
    fn signal(self, pseudorange_m: f64, strength: &str) -> Option<MeasuredSignal> {
        let class = strength.parse::<u8>().ok().filter(|class| *class > 0);
        let cn0_dbhz = class.map(|class| 6.0 * f64::from(class) + 3.0);
        Some(MeasuredSignal {
            band: self.band,
            attribute: self.attribute?,
            pseudorange_m,
            carrier_cycles: None,
            cn0_dbhz,
            doppler_hz: None,
        })
    }

    fn complete(self, signal: &mut MeasuredSignal, value: f64) {
        match self.quantity {
            Quantity::CarrierPhase => signal.carrier_cycles = Some(value),
            Quantity::SignalToNoise => signal.cn0_dbhz = Some(value),
            Quantity::Doppler => signal.doppler_hz = Some(value),
            Quantity::Pseudorange => {}
        }
    }
}

/// Returns the component of the signal of a pseudorange, which RINEX 2 does not state.
fn attribute_2(constellation: Constellation, letter: char, band: u8) -> char {
    match (constellation, letter, band) {
        (Constellation::Gps, 'P', _) => 'W',
        (_, 'P', _) => 'P',
        (Constellation::Gps | Constellation::Glonass, _, 1) | (Constellation::Glonass, ..) => 'C',
        (Constellation::Beidou, ..) => 'I',
        _ => 'X',
    }
}
