//! A block of SBF, with its time and its fields.
//!
//! Offsets count from the first byte of the block, and lie inside it: each reader first asks for
//! the length that it needs ([`Block::at_least`]). Bytes beyond the end read as zero.

use crate::input::Unread;
use crate::input::protocol::Frame;
use crate::time::{GpsTime, WEEK_MS};

/// Bytes up to the end of the week number.
const HEADER: usize = 14;

/// A block that passed its check.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block<'a> {
    bytes: &'a [u8],
}

impl<'a> Block<'a> {
    pub(super) const fn of(frame: &Frame<'a>) -> Self {
        Self { bytes: frame.bytes }
    }

    /// Returns the number of the block, without its revision.
    pub(super) fn number(&self) -> u16 {
        self.u16(4) & 0x1FFF
    }

    /// Returns the time of the block.
    ///
    /// # Errors
    /// [`Unread::WithoutWeek`] before the receiver knows it.
    pub(super) fn time(&self) -> Result<GpsTime, Unread> {
        self.at_least(HEADER)?;
        let (tow_ms, week) = (self.u32(8), self.u16(12));
        match (tow_ms, week) {
            (u32::MAX, _) | (_, u16::MAX) => Err(Unread::WithoutWeek),
            (..WEEK_MS, week) => Ok(GpsTime { week, tow_ms }),
            _ => Err(Unread::Time),
        }
    }

    /// Refuses a block of fewer bytes.
    pub(super) fn at_least(&self, bytes: usize) -> Result<(), Unread> {
        if self.bytes.len() >= bytes { Ok(()) } else { Err(Unread::Malformed) }
    }

    /// Returns the bytes from an offset on.
    pub(super) fn behind(&self, offset: usize) -> &'a [u8] {
        self.bytes.get(offset..).unwrap_or_default()
    }

    pub(super) fn u8(&self, offset: usize) -> u8 {
        self.bytes.get(offset).copied().unwrap_or(0)
    }

    pub(super) fn u16(&self, offset: usize) -> u16 {
        u16::from_le_bytes(self.field(offset))
    }

    // Not inlined, so that the many fields of an ephemeris share one copy.
    #[inline(never)]
    pub(super) fn u32(&self, offset: usize) -> u32 {
        u32::from_le_bytes(self.field(offset))
    }

    #[inline(never)]
    pub(super) fn u64(&self, offset: usize) -> u64 {
        u64::from_le_bytes(self.field(offset))
    }

    pub(super) fn f32(&self, offset: usize) -> f32 {
        f32::from_bits(self.u32(offset))
    }

    pub(super) fn f64(&self, offset: usize) -> f64 {
        f64::from_bits(self.u64(offset))
    }

    fn field<const N: usize>(&self, offset: usize) -> [u8; N] {
        self.behind(offset).first_chunk().copied().unwrap_or([0; N])
    }
}
