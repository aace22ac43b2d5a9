//! Satellites of a report: a line of figures and a track for each, in bounded memory.
//!
//! A track has a bucket for each stretch of epochs, at first one epoch. If there are [`MOST`], each
//! two neighbours become one with the extremes of both.

use std::collections::BTreeMap;

use raim_core::satellite::SatelliteId;

use super::code::{UNKNOWN, coded};
use super::epochs::least;
use crate::satellites::{Account, Fate};

/// Largest number of buckets of a track.
const MOST: u64 = 2048;

/// C/N0 in a byte: quarters of a dB-Hz; 0 is unknown.
const PER_DBHZ: f64 = 4.0;

/// An epoch, or several, of one satellite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    /// Number of the bucket.
    pub(super) bucket: u32,
    pub(super) cn0: [u8; 2],
    pub(super) residual: [i16; 2],
    pub(super) sigma: i16,
    /// W-test of the largest magnitude.
    pub(super) w_test: i16,
    /// Azimuth and elevation in hundredths of a degree; [`UNKNOWN`] without an orbit.
    pub(super) direction: [i16; 2],
    /// Number of the fate; an exclusion outranks use, and use outranks the rest.
    pub(super) fate: u8,
}

impl Spot {
    fn of(bucket: u32, seen: &Account) -> Self {
        let cn0 = seen.cn0_dbhz.map_or(0, |dbhz| (dbhz * PER_DBHZ).round() as u8);
        let residual = coded(seen.residual_m);
        // Azimuths from −180° fit into 16 bits.
        let hundredths = |radians: Option<f64>| {
            let degrees = radians.map(f64::to_degrees);
            let degrees = degrees.map(|degrees| if degrees > 180.0 { degrees - 360.0 } else { degrees });
            degrees.map_or(UNKNOWN, |degrees| (degrees * 100.0).round() as i16)
        };
        Self {
            bucket,
            cn0: [cn0; 2],
            residual: [residual; 2],
            sigma: coded(seen.sigma_m),
            w_test: coded(seen.w_test),
            direction: [hundredths(seen.azimuth_rad), hundredths(seen.elevation_rad)],
            fate: seen.fate as u8,
        }
    }

    fn join(&mut self, other: &Self) {
        let lowest = [self.cn0[0], other.cn0[0]].into_iter().filter(|cn0| *cn0 > 0).min();
        self.cn0 = [lowest.unwrap_or(0), self.cn0[1].max(other.cn0[1])];
        self.residual = [least(self.residual[0], other.residual[0]), self.residual[1].max(other.residual[1])];
        if magnitude(other.w_test) > magnitude(self.w_test) {
            (self.w_test, self.sigma) = (other.w_test, other.sigma);
        }
        if self.direction[0] == UNKNOWN {
            self.direction = other.direction;
        }
        if rank(other.fate) > rank(self.fate) {
            self.fate = other.fate;
        }
    }
}

fn magnitude(code: i16) -> i32 {
    if code == UNKNOWN { -1 } else { i32::from(code).abs() }
}

fn rank(fate: u8) -> u8 {
    match Fate::ALL.get(usize::from(fate)) {
        Some(fate) if fate.is_excluded() => 2,
        Some(Fate::Used) => 1,
        _ => 0,
    }
}

/// Figures of one satellite over all its epochs.
#[derive(Clone, Debug, Default)]
pub(super) struct Satellite {
    pub(super) track: Vec<Spot>,
    pub(super) epochs: u64,
    /// Epochs by number of fate.
    pub(super) fates: [u64; Fate::ALL.len()],
    pub(super) elevation_deg: Option<[f64; 2]>,
    pub(super) last_azimuth_deg: Option<f64>,
    of_cn0: Sum,
    of_residual: Sum,
    of_sigma: Sum,
    pub(super) largest_w: Option<f64>,
}

/// Count, sum and sum of squares.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    count: u64,
    total: f64,
    squares: f64,
}

impl Sum {
    fn add(&mut self, value: Option<f64>) {
        let Some(value) = value else { return };
        self.count += 1;
        self.total += value;
        self.squares += value * value;
    }

    fn mean(self) -> Option<f64> {
        (self.count > 0).then(|| self.total / self.count as f64)
    }

    fn rms(self) -> Option<f64> {
        (self.count > 0).then(|| (self.squares / self.count as f64).sqrt())
    }
}

impl Satellite {
    /// Returns the mean C/N0, dB-Hz.
    pub(super) fn cn0_dbhz(&self) -> Option<f64> {
        self.of_cn0.mean()
    }

    /// Returns the root mean square of the residuals while it is used, m.
    pub(super) fn residual_m(&self) -> Option<f64> {
        self.of_residual.rms()
    }

    /// Returns the mean sigma, m.
    pub(super) fn sigma_m(&self) -> Option<f64> {
        self.of_sigma.mean()
    }

    /// Returns the number of epochs in which it is used.
    pub(super) fn used(&self) -> u64 {
        self.fates[Fate::Used as usize]
    }

    fn push(&mut self, bucket: u32, seen: &Account) {
        let spot = Spot::of(bucket, seen);
        match self.track.last_mut().filter(|last| last.bucket == bucket) {
            Some(last) => last.join(&spot),
            None => self.track.push(spot),
        }
        self.epochs += 1;
        self.fates[seen.fate as usize] += 1;
        self.of_cn0.add(seen.cn0_dbhz);
        self.of_sigma.add(seen.sigma_m);
        self.of_residual.add(seen.residual_m.filter(|_| seen.fate == Fate::Used));
        if let Some(elevation_deg) = seen.elevation_rad.map(f64::to_degrees) {
            let [low, high] = self.elevation_deg.unwrap_or([elevation_deg; 2]);
            self.elevation_deg = Some([low.min(elevation_deg), high.max(elevation_deg)]);
        }
        self.last_azimuth_deg = seen.azimuth_rad.map(f64::to_degrees).or(self.last_azimuth_deg);
        if let Some(w_test) = seen.w_test
            && self.largest_w.is_none_or(|largest| w_test.abs() > largest.abs())
        {
            self.largest_w = Some(w_test);
        }
    }

    fn halve(&mut self) {
        let mut half = 0;
        for index in 0..self.track.len() {
            let spot = Spot { bucket: self.track[index].bucket / 2, ..self.track[index] };
            if half > 0 && self.track[half - 1].bucket == spot.bucket {
                self.track[half - 1].join(&spot);
            } else {
                self.track[half] = spot;
                half += 1;
            }
        }
        self.track.truncate(half);
        self.track.shrink_to_fit();
    }
}

/// All satellites.
#[derive(Clone, Debug)]
pub(super) struct Satellites {
    pub(super) all: BTreeMap<SatelliteId, Satellite>,
    /// Epochs of a bucket.
    stretch: u64,
    epochs: u64,
    /// Milliseconds from the first epoch to that of each bucket.
    pub(super) times_ms: Vec<u32>,
}

impl Default for Satellites {
    fn default() -> Self {
        Self { all: BTreeMap::new(), stretch: 1, epochs: 0, times_ms: Vec::new() }
    }
}

impl Satellites {
    pub(super) fn push(&mut self, time_s: f64, seen: &[Account]) {
        if self.epochs / self.stretch >= MOST {
            self.stretch *= 2;
            self.all.values_mut().for_each(Satellite::halve);
            let mut index = 0;
            self.times_ms.retain(|_| {
                index += 1;
                index % 2 == 1
            });
        }
        let bucket = self.epochs / self.stretch;
        if self.times_ms.len() as u64 == bucket {
            self.times_ms.push((time_s * 1e3).round() as u32);
        }
        for one in seen {
            self.all.entry(one.satellite).or_default().push(bucket as u32, one);
        }
        self.epochs += 1;
    }
}

#[cfg(test)]
mod tests {
    use raim_core::satellite::Constellation;

    use super::super::code::value;
    use super::*;

    fn seen(number: u32) -> Account {
        let mut account = Account::of(
            SatelliteId::new(Constellation::Gps, 5).unwrap(),
            if number == 5001 { Fate::Excluded } else { Fate::Used },
        );
        account.azimuth_rad = Some(3.5);
        account.elevation_rad = Some(0.5);
        account.cn0_dbhz = Some(if number == 7777 { 20.0 } else { 45.0 });
        account.residual_m = Some(if number == 5001 { 80.0 } else { -1.0 });
        account.sigma_m = Some(2.0);
        account.w_test = Some(if number == 5001 { 40.0 } else { -0.5 });
        account
    }

    #[test]
    fn an_event_of_one_epoch_stays_however_long_the_track_is() {
        let mut satellites = Satellites::default();
        (0..100_000).for_each(|number| satellites.push(f64::from(number), &[seen(number)]));
        let gps = satellites.all.values().next().unwrap();
        assert!(gps.track.len() as u64 <= MOST && gps.track.len() as u64 > MOST / 2, "{}", gps.track.len());
        assert_eq!(gps.track.len(), satellites.times_ms.len());
        let of = |number: u64| gps.track[(number / satellites.stretch) as usize];
        let event = of(5001);
        assert_eq!(event.fate, Fate::Excluded as u8);
        assert!((value(event.residual[1]).unwrap() - 80.0).abs() < 0.1);
        assert!((value(event.residual[0]).unwrap() + 1.0).abs() < 0.01);
        assert!((value(event.w_test).unwrap() - 40.0).abs() < 0.1);
        assert_eq!(of(7777).cn0, [80, 180]);
        assert_eq!((gps.epochs, gps.used(), gps.largest_w), (100_000, 99_999, Some(40.0)));
        assert_eq!(gps.residual_m(), Some(1.0), "an excluded range is no residual of the position");
        assert_eq!(satellites.times_ms[3], 3 * 1000 * satellites.stretch as u32);
        // 200.5° is −159.5°.
        assert_eq!(event.direction, [-15_946, 2_865]);
    }
}
