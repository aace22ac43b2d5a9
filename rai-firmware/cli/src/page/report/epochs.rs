//! The values of all epochs over time, in bounded memory.
//!
//! Every epoch has a bucket until there are [`MOST`] of them. Then each two neighbours become one,
//! with the smallest and the largest of their values and the worst of their states. The largest
//! values are stored only from then on, because those of one epoch are its smallest.

use super::code::{UNKNOWN, coded};
use crate::page::Verdict;

/// Largest number of buckets: a day at one epoch a second fits.
const MOST: usize = 90_000;

/// Curves of a bucket, by the names that the script knows.
pub(super) const CURVES: [&str; 8] = ["hpl", "vpl", "hal", "val", "he", "ve", "stat", "thr"];

/// Values that have no extremes, by the names that the script knows.
pub(super) const VALUES: [&str; 4] = ["clock", "east", "north", "up"];

/// Values of one epoch, in the order of [`CURVES`] and [`VALUES`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sample {
    pub(super) time_s: f64,
    pub(super) curves: [Option<f64>; CURVES.len()],
    pub(super) values: [Option<f64>; VALUES.len()],
    /// Number of the reason.
    pub(super) reason: u8,
    pub(super) severity: u8,
    /// Level of the pin, 0 or 1.
    pub(super) pin: u8,
    pub(super) used: u8,
    pub(super) excluded: u8,
}

/// Severity of a verdict: that of the worst counts for a bucket.
pub(super) const fn severity(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::Protected => 0,
        Verdict::Unavailable => 1,
        Verdict::Alert => 2,
    }
}

/// Epochs next to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bucket {
    /// Milliseconds after the first epoch.
    pub(super) first_ms: u32,
    /// Smallest values.
    pub(super) low: Codes,
    pub(super) values: [f32; VALUES.len()],
    pub(super) reason: u8,
    pub(super) severity: u8,
    /// The lowest level of the pin.
    pub(super) pin: u8,
    /// The fewest satellites used.
    pub(super) used: u8,
    /// The most satellites excluded.
    pub(super) excluded: u8,
}

impl Bucket {
    fn of(sample: &Sample) -> Self {
        Self {
            first_ms: (sample.time_s * 1e3).round() as u32,
            low: sample.curves.map(coded),
            values: sample.values.map(|value| value.map_or(f32::NAN, |value| value as f32)),
            reason: sample.reason,
            severity: sample.severity,
            pin: sample.pin,
            used: sample.used,
            excluded: sample.excluded,
        }
    }

    fn join(&mut self, other: &Self) {
        for curve in 0..CURVES.len() {
            self.low[curve] = least(self.low[curve], other.low[curve]);
        }
        for (value, other) in self.values.iter_mut().zip(other.values) {
            if value.is_nan() {
                *value = other;
            }
        }
        if other.severity > self.severity {
            (self.reason, self.severity) = (other.reason, other.severity);
        }
        self.pin = self.pin.min(other.pin);
        self.used = self.used.min(other.used);
        self.excluded = self.excluded.max(other.excluded);
    }
}

/// Returns the smaller code; an unknown one does not count.
pub(super) fn least(one: i16, other: i16) -> i16 {
    match (one, other) {
        (UNKNOWN, code) | (code, UNKNOWN) => code,
        _ => one.min(other),
    }
}

/// Codes of the curves.
type Codes = [i16; CURVES.len()];

/// Returns the largest codes of both. The unknown is the least of all codes.
fn largest(one: Codes, other: Codes) -> Codes {
    std::array::from_fn(|curve| one[curve].max(other[curve]))
}

/// All epochs.
#[derive(Clone, Debug)]
pub(super) struct Epochs {
    pub(super) buckets: Vec<Bucket>,
    /// Largest values of each bucket; empty while a bucket is one epoch.
    pub(super) high: Vec<Codes>,
    /// Epochs of a bucket.
    pub(super) stretch: u64,
    all: u64,
}

impl Default for Epochs {
    fn default() -> Self {
        // All the room at once, which costs nothing before it is used. Growing it would need the
        // old and the new room at the same time.
        Self { buckets: Vec::with_capacity(MOST + 1), high: Vec::new(), stretch: 1, all: 0 }
    }
}

impl Epochs {
    pub(super) fn push(&mut self, sample: &Sample) {
        let bucket = Bucket::of(sample);
        let is_next = self.all.is_multiple_of(self.stretch);
        if let Some(last) = self.buckets.last_mut().filter(|_| !is_next) {
            last.join(&bucket);
            if let Some(high) = self.high.last_mut() {
                *high = largest(*high, bucket.low);
            }
        } else {
            self.buckets.push(bucket);
            if self.stretch > 1 {
                self.high.push(bucket.low);
            }
        }
        self.all += 1;
        if self.buckets.len() >= MOST && self.all.is_multiple_of(2 * self.stretch) {
            self.halve();
        }
    }

    fn halve(&mut self) {
        self.stretch *= 2;
        let mut highs = Vec::with_capacity(MOST / 2 + 1);
        for index in (0..self.buckets.len()).step_by(2) {
            let (mut joined, mut high) = (self.buckets[index], self.high_of(index));
            if let Some(second) = self.buckets.get(index + 1) {
                joined.join(second);
                high = largest(high, self.high_of(index + 1));
            }
            self.buckets[highs.len()] = joined;
            highs.push(high);
        }
        self.buckets.truncate(highs.len());
        self.high = highs;
    }

    /// Returns the largest values of a bucket.
    fn high_of(&self, index: usize) -> Codes {
        self.high.get(index).copied().unwrap_or(self.buckets[index].low)
    }

    /// Returns the number of epochs.
    pub(super) fn all(&self) -> u64 {
        self.all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(number: u32) -> Sample {
        let hpl = if number == 123_457 { 99.0 } else { 10.0 + f64::from(number % 7) };
        let severity = if number == 70_001 { 2 } else { 0 };
        Sample {
            time_s: f64::from(number),
            curves: [Some(hpl), None, None, None, None, None, None, None],
            severity,
            reason: severity,
            used: if number == 5 { 4 } else { 12 },
            ..Sample::default()
        }
    }

    #[test]
    fn a_day_is_whole_and_of_a_week_the_extremes_stay() {
        let mut epochs = Epochs::default();
        (0..86_400).for_each(|number| epochs.push(&sample(number)));
        assert_eq!((epochs.stretch, epochs.buckets.len()), (1, 86_400));
        (86_400..604_800).for_each(|number| epochs.push(&sample(number)));
        assert!(epochs.buckets.len() <= MOST && epochs.buckets.len() > MOST / 2, "{}", epochs.buckets.len());
        assert_eq!(epochs.all(), 604_800);
        let of = |number: u64| epochs.buckets[(number / epochs.stretch) as usize];
        assert_eq!(epochs.high.len(), epochs.buckets.len());
        assert_eq!(epochs.high[(123_457 / epochs.stretch) as usize][0], coded(Some(99.0)));
        assert_eq!(of(123_457).low[0], coded(Some(10.0)));
        assert_eq!((of(70_001).severity, of(70_001).reason, of(5).used), (2, 2, 4));
        assert_eq!(of(0).low[1], UNKNOWN);
        assert!(epochs.buckets.is_sorted_by(|one, other| one.first_ms < other.first_ms));
    }
}
