//! Pages of any content with valid parities, because nothing else reaches a decoder behind a check.

use anyhow::{Result, ensure};

use super::bits::Row;
use super::{beidou, cnav, galileo, glonass, lnav};

/// Form of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A subframe of LNAV: GPS and QZSS.
    Lnav,
    /// An even and an odd part of I/NAV.
    Inav,
    /// A page of F/NAV.
    Fnav,
    /// A subframe of `BeiDou`, D1 or D2.
    Beidou,
    /// A string of GLONASS.
    Glonass,
    /// A frame of CNAV. It keeps the number of its satellite.
    Cnav,
}

impl Form {
    /// All forms.
    pub const ALL: [Self; 6] = [Self::Lnav, Self::Inav, Self::Fnav, Self::Beidou, Self::Glonass, Self::Cnav];

    /// Returns the number of words of 32 bits that a receiver sends.
    pub const fn words(self) -> usize {
        match self {
            Self::Lnav | Self::Beidou | Self::Cnav => 10,
            Self::Inav | Self::Fnav => 8,
            Self::Glonass => 4,
        }
    }

    /// Returns the same page with its own preamble, flags and parities in place of the present
    /// ones.
    ///
    /// # Errors
    /// The number of words is not that of the form.
    pub fn sealed(self, words: &[u32]) -> Result<Vec<u32>> {
        ensure!(words.len() == self.words(), "{} words of {self:?}", words.len());
        let content = Content(words);
        match self {
            Self::Lnav => lnav::words(Row::default().unsigned(0x8B, 8)?.then(&content.each(24, 6, 8))),
            Self::Inav => {
                galileo::inav_page(Row::default().then(&content.of(2..114)).then(&content.of(130..146)))
            }
            Self::Fnav => galileo::fnav_page(Row::default().then(&content.of(0..214))),
            Self::Beidou => {
                let row =
                    Row::default().unsigned(0b111_0001_0010, 11)?.then(&content.of_word(0, 26, 4)[11..]);
                beidou::words(row.then(&Content(&words[1..]).each(22, 8, 0)))
            }
            Self::Cnav => cnav::sealed(Row::default().unsigned(0x8B, 8)?.then(&content.of(8..276))),
            Self::Glonass => glonass::words(Row::default().unsigned(0, 1)?.then(&content.of(1..77))),
        }
    }
}

/// Words of a page as bits.
#[derive(Clone, Copy)]
struct Content<'w>(&'w [u32]);

impl Content<'_> {
    /// Returns bits of the words one after another, each with its first bit highest.
    fn of(self, range: std::ops::Range<usize>) -> Vec<bool> {
        range.map(|position| self.0[position / 32] >> (31 - position % 32) & 1 == 1).collect()
    }

    /// Returns the `width` bits of a word that have `behind` others behind them.
    fn of_word(self, index: usize, width: usize, behind: usize) -> Vec<bool> {
        (0..width).rev().map(|position| self.0[index] >> (position + behind) & 1 == 1).collect()
    }

    /// Returns these bits of every word, without the first `skipped` of all.
    fn each(self, width: usize, behind: usize, skipped: usize) -> Vec<bool> {
        (0..self.0.len()).flat_map(|index| self.of_word(index, width, behind)).skip(skipped).collect()
    }
}
