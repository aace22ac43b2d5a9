//! Next occurrence of each mishap: at random, after so many epochs on average.

use rand::RngExt;
use rand::rngs::ChaCha8Rng;

/// A recurring event.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recurring {
    mean_epochs: u32,
    next: u32,
}

impl Recurring {
    pub(super) fn new(mean_epochs: u32, rng: &mut ChaCha8Rng) -> Self {
        let mut recurring = Self { mean_epochs, next: 0 };
        recurring.put_off(0, rng);
        recurring
    }

    pub(super) fn is_due(&mut self, turn: u32, rng: &mut ChaCha8Rng) -> bool {
        let is_due = turn >= self.next;
        if is_due {
            self.put_off(turn, rng);
        }
        is_due
    }

    fn put_off(&mut self, turn: u32, rng: &mut ChaCha8Rng) {
        self.next = turn + rng.random_range(self.mean_epochs / 2..=self.mean_epochs * 3 / 2).max(1);
    }
}

/// Next occurrence of each mishap.
#[derive(Clone, Copy, Debug)]
pub(super) struct Diary {
    pub(super) unplug: Recurring,
    pub(super) power_on: Recurring,
    pub(super) rewind: Recurring,
    pub(super) unread: Recurring,
    pub(super) setting: Recurring,
    pub(super) questions: Recurring,
}

impl Diary {
    /// Returns the first occurrences, of mishaps that come once in `calm` epochs on average, or in
    /// a multiple of them.
    pub(super) fn new(calm: u32, rng: &mut ChaCha8Rng) -> Self {
        let mut each = |mean_epochs| Recurring::new(mean_epochs, rng);
        Self {
            unplug: each(calm),
            power_on: each(calm),
            rewind: each(calm * 2),
            unread: each(calm * 2),
            setting: each(calm / 4),
            questions: each(calm),
        }
    }
}
