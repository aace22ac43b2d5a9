//! Settings: what a command can change, each value within its range.
//!
//! Types that only a command knows stand here; those of the core are its own.

use rai_core::integrity::raim::detection::threshold::policy::Policy;
use rai_core::monitor::Method;
use rai_core::numeric::probability::Probability;
use rai_core::satellite::Constellation;
use rai_core::weighting::{Ism, IsmParameters};

use super::Phase;
use crate::output::schedule::Item;

pub use rai_core::integrity::raim::levels::Levels;

/// Which ranges are used of a satellite that offers two frequencies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frequencies {
    /// Whichever gives the smaller protection levels.
    Auto,
    /// The combination that is free of the ionosphere.
    Dual,
    /// One frequency, with a model of the ionosphere.
    Single,
}

/// Where the sigmas of the ranges come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sigma {
    /// The model alone.
    Fixed,
    /// The model, scaled by what the residuals of the last minutes show.
    Adapted,
}

/// Satellite systems, as a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Systems(u8);

impl Systems {
    /// The letters of RINEX, in the order in which they are said.
    pub const LETTERS: [char; 5] = ['G', 'R', 'E', 'C', 'J'];

    /// GPS, Galileo and `BeiDou`.
    pub const AT_START: Self = Self(0b01101);

    /// The systems with these letters, each once; `None` for none, twice the same, or another letter.
    pub fn of(letters: &str) -> Option<Self> {
        let mut set = 0;
        for letter in letters.chars() {
            let bit = 1 << Self::LETTERS.iter().position(|known| *known == letter)?;
            if set & bit != 0 {
                return None;
            }
            set |= bit;
        }
        (set != 0).then_some(Self(set))
    }

    /// Does the system with this letter take part?
    pub fn contains(self, letter: char) -> bool {
        Self::LETTERS.iter().position(|known| *known == letter).is_some_and(|bit| self.0 >> bit & 1 == 1)
    }
}

/// How long satellites must agree before a promise returns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recovery {
    /// Epochs in a row.
    pub epochs: u8,
    /// Seconds that these span.
    pub seconds: f64,
}

/// Heights at which a receiver can be, above the ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heights {
    /// Least, m.
    pub least_m: f64,
    /// Greatest, m.
    pub greatest_m: f64,
}

/// One change of the configuration, each number within its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// `PHASE`.
    Phase(Phase),
    /// `HAL`, m.
    HorizontalAlertLimit(f64),
    /// `VAL`, m; `None` for `OFF`.
    VerticalAlertLimit(Option<f64>),
    /// `PFA`.
    FalseAlarm(Probability),
    /// `PMD`.
    MissedDetection(Probability),
    /// `PFF`.
    FaultFree(Probability),
    /// `TTA`, s.
    TimeToAlert(f64),
    /// `POLICY`.
    Policy(Policy),
    /// `METHOD`.
    Method(Method),
    /// `LEVELS`.
    Levels(Levels),
    /// `SYSTEMS`.
    Systems(Systems),
    /// `MASK`, rad (degrees on the wire).
    Mask(f64),
    /// `CLOCKAID`.
    ClockAid(bool),
    /// `CN0MASK`, dB-Hz.
    SignalMask(f64),
    /// `VMAX`, m/s.
    GreatestSpeed(f64),
    /// `HEIGHT`.
    Heights(Heights),
    /// `RECOVER`.
    Recovery(Recovery),
    /// `FREQ`.
    Frequencies(Frequencies),
    /// `SIGMA`.
    Sigma(Sigma),
    /// `BAUD`, bits a second; `None` for `AUTO`.
    BitRate(Option<u32>),
    /// `IONO`, α0 to α3 and β0 to β3 as broadcast; `None` for `AUTO`, what the satellites say.
    Ionosphere(Option<[f64; 8]>),
    /// `ISM`: what is promised of the satellites, by a preset.
    Support(Ism),
    /// `ISM`: what is promised of one system's.
    SupportOf(Constellation, IsmParameters),
    /// `OUTPUT`: something that is sent, and with every how many epochs.
    Output(Item, u8),
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
