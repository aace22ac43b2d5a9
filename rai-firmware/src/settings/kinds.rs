//! Types that only settings have; the other types are the core's.

use heapless::String;

use super::Refusal;
use super::number::plain;
use super::read::{Values, next, next_number, next_whole};
use super::value::{Ranges, Spelled, Take, Value, range};

pub use raim_core::internals::integrity::raim::levels::Levels;
pub use raim_core::monitor::Noise;

/// Choice of ranges of a satellite that offers two frequencies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Frequencies {
    /// The set of ranges with the smaller protection levels.
    Auto,
    /// The combination that is free of the ionosphere.
    Dual,
    /// One frequency, with a model of the ionosphere.
    Single,
}

/// Use of the receiver's own reports of spoofing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SpoofFlag {
    /// They are reported, and change no verdict.
    Say,
    /// They take promises back.
    Hold,
}

/// Satellite systems, as a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Systems(u8);

impl Systems {
    /// Letters of RINEX, in the order in which they are reported.
    pub const LETTERS: [char; 5] = ['G', 'R', 'E', 'C', 'J'];

    /// GPS, Galileo and `BeiDou`.
    pub const AT_START: Self = Self(0b01101);

    /// Returns the systems with these letters; `None` for an empty text, a repeated letter or an
    /// unknown one.
    pub fn of(letters: &str) -> Option<Self> {
        let mut set = 0;
        for letter in letters.bytes() {
            let bit = 1 << Self::LETTERS.iter().position(|known| *known == char::from(letter))?;
            if set & bit != 0 {
                return None;
            }
            set |= bit;
        }
        (set != 0).then_some(Self(set))
    }

    /// Returns true if the system with this letter takes part.
    pub fn contains(self, letter: char) -> bool {
        Self::LETTERS.iter().position(|known| *known == letter).is_some_and(|bit| self.0 >> bit & 1 == 1)
    }
}

/// Time for which satellites must agree before the position is protected again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recovery {
    /// Number of consecutive epochs.
    pub epochs: u8,
    /// Time that these epochs span, s.
    pub seconds: f64,
}

/// Heights at which a receiver can be, above the ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heights {
    /// Lowest height, m.
    pub least_m: f64,
    /// Highest height, m.
    pub greatest_m: f64,
}

/// Bit rate of the GNSS port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Baud {
    /// Rate that the module detects itself.
    Auto,
    /// 9600 bit/s.
    B9600,
    /// 38400 bit/s.
    B38400,
    /// 115200 bit/s.
    B115200,
    /// 230400 bit/s.
    B230400,
    /// 460800 bit/s.
    B460800,
    /// 921600 bit/s.
    B921600,
}

impl Baud {
    /// Returns the rate in bit/s; `None` if the module detects it.
    pub const fn rate(self) -> Option<u32> {
        match self {
            Self::Auto => None,
            Self::B9600 => Some(9600),
            Self::B38400 => Some(38_400),
            Self::B115200 => Some(115_200),
            Self::B230400 => Some(230_400),
            Self::B460800 => Some(460_800),
            Self::B921600 => Some(921_600),
        }
    }
}

impl Spelled for Systems {
    const RANGES: usize = 0;
    // The value is a set of letters, so it has no words; the text of its row lists the letters.
    const WORDS: &'static [&'static str] = &[];
}

impl Value for Systems {
    fn change(&mut self, values: Values<'_, '_>, _: &Ranges) -> Result<(), Refusal> {
        let systems = Self::of(next(values)?).ok_or(Refusal::UnknownValue)?;
        if systems.contains('R') && !cfg!(feature = "glonass") {
            return Err(Refusal::NotInBuild);
        }
        *self = systems;
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        let mut letters = String::<{ Self::LETTERS.len() }>::new();
        let kept = Self::LETTERS.into_iter().filter(|letter| self.contains(*letter));
        // Every letter fits.
        kept.for_each(|letter| _ = letters.push(letter));
        take(&letters);
    }
}

impl Spelled for Heights {
    const RANGES: usize = 2;
    const WORDS: &'static [&'static str] = &[];
}

impl Value for Heights {
    fn change(&mut self, values: Values<'_, '_>, ranges: &Ranges) -> Result<(), Refusal> {
        let least_m = next_number(values, range(ranges, 0))?;
        let greatest_m = next_number(values, range(ranges, 1))?;
        *self = Self { least_m, greatest_m };
        if least_m < greatest_m { Ok(()) } else { Err(Refusal::OutOfRange) }
    }

    fn say(&self, take: Take<'_>) {
        take(&plain(self.least_m));
        take(&plain(self.greatest_m));
    }
}

impl Spelled for Recovery {
    const RANGES: usize = 2;
    const WORDS: &'static [&'static str] = &[];
}

impl Value for Recovery {
    fn change(&mut self, values: Values<'_, '_>, ranges: &Ranges) -> Result<(), Refusal> {
        let epochs = next_whole(values, range(ranges, 0))?;
        let seconds = next_number(values, range(ranges, 1))?;
        *self = Self { epochs, seconds };
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        take(&plain(f64::from(self.epochs)));
        take(&plain(self.seconds));
    }
}

#[cfg(test)]
mod tests {
    use super::Systems;

    #[test]
    fn systems_are_a_set_of_known_letters() {
        for letters in ["", "X", "GG", "g", "GE ", "GREX", "é"] {
            assert_eq!(Systems::of(letters), None, "{letters:?}");
        }
        let have = Systems::of("CGE");
        assert_eq!(have, Some(Systems::AT_START));
        let contained = Systems::LETTERS.map(|letter| have.is_some_and(|have| have.contains(letter)));
        assert_eq!(contained, [true, false, true, true, false]);
    }
}
