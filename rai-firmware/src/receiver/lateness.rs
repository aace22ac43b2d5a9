//! Lateness of epochs: a line, a relay or a logger can delay data, and their time tags do not show
//! it.
//!
//! ```text
//! late = max (0, max over p of (t − tₚ − (τ − τₚ) − d (t − tₚ)))
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `t`, `τ` | arrival of the epoch by the module's own clock; its tag | ms |
//! | `tₚ`, `τₚ` | the same for an earlier epoch `p` whose ranges agreed with orbits | ms |
//! | `d` | largest rate at which the module's own clock may gain: [`Boot::clock_error_ppm`](super::Boot::clock_error_ppm) | – |
//!
//! The path from the antenna to the module always takes some time; the shortest delay so far counts
//! as zero. Satellites move by kilometres in a second, so that the tag of an epoch is right if its
//! ranges agree with orbits. Only such epochs serve as reference. The ranges of a replayed
//! recording agree with the orbits of its old tags, so that it is late by its age.
//!
//! One epoch alone may be wrong, so that an epoch far ahead of the others is ignored. But
//! [`FIRM_EPOCHS`] epochs over [`FIRM_MS`] with the same delay replace the reference. Late epochs
//! replace it only while it rests on less than that itself.
//!
//! **Limits.** A delay that grows more slowly than `d` looks like a fast clock. A delay that exists
//! from the start is not detected. If the clock runs fast by more than `d`, every epoch is late in
//! the end.

use crate::division::divided;
use crate::time::{GpsTime, WEEK_MS};

/// Least number of epochs that make a reference firm.
const FIRM_EPOCHS: u8 = 10;

/// Least time from the first to the last of them, ms.
const FIRM_MS: u64 = 10_000;

/// Difference below which two delays count as the same, ms.
const SAME_MS: i64 = 1000;

/// Difference from the reference beyond which an epoch belongs to another cycle of GPS weeks, and
/// is not late, ms.
const HALF_CYCLE_MS: i64 = 512 * WEEK_MS as i64;

/// Delays of epochs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lateness {
    clock_error_ppm: u32,
    known: Option<Line>,
    /// Epochs that contradict `known`.
    other: Option<Line>,
}

/// An epoch, and its arrival by the module's own clock.
#[derive(Clone, Copy, Debug)]
struct Arrival {
    time: GpsTime,
    came_ms: u64,
}

/// Epochs with the same delay.
#[derive(Clone, Copy, Debug)]
struct Line {
    first: Arrival,
    shortest: Arrival,
    last_ms: u64,
    epochs: u8,
}

impl Lateness {
    /// Returns the state before the first epoch. The module's own clock may run fast by
    /// `clock_error_ppm`, parts per million.
    pub(super) const fn by_clock_within(clock_error_ppm: u32) -> Self {
        Self { clock_error_ppm, known: None, other: None }
    }

    /// Discards all epochs.
    pub(super) const fn forget(&mut self) {
        *self = Self::by_clock_within(self.clock_error_ppm);
    }

    /// Returns the lateness of an epoch, ms.
    pub(super) fn of(&self, time: GpsTime, came_ms: u64) -> u64 {
        let here = Arrival { time, came_ms };
        self.known.map_or(0, |known| {
            let late_ms = here.longer_ms(known.shortest);
            let late_ms = if late_ms < HALF_CYCLE_MS { late_ms } else { 0 };
            u64::try_from(late_ms)
                .unwrap_or(0)
                .saturating_sub(here.gained_ms(known.shortest, self.clock_error_ppm))
        })
    }

    /// Takes an epoch whose ranges agreed with orbits, so that its tag is right.
    pub(super) fn learn(&mut self, time: GpsTime, came_ms: u64) {
        let here = Arrival { time, came_ms };
        let clock_error_ppm = self.clock_error_ppm;
        let Some(known) = &mut self.known else {
            self.known = Some(Line::begun(here));
            return;
        };
        let longer_ms = here.longer_ms(known.shortest);
        if !(-SAME_MS..HALF_CYCLE_MS).contains(&longer_ms) {
            return self.dispute(here);
        }
        self.other = None;
        if known.is_firm() || known.holds(here, clock_error_ppm) {
            known.count(here);
        }
        if longer_ms <= here.gained_ms(known.shortest, clock_error_ppm).cast_signed() {
            known.shortest = here;
        }
    }

    /// Takes an epoch that was too late to be judged.
    pub(super) fn doubt(&mut self, time: GpsTime, came_ms: u64) {
        if self.known.is_some_and(|known| !known.is_firm()) {
            self.dispute(Arrival { time, came_ms });
        }
    }

    /// Counts an epoch that contradicts the reference.
    fn dispute(&mut self, here: Arrival) {
        let same = self.other.filter(|other| other.holds(here, self.clock_error_ppm));
        let mut other = same.unwrap_or(Line::begun(here));
        if other.last_ms != here.came_ms {
            other.count(here);
        }
        self.other = Some(other);
        if other.is_firm() {
            *self = Self { known: self.other, other: None, ..*self };
        }
    }
}

impl Arrival {
    /// Returns the delay minus that of an earlier epoch, ms.
    fn longer_ms(self, earlier: Self) -> i64 {
        self.came_ms.saturating_sub(earlier.came_ms).cast_signed() - self.time.since_ms(earlier.time)
    }

    /// Returns the most that the module's own clock may have gained since an earlier epoch, ms.
    fn gained_ms(self, earlier: Self, clock_error_ppm: u32) -> u64 {
        let passed_ms = self.came_ms.saturating_sub(earlier.came_ms);
        divided(passed_ms.saturating_mul(u64::from(clock_error_ppm)), 1_000_000).0
    }
}

impl Line {
    const fn begun(here: Arrival) -> Self {
        Self { first: here, shortest: here, last_ms: here.came_ms, epochs: 1 }
    }

    fn is_firm(&self) -> bool {
        self.epochs >= FIRM_EPOCHS && self.last_ms.saturating_sub(self.first.came_ms) >= FIRM_MS
    }

    /// Returns true if an epoch has the same delay as the first.
    fn holds(&self, here: Arrival, clock_error_ppm: u32) -> bool {
        here.longer_ms(self.first).abs() < SAME_MS + here.gained_ms(self.first, clock_error_ppm).cast_signed()
    }

    const fn count(&mut self, here: Arrival) {
        self.last_ms = here.came_ms;
        self.epochs = self.epochs.saturating_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::super::Boot;
    use super::*;

    const START: GpsTime = GpsTime { week: 2200, tow_ms: 0 };

    /// Returns the lateness of epochs, s, from their tags and arrivals, s. Epochs that are less
    /// than ten seconds late agree with orbits.
    fn late_s_by(clock_error_ppm: u32, epochs: &[(f64, f64)]) -> std::vec::Vec<f64> {
        let mut lateness = Lateness::by_clock_within(clock_error_ppm);
        let late = |&(tag_s, came_s): &(f64, f64)| {
            let time = GpsTime::from_ms(START.to_ms().wrapping_add_signed((tag_s * 1e3) as i64));
            let (came_ms, late_ms) = ((came_s * 1e3) as u64, lateness.of(time, (came_s * 1e3) as u64));
            if late_ms < 10_000 {
                lateness.learn(time, came_ms);
            } else {
                lateness.doubt(time, came_ms);
            }
            late_ms as f64 * 1e-3
        };
        epochs.iter().map(late).collect()
    }

    fn late_s(epochs: &[(f64, f64)]) -> std::vec::Vec<f64> {
        late_s_by(Boot::CRYSTAL_PPM, epochs)
    }

    fn assert_late(epochs: &[(f64, f64)], want_s: &[f64]) {
        for (have, want) in late_s(epochs).into_iter().zip(want_s) {
            assert!((have - want).abs() < 0.3, "{have} s, want {want}");
        }
    }

    #[test]
    fn what_the_line_holds_back_is_late() {
        // The path takes 0.3 s. Then the line delays by 5 s, catches up, and delays for good.
        let epochs = [(100.0, 0.3), (101.0, 1.3), (102.0, 7.3), (108.0, 8.3), (109.0, 14.3), (110.0, 15.3)];
        assert_late(&epochs, &[0.0, 0.0, 5.0, 0.0, 5.0, 5.0]);
    }

    #[test]
    fn a_fast_clock_of_its_own_is_no_delay() {
        let epochs: std::vec::Vec<_> =
            (0..10_000).map(|second| (f64::from(second), f64::from(second) * 1.039)).collect();
        let late_s = late_s_by(Boot::WITHOUT_CRYSTAL_PPM, &epochs);
        assert!(late_s.into_iter().all(|late_s| late_s < 0.02));
    }

    #[test]
    fn after_ten_minutes_of_silence_only_a_poor_clock_leaves_them_in_doubt() {
        // Ten minutes without data, and then a delay of 15 s.
        let epochs = [(0.0, 0.3), (1.0, 1.3), (601.0, 616.3)];
        let late_s = |clock_error_ppm| late_s_by(clock_error_ppm, &epochs)[2];
        assert!((14.8..15.0).contains(&late_s(Boot::CRYSTAL_PPM)));
        assert!(late_s(Boot::WITHOUT_CRYSTAL_PPM) == 0.0);
    }

    #[test]
    fn what_was_recorded_is_late_by_its_age() {
        const WEEK_S: f64 = WEEK_MS as f64 * 1e-3;
        assert_late(&[(5000.0, 1.0), (20.0, 2.0), (21.0, 3.0), (5003.0, 4.0)], &[0.0, 4981.0, 4981.0, 0.0]);
        assert_late(&[(0.0, 1.0), (1.0 - WEEK_S, 2.0)], &[0.0, WEEK_S]);
    }

    #[test]
    fn one_epoch_ahead_makes_the_others_late_for_no_longer_than_ten_take() {
        let healthy = |seconds: core::ops::Range<u32>| seconds.map(f64::from).map(|second| (second, second));
        let mut before: std::vec::Vec<_> = healthy(0..20).collect();
        before.push((319.0, 19.5));
        before.extend(healthy(20..40));
        assert_late(&before, &[0.0; 41]);
        // The first epoch of all is ahead.
        let mut first = std::vec![(300.0, 0.0)];
        first.extend(healthy(1..30));
        let late_s = late_s(&first);
        assert!(late_s[1..=11].iter().all(|late_s| (late_s - 300.0).abs() < 1.0), "{late_s:?}");
        assert!(late_s[12..].iter().all(|late_s| *late_s < 1.0), "{late_s:?}");
    }

    #[test]
    fn what_is_well_known_gives_way_to_no_epochs_that_are_late() {
        let held_back =
            |second: u32| (f64::from(second), f64::from(second) + if second < 30 { 0.0 } else { 20.0 });
        let late_s = late_s(&(0..200).map(held_back).collect::<std::vec::Vec<_>>());
        assert!(late_s[30..].iter().all(|late_s| (late_s - 20.0).abs() < 0.3), "{late_s:?}");
    }

    #[test]
    fn other_cycle_of_gps_weeks_is_no_delay() {
        const CYCLE_S: f64 = 1024.0 * WEEK_MS as f64 * 1e-3;
        assert_late(&[(0.0, 1.0), (1.0 - CYCLE_S, 2.0), (2.0 - CYCLE_S, 3.0)], &[0.0; 3]);
    }

    #[test]
    fn before_anything_agreed_nothing_is_late() {
        let lateness = Lateness::by_clock_within(Boot::CRYSTAL_PPM);
        assert_eq!(lateness.of(START, 0), 0);
        assert_eq!(lateness.of(START, u64::MAX / 2), 0);
    }
}
