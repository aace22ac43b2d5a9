//! Whether the epochs of several files can be of one receiver.
//!
//! A receiver writes one file after another; copies of a part of its time hold the same ranges. Where
//! two files hold other ranges of the same time, or their epochs stand in turn, two receivers were at
//! work. A merged recording of two would move its antenna with every epoch.

use crate::signal::measurement::MeasuredEpoch;

/// Largest difference of two ranges that are copies, m: ten times the last digit of a file.
const COPY_M: f64 = 0.01;

/// What is known of the files so far.
#[derive(Default)]
pub(super) struct OneReceiver {
    last: Option<(usize, MeasuredEpoch)>,
    /// Files of which an epoch came before one of another file.
    left: Vec<usize>,
    has_copies: bool,
}

impl OneReceiver {
    /// Takes the next epoch in time, with the number of its file; returns the number of the file that
    /// cannot be of the same receiver.
    pub(super) fn other(&mut self, file: usize, epoch: &MeasuredEpoch) -> Option<usize> {
        let (last_file, last) = self.last.as_ref().map(|(file, epoch)| (*file, epoch)).unzip();
        let other = last_file.filter(|last| *last != file);
        if let (Some(other), Some(last)) = (other, last.filter(|last| last.time == epoch.time)) {
            let differences_m = differences_m(last, epoch);
            let is_other = differences_m.iter().any(|difference_m| *difference_m > COPY_M);
            self.has_copies |= !differences_m.is_empty() && !is_other;
            return is_other.then_some(other);
        }
        self.left.extend(other);
        self.last = Some((file, epoch.clone()));
        // Of copies, one may lack epochs that the other has.
        other.filter(|_| self.left.contains(&file) && !self.has_copies)
    }
}

/// Returns how far the ranges of the signals differ that both epochs have, m.
fn differences_m(one: &MeasuredEpoch, other: &MeasuredEpoch) -> Vec<f64> {
    let signals = |epoch: &MeasuredEpoch| -> Vec<_> {
        let of = epoch.satellites.iter();
        of.flat_map(|one| one.signals.iter().map(|signal| (one.satellite, *signal))).collect()
    };
    let others = signals(other);
    let same = |(satellite, signal): (_, crate::signal::measurement::MeasuredSignal)| {
        let found = others.iter().find(|(name, one)| {
            *name == satellite && (one.band, one.attribute) == (signal.band, signal.attribute)
        });
        found.map(|(_, one)| (one.pseudorange_m - signal.pseudorange_m).abs())
    };
    signals(one).into_iter().filter_map(same).collect()
}

#[cfg(test)]
mod tests {
    use raim_core::satellite::{Constellation, SatelliteId};
    use raim_firmware::time::GpsTime;

    use super::*;
    use crate::signal::measurement::{MeasuredSatellite, MeasuredSignal};

    fn epoch(time_s: u64, range_m: f64) -> MeasuredEpoch {
        let signal = MeasuredSignal {
            band: 1,
            attribute: 'C',
            pseudorange_m: range_m,
            carrier_cycles: None,
            cn0_dbhz: None,
            doppler_hz: None,
        };
        let satellite = SatelliteId::new(Constellation::Gps, 3).unwrap();
        let satellites = vec![MeasuredSatellite { satellite, signals: vec![signal] }];
        MeasuredEpoch { time: GpsTime::from_ms(time_s * 1000), satellites }
    }

    /// Returns what is found of epochs, as file, time and range.
    fn found(epochs: &[(usize, u64, f64)]) -> Option<usize> {
        let mut files = OneReceiver::default();
        epochs.iter().find_map(|(file, time_s, range_m)| files.other(*file, &epoch(*time_s, *range_m)))
    }

    #[test]
    fn files_after_each_other_and_copies_are_of_one_receiver() {
        assert_eq!(found(&[(1, 1, 2e7), (1, 2, 2e7), (0, 3, 2e7), (0, 4, 2e7), (2, 5, 2e7)]), None);
        // The last epoch of an hour is the first of the next; a copy may lack one.
        assert_eq!(found(&[(0, 1, 2e7), (0, 2, 2e7), (1, 2, 2e7), (1, 3, 2e7)]), None);
        assert_eq!(found(&[(0, 1, 2e7), (1, 1, 2e7), (1, 2, 2e7), (0, 3, 2e7), (1, 3, 2e7)]), None);
    }

    #[test]
    fn other_ranges_of_the_same_time_and_epochs_in_turn_are_of_two() {
        assert_eq!(found(&[(0, 1, 2e7), (1, 1, 2e7 + 5.0)]), Some(0));
        assert_eq!(found(&[(0, 1, 2e7), (0, 2, 2e7), (1, 3, 2e7), (0, 4, 2e7)]), Some(1));
    }
}
