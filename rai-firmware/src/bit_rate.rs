//! Bit rate of the GNSS port: fixed by command, or found by trial.
//!
//! At a wrong rate, bytes come without a valid frame. After [`PATIENCE_MS`] of such bytes, the port
//! tries the next of [`RATES`], in a cycle. An unplugged cable looks the same, because noise also
//! gives bytes without a frame. The last working rate is therefore tried again between any two
//! others, so that a reconnected receiver is found soon.
//!
//! A silent line gives no information about its rate. The rate therefore stays, and a receiver that
//! returns is read at once. A silence of [`PATIENCE_MS`] also restarts the time, so that single
//! bytes between rare epochs do not count against the rate. The rate of a receiver that sends less
//! often than that is not found, and must be set by `BAUD`.

/// Bit rates to try, in this order, beginning with the rate at start, bit/s.
pub const RATES: [u32; 6] = [115_200, 38_400, 230_400, 460_800, 921_600, 9_600];

/// Time for which bytes may come without a valid frame, ms.
pub const PATIENCE_MS: u64 = 5_000;

/// The rate in force, with the evidence for and against it.
#[derive(Debug)]
pub struct BitRate {
    in_force: u32,
    /// Rate of the last valid frame, bit/s.
    proven: Option<u32>,
    /// Last of [`RATES`] that was tried, bit/s.
    tried: u32,
    /// Number of valid frames at the last call of [`BitRate::next`].
    frames: u32,
    /// Times of the first and last byte without a valid frame, ms since start.
    unread_ms: Option<(u64, u64)>,
}

impl Default for BitRate {
    fn default() -> Self {
        Self::new()
    }
}

impl BitRate {
    /// Returns the state at start, with the first of [`RATES`].
    pub const fn new() -> Self {
        let [at_start, ..] = RATES;
        Self { in_force: at_start, proven: None, tried: at_start, frames: 0, unread_ms: None }
    }

    /// Notes that bytes have come.
    pub fn receive(&mut self, now_ms: u64) {
        self.unread_ms = match self.unread_ms {
            Some((first_ms, last_ms)) if now_ms.saturating_sub(last_ms) < PATIENCE_MS => {
                Some((first_ms, now_ms))
            }
            _ => Some((now_ms, now_ms)),
        };
    }

    /// Returns the new rate of the port, bit/s, or `None` if the rate stays.
    ///
    /// `frames` is the number of valid frames since start. `fixed` is the rate that a command has
    /// set, bit/s.
    pub fn next(&mut self, frames: u32, fixed: Option<u32>) -> Option<u32> {
        let is_read = core::mem::replace(&mut self.frames, frames) != frames;
        if is_read {
            self.proven = Some(self.in_force);
        }
        if is_read || fixed.is_some() {
            self.unread_ms = None;
        }
        let is_unread =
            self.unread_ms.is_some_and(|(first_ms, last_ms)| last_ms.saturating_sub(first_ms) >= PATIENCE_MS);
        let wanted = match fixed {
            Some(baud) => baud,
            None if is_unread => self.following(),
            None => self.in_force,
        };
        if wanted == self.in_force {
            return None;
        }
        (self.in_force, self.unread_ms) = (wanted, None);
        Some(wanted)
    }

    /// Returns the next rate to try: the last working rate, or, if that is in force, the one after
    /// the last trial.
    fn following(&mut self) -> u32 {
        if let Some(proven) = self.proven.filter(|proven| *proven != self.in_force) {
            return proven;
        }
        let behind = RATES.iter().skip_while(|baud| **baud != self.tried).skip(1);
        let others = |baud: &&u32| **baud != self.in_force;
        self.tried = behind.chain(&RATES).find(others).copied().unwrap_or(self.in_force);
        self.tried
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    /// Returns the changes of the rate on a line that sends a byte each 100 ms. A rate gives frames
    /// if `reads` is true.
    fn set(seconds: u64, fixed: Option<u32>, reads: impl Fn(u32) -> bool) -> Vec<(u64, u32)> {
        let (mut rate, mut baud, mut frames, mut changes) = (BitRate::new(), RATES[0], 0, Vec::new());
        for now_ms in (0..1000 * seconds).step_by(100) {
            rate.receive(now_ms);
            frames += u32::from(reads(baud));
            if let Some(next) = rate.next(frames, fixed) {
                baud = next;
                changes.push((now_ms, next));
            }
        }
        changes
    }

    #[test]
    fn rates_are_tried_in_order_until_one_works() {
        assert_eq!(set(60, None, |_| true), []);
        let have = set(60, None, |baud| baud == 9_600);
        assert_eq!(have.iter().map(|(_, baud)| *baud).collect::<Vec<_>>(), RATES[1..]);
        assert!(
            have.iter().zip(have.iter().skip(1)).all(|(a, b)| b.0 - a.0 <= PATIENCE_MS + 200),
            "{have:?}"
        );
    }

    #[test]
    fn when_none_works_they_are_tried_again() {
        let have: Vec<u32> = set(70, None, |_| false).into_iter().map(|(_, baud)| baud).collect();
        let want: Vec<u32> = RATES.into_iter().cycle().skip(1).take(have.len()).collect();
        assert!(have.len() > RATES.len() && have == want, "{have:?}");
    }

    #[test]
    fn a_rate_that_a_command_has_fixed_stays() {
        assert_eq!(set(60, Some(460_800), |_| false), [(0, 460_800)]);
        assert_eq!(set(60, Some(115_200), |_| false), []);
    }

    #[test]
    fn what_is_said_between_rare_epochs_does_not_count_against_the_rate() {
        let mut rate = BitRate::new();
        for epoch in 1..20 {
            let now_ms = 30_000 * u64::from(epoch);
            rate.receive(now_ms);
            assert_eq!(rate.next(epoch, None), None);
            // Bytes after the last frame.
            rate.receive(now_ms + 100);
            assert_eq!(rate.next(epoch, None), None);
        }
    }

    #[test]
    fn noise_moves_from_a_proven_rate_for_as_long_as_the_patience_at_most() {
        let (mut rate, mut baud) = (BitRate::new(), RATES[0]);
        let (mut away_since_ms, mut tried) = (None, Vec::new());
        // A frame at 38400, then noise for two minutes.
        assert_eq!(rate.next(0, Some(RATES[1])), Some(RATES[1]));
        assert_eq!(rate.next(1, None), None);
        for now_ms in (0..120_000).step_by(100) {
            rate.receive(now_ms);
            if let Some(next) = rate.next(1, None) {
                baud = next;
                away_since_ms = (next != RATES[1]).then_some(now_ms);
                tried.extend((next != RATES[1]).then_some(next));
            }
            assert!(away_since_ms.is_none_or(|since_ms| now_ms - since_ms <= PATIENCE_MS + 200), "{baud}");
        }
        // The others are still tried, so that a receiver that was set to another rate is found.
        assert!(RATES.iter().all(|baud| *baud == RATES[1] || tried.contains(baud)), "{tried:?}");
    }

    #[test]
    fn a_silent_line_keeps_its_rate() {
        let mut rate = BitRate::new();
        rate.receive(0);
        for _ in 0..100 {
            assert_eq!(rate.next(0, None), None);
        }
    }
}
