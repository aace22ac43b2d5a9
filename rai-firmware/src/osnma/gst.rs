//! Galileo system time in half minutes, the clock of OSNMA.

/// Seconds of a week.
pub(super) const WEEK_S: u32 = 604_800;

/// Half minutes of a week.
pub(super) const WEEK: u32 = WEEK_S / 30;

/// Number of a subframe: half minutes of Galileo system time since its start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Subframe(pub(super) u32);

impl Subframe {
    /// Returns the subframe of an instant, in seconds since the start of Galileo system time.
    pub(super) const fn of(gst_s: u32) -> Self {
        Self(gst_s / 30)
    }

    /// Returns the subframe that is `count` earlier.
    pub(super) const fn back(self, count: u32) -> Self {
        Self(self.0.wrapping_sub(count))
    }

    /// Returns the 32 bits that tags and keys are computed from: the week in 12 bits, the second of
    /// the week in 20.
    pub(super) const fn bits(self) -> u32 {
        (self.0 / WEEK) << 20 | (self.0 % WEEK * 30)
    }

    /// Returns true in the second half of a minute.
    pub(super) const fn is_odd(self) -> bool {
        self.0 % 2 == 1
    }

    /// Returns the number modulo 256, which is enough to compare what is less than an hour apart.
    pub(super) const fn short(self) -> u8 {
        self.0 as u8
    }
}
