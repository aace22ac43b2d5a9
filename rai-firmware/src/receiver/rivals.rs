//! Evidence that ranges come from two receivers, and how long it counts.

use crate::input::Rivalry;

/// Number of epochs without protection after the same epoch came twice with different ranges.
const RIVALLED_EPOCHS: u8 = 10;

/// Number of epochs without protection after an epoch that may be half of an instant, or may come
/// from another receiver.
const DOUBTED_EPOCHS: u8 = 2;

/// Number of consecutive detections of a second receiver after which the alert stays until
/// `FORGET`, because the module cannot tell which receiver remains.
const FIRM_RIVALRIES: u8 = 3;

/// Evidence of a second receiver so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rivals {
    /// Number of epochs during which another detection still counts as consecutive.
    rivalled: u8,
    /// Number of epochs for which nothing is promised.
    doubted: u8,
    /// Number of consecutive detections of two receivers.
    rivalries: u8,
}

impl Rivals {
    pub(super) const NONE: Self = Self { rivalled: 0, doubted: 0, rivalries: 0 };

    /// Adds evidence that the ranges are not all from one antenna at one instant.
    #[inline(never)]
    pub(super) fn receive(&mut self, rivalry: Rivalry) {
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

    /// Counts a detection of two receivers. It is consecutive if the detection before it still
    /// counts.
    fn count(&mut self) {
        self.rivalries = if self.rivalled > 0 { self.rivalries.saturating_add(1) } else { 1 };
        self.rivalled = RIVALLED_EPOCHS;
    }

    /// Returns true if the ranges of this epoch may come from another receiver.
    pub(super) const fn are_near(self) -> bool {
        self.doubted > 0 || self.rivalries >= FIRM_RIVALRIES
    }

    /// Ends an epoch.
    pub(super) const fn age(&mut self) {
        self.rivalled = self.rivalled.saturating_sub(1);
        self.doubted = self.doubted.saturating_sub(1);
    }
}
