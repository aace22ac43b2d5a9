//! Satellites and the constellations they belong to.
//!
//! A constellation matters to integrity because the receiver clock has another offset to each. Each
//! range depends on exactly one of these clock offsets.
//!
//! QZSS satellites transmit GPS signals in GPS time, with numbers of the same family (193 to 202).
//! Their ranges depend on the receiver's GPS clock, so that they are satellites of
//! [`Constellation::Gps`] here. Only their names differ: `J01` to `J10`. In five minutes near
//! Nagoya their corrected ranges are 0.5 m shorter than those of GPS, in hours at Esbjerg 0.04 m
//! longer (`tests-host/tests/all/ubx/qzss.rs`). The clocks of two systems differ by tens of metres
//! and more.

use core::fmt;
use core::str::FromStr;

/// A satellite navigation system with its own time scale, hence with its own receiver clock offset.
///
/// ```
/// use raim_core::{Constellation, SatelliteId};
///
/// let satellite: SatelliteId = "C07".parse()?;
/// assert_eq!(satellite.constellation(), Constellation::Beidou);
/// assert!(Constellation::all().map(Constellation::letter).eq(['G', 'C', 'E', 'R']));
/// # Ok::<(), raim_core::satellite::ParseSatelliteError>(())
/// ```
///
/// The discriminants are the ids in the published vectors. They also set the order of the clocks in
/// every result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
#[non_exhaustive]
pub enum Constellation {
    /// Global Positioning System.
    Gps = 0,
    /// `BeiDou` navigation satellite system.
    Beidou = 1,
    /// Galileo.
    Galileo = 2,
    /// GLONASS.
    Glonass = 3,
}

impl Constellation {
    /// Number of constellations.
    #[doc(hidden)]
    pub const COUNT: usize = 4;

    /// All constellations in ascending id.
    #[doc(hidden)]
    pub const ALL: [Self; Self::COUNT] = [Self::Gps, Self::Beidou, Self::Galileo, Self::Glonass];

    /// Returns all constellations of this version, in the order of the clocks in every result.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter()
    }

    /// Returns the RINEX letter: `G`, `C`, `E`, `R`.
    pub const fn letter(self) -> char {
        match self {
            Self::Gps => 'G',
            Self::Beidou => 'C',
            Self::Galileo => 'E',
            Self::Glonass => 'R',
        }
    }

    /// Returns the constellation of a RINEX letter.
    #[doc(hidden)]
    pub fn from_letter(letter: char) -> Option<Self> {
        Self::ALL.into_iter().find(|constellation| constellation.letter() == letter)
    }
}

/// Offset from the number in a QZSS satellite's name to its number here.
const QZSS: u8 = 192;

/// One satellite, named as in RINEX: `G05`, `C12`, `E31`, `J02`.
///
/// ```
/// use raim_core::{Constellation, SatelliteId};
///
/// let satellite: SatelliteId = "E31".parse()?;
/// assert_eq!(satellite.constellation(), Constellation::Galileo);
/// assert_eq!((satellite.number(), satellite.to_string().as_str()), (31, "E31"));
/// assert!("X01".parse::<SatelliteId>().is_err());
/// # Ok::<(), raim_core::satellite::ParseSatelliteError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SatelliteId {
    constellation: Constellation,
    number: u8,
}

impl SatelliteId {
    /// Returns a satellite by its number within the constellation, 1 to 99, or 193 to 202 for QZSS
    /// within GPS; `None` outside.
    pub const fn new(constellation: Constellation, number: u8) -> Option<Self> {
        match (constellation, number) {
            (_, 1..=99) | (Constellation::Gps, 193..=202) => Some(Self { constellation, number }),
            _ => None,
        }
    }

    /// Returns a QZSS satellite by the number in its name, 1 to 10; `None` outside.
    pub const fn qzss(number: u8) -> Option<Self> {
        if number <= 10 { Self::new(Constellation::Gps, QZSS + number) } else { None }
    }

    /// Returns a satellite by the letter and the number of its name.
    #[doc(hidden)]
    pub fn from_name(letter: char, number: u8) -> Option<Self> {
        match letter {
            'J' => Self::qzss(number),
            _ => Constellation::from_letter(letter)
                .filter(|_| number <= 99)
                .and_then(|constellation| Self::new(constellation, number)),
        }
    }

    /// Returns the constellation on whose clock the satellite's range depends.
    pub const fn constellation(self) -> Constellation {
        self.constellation
    }

    /// Returns the number within the constellation, 1 to 99, or 193 to 202.
    pub const fn number(self) -> u8 {
        self.number
    }

    /// Returns true for a QZSS satellite.
    pub const fn is_qzss(self) -> bool {
        self.number > QZSS
    }

    /// Returns the letter and the number of its name.
    pub const fn name(self) -> (char, u8) {
        if self.is_qzss() { ('J', self.number - QZSS) } else { (self.constellation.letter(), self.number) }
    }
}

impl FromStr for SatelliteId {
    type Err = ParseSatelliteError;

    /// Parses a name as RINEX writes it: a letter and one or two digits.
    fn from_str(name: &str) -> Result<Self, ParseSatelliteError> {
        let parsed = || {
            let mut characters = name.chars();
            let letter = characters.next()?;
            let tens = characters.next()?.to_digit(10)? as u8;
            let number = match characters.next() {
                Some(ones) => 10 * tens + ones.to_digit(10)? as u8,
                None => tens,
            };
            characters.next().is_none().then_some(())?;
            Self::from_name(letter, number)
        };
        parsed().ok_or(ParseSatelliteError)
    }
}

/// A name that no satellite has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct ParseSatelliteError;

impl fmt::Display for ParseSatelliteError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("satellite must be G, C, E or R with 1 to 99, or J with 1 to 10")
    }
}

impl core::error::Error for ParseSatelliteError {}

impl fmt::Display for SatelliteId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (letter, number) = self.name();
        write!(formatter, "{letter}{number:02}")
    }
}
