//! Ranges of one epoch: selects which are stored, and compares later ranges with them.

use heapless::Vec;
use raim_core::internals::numeric::bounds::is_within;
use raim_core::satellite::SatelliteId;

use crate::counters::count;
use crate::input::Counters;
use crate::raw::{RawEpoch, RawSatellite, RawSignal};

/// Possible pseudoranges, m.
///
/// No satellite is nearer than 19,000 km or farther than 43,000 km; a receiver clock may add or
/// subtract 30 ms.
const RANGE_M: core::ops::RangeInclusive<f64> = 1.0e7..=5.2e7;

/// Difference of two ranges of one band at one instant beyond which they are of two antennas or two
/// clocks, m. If a receiver repeats a range, both values agree to the resolution of the messages.
/// Reflections can make different codes of one band differ by as much. Then at least one of the
/// codes agrees with the stored range.
const APART_M: f64 = 5.0;

/// Returns a hash of all satellites and ranges; `None` without satellites.
///
/// Two different consecutive epochs have the same hash once in 2³². The second is then dropped,
/// which costs one epoch in thirteen years at 10 Hz.
pub(super) fn hash_of_ranges(epoch: &RawEpoch) -> Option<u32> {
    let mix = |hash: u32, word: u32| (hash.rotate_left(5) ^ word).wrapping_mul(0x9E37_79B1);
    let hash = epoch.satellites.iter().fold(0, |hash, satellite| {
        let hash = mix(
            hash,
            u32::from(satellite.satellite.number()) << 8 | satellite.satellite.constellation() as u32,
        );
        satellite.signals.iter().fold(hash, |hash, signal| {
            let bits = signal.range_m.to_bits();
            mix(mix(hash ^ signal.carrier.band as u32, bits as u32), (bits >> 32) as u32)
        })
    });
    (!epoch.satellites.is_empty()).then_some(hash)
}

/// Comparison of the ranges of a message with the stored ranges of the same satellites.
///
/// ```text
/// of two receivers if  n(differ) > 0  and  n(differ) ≥ n(agree)
/// ```
///
/// A satellite differs if it has a band on which every new range differs from the stored one. A
/// single wrong range among repeated ones does not indicate a second receiver: it is left to the
/// integrity test.
pub(super) struct Comparison {
    /// Largest difference of two ranges of one antenna, m.
    most_m: f64,
    satellite: Option<SatelliteId>,
    /// Bands of the satellite on which a new range equals the stored one.
    agree: u16,
    /// Bands of the satellite on which a new range differs from the stored one.
    differ: u16,
    /// Number of satellites that agree, minus those that differ.
    balance: i16,
    has_differed: bool,
}

impl Comparison {
    /// Returns a comparison of ranges that may have changed by `moved_m` between their tags.
    pub(super) const fn within(moved_m: f64) -> Self {
        let most_m = APART_M + moved_m;
        Self { most_m, satellite: None, agree: 0, differ: 0, balance: 0, has_differed: false }
    }

    /// Adds the next signal. The signals of a satellite are consecutive.
    pub(super) fn add(&mut self, epoch: &RawEpoch, satellite: SatelliteId, signal: &RawSignal) {
        if self.satellite.is_some_and(|before| before != satellite) {
            self.close();
        }
        self.satellite = Some(satellite);
        let known = epoch.satellites.iter().filter(|known| known.satellite == satellite);
        let band = signal.carrier.band;
        for known in known.flat_map(|known| &known.signals).filter(|known| known.carrier.band == band) {
            let is_apart = (known.range_m - signal.range_m).abs() > self.most_m;
            *(if is_apart { &mut self.differ } else { &mut self.agree }) |= 1 << band as u16;
        }
    }

    /// Counts the satellite whose signals are complete.
    fn close(&mut self) {
        let is_other = self.differ & !self.agree != 0;
        self.has_differed |= is_other;
        if self.agree | self.differ != 0 {
            self.balance = self.balance.saturating_add(if is_other { -1 } else { 1 });
        }
        (self.agree, self.differ) = (0, 0);
    }

    /// Returns true if the ranges come from a second receiver.
    pub(super) fn finds_another(mut self) -> bool {
        self.close();
        self.has_differed && self.balance <= 0
    }
}

/// Adds a signal of a message that began when the epoch held `earlier` satellites; returns true for
/// a duplicate.
///
/// A satellite of an earlier message of the epoch is a duplicate and keeps its first ranges.
pub(super) fn add(
    epoch: &mut RawEpoch,
    satellite: SatelliteId,
    signal: RawSignal,
    is_reference: bool,
    earlier: usize,
    counters: &mut Counters,
) -> bool {
    if !is_within(signal.range_m, &RANGE_M) {
        count(&mut counters.ranges_out_of_bounds);
        return false;
    }
    // The signals of a satellite are consecutive.
    let known = epoch.satellites.iter_mut().enumerate().rev().find(|(_, known)| known.satellite == satellite);
    match known {
        Some((index, _)) if index < earlier => {
            count(&mut counters.satellites_duplicate);
            return true;
        }
        Some((_, known)) => add_signal(known, signal, is_reference, counters),
        None => open(epoch, satellite, signal, counters),
    }
    false
}

fn open(epoch: &mut RawEpoch, satellite: SatelliteId, signal: RawSignal, counters: &mut Counters) {
    let mut raw = RawSatellite { satellite, signals: Vec::new() };
    add_signal(&mut raw, signal, false, counters);
    if epoch.satellites.push(raw).is_err() {
        count(&mut counters.satellites_surplus);
    }
}

/// Stores one code of each band: the one that the broadcast clock refers to, otherwise the first on
/// the wire. If that code has no usable strength, it takes the strength of the other. If the
/// satellite has more bands than fit, spare bands are left out.
fn add_signal(raw: &mut RawSatellite, signal: RawSignal, is_reference: bool, counters: &mut Counters) {
    if let Some(known) = raw.signals.iter_mut().find(|known| known.carrier.band == signal.carrier.band) {
        if is_reference {
            *known = match known.cn0_dbhz() {
                Some(cn0_dbhz) if signal.cn0_dbhz().is_none() => signal.with_cn0_dbhz(cn0_dbhz),
                _ => signal,
            };
        }
        count(&mut counters.signals_surplus);
    } else if raw.signals.push(signal).is_err() {
        count(&mut counters.signals_surplus);
        let spare = raw.signals.iter_mut().rev().find(|known| known.carrier.band.is_spare());
        if let Some(spare) = spare.filter(|_| !signal.carrier.band.is_spare()) {
            *spare = signal;
        }
    }
}
