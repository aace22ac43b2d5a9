//! Strengths of the signals: signals that one counterfeiting antenna sends arrive equally strong.
//!
//! ```text
//! s² = Σ_c Σ_i (C_i − C̄_c)² / (n − m)          s < 1 dB for 10 s, after s > 2 dB once: a sign
//! C̄ > 52 dB-Hz                                  a sign: stronger than any satellite
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `C_i` | C/N0 of a satellite's first signal | dB-Hz |
//! | `C̄_c`, `C̄` | their means in system `c` and in all | dB-Hz |
//! | `n`, `m` | satellites with a C/N0, systems among them; `n ≥ 6` | – |
//!
//! Genuine signals come from all directions, and the antenna receives low satellites more weakly.
//! Counterfeit signals of one antenna come from one direction. The mean of each system is removed,
//! because systems send with different powers. The trend with elevation is not removed, because it
//! tells genuine signals from counterfeit ones.
//!
//! This sign alone takes no promise back. It counts if the receiver also suspects spoofing.

use raim_core::satellite::Constellation;

use crate::raw::{RawEpoch, RawSignal};

/// Least number of satellites.
const LEAST_SATELLITES: u32 = 6;

/// Variance below which strengths are alike, dB².
const ALIKE_DB2: f32 = 1.0;

/// Variance above which strengths differ as those of genuine signals do, dB².
const APART_DB2: f32 = 4.0;

/// Time for which strengths must be alike, ms.
const ALIKE_MS: u64 = 10_000;

/// Mean above which signals are too strong for satellites, dB-Hz.
const STRONG_DB_HZ: f32 = 52.0;

/// Number, sum and sum of squares of strengths.
#[derive(Clone, Copy, Default)]
struct Sums {
    count: u32,
    sum: f32,
    squares: f32,
}

/// Memory of the strengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Strengths {
    /// True after strengths that differed as those of genuine signals do.
    were_apart: bool,
    /// Time since which strengths are alike, ms.
    alike_ms: Option<u64>,
}

impl Strengths {
    /// Memory of no epoch.
    pub(super) const NONE: Self = Self { were_apart: false, alike_ms: None };

    /// Takes an epoch. Returns true if its strengths indicate counterfeit signals.
    #[inline(never)]
    pub(super) fn take(&mut self, raw: &RawEpoch, now_ms: u64) -> bool {
        let mut systems = [Sums::default(); Constellation::COUNT];
        for satellite in &raw.satellites {
            let strength = satellite.signals.first().and_then(RawSignal::cn0_dbhz);
            let system = systems.get_mut(satellite.satellite.constellation() as usize);
            if let (Some(strength), Some(system)) = (strength, system) {
                system.count += 1;
                system.sum += strength;
                system.squares += strength * strength;
            }
        }
        let (mut count, mut sum, mut squares, mut unknowns) = (0, 0.0, 0.0, 0);
        for system in systems.iter().filter(|system| system.count > 0) {
            count += system.count;
            sum += system.sum;
            squares += system.squares - system.sum * system.sum / system.count as f32;
            unknowns += 1;
        }
        if count < LEAST_SATELLITES {
            self.alike_ms = None;
            return false;
        }
        let variance = squares / (count - unknowns) as f32;
        self.were_apart |= variance > APART_DB2;
        let since_ms = self.alike_ms.unwrap_or(now_ms);
        self.alike_ms = (variance < ALIKE_DB2).then_some(since_ms);
        let are_alike = self.alike_ms.is_some_and(|since_ms| now_ms.abs_diff(since_ms) >= ALIKE_MS);
        are_alike && self.were_apart || sum > STRONG_DB_HZ * count as f32
    }
}

#[cfg(test)]
mod tests {
    use raim_core::satellite::SatelliteId;

    use super::*;
    use crate::raw::{Band, Carrier, RawSatellite};
    use crate::time::GpsTime;

    /// Returns an epoch with these strengths, dB-Hz, of satellites of two systems in turn.
    fn epoch(strengths: &[f32]) -> RawEpoch {
        let mut raw = RawEpoch::new(GpsTime { week: 2300, tow_ms: 0 });
        for (number, &strength) in (1..).zip(strengths) {
            let (system, band) = if number % 2 == 0 {
                (Constellation::Gps, Band::L1)
            } else {
                (Constellation::Galileo, Band::E1)
            };
            let signal = RawSignal::new(Carrier::of(band), 2.2e7).with_cn0_dbhz(strength);
            let satellite = SatelliteId::new(system, number).expect("a satellite");
            let signals = core::iter::once(signal).collect();
            raw.satellites.push(RawSatellite { satellite, signals }).expect("room");
        }
        raw
    }

    const APART: [f32; 8] = [50.0, 48.0, 45.0, 41.0, 38.0, 44.0, 47.0, 36.0];
    /// Systems 3 dB apart, each alike.
    const ALIKE: [f32; 8] = [45.0, 42.0, 45.5, 42.5, 44.5, 42.0, 45.0, 41.5];

    #[test]
    fn strengths_that_become_alike_are_a_sign_after_ten_seconds() {
        let mut strengths = Strengths::NONE;
        assert!(!strengths.take(&epoch(&APART), 0));
        for second in 1..=20 {
            let have = strengths.take(&epoch(&ALIKE), 1000 * second);
            assert_eq!(have, second >= 11, "{second} s");
        }
        assert!(!strengths.take(&epoch(&APART), 21_000));
        assert!(!strengths.take(&epoch(&ALIKE), 22_000), "the time begins anew");
    }

    #[test]
    fn strengths_that_were_always_alike_are_those_of_the_receiver() {
        let mut strengths = Strengths::NONE;
        assert!((0..100).all(|second| !strengths.take(&epoch(&ALIKE), 1000 * second)));
    }

    #[test]
    fn five_satellites_say_nothing_and_too_strong_ones_do() {
        let mut strengths = Strengths::NONE;
        assert!(!strengths.take(&epoch(&[55.0; 5]), 0));
        assert!(strengths.take(&epoch(&[53.0, 52.5, 51.5, 53.0, 54.0, 50.0]), 1000));
        assert!(!strengths.take(&epoch(&[53.0, 52.5, 51.5, 52.0, 51.0, 51.9]), 2000));
    }
}
