//! Lumps with look-ahead, so that their usual interval is known before the first silence.

use std::collections::{BTreeMap, VecDeque};

use anyhow::Result;

use crate::signal::lump::Lump;

/// Number of lumps that are read ahead: four minutes at one a second.
const AHEAD: usize = 256;

/// Number of different intervals that are counted separately; a further one counts as the next
/// longer of these.
const INTERVALS: usize = 4096;

/// Lumps with look-ahead.
pub(super) struct Ahead<I> {
    source: I,
    waiting: VecDeque<Lump>,
    intervals: Intervals,
    newest_ms: Option<u64>,
}

impl<I: Iterator<Item = Result<Lump>>> Ahead<I> {
    pub(super) fn of(source: I) -> Self {
        Self { source, waiting: VecDeque::new(), intervals: Intervals::default(), newest_ms: None }
    }

    /// Returns the next lump, and the time of the one behind it, ms.
    ///
    /// # Errors
    /// Errors of the source, as soon as they occur.
    pub(super) fn next(&mut self) -> Result<Option<(Lump, Option<u64>)>> {
        while self.waiting.len() <= AHEAD
            && let Some(lump) = self.source.next().transpose()?
        {
            let now_ms = lump.elapsed_ms();
            if let Some(before_ms) = self.newest_ms.replace(now_ms) {
                self.intervals.count(now_ms.saturating_sub(before_ms));
            }
            self.waiting.push_back(lump);
        }
        Ok(self.waiting.pop_front().map(|lump| (lump, self.waiting.front().map(Lump::elapsed_ms))))
    }

    /// Returns the median interval of all lumps so far and of those that are read ahead, ms; 0
    /// without intervals.
    pub(super) fn usual_ms(&self) -> u64 {
        self.intervals.median_ms()
    }
}

/// Number of occurrences of each interval.
#[derive(Default)]
struct Intervals {
    counts: BTreeMap<u64, u64>,
    all: u64,
}

impl Intervals {
    fn count(&mut self, interval_ms: u64) {
        let is_full = self.counts.len() >= INTERVALS;
        let nearest_ms = self.counts.range(interval_ms..).next().or(self.counts.last_key_value());
        let key_ms = nearest_ms.filter(|_| is_full).map_or(interval_ms, |(nearest_ms, _)| *nearest_ms);
        *self.counts.entry(key_ms).or_default() += 1;
        self.all += 1;
    }

    fn median_ms(&self) -> u64 {
        let mut below = 0;
        let median = self.counts.iter().find(|(_, count)| {
            below += **count;
            below > self.all / 2
        });
        median.map_or(0, |(interval_ms, _)| *interval_ms)
    }
}

#[cfg(test)]
mod tests {
    use raim_firmware::time::GpsTime;

    use super::*;

    #[test]
    fn the_median_is_that_of_the_sorted_intervals() {
        for intervals_ms in [&[7][..], &[3, 1], &[1000, 30_000, 1000, 1000, 999], &[5, 4, 3, 2, 1, 6]] {
            let mut intervals = Intervals::default();
            for interval_ms in intervals_ms {
                intervals.count(*interval_ms);
            }
            let mut sorted = intervals_ms.to_vec();
            sorted.sort_unstable();
            assert_eq!(intervals.median_ms(), sorted[sorted.len() / 2], "{intervals_ms:?}");
        }
        assert_eq!(Intervals::default().median_ms(), 0);
    }

    #[test]
    fn no_number_of_lumps_or_intervals_is_kept() {
        let mut elapsed_s = 0.0;
        let lumps = (0..20_000).map(|number| {
            elapsed_s += f64::from(number) * 1e-3;
            let time = GpsTime::from_ms((elapsed_s * 1e3) as u64);
            Ok(Lump { time, elapsed_s, bytes: Vec::new() })
        });
        let (mut ahead, mut many) = (Ahead::of(lumps), 0);
        while ahead.next().unwrap().is_some() {
            many += 1;
            assert!(ahead.waiting.len() <= AHEAD && ahead.intervals.counts.len() <= INTERVALS);
        }
        assert_eq!(many, 20_000);
    }
}
