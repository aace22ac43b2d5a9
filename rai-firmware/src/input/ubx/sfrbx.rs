//! RXM-SFRBX: navigation bits, page by page, and the content of complete sets.
//!
//! | offset | type | field |
//! |---|---|---|
//! | 0 to 3 | u8 | system, satellite, signal, GLONASS channel + 7 |
//! | 4 | u8 | number of words |
//! | 6 | u8 | version, 2 |
//! | 8 | u32 each | words |
//!
//! | signal | words | read by |
//! |---|---|---|
//! | GPS, QZSS L1 C/A (0) | 10 | [`lnav`] |
//! | Galileo E1 (0, 1) | 8 or 9 | [`galileo`], I/NAV |
//! | Galileo E5a (3, 4) | 8 or 9 | [`galileo`], F/NAV |
//! | `BeiDou` B1I, B2I, B3I (0 to 4, 10) | 10 | [`beidou`], D1 of most and D2 of the geostationary satellites |
//! | GLONASS L1, L2 (0, 2) | 4 | [`glonass`] |
//!
//! I/NAV of E5b has its words in another order and would complete sets too early; that of E1 has
//! the same content. Others (CNAV, `BeiDou`'s newer messages, SBAS) are counted.
//!
//! Reference: [UBX-F9] RXM-SFRBX.
//!
//! [UBX-F9]: crate#references

use raim_core::satellite::{Constellation, SatelliteId};

#[cfg(feature = "glonass")]
use super::glonass;
use super::leap::Announcement;
use super::pages::{Kind, Page, Pages};
use super::{Refusal, beidou, galileo, lnav, rawx};
use crate::ephemeris::Broadcast;
use crate::input::bits::Bits;
use crate::input::calendar::Calendar;
use crate::input::system::System;
use crate::input::{Message, Unread};

/// Incomplete navigation messages.
#[derive(Debug)]
pub(in crate::input) struct Navigation {
    pages: Pages,
}

impl Navigation {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(in crate::input) const fn new() -> Self {
        Self { pages: Pages::new() }
    }

    /// Returns the number of sets discarded incomplete.
    pub(super) const fn abandoned(&self) -> u32 {
        self.pages.abandoned()
    }

    /// Reads one frame's payload; `None` if it only adds to earlier ones.
    pub(super) fn read<'a>(
        &mut self,
        payload: &[u8],
        now_ms: u64,
        calendar: &Calendar,
    ) -> Result<Option<Message<'a>>, Unread> {
        Context { pages: &mut self.pages, calendar, now_ms }.read(&Frame::new(payload)?)
    }
}

/// State for reading a frame.
struct Context<'c> {
    pages: &'c mut Pages,
    calendar: &'c Calendar,
    now_ms: u64,
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

/// Frame whose header and length are valid.
struct Frame<'a> {
    system: System,
    satellite: SatelliteId,
    signal: u8,
    words: &'a [u8],
}

impl<'a> Frame<'a> {
    fn new(payload: &'a [u8]) -> Result<Self, Unread> {
        const VERSIONS: core::ops::RangeInclusive<u8> = 1..=2;
        let (header, words) = payload.split_first_chunk::<8>().ok_or(Refusal::Malformed)?;
        let &[system, number, signal, _, many, _, version, _] = header;
        if !VERSIONS.contains(&version) || words.len() != 4 * usize::from(many) {
            return Err(Refusal::Malformed.into());
        }
        let system = rawx::system_of(system).ok_or(Unread::BitsOther)?;
        let satellite = system.satellite(number).ok_or(Unread::Satellite)?;
        Ok(Self { system, satellite, signal, words })
    }

    /// Returns the first `N` words of a frame, if it has so many.
    fn words<const N: usize>(&self) -> Result<[u32; N], Refusal> {
        let mut words = [0; N];
        let mut bytes = self.words.chunks_exact(4);
        for word in &mut words {
            let bytes = bytes.next().and_then(|bytes| bytes.first_chunk::<4>());
            *word = u32::from_le_bytes(*bytes.ok_or(Refusal::Malformed)?);
        }
        Ok(words)
    }

    /// Returns the number of words.
    fn count(&self) -> usize {
        self.words.len() / 4
    }
}

impl Context<'_> {
    fn read<'a>(&mut self, frame: &Frame<'_>) -> Result<Option<Message<'a>>, Unread> {
        match (frame.system, frame.signal, frame.count()) {
            // A frame of L1S has another length under the same number.
            (System::Gps, 0, _) | (System::Qzss, 0, 10) => self.lnav(frame),
            (System::Galileo, 0 | 1, _) => self.inav(frame),
            (System::Galileo, 3 | 4, _) => self.fnav(frame),
            // Frames of newer signals have other lengths under the same numbers.
            (System::Beidou, 0..=4 | 10, 10) => self.beidou(frame),
            #[cfg(feature = "glonass")]
            (System::Glonass, 0 | 2, 4) => self.glonass(frame),
            _ => Err(Unread::BitsOther),
        }
    }

    fn lnav<'a>(&mut self, frame: &Frame<'_>) -> Result<Option<Message<'a>>, Unread> {
        let subframe = lnav::subframe(&frame.words()?)?;
        match lnav::number(Bits(&subframe)) {
            number @ 1..=3 => {
                let page = page(frame, Kind::Lnav, number - 1, &subframe);
                self.complete(&page, lnav::ephemeris)
            }
            4 => {
                let said = lnav::ionosphere_and_utc(Bits(&subframe));
                Ok(said.map(|(coefficients, leap)| {
                    Message::Corrections(Some((Constellation::Gps, coefficients)), self.leap_s(&leap))
                }))
            }
            5 => Ok(None),
            _ => Err(Refusal::Malformed.into()),
        }
    }

    fn inav<'a>(&mut self, frame: &Frame<'_>) -> Result<Option<Message<'a>>, Unread> {
        /// Words 1 to 4.
        const BEFORE_THE_LAST: u16 = 0b1111;
        let word = galileo::inav_word(&frame.words()?)?;
        match galileo::kind(Bits(&word)) {
            kind @ 1..=4 => {
                self.pages
                    .add(&page(frame, Kind::Inav, kind - 1, &word), self.now_ms)
                    .ok_or(Unread::BitsSurplus)?;
                Ok(None)
            }
            // The fifth word states no issue. It belongs to the words before it, and is taken only
            // if these have come.
            5 => {
                let page = page(frame, Kind::Inav, 4, &word);
                let set = self.pages.add(&page, self.now_ms).ok_or(Unread::BitsSurplus)?;
                if !set.has(BEFORE_THE_LAST) {
                    return Ok(None);
                }
                self.complete(&page, galileo::inav_ephemeris)
            }
            6 => Ok(Some(Message::Corrections(None, self.leap_s(&galileo::utc(Bits(&word)))))),
            _ => Ok(None),
        }
    }

    fn fnav<'a>(&mut self, frame: &Frame<'_>) -> Result<Option<Message<'a>>, Unread> {
        let fnav = galileo::fnav_page(&frame.words()?)?;
        match galileo::kind(Bits(&fnav)) {
            kind @ 1..=4 => self.complete(&page(frame, Kind::Fnav, kind - 1, &fnav), galileo::fnav_ephemeris),
            _ => Ok(None),
        }
    }

    fn beidou<'a>(&mut self, frame: &Frame<'_>) -> Result<Option<Message<'a>>, Unread> {
        let subframe = beidou::subframe(&frame.words()?)?;
        let bits = Bits(&subframe);
        let is_geostationary = matches!(frame.satellite.number(), 1..=5 | 59..=63);
        let (told, ionosphere) = match (is_geostationary, beidou::number(bits), beidou::page(bits)) {
            (false, number @ 1..=3, _) => (
                self.complete(&page(frame, Kind::D1, number - 1, &subframe), beidou::d1_ephemeris)?,
                (number == 1).then(|| beidou::d1_ionosphere(bits)),
            ),
            (true, 1, number @ 1..=10) => (
                self.complete(&page(frame, Kind::D2, number - 1, &subframe), beidou::d2_ephemeris)?,
                (number == 2).then(|| beidou::d2_ionosphere(bits)),
            ),
            (_, 1..=5, _) => (None, None),
            _ => return Err(Refusal::Malformed.into()),
        };
        // A page that completes an ephemeris reports only that; its coefficients come again.
        let coefficients = || Some(Message::Corrections(Some((Constellation::Beidou, ionosphere?)), None));
        Ok(told.or_else(coefficients))
    }

    #[cfg(feature = "glonass")]
    fn glonass<'a>(&mut self, frame: &Frame<'_>) -> Result<Option<Message<'a>>, Unread> {
        let string = glonass::string(&frame.words()?)?;
        let number @ 1..=4 = glonass::number(Bits(&string)) else {
            return Ok(None);
        };
        let page = page(frame, Kind::Glonass, number - 1, &string);
        let mut set = self.pages.add(&page, self.now_ms).ok_or(Unread::BitsSurplus)?;
        if !set.follows(page.index) {
            return Ok(None);
        }
        let Some(strings) = set.all() else {
            return Ok(None);
        };
        let leap = self.calendar.leap_second().ok_or(Unread::LeapUnknown)?;
        let now = self.calendar.present().ok_or(Unread::WithoutWeek)?;
        let state = glonass::ephemeris(page.satellite, &strings, now, leap.seconds)?;
        drop(strings);
        set.close();
        Ok(Some(Message::State(state)))
    }

    /// Adds a page, and reads the set if it is complete.
    #[inline(never)]
    fn complete<'a>(
        &mut self,
        page: &Page<'_>,
        read: fn(SatelliteId, &[Bits<'_>], &Calendar) -> Result<Broadcast, Refusal>,
    ) -> Result<Option<Message<'a>>, Unread> {
        let set = self.pages.add(page, self.now_ms).ok_or(Unread::BitsSurplus)?;
        let Some(pages) = set.all() else {
            return Ok(None);
        };
        let ephemeris = read(page.satellite, &pages, self.calendar)?;
        drop(pages);
        set.close();
        Ok(Some(Message::Broadcast(ephemeris)))
    }

    fn leap_s(&self, announcement: &Announcement) -> Option<u8> {
        announcement.at(self.calendar.present()?)
    }
}

fn page<'a>(frame: &Frame<'_>, kind: Kind, index: u32, bytes: &'a [u8]) -> Page<'a> {
    Page { satellite: frame.satellite, kind, index: index as usize, bytes }
}
