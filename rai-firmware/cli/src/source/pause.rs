//! Pauses before a line is opened again.
//!
//! ```text
//! p, 2p, 4p, … at most the longest; p again after a connection that brought something
//! ```

use std::time::Duration;

/// Pause that doubles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pause {
    first: Duration,
    longest: Duration,
    next: Duration,
}

impl Pause {
    /// A receiver's line: a cable comes back soon.
    pub(crate) const RECEIVER: Self = Self::new(Duration::from_millis(250), Duration::from_secs(8));

    /// A caster: it bans those that come back fast.
    pub(crate) const CASTER: Self = Self::new(Duration::from_secs(10), Duration::from_mins(5));

    /// An address of datagrams: that of this computer changes seldom.
    pub(crate) const ADDRESS: Self = Self::new(Duration::from_secs(1), Duration::from_mins(1));

    const fn new(first: Duration, longest: Duration) -> Self {
        Self { first, longest, next: first }
    }

    /// Begins again, because something came.
    pub(crate) const fn reset(&mut self) {
        self.next = self.first;
    }

    /// Returns the next pause.
    pub(crate) const fn next(&self) -> Duration {
        self.next
    }

    /// Doubles the next pause.
    pub(crate) fn double(&mut self) {
        self.next = self.longest.min(2 * self.next);
    }
}

#[cfg(test)]
mod tests {
    use super::Pause;

    #[test]
    fn a_pause_doubles_up_to_its_longest_and_begins_again() {
        let mut pause = Pause::RECEIVER;
        let mut take = |_| {
            let now = pause.next().as_millis();
            pause.double();
            now
        };
        assert_eq!([0; 7].map(&mut take), [250, 500, 1000, 2000, 4000, 8000, 8000]);
        pause.reset();
        assert_eq!(pause.next().as_millis(), 250);
    }
}
