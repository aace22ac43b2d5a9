//! Navigation bits of satellites, from any wire format, to orbits, clocks and coefficients.
//!
//! ```text
//! RXM-SFRBX ──► ubx/sfrbx ────Transmission──► navigation ──► Message::Broadcast, State, Corrections
//! GPSRawCA … ─► sbf/raw_bits ─┘
//!               words in normal order         one reader for each message
//! ```
//!
//! A wire format maps its signal numbers to a [`Kind`], and puts the words into normal order, with
//! the most significant bit first:
//!
//! | message | signals | words | normal order |
//! |---|---|---|---|
//! | LNAV ([`lnav`]) | GPS, QZSS L1 C/A | 10 | each word `D29* ⊕ D30*`, 0, 24 data bits, not inverted, 6 parity bits `⊕ D30*` |
//! | I/NAV ([`galileo`]) | Galileo E1, E5b | 8 | the 120 bits of the even part in four words, 8 unused bits, the odd part likewise |
//! | F/NAV ([`galileo`]) | Galileo E5a | 8 | 244 bits from the first word's highest bit on |
//! | D1, D2 ([`beidou`]) | `BeiDou` B1I, B2I, B3I | 10 | each word 2 unused bits, 30 bits |
//! | CNAV (`cnav`) | GPS, QZSS L2C, L5 | 10 | 300 bits from the first word's highest bit on |
//! | GLONASS ([`glonass`]) | L1, L2 | 3 | 85 bits from the first word's highest bit on |
//!
//! `D29*` and `D30*` are the last two bits of the word before, as broadcast. If `D30*` is 1, the
//! satellite inverts the data; normal order undoes this ([`parity`]).
//!
//! [`pages`] collects the pages of a message until they are a set, and [`leap`] reads announcements
//! of leap seconds. A new message is a file with a type that implements
//! [`message::NavigationMessage`]. It also needs a row in the table below, and an arm in each wire
//! format that brings it. `toy.rs` is the smallest.

mod beidou;
#[cfg(feature = "cnav")]
mod cnav;
mod galileo;
#[cfg(feature = "glonass")]
mod glonass;
mod leap;
mod lnav;
mod message;
mod pages;
mod parity;
mod sizes;
#[cfg(test)]
mod toy;

use raim_core::satellite::SatelliteId;

use super::calendar::Calendar;
use super::{Message, Unread};

pub(super) use beidou::kind_of as beidou_kind;
#[cfg(feature = "sbf")]
pub(super) use leap::Announcement;
use message::{NavigationMessage, Reader, messages, sizes_of};
use pages::Pages;
use sizes::Sizes;

// One row for each navigation message.
messages! {
    lnav::Lnav,
    #[cfg(feature = "cnav")]
    cnav::Cnav,
    galileo::Inav,
    galileo::Fnav,
    beidou::D1,
    beidou::D2,
    #[cfg(feature = "glonass")]
    glonass::Glonass,
    #[cfg(test)]
    toy::Toy,
}

/// Words that one satellite sent, in normal order.
pub(super) struct Transmission<'a> {
    pub(super) satellite: SatelliteId,
    pub(super) kind: Kind,
    pub(super) words: &'a [u32],
    /// True if the signal is E1 of Galileo, whose pages carry bits for authentication.
    #[cfg(feature = "osnma")]
    pub(super) is_e1: bool,
}

/// Incomplete navigation messages.
#[derive(Debug)]
pub(super) struct Navigation {
    pages: Pages,
    /// Authentication of Galileo's words.
    #[cfg(feature = "osnma")]
    pub(super) authentication: crate::osnma::Authentication,
}

impl Navigation {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self {
            pages: Pages::new(),
            #[cfg(feature = "osnma")]
            authentication: crate::osnma::Authentication::switched(false),
        }
    }

    /// Returns the number of incomplete sets that were discarded.
    pub(super) const fn abandoned(&self) -> u32 {
        self.pages.abandoned()
    }

    /// Reads one transmission. The result is `None` if it is one part of a set whose other parts
    /// have not all come.
    pub(super) fn read<'a>(
        &mut self,
        transmission: &Transmission<'_>,
        now_ms: u64,
        calendar: &Calendar,
    ) -> Result<Option<Message<'a>>, Unread> {
        let mut reader = Reader {
            transmission,
            pages: &mut self.pages,
            #[cfg(feature = "osnma")]
            authentication: &mut self.authentication,
            calendar,
            now_ms,
        };
        transmission.kind.read(&mut reader)
    }
}

/// Reason for which navigation bits are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// The page has a wrong preamble, flags or number of words.
    Malformed,
    /// A parity or CRC is wrong.
    Parity,
    /// The pages are of different issues.
    Mixed,
    /// No satellite sends such a value.
    Value,
}

impl From<Refusal> for Unread {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Malformed => Self::BitsMalformed,
            Refusal::Parity => Self::BitsParity,
            Refusal::Mixed => Self::BitsMixed,
            Refusal::Value => Self::Ephemeris,
        }
    }
}
