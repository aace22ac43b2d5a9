//! Advice about an input that gives no position, or fewer satellites than it could: what came, what
//! of it is not read, and what is missing, in this order.
//!
//! Captures and RINEX files are described alike ([`Found`]), so that one function makes all advice.

use std::collections::{BTreeMap, BTreeSet};

use raim_core::satellite::SatelliteId;

/// Systems by their letters, with the message of RTCM that has their ephemerides.
const SYSTEMS: [(char, &str, &str); 5] = [
    ('G', "GPS", "1019"),
    ('R', "GLONASS", "1020"),
    ('E', "Galileo", "1045 or 1046"),
    ('C', "BeiDou", "1042"),
    ('J', "QZSS", "1044"),
];

/// Form of an input, which decides what to switch on at its source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// Neither of the others.
    #[default]
    Unknown,
    /// Frames of a u-blox receiver.
    Ubx,
    /// RTCM 3.
    Rtcm,
    /// Blocks of a Septentrio receiver.
    Sbf,
    /// RINEX files.
    Rinex,
}

/// Content of an input.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Form of the input.
    pub form: Form,
    /// What came, in words.
    pub came: String,
    /// What of it is not read, and what to send in its place.
    pub unread: Vec<String>,
    /// Letters of the systems that take part.
    pub systems: String,
    /// Satellites with ranges.
    pub ranged: BTreeSet<SatelliteId>,
    /// Satellites with orbits.
    pub known: BTreeSet<SatelliteId>,
    /// Satellites of which ephemerides were refused, with their number.
    pub refused: BTreeMap<SatelliteId, u32>,
    /// Letters of the systems whose ephemerides came, usable or not.
    pub sent: String,
    /// True if ranges came whose week nothing states.
    pub lacks_week: bool,
    /// True if GLONASS came without leap seconds.
    pub lacks_leap: bool,
    /// What else is missing.
    pub others: Vec<String>,
}

impl Found {
    /// Returns the advice; `None` if everything that came is read and nothing is missing.
    pub fn advice(&self) -> Option<String> {
        let (unread, missing) = (self.unread(), self.missing());
        let parts = [("not read", &unread), ("missing", &missing)];
        let parts: Vec<String> = parts
            .iter()
            .filter(|(_, items)| !items.is_empty())
            .map(|(name, items)| format!("{name}: {}", items.join("; ")))
            .collect();
        (!parts.is_empty()).then(|| format!("holds {}. {}", self.came, parts.join(". ")))
    }

    /// Returns what is not read. Refused ephemerides of satellites that have accepted ones too are
    /// left out.
    fn unread(&self) -> Vec<String> {
        let mut unread = self.unread.clone();
        let refused = self.refused.iter().filter(|(satellite, _)| {
            self.systems.contains(satellite.name().0) && !self.known.contains(satellite)
        });
        let names: Vec<String> = refused.map(|(satellite, count)| format!("{satellite} ({count})")).collect();
        if !names.is_empty() {
            unread.push(format!(
                "every ephemeris of {}: a value that no satellite sends, or an orbit that its system does not have",
                names.join(", ")
            ));
        }
        unread
    }

    /// Returns what is missing for a position, or for the use of a system.
    fn missing(&self) -> Vec<String> {
        let mut missing = self.others.clone();
        missing.extend(self.lacking_ranges());
        missing.extend(self.lacking_orbits());
        if self.lacks_week {
            missing.push("the week, which ephemerides or the receiver state".to_owned());
        }
        if self.lacks_leap {
            let from = match self.form {
                Form::Rinex => "LEAP SECONDS in the header",
                _ => "1013, or ranges of another system beside it",
            };
            missing.push(format!("the leap seconds, without which GLONASS has no time: {from}"));
        }
        missing
    }

    fn lacking_ranges(&self) -> Option<String> {
        if !self.ranged.is_empty() || self.lacks_week || self.lacks_leap || !self.others.is_empty() {
            return None;
        }
        let what = match self.form {
            Form::Ubx => "RXM-RAWX",
            Form::Sbf => "MeasEpoch",
            Form::Rtcm => "MSM4 to MSM7 (1077, 1097, 1127)",
            Form::Rinex => "pseudoranges of the selected systems in the observation files",
            Form::Unknown => {
                return Some(
                    "ranges and orbits: RXM-RAWX and RXM-SFRBX of a u-blox receiver, MeasEpoch with GPSRawCA, GALRawINAV \
                     and BDSRaw of a Septentrio receiver, or RTCM 3 with MSM4 to MSM7 (1077, 1097, \
                     1127) and ephemerides (1019, 1045 or 1046, 1042)"
                        .to_owned(),
                );
            }
        };
        Some(format!("ranges: {what}"))
    }

    /// Returns the systems with ranges and without orbits, apart from those whose ephemerides came
    /// and cannot be used.
    fn lacking_orbits(&self) -> Vec<String> {
        let of = |satellites: &BTreeSet<SatelliteId>, letter: char| {
            satellites.iter().any(|satellite| satellite.name().0 == letter)
        };
        let without: Vec<_> = SYSTEMS
            .iter()
            .filter(|(letter, ..)| self.systems.contains(*letter))
            .filter(|(letter, ..)| of(&self.ranged, *letter) && !of(&self.known, *letter))
            .collect();
        let named = |wanted: bool| {
            without.iter().filter(move |(letter, ..)| self.sent.contains(*letter) == wanted).copied()
        };
        let names = |wanted| named(wanted).map(|(_, name, _)| *name).collect::<Vec<_>>().join(", ");
        let mut lacking = Vec::new();
        if named(false).next().is_some() {
            let numbers: Vec<_> = named(false).map(|(_, _, number)| *number).collect();
            let from = match self.form {
                Form::Sbf => format!(
                    "{}, or a RINEX navigation file of that day by --nav",
                    named(false).map(|(letter, ..)| raw_bits(*letter)).collect::<Vec<_>>().join(", ")
                ),
                Form::Ubx => "RXM-SFRBX, or a RINEX navigation file of that day by --nav".to_owned(),
                Form::Rinex => "a navigation file that has them".to_owned(),
                Form::Rtcm | Form::Unknown => {
                    format!("{}, or a RINEX navigation file of that day by --nav", numbers.join(", "))
                }
            };
            lacking.push(format!("ephemerides of {}: {from}", names(false)));
        }
        if named(true).next().is_some() {
            lacking.push(format!("a usable one among the ephemerides of {}", names(true)));
        }
        lacking
    }
}

/// Returns the name of the system with this letter.
pub fn system_name(letter: char) -> &'static str {
    SYSTEMS.iter().find(|(other, ..)| *other == letter).map_or("the system", |(_, name, _)| name)
}

/// Returns the block of SBF with the navigation bits of a system.
const fn raw_bits(letter: char) -> &'static str {
    match letter {
        'G' => "GPSRawCA",
        'R' => "GLORawCA",
        'E' => "GALRawINAV",
        'C' => "BDSRaw",
        _ => "QZSRawL1CA",
    }
}

/// Returns `9 GPS, 7 Galileo` for satellites.
pub fn counted(satellites: &BTreeSet<SatelliteId>) -> String {
    let count = |letter: char| satellites.iter().filter(|satellite| satellite.name().0 == letter).count();
    let parts =
        SYSTEMS.iter().map(|(letter, name, _)| (count(*letter), name)).filter(|(count, _)| *count > 0);
    let parts: Vec<String> = parts.map(|(count, name)| format!("{count} {name}")).collect();
    if parts.is_empty() { "no satellites".to_owned() } else { parts.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(names: &[(char, u8)]) -> BTreeSet<SatelliteId> {
        names.iter().filter_map(|(letter, number)| SatelliteId::from_name(*letter, *number)).collect()
    }

    #[test]
    fn advice_says_what_came_then_what_is_not_read_then_what_is_missing() {
        let found = Found {
            form: Form::Rtcm,
            came: "44 RTCM 1002, 44 RTCM 1019, 30 RTCM 1097".to_owned(),
            unread: vec!["1002: choose MSM".to_owned()],
            systems: "GCE".to_owned(),
            ranged: set(&[('E', 5), ('E', 9)]),
            known: set(&[('G', 7)]),
            sent: "G".to_owned(),
            ..Found::default()
        };
        assert_eq!(
            found.advice().unwrap(),
            "holds 44 RTCM 1002, 44 RTCM 1019, 30 RTCM 1097. not read: 1002: choose MSM. missing: ephemerides of Galileo: 1045 \
             or 1046, or a RINEX navigation file of that day by --nav"
        );
        let whole = Found { unread: Vec::new(), known: set(&[('E', 5)]), ..found };
        assert_eq!(whole.advice(), None);
    }

    #[test]
    fn ephemerides_that_came_are_not_asked_for_again() {
        let found = Found {
            form: Form::Rtcm,
            systems: "GE".to_owned(),
            ranged: set(&[('G', 1), ('E', 5), ('R', 3)]),
            sent: "G".to_owned(),
            refused: [(SatelliteId::from_name('G', 1).unwrap(), 3)].into(),
            ..Found::default()
        };
        let advice = found.advice().unwrap();
        assert!(advice.contains("every ephemeris of G01 (3)"), "{advice}");
        assert!(advice.contains("a usable one among the ephemerides of GPS"), "{advice}");
        assert!(advice.contains("of Galileo: 1045 or 1046"), "{advice}");
        // GLONASS is not selected.
        assert!(!advice.contains("GLONASS") && !advice.contains("1019"), "{advice}");
    }
}
