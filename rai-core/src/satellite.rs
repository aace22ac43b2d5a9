//! Satellites and the constellations they belong to.
//!
//! A constellation matters to integrity because it has its own receiver clock: each range touches exactly one.

use core::fmt;

/// A satellite navigation system with its own time scale, hence with its own receiver clock offset.
///
/// The discriminants are the ids of the published vectors, and the order of the clocks in every result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
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
    /// How many constellations there are.
    pub const COUNT: usize = 4;

    /// All constellations in ascending id.
    pub const ALL: [Self; Self::COUNT] = [Self::Gps, Self::Beidou, Self::Galileo, Self::Glonass];

    /// The letter that RINEX uses: `G`, `C`, `E`, `R`.
    pub const fn letter(self) -> char {
        match self {
            Self::Gps => 'G',
            Self::Beidou => 'C',
            Self::Galileo => 'E',
            Self::Glonass => 'R',
        }
    }

    /// The constellation of a RINEX letter.
    pub fn from_letter(letter: char) -> Option<Self> {
        Self::ALL.into_iter().find(|constellation| constellation.letter() == letter)
    }
}

/// One satellite, named as in RINEX: `G05`, `C12`, `E31`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SatelliteId {
    constellation: Constellation,
    number: u8,
}

impl SatelliteId {
    /// A satellite by its number within the constellation, 1 to 99; `None` outside.
    pub const fn new(constellation: Constellation, number: u8) -> Option<Self> {
        if matches!(number, 1..=99) { Some(Self { constellation, number }) } else { None }
    }

    /// The constellation whose clock the satellite's range touches.
    pub const fn constellation(self) -> Constellation {
        self.constellation
    }

    /// The number within the constellation, 1 to 99.
    pub const fn number(self) -> u8 {
        self.number
    }
}

impl fmt::Display for SatelliteId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}{:02}", self.constellation.letter(), self.number)
    }
}
