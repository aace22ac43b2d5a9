//! Observation records to epochs: RINEX 2 in one layout, RINEX 3 and 4 in another.
//!
//! | | RINEX 2 | RINEX 3, 4 |
//! |---|---|---|
//! | satellites | named in the epoch line, twelve to a line | each before its own line |
//! | fields (14 columns of value, 2 of flags) | five to a line | all in one line |
//! | codes | `C1`, `P2`: band only | `C1C`, `C2W`: band and attribute |
//!
//! Codes become those of RINEX 3.05, see [`Field::new`]. Kept are the systems RAI knows; of these, satellites with a
//! pseudorange. Epochs of events (new site, header lines, cycle slips) carry no ranges; header lines inside them
//! are obeyed.
//! References: [RINEX-2.11] table A2, [RINEX-3.05] tables 12 to 18 and A3.
//!
//! [RINEX-2.11]: crate#references
//! [RINEX-3.05]: crate#references

use std::collections::HashMap;
use std::fmt::Write as _;

use anyhow::{Context, Result};
use rai_core::satellite::{Constellation, SatelliteId};

use super::calendar;
use super::header::Header;
use super::text::{Lines, columns, number};
use crate::measurement::{MeasuredEpoch, MeasuredSatellite, MeasuredSignal};

/// All epochs after the header, and how many records of systems that are not `wanted` could not be read.
pub(super) fn read(
    header: Header,
    lines: &mut Lines<'_>,
    wanted: &[Constellation],
) -> Result<(Vec<MeasuredEpoch>, u64)> {
    let mut reader = Reader { fields: fields(&header), header, wanted, malformed: 0 };
    let mut epochs = Vec::new();
    while let Some(line) = lines.next() {
        let begin = lines.number();
        let epoch = reader.epoch(line, lines);
        epochs.extend(epoch.with_context(|| format!("line {}, epoch from line {begin}", lines.number()))?);
    }
    Ok((epochs, reader.malformed))
}

struct Reader<'a> {
    /// Systems of which every record must be sound.
    wanted: &'a [Constellation],
    /// Records of other systems that are not.
    malformed: u64,
    header: Header,
    fields: HashMap<Constellation, Vec<Option<Field>>>,
}

/// What the epoch line says.
struct Opening<'a> {
    date: &'a str,
    flag: &'a str,
    count: usize,
}

impl Reader<'_> {
    /// The epoch that `line` opens; none for an event or a blank line.
    fn epoch(&mut self, line: &str, lines: &mut Lines<'_>) -> Result<Option<MeasuredEpoch>> {
        if line.trim().is_empty() {
            return Ok(None);
        }
        let opening = self.opening(line)?;
        if !matches!(opening.flag, "" | "0" | "1") {
            self.event(opening.count, lines)?;
            return Ok(None);
        }
        let time = calendar::instant(opening.date, self.header.time_system)?;
        let satellites = if self.header.version < 300 {
            self.satellites_2(line, opening.count, lines)?
        } else {
            self.satellites_3(opening.count, lines)?
        };
        Ok(Some(MeasuredEpoch { time, satellites }))
    }

    fn opening<'a>(&self, line: &'a str) -> Result<Opening<'a>> {
        let (date, flag) = if self.header.version < 300 { (0..26, 28) } else { (1..29, 31) };
        let count = columns(line, flag + 1, flag + 4);
        Ok(Opening {
            date: columns(line, date.start, date.end),
            flag: columns(line, flag, flag + 1),
            count: count.parse().with_context(|| format!("`{}` does not begin an epoch", line.trim()))?,
        })
    }

    /// Header lines in the middle may list other observations.
    fn event(&mut self, count: usize, lines: &mut Lines<'_>) -> Result<()> {
        for _ in 0..count {
            self.header.codes.read(lines.within("an event")?)?;
        }
        self.fields = fields(&self.header);
        Ok(())
    }

    fn satellites_3(&mut self, count: usize, lines: &mut Lines<'_>) -> Result<Vec<MeasuredSatellite>> {
        let mut satellites = Vec::with_capacity(count);
        for _ in 0..count {
            let line = lines.within("an epoch")?;
            let name = columns(line, 0, 3);
            let values = line.get(3..).unwrap_or("");
            satellites.extend(self.record(name, values)?);
        }
        Ok(satellites)
    }

    fn satellites_2(
        &mut self,
        opening: &str,
        count: usize,
        lines: &mut Lines<'_>,
    ) -> Result<Vec<MeasuredSatellite>> {
        let mut line = opening;
        let mut names = Vec::with_capacity(count);
        for index in 0..count {
            if index > 0 && index % 12 == 0 {
                line = lines.within("an epoch")?;
            }
            let column = 32 + 3 * (index % 12);
            names.push(line.get(column..(column + 3).min(line.len())).unwrap_or(""));
        }
        let mut satellites = Vec::with_capacity(count);
        for name in names {
            let height = self.header.codes.of(self.system(name))?.len().div_ceil(5);
            let mut values = String::with_capacity(80 * height);
            for _ in 0..height {
                // Five fields of 16 columns; trailing blanks may have been cut.
                let _ = write!(values, "{:80.80}", lines.within("an epoch")?);
            }
            satellites.extend(self.record(name, &values)?);
        }
        Ok(satellites)
    }

    /// The letter of a satellite's system; RINEX 2 may leave it blank where the header names the only one.
    fn system(&self, name: &str) -> char {
        match name.chars().next() {
            Some(letter) if letter.is_ascii_alphabetic() => letter,
            _ if self.header.system == 'M' => 'G',
            _ => self.header.system,
        }
    }

    /// One satellite's record; one that cannot be read, of a system that nobody asked for, is counted and passed over.
    fn record(&mut self, name: &str, values: &str) -> Result<Option<MeasuredSatellite>> {
        let system = Constellation::from_letter(self.system(name));
        let is_wanted = system.is_some_and(|system| self.wanted.contains(&system));
        match self.satellite(name, values) {
            Err(_) if !is_wanted => {
                self.malformed += 1;
                Ok(None)
            }
            read => read.with_context(|| format!("satellite {name}")),
        }
    }

    /// One satellite from its fields, side by side; none if it is of no use.
    fn satellite(&self, name: &str, values: &str) -> Result<Option<MeasuredSatellite>> {
        let system = self.system(name);
        let Some(constellation) = Constellation::from_letter(system) else { return Ok(None) };
        let digits = name.trim_start_matches(|letter: char| letter.is_ascii_alphabetic()).trim();
        let satellite = digits.parse().ok().and_then(|number| SatelliteId::new(constellation, number));
        let satellite = satellite.with_context(|| format!("`{name}` is not a satellite"))?;
        // Asked of the header, so that RINEX 2's one list serves every system.
        self.header.codes.of(system)?;
        let fields = self.fields.get(&constellation).map_or(&[][..], Vec::as_slice);
        let signals = signals(fields, values)?;
        Ok((!signals.is_empty()).then_some(MeasuredSatellite { satellite, signals }))
    }
}

/// The signals of one satellite that have a pseudorange; blank and zero mean none.
fn signals(fields: &[Option<Field>], values: &str) -> Result<Vec<MeasuredSignal>> {
    let mut signals: Vec<MeasuredSignal> = Vec::new();
    let mut others: Vec<(Field, f64)> = Vec::new();
    for (index, field) in fields.iter().enumerate() {
        let (Some(field), column) = (field, 16 * index) else { continue };
        let value = number(columns(values, column, column + 14))?.filter(|value| *value != 0.0);
        match (value, field.quantity) {
            (None, _) => {}
            (Some(range_m), Quantity::Pseudorange) => {
                signals.extend(field.signal(range_m, columns(values, column + 15, column + 16)));
            }
            (Some(value), _) => others.push((*field, value)),
        }
    }
    for (field, value) in others {
        signals
            .iter_mut()
            .filter(|signal| field.belongs_to(signal))
            .for_each(|signal| field.complete(signal, value));
    }
    Ok(signals)
}

/// What a field measures, as far as RAI cares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Pseudorange,
    CarrierPhase,
    SignalToNoise,
    Doppler,
}

/// What one field of a satellite's record holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Field {
    quantity: Quantity,
    band: u8,
    /// None where RINEX 2 gives a quantity per band only.
    attribute: Option<char>,
}

impl Field {
    /// The field of a code as RINEX 3.05 names signals, or none if RAI has no use for it.
    ///
    /// `BeiDou`'s B1I at 1561.098 MHz has been band 2 since RINEX 3.03 and was band 1 in 3.02; RINEX 2 names the band
    /// alone, so the attribute is the one in common use there.
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

    /// A signal of this pseudorange. Until a field says more, C/N0 is the middle of the class that the digit beside the
    /// value names: class `k` of 2 to 9 goes from `6 k` to `6 k + 6` dB-Hz.
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

/// What RINEX 2 leaves unsaid: the component of the signal that a pseudorange was taken from.
fn attribute_2(constellation: Constellation, letter: char, band: u8) -> char {
    match (constellation, letter, band) {
        (Constellation::Gps, 'P', _) => 'W',
        (_, 'P', _) => 'P',
        (Constellation::Gps | Constellation::Glonass, _, 1) | (Constellation::Glonass, ..) => 'C',
        (Constellation::Beidou, ..) => 'I',
        _ => 'X',
    }
}

/// The fields of each system's records.
fn fields(header: &Header) -> HashMap<Constellation, Vec<Option<Field>>> {
    let of = |constellation: Constellation| {
        let codes = header.codes.of(constellation.letter()).ok()?;
        let field = |code: &String| Field::new(constellation, code, header.version);
        Some((constellation, codes.iter().map(field).collect()))
    };
    Constellation::ALL.into_iter().filter_map(of).collect()
}
