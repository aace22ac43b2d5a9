//! Evidence that ranges are of two receivers, and how long it counts.

use crate::input::Rivalry;

/// Number of epochs without protection after an epoch came again with other ranges.
const RIVALLED_EPOCHS: u8 = 10;

/// Number of epochs without protection after one that may be a half, or of another receiver.
const DOUBTED_EPOCHS: u8 = 2;

/// Number of detections of two receivers in a row after which only `FORGET` accepts one of them,
/// because the one that remains may be the other.
const FIRM_RIVALRIES: u8 = 3;

/// Evidence so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rivals {
    /// Number of epochs for which an epoch that came again with other ranges still counts.
    rivalled: u8,
    /// Number of epochs for which nothing is promised.
    doubted: u8,
    /// Number of times in a row that two receivers were detected.
    rivalries: u8,
}

impl Rivals {
    pub(super) const NONE: Self = Self { rivalled: 0, doubted: 0, rivalries: 0 };

    /// Adds evidence that the ranges are not all of one antenna at one instant.
    #[inline(never)]
    pub(super) fn hear(&mut self, rivalry: Rivalry) {
        let epochs = match rivalry {
            Rivalry::Receivers => {
                self.count();
                RIVALLED_EPOCHS
            }
            Rivalry::Joined => {
                self.count();
                if self.rivalries > 1 { RIVALLED_EPOCHS } else { 1 }
            }
            Rivalry::Suspected | Rivalry::Halves => DOUBTED_EPOCHS,
        };
        self.doubted = self.doubted.max(epochs);
    }

    /// Counts a detection of two receivers, in a row with those before it that still count.
    fn count(&mut self) {
        self.rivalries = if self.rivalled > 0 { self.rivalries.saturating_add(1) } else { 1 };
        self.rivalled = RIVALLED_EPOCHS;
    }

    /// Returns true if ranges of an epoch may be those of another receiver.
    pub(super) const fn are_near(self) -> bool {
        self.doubted > 0 || self.rivalries >= FIRM_RIVALRIES
    }

    /// Ends an epoch.
    pub(super) const fn age(&mut self) {
        self.rivalled = self.rivalled.saturating_sub(1);
        self.doubted = self.doubted.saturating_sub(1);
    }
}
