//! Multiple Signal Messages, type 7: the ranges of one system at one instant.
//!
//! ```text
//! pseudorange = c · (whole + mod1 + fine)
//! ```
//!
//! | symbol | field | unit | resolution | range |
//! |---|---|---|---|---|
//! | `whole` | rough range, integer | ms | 1 | 0 to 254, per satellite |
//! | `mod1` | rough range modulo 1 ms | ms | 2⁻¹⁰ | 0 to 1, per satellite |
//! | `fine` | fine pseudorange, extended | ms | 2⁻²⁹ (0.6 mm) | ±2⁻¹⁰ (±292 m), per signal |
//! | | C/N0, extended | dBHz | 2⁻⁴ | 0 to 64, per signal |
//! | | rough phase range rate | m/s | 1 | ±8191, per satellite |
//! | | fine phase range rate | m/s | 10⁻⁴ | ±1.6383, per signal |
//!
//! A message holds at most 64 cells, the product of the number of satellites and of different
//! signals; further satellites go into further messages of the same kind. Carrier phases are marked
//! invalid, because RAI does not use them.
//!
//! Of each satellite, one signal is sent, of the first band in the order of the module
//! ([`SINGLES`]) that it has, or for two frequencies the pair that the receiver combines ([`pairs`]). References: [RTCM-10403.3] tables 3.5-78 to 3.5-106.
//!
//! [RTCM-10403.3]: crate#references

mod message;
#[cfg(test)]
mod tests;

use raim_core::frame::SPEED_OF_LIGHT_M_S;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::correction::SINGLES;
use raim_firmware::raw::Band;

use super::Selection;
use super::channels::Channels;
use crate::signal::measurement::{MeasuredEpoch, MeasuredSatellite, MeasuredSignal};

/// Number of frequencies of a satellite that are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frequency {
    /// One band: the first one that the module would use, mostly L1, E1, B1I.
    Single,
    /// A pair, if the satellite has one.
    Dual,
}

/// Distance that light travels in a millisecond, m.
const M_PER_MS: f64 = SPEED_OF_LIGHT_M_S * 1e-3;

/// Steps of `mod1` in a millisecond.
const ROUGH_STEPS: f64 = 1024.0;

/// Largest difference of a signal from its satellite's rough range, ms: the range of `fine`, less
/// one unit.
const FINE_LIMIT_MS: f64 = 1.0 / 1024.0 - 1.0 / 536_870_912.0;

/// Highest whole millisecond of a rough range; 255 means invalid.
const WHOLE_LIMIT_MS: f64 = 254.0;

/// Largest rough rate, and largest difference of a signal's rate from it, m/s.
const ROUGH_RATE_LIMIT_M_S: f64 = 8191.0;
const FINE_RATE_LIMIT_M_S: f64 = 1.6383;

/// Largest number of cells in a message.
const CELLS: usize = 64;

/// A band, and its components in the order of preference.
type Choice = (u8, &'static str);

/// The two bands of a pair, the first alone if only one is sent.
type Pair = [Choice; 2];

/// Returns a band as RINEX 3.05 numbers it, with its components.
///
/// Components are in the order in which the broadcast group delays fit them best: GPS clocks refer
/// to L1 P(Y) and L2 P(Y), Galileo's to E1 and E5, `BeiDou`'s to B3I.
const fn choice(band: Band) -> Choice {
    match band {
        Band::L1 => (1, "CWPXLS"),
        Band::L2 => (2, "WPLXSC"),
        Band::L5 | Band::E5a => (5, "QXI"),
        Band::E1 => (1, "CXBAZ"),
        Band::E5b => (7, "QXI"),
        Band::B1I => (2, "IXQ"),
        Band::B3I => (6, "IXQ"),
        Band::B2I => (7, "IXQ"),
        Band::B1C => (1, "PXD"),
        Band::B2a => (5, "PXD"),
        Band::G1 => (1, "CP"),
        Band::G2 => (2, "CP"),
    }
}

/// Returns the pairs in the order of preference: first band, then second.
const fn pairs(constellation: Constellation) -> &'static [Pair] {
    const fn of(first: Band, second: Band) -> Pair {
        [choice(first), choice(second)]
    }
    match constellation {
        Constellation::Gps => &const { [of(Band::L1, Band::L2), of(Band::L1, Band::L5)] },
        Constellation::Galileo => &const { [of(Band::E1, Band::E5a), of(Band::E1, Band::E5b)] },
        Constellation::Beidou => {
            &const { [of(Band::B1I, Band::B3I), of(Band::B1I, Band::B2I), of(Band::B1C, Band::B2a)] }
        }
        Constellation::Glonass => &const { [of(Band::G1, Band::G2)] },
        _ => &[],
    }
}

/// Returns the single bands of a system in the module's order of preference.
fn singles(constellation: Constellation) -> impl Iterator<Item = Choice> {
    SINGLES.into_iter().filter(move |band| system_of(*band) == constellation).map(choice)
}

/// Returns the system of a band; a QZSS satellite has the bands of GPS.
const fn system_of(band: Band) -> Constellation {
    match band {
        Band::L1 | Band::L2 | Band::L5 => Constellation::Gps,
        Band::E1 | Band::E5a | Band::E5b => Constellation::Galileo,
        Band::B1I | Band::B1C | Band::B2a | Band::B2I | Band::B3I => Constellation::Beidou,
        Band::G1 | Band::G2 => Constellation::Glonass,
    }
}

/// Signals of a GPS satellite that has all of them: C/A, which every reader of RTCM uses, and the
/// two codes to which the broadcast clock refers. Between C/A and P(Y) a satellite has a delay of
/// its own, up to a metre, which the combination triples and no message contains.
const GPS_TRIPLE: [Choice; 3] = [(1, "C"), (1, "WP"), (2, "WP")];

/// Returns the best signal of a satellite for a choice.
fn find(satellite: &MeasuredSatellite, (band, attributes): Choice) -> Option<&MeasuredSignal> {
    let signal = |attribute| satellite.signals.iter().find(|s| s.band == band && s.attribute == attribute);
    attributes.chars().find_map(signal)
}

/// Returns the signals of a satellite that are sent, at the front.
pub(super) fn chosen(satellite: &MeasuredSatellite, frequency: Frequency) -> [Option<&MeasuredSignal>; 3] {
    let system = satellite.satellite.constellation();
    let has = |choices: &&[Choice]| choices.iter().all(|choice| find(satellite, *choice).is_some());
    let triple = || (system == Constellation::Gps).then_some(GPS_TRIPLE.as_slice()).filter(has);
    let pair = || pairs(system).iter().map(Pair::as_slice).find(has);
    let several = if frequency == Frequency::Dual { triple().or_else(pair) } else { None };
    let Some(choices) = several else {
        return [singles(system).find_map(|choice| find(satellite, choice)), None, None];
    };
    let mut chosen = [None; 3];
    for (signal, choice) in chosen.iter_mut().zip(choices) {
        *signal = find(satellite, *choice);
    }
    chosen
}

/// One satellite in the form of the message.
#[derive(Clone, Debug)]
struct Row {
    number: u8,
    /// Frequency slot, for GLONASS satellites.
    slot: i8,
    whole_ms: u8,
    mod1_ms: f64,
    rate_m_s: Option<f64>,
    /// Signals in the order of the standard's numbers.
    cells: Vec<Cell>,
}

/// One signal in the form of the message.
#[derive(Clone, Copy, Debug)]
struct Cell {
    /// Number of the signal in the mask, from 1.
    signal: u8,
    fine_ms: f64,
    cn0_dbhz: Option<f64>,
    fine_rate_m_s: Option<f64>,
}

impl Row {
    /// Splits the ranges of a satellite; `None` if no signal is left. Counts signals that do not
    /// fit.
    fn new(
        satellite: SatelliteId,
        signals: [Option<&MeasuredSignal>; 3],
        channels: &Channels,
        unsendable: &mut u64,
    ) -> Option<Self> {
        let system = satellite.constellation();
        let signals = || signals.iter().flatten().copied();
        let Some(slot) = channels.slot(satellite) else {
            *unsendable += signals().count() as u64;
            return None;
        };
        let sendable = |range_ms: f64| (0.0..=WHOLE_LIMIT_MS).contains(&range_ms);
        let first_ms = signals().map(|signal| signal.pseudorange_m / M_PER_MS).find(|ms| sendable(*ms));
        // The rough range is rounded from the first signal, so that at least half of the fine range
        // is left for the others.
        let rough = (first_ms.unwrap_or(0.0) * ROUGH_STEPS).round();
        let rough_ms = rough / ROUGH_STEPS;
        let rates = signals().filter_map(|signal| rate_m_s(system, slot, signal));
        let rate_m_s = rates.map(f64::round).find(|rate| rate.abs() <= ROUGH_RATE_LIMIT_M_S);
        let (letter, number) = satellite.name();
        let cell = |signal: &MeasuredSignal| {
            let fine_ms = signal.pseudorange_m / M_PER_MS - rough_ms;
            let place = first_ms.is_some() && fine_ms.abs() < FINE_LIMIT_MS;
            let number = signal_number(letter, signal).filter(|_| place);
            number.map(|number| Cell {
                signal: number,
                fine_ms,
                cn0_dbhz: cn0(signal),
                fine_rate_m_s: fine_rate_m_s(self::rate_m_s(system, slot, signal), rate_m_s),
            })
        };
        let mut cells = Vec::with_capacity(3);
        cells.extend(signals().filter_map(cell));
        cells.sort_by_key(|cell: &Cell| cell.signal);
        *unsendable += (signals().count() - cells.len()) as u64;
        let (whole_ms, mod1_ms) = (rough_ms.floor() as u8, rough_ms.fract());
        (!cells.is_empty()).then_some(Self { number, slot, whole_ms, mod1_ms, rate_m_s, cells })
    }
}

/// Returns the number of a signal in the mask of its system's messages, from 1.
///
/// Reference: [RTCM-10403.3] tables 3.5-91, 3.5-96, 3.5-99, 3.5-105, 3.5-108.
///
/// [RTCM-10403.3]: crate#references
fn signal_number(letter: char, signal: &MeasuredSignal) -> Option<u8> {
    let is_cpw = matches!(signal.attribute, 'C' | 'P' | 'W');
    let (first, attributes) = match (letter, signal.band) {
        ('G' | 'R', 1) if is_cpw => (2, "CPW"),
        ('G' | 'R', 2) if is_cpw => (8, "CPW"),
        ('J', 1) if signal.attribute == 'C' => (2, "C"),
        ('G' | 'J', 1) => (30, "SLX"),
        ('G' | 'J', 2) => (15, "SLX"),
        ('G' | 'J' | 'E', 5) => (22, "IQX"),
        ('E', 1) => (2, "CABXZ"),
        ('E' | 'C', 7) => (14, "IQX"),
        ('C', 2) => (2, "IQX"),
        ('C', 6) => (8, "IQX"),
        ('C', 5) => (22, "DPX"),
        ('C', 1) => (30, "DPX"),
        _ => return None,
    };
    // A search for text would cost as much as the rest of the signal.
    let place = attributes.bytes().position(|attribute| char::from(attribute) == signal.attribute);
    place.map(|place| first + place as u8)
}

/// Returns the phase range rate of a signal, m/s.
fn rate_m_s(system: Constellation, slot: i8, signal: &MeasuredSignal) -> Option<f64> {
    Some(-signal.doppler_hz? * SPEED_OF_LIGHT_M_S / signal.frequency_hz(system, slot)?)
}

/// Returns the difference of a signal's rate from its satellite's rough one, if it fits the field.
fn fine_rate_m_s(rate_m_s: Option<f64>, rough_m_s: Option<f64>) -> Option<f64> {
    rate_m_s.zip(rough_m_s).map(|(rate, rough)| rate - rough).filter(|fine| fine.abs() <= FINE_RATE_LIMIT_M_S)
}

/// Returns C/N0 within the range of the field, whose 0 means invalid.
fn cn0(signal: &MeasuredSignal) -> Option<f64> {
    signal.cn0_dbhz.filter(|cn0_dbhz| *cn0_dbhz >= 0.0625).map(|cn0_dbhz| cn0_dbhz.min(63.9375))
}

/// Parts the rows so that each part fits into one message. The size of its cell mask is that of the
/// part times the number of its different signals.
fn parts(rows: Vec<Row>) -> Vec<Vec<Row>> {
    let (mut parts, mut part, mut signals) = (Vec::new(), Vec::with_capacity(rows.len()), 0_u64);
    for row in rows {
        let of_row = row.cells.iter().fold(0, |signals, cell| signals | 1 << cell.signal);
        signals |= of_row;
        if (part.len() + 1) * signals.count_ones() as usize > CELLS {
            parts.push(std::mem::take(&mut part));
            signals = of_row;
        }
        part.push(row);
    }
    parts.push(part);
    parts
}

/// Returns the frames of an epoch; none for a system without satellites, because some readers
/// refuse an empty message.
pub(super) fn frames(
    epoch: &MeasuredEpoch,
    selection: &Selection,
    channels: &Channels,
    leap_s: u8,
    unsendable: &mut u64,
) -> impl Iterator<Item = Vec<u8>> {
    let mut planned: Vec<(char, Vec<Row>)> = Vec::new();
    for letter in &selection.letters {
        let rows = rows(epoch, *letter, selection.frequency, channels, unsendable);
        planned.extend(parts(rows).into_iter().filter(|part| !part.is_empty()).map(|part| (*letter, part)));
    }
    let last = planned.len().saturating_sub(1);
    let frame = move |(index, (letter, rows)): (usize, (_, Vec<Row>))| {
        message::frame(letter, (epoch.time, leap_s), index < last, &rows)
    };
    planned.into_iter().enumerate().map(frame)
}

fn rows(
    epoch: &MeasuredEpoch,
    letter: char,
    frequency: Frequency,
    channels: &Channels,
    unsendable: &mut u64,
) -> Vec<Row> {
    let of_system = epoch.satellites.iter().filter(|satellite| satellite.satellite.name().0 == letter);
    let row = |satellite: &MeasuredSatellite| {
        Row::new(satellite.satellite, chosen(satellite, frequency), channels, unsendable)
    };
    let mut rows = Vec::with_capacity(epoch.satellites.len());
    rows.extend(of_system.filter_map(row).filter(|row| row.number <= 64));
    rows.sort_by_key(|row| row.number);
    rows.dedup_by_key(|row| row.number);
    rows
}
