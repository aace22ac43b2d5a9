//! The bit rate of the GNSS port: fixed by command, or found.
//!
//! A receiver that sends at another rate is heard as bytes without a frame. While they come and [`PATIENCE_MS`] pass
//! without a frame whose check is right, the next of [`RATES`] is tried, round and round. Noise on a line that somebody
//! has pulled sounds the same: the rate of the last frame is tried again between any two others, and who comes back is heard
//! within as long.
//!
//! A silent line tells nothing of its rate, so the last one stays: who comes back is heard at once. Bytes after a silence
//! of as long begin the time anew, or what a receiver says between two rare epochs would count against it; one that says
//! something less often than that is not found, and needs `BAUD`.

/// The rates that are tried, in this order, from the one at start; bits a second.
pub const RATES: [u32; 6] = [115_200, 38_400, 230_400, 460_800, 921_600, 9_600];

/// How long bytes may come without a frame, ms.
pub const PATIENCE_MS: u64 = 5_000;

/// The rate in force, and what speaks against it.
#[derive(Debug)]
pub struct BitRate {
    in_force: u32,
    /// The one at which a frame was read last.
    proven: Option<u32>,
    /// The last of [`RATES`] that was tried.
    tried: u32,
    /// Frames that have been counted.
    frames: u32,
    /// First and last byte without a frame, ms since start.
    unread_ms: Option<(u64, u64)>,
}

impl Default for BitRate {
    fn default() -> Self {
        Self::new()
    }
}

impl BitRate {
    /// The rate at which every port starts.
    pub const fn new() -> Self {
        let [at_start, ..] = RATES;
        Self { in_force: at_start, proven: None, tried: at_start, frames: 0, unread_ms: None }
    }

    /// Bytes have come.
    pub fn hear(&mut self, now_ms: u64) {
        self.unread_ms = match self.unread_ms {
            Some((first_ms, last_ms)) if now_ms.saturating_sub(last_ms) < PATIENCE_MS => {
                Some((first_ms, now_ms))
            }
            _ => Some((now_ms, now_ms)),
        };
    }

    /// The rate that the port is to have from now on, where that is another one.
    ///
    /// `frames` counts those with a right check since start; `fixed` is what a command has said, bits a second.
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

    /// The rate to try instead of the one in force: the proven one, and from there the one behind what was tried last.
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

    /// Rates that are set within some seconds of a line that sends a byte each 100 ms, with a frame where `reads` says so.
    fn set(seconds: u64, fixed: Option<u32>, reads: impl Fn(u32) -> bool) -> Vec<(u64, u32)> {
        let (mut rate, mut baud, mut frames, mut changes) = (BitRate::new(), RATES[0], 0, Vec::new());
        for now_ms in (0..1000 * seconds).step_by(100) {
            rate.hear(now_ms);
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
            rate.hear(now_ms);
            assert_eq!(rate.next(epoch, None), None);
            // Behind the last frame.
            rate.hear(now_ms + 100);
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
            rate.hear(now_ms);
            if let Some(next) = rate.next(1, None) {
                baud = next;
                away_since_ms = (next != RATES[1]).then_some(now_ms);
                tried.extend((next != RATES[1]).then_some(next));
            }
            assert!(away_since_ms.is_none_or(|since_ms| now_ms - since_ms <= PATIENCE_MS + 200), "{baud}");
        }
        // All others all the same: a receiver that was set to another rate is found.
        assert!(RATES.iter().all(|baud| *baud == RATES[1] || tried.contains(baud)), "{tried:?}");
    }

    #[test]
    fn a_silent_line_keeps_its_rate() {
        let mut rate = BitRate::new();
        rate.hear(0);
        for _ in 0..100 {
            assert_eq!(rate.next(0, None), None);
        }
    }
}
