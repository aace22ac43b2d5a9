//! Pages of navigation messages, collected until they are a complete ephemeris.
//!
//! Each message of a satellite occupies a slot until its set is complete. Most sets fit into
//! [`SMALL_BYTES`]. Only the ten pages of a geostationary `BeiDou` satellite need one of the large
//! slots, of which there are few. A slot is free after its set was read. If no page comes for
//! [`ABANDONED_MS`], the slot is also free, and its pages are discarded. A returning satellite thus
//! does not mix new pages with old ones.
//!
//! Slots for 48 satellites and 8 geostationary ones take 6.5 KiB. If there is no slot for a page,
//! it is dropped and counted. The satellite repeats it half a minute later, when other sets are
//! complete.

use heapless::Vec;
use raim_core::satellite::SatelliteId;

use super::Kind;
use super::sizes::Sizes;
use crate::counters::count;
use crate::input::bits::Bits;

/// Largest set of all messages except D2, bytes: that of F/NAV.
const SMALL_BYTES: usize = 96;

/// Number of slots for sets up to [`SMALL_BYTES`].
const SMALL_SLOTS: usize = 48;

/// Number of slots for larger sets.
const LARGE_SLOTS: usize = 8;

const _: () = assert!(size_of::<Pages>() <= 6_656);

/// Time without a new page after which a set is discarded, ms. A set takes 30 s to 50 s.
const ABANDONED_MS: u64 = 120_000;

/// Pages of one message of one satellite.
#[derive(Clone, Copy, Debug)]
struct Slot<const BYTES: usize> {
    satellite: SatelliteId,
    kind: Kind,
    /// One bit for each page that has come.
    present: u16,
    /// Arrival of the last page, in units of 1.024 s, so that 32 bits suffice.
    touched: u32,
    bytes: [u8; BYTES],
}

/// All incomplete sets.
#[derive(Debug)]
pub(super) struct Pages {
    small: Vec<Slot<SMALL_BYTES>, SMALL_SLOTS>,
    large: Vec<Slot<{ Kind::SET_BYTES }>, LARGE_SLOTS>,
    /// Number of incomplete sets that were discarded.
    abandoned: u32,
}

/// A page, and its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Page<'a> {
    pub(super) satellite: SatelliteId,
    pub(super) kind: Kind,
    /// Index in the set, from 0.
    pub(super) index: usize,
    pub(super) bytes: &'a [u8],
}

/// A set of pages after one was added.
pub(super) struct Set<'a> {
    bytes: &'a [u8],
    page_bytes: usize,
    /// Number of pages in the set.
    pages: usize,
    present: &'a mut u16,
    /// Time since the page before, in the slot's units.
    gap: u32,
}

impl Set<'_> {
    /// Returns the pages if all have come.
    #[inline(never)]
    pub(super) fn all(&self) -> Option<Vec<Bits<'_>, { Kind::PAGES }>> {
        let complete = (1_u32 << self.pages) - 1;
        if u32::from(*self.present) & complete != complete {
            return None;
        }
        let pages = (0..self.pages).filter_map(|index| {
            let start = index * self.page_bytes;
            self.bytes.get(start..start + self.page_bytes).map(Bits)
        });
        // This never fails, because the capacity is that of the largest set.
        Some(pages.fold(Vec::new(), |mut pages, page| {
            let _ = pages.push(page);
            pages
        }))
    }

    /// Returns true if the added page comes directly after the one before it, or is the first of
    /// its set. Otherwise the set is discarded.
    #[cfg(feature = "glonass")]
    pub(super) fn follows(&mut self, index: u32) -> bool {
        /// Two to three units of time, 2 s to 3 s.
        const NEXT: u32 = 3;
        let before = (1_u16 << index) - 1;
        if index == 0 {
            *self.present = 1;
        } else if !self.has(before) || self.gap > NEXT {
            *self.present = 0;
        }
        *self.present != 0
    }

    /// Frees the slot after its set was read, except for the pages of a mask.
    pub(super) fn keep(self, mask: u16) {
        *self.present &= mask;
    }

    /// Returns true if all pages of a mask have come.
    #[cfg(feature = "glonass")]
    fn has(&self, mask: u16) -> bool {
        *self.present & mask == mask
    }
}

impl Pages {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { small: Vec::new(), large: Vec::new(), abandoned: 0 }
    }

    /// Returns the number of incomplete sets that were discarded.
    pub(super) const fn abandoned(&self) -> u32 {
        self.abandoned
    }

    /// Adds a page to its set; `None` if every slot is in use.
    pub(super) fn add(&mut self, page: &Page<'_>, now_ms: u64) -> Option<Set<'_>> {
        if page.kind.sizes().set_bytes() <= SMALL_BYTES {
            add(&mut self.small, page, now_ms, &mut self.abandoned)
        } else {
            add(&mut self.large, page, now_ms, &mut self.abandoned)
        }
    }
}

fn add<'a, const BYTES: usize, const SLOTS: usize>(
    slots: &'a mut Vec<Slot<BYTES>, SLOTS>,
    page: &Page<'_>,
    now_ms: u64,
    abandoned: &mut u32,
) -> Option<Set<'a>> {
    let now = (now_ms >> 10) as u32;
    let slot = slot_of(slots, page, now, abandoned)?;
    let Sizes { page_bytes, pages, .. } = page.kind.sizes();
    if let Some(place) = slot.bytes.chunks_exact_mut(page_bytes.max(1)).nth(page.index) {
        place.iter_mut().zip(page.bytes).for_each(|(place, byte)| *place = *byte);
        slot.present |= 1 << page.index;
    }
    let gap = now.wrapping_sub(slot.touched);
    slot.touched = now;
    Some(Set { bytes: &slot.bytes, page_bytes, pages, present: &mut slot.present, gap })
}

/// Returns the slot of a page's message: the present one, a new one, or a free one.
fn slot_of<'a, const BYTES: usize, const SLOTS: usize>(
    slots: &'a mut Vec<Slot<BYTES>, SLOTS>,
    page: &Page<'_>,
    now: u32,
    abandoned: &mut u32,
) -> Option<&'a mut Slot<BYTES>> {
    let is_own = |slot: &Slot<BYTES>| slot.satellite == page.satellite && slot.kind == page.kind;
    let is_abandoned = |slot: &Slot<BYTES>| u64::from(now.wrapping_sub(slot.touched)) << 10 > ABANDONED_MS;
    let empty =
        Slot { satellite: page.satellite, kind: page.kind, present: 0, touched: now, bytes: [0; BYTES] };
    let index = match slots.iter().position(is_own) {
        Some(own) => {
            let slot = slots.get_mut(own)?;
            if is_abandoned(slot) {
                give_up(slot, abandoned);
            }
            return Some(slot);
        }
        None if slots.is_full() => slots.iter().position(|slot| slot.present == 0 || is_abandoned(slot))?,
        None => {
            let _ = slots.push(empty);
            slots.len() - 1
        }
    };
    let slot = slots.get_mut(index)?;
    give_up(slot, abandoned);
    *slot = empty;
    Some(slot)
}

/// Discards the pages of a set, and counts the set if it had pages.
fn give_up<const BYTES: usize>(slot: &mut Slot<BYTES>, abandoned: &mut u32) {
    if core::mem::take(&mut slot.present) != 0 {
        count(abandoned);
    }
}
