//! Records of satellites to their signals.
//!
//! Codes become those of RINEX 3.05, see [`Field::new`].
//! References: [RINEX-2.11] table A1, [RINEX-3.05] tables 12 to 18.
//!
//! [RINEX-2.11]: crate#references
//! [RINEX-3.05]: crate#references

use anyhow::{Result, ensure};
use raim_core::satellite::{Constellation, SatelliteId};

use super::header::Header;
use super::text::{columns, decimal, number};
use crate::signal::measurement::{MeasuredSatellite, MeasuredSignal};

/// The fields that are read of the records of each system, by the system's letter, and the column
/// of each. Pseudoranges come first, because the other quantities complete the signals that they
/// begin.
pub(super) struct Fields(Vec<(char, Vec<(usize, Field)>)>);

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
            let codes = header.codes.of(letter)?;
            let field = |(index, code): (usize, &String)| {
                Field::new(constellation, code, header.version).map(|field| (16 * index, field))
            };
            let mut fields: Vec<_> = codes.iter().enumerate().filter_map(field).collect();
            fields.sort_by_key(|(_, field)| field.quantity != Quantity::Pseudorange);
            Some((letter, fields))
        };
        Self(Self::SYSTEMS.into_iter().filter_map(fields).collect())
    }

    /// Returns true for the letter of a system that is read.
    fn is_read(letter: char) -> bool {
        Self::SYSTEMS.iter().any(|(system, _)| *system == letter)
    }

    /// The fields of a system; `None` if the header lists none.
    fn of_system(&self, letter: char) -> Option<&[(usize, Field)]> {
        self.0.iter().find(|(system, _)| *system == letter).map(|(_, fields)| fields.as_slice())
    }
}

/// Result of reading a satellite's record.
pub(super) enum Read {
    /// Measured signals, and the number of values beside the pseudoranges that cannot be read.
    Satellite(MeasuredSatellite, u64),
    /// A system that RAI does not know.
    OtherSystem,
    /// A system of which the header lists no observations.
    Unlisted,
    /// A satellite that its system does not have.
    Unknown,
    /// A record that cannot be read.
    Damaged,
}

/// One satellite from its fields, side by side.
pub(super) fn satellite(name: &str, values: &str, header: &Header, fields: &Fields) -> Read {
    let Some(letter) = system(name, header) else { return Read::Damaged };
    let digits = name.trim_start_matches(letter).trim();
    let Ok(number) = digits.parse() else { return Read::Damaged };
    if !Fields::is_read(letter) {
        return if letter.is_ascii_uppercase() { Read::OtherSystem } else { Read::Damaged };
    }
    let Some(satellite) = SatelliteId::from_name(letter, number) else { return Read::Unknown };
    let Some(fields) = fields.of_system(letter) else { return Read::Unlisted };
    match signals(fields, values) {
        Ok(found) => Read::Satellite(MeasuredSatellite { satellite, signals: found.signals }, found.damaged),
        Err(_) => Read::Damaged,
    }
}

/// The letter of a satellite's system; RINEX 2 may leave it blank where the header names the only
/// one.
fn system(name: &str, header: &Header) -> Option<char> {
    match name.chars().next()? {
        letter if letter.is_ascii_alphabetic() => Some(letter),
        ' ' | '0'..='9' if header.version < 300 => {
            Some(if header.system == 'M' { 'G' } else { header.system })
        }
        _ => None,
    }
}

/// The signals of one satellite, and how many of the values beside their pseudoranges cannot be
/// read.
struct Signals {
    signals: Vec<MeasuredSignal>,
    damaged: u64,
}

/// Returns the signals of one satellite that have a pseudorange; blank and zero mean none.
///
/// # Errors
/// A pseudorange that is no number with a decimal point, because what follows it may have moved.
fn signals(fields: &[(usize, Field)], values: &str) -> Result<Signals> {
    let ranges = fields.iter().take_while(|(_, field)| field.quantity == Quantity::Pseudorange).count();
    let mut found = Signals { signals: Vec::with_capacity(ranges), damaged: 0 };
    for &(column, field) in fields {
        let value = match (value(values, column), field.quantity) {
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
            (Some(value), _) => found
                .signals
                .iter_mut()
                .filter(|signal| field.belongs_to(signal))
                .for_each(|signal| field.complete(signal, value)),
        }
    }
    Ok(found)
}

/// Reads the measured value that begins in a column; `None` for blank columns. It always has a
/// decimal point, because a number without one was cut.
fn value(values: &str, column: usize) -> Result<Option<f64>> {
    let Some(rest) = values.as_bytes().get(column..) else { return Ok(None) };
    let plain = decimal(rest.get(..14).unwrap_or(rest));
    if plain.is_some() {
        return Ok(plain);
    }
    let text = columns(values, column, column + 14);
    ensure!(text.is_empty() || text.bytes().any(|byte| byte == b'.'), "`{text}` has no decimal point");
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
struct Field {
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
