//! Receivers noisier than their sigmas, with slow faults: levels bound what the noise may hide.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use crate::noise::Noise;
use crate::sky::{CAPACITY, DIRECTIONS, SIGMA_M, observe, receiver, satellite};
use raim_core::epoch::Epoch;
use raim_core::frame::LocalFrame;
use raim_core::monitor::Monitor;
use raim_core::report::{Report, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation;

/// A quarter of an hour.
const EPOCHS: u32 = 900;

/// Number of epochs of one run or of several.
#[derive(Debug, Default)]
struct Count {
    protected: u32,
    beyond: u32,
    /// Epochs without the satellite whose range is wrong.
    excluding: u32,
    epochs: u32,
}

impl Count {
    /// Adds a report, if it counts.
    fn add(&mut self, report: &Report<CAPACITY>, counts: bool) {
        if !counts {
            return;
        }
        self.epochs += 1;
        if matches!(report.verdict, Verdict::Protected(_)) {
            let levels = report.protection.as_ref().unwrap();
            let error = report.solution.as_ref().unwrap().position - receiver();
            let error = LocalFrame::at(receiver()).rotate(error);
            self.protected += 1;
            self.beyond += u32::from(error.horizontal() > levels.hpl_m || error.up.abs() > levels.vpl_m);
        }
    }
}

/// A noisy sky.
#[derive(Clone, Copy)]
struct Sky {
    /// Standard deviation of the noise at a second, in units of its sigma.
    noise: fn(u32) -> f64,
    /// Time over which the noise is correlated, s.
    correlated_s: f64,
    seed: u64,
}

/// Adds a quarter of an hour with errors of satellites, by their index and the second, m.
fn run(sky: Sky, error_m: &dyn Fn(usize, u32) -> f64, faulty: usize, count: &mut Count) {
    let mut monitor = Monitor::<f64, CAPACITY>::new(Requirements::non_precision_approach()).unwrap();
    let (mut chance, mut noise) = (Noise(sky.seed), [0.0; DIRECTIONS.len()]);
    let kept = if sky.correlated_s > 0.0 { (-1.0 / sky.correlated_s).exp() } else { 0.0 };
    for value in &mut noise {
        *value = chance.normal();
    }
    for second in 0..EPOCHS {
        let mut epoch = Epoch::new(f64::from(second));
        for (index, direction) in DIRECTIONS.into_iter().enumerate() {
            noise[index] = kept * noise[index] + (1.0 - kept * kept).sqrt() * chance.normal();
            let mut seen = observe(satellite(Constellation::Gps, index + 1), direction, 0.0);
            seen.range_m += SIGMA_M * (sky.noise)(second) * noise[index] + error_m(index, second);
            epoch.push(seen).unwrap();
        }
        let report = monitor.process(&epoch);
        let faulty = satellite(Constellation::Gps, faulty + 1);
        count.excluding += u32::from(report.excluded.iter().any(|suspect| suspect.satellite == faulty));
        count.add(&report, true);
    }
}

/// The settings permit a missed fault in one of a thousand epochs.
fn assert_bounded(count: &Count, what: &str) {
    println!("{what}: {count:?}");
    assert!(count.beyond * 1000 <= count.protected, "{what}: {count:?}");
}

#[test]
fn one_satellites_ramp_is_bounded_whatever_the_noise() {
    let noises: [fn(u32) -> f64; 3] = [|_| 0.5, |_| 1.0, |_| 3.0];
    for (number, noise) in noises.into_iter().enumerate() {
        for correlated_s in [0.0, 60.0] {
            for rate_m_s in [0.01, 0.03, 0.1, 0.3, 1.0] {
                let mut count = Count::default();
                for faulty in 0..DIRECTIONS.len() {
                    let ramp =
                        |index, second| if index == faulty { rate_m_s * f64::from(second) } else { 0.0 };
                    let sky = Sky { noise, correlated_s, seed: 1 + faulty as u64 };
                    run(sky, &ramp, faulty, &mut count);
                }
                assert_bounded(&count, &format!("noise {number}, {correlated_s} s, {rate_m_s} m/s"));
                // The noise must not swallow the fault: at the end it is 100 of its sigmas or more.
                if rate_m_s >= 0.3 && number < 2 {
                    assert!(count.excluding * 3 > count.epochs, "{rate_m_s}: {count:?}");
                }
            }
        }
    }
}

#[test]
fn two_ramps_at_once_and_a_street_after_quiet_are_bounded() {
    let mut count = Count::default();
    for seed in 1..=20_u64 {
        let (one, other) = (seed as usize % 8, (seed as usize * 3 + 1) % 8);
        for rate_m_s in [0.03, 0.3] {
            let ramps = |index, second| {
                if index == one || index == other { rate_m_s * f64::from(second) } else { 0.0 }
            };
            run(Sky { noise: |_| 1.0, correlated_s: 0.0, seed }, &ramps, one, &mut count);
        }
    }
    assert_bounded(&count, "two ramps");
    let mut street = Count::default();
    for seed in 1..=40 {
        let sky = Sky { noise: |second| if second < 450 { 0.3 } else { 4.0 }, correlated_s: 20.0, seed };
        run(sky, &|_, _| 0.0, 0, &mut street);
    }
    assert_bounded(&street, "quiet, then street");
    // The street costs at most ten epochs of each quarter of an hour.
    assert!(street.protected + 40 * 20 > street.epochs, "{street:?}");
}

#[test]
fn a_burst_costs_its_own_epochs_alone() {
    let mut count = Count::default();
    for seed in 1..=20 {
        let noise = |second| if (450..456).contains(&second) { 10.0 } else { 0.7 };
        run(Sky { noise, correlated_s: 0.0, seed }, &|_, _| 0.0, 0, &mut count);
    }
    assert_bounded(&count, "burst");
    assert!(count.protected + 20 * 15 > count.epochs, "{count:?}");
}

/// Adds two minutes of 150 random skies of 6 to 15 satellites, in which several satellites are wrong
/// by 10 to 300 m from a second on.
fn several_faults(faults: usize, from: u32, count: &mut Count) {
    for seed in 0..150_u64 {
        let mut chance = Noise((seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (faults as u64) << 40);
        let systems = 1 + (seed % 2) as usize;
        let satellites = 5 + systems + (chance.uniform() * 8.0) as usize;
        let least = 10_f64.to_radians().sin();
        let mut sky: Vec<_> = (0..satellites)
            .map(|_| {
                let sin_elevation = least + chance.uniform() * (1.0 - least);
                ((360.0 * chance.uniform(), sin_elevation.asin().to_degrees()), 0.0)
            })
            .collect();
        for (_, fault_m) in sky.iter_mut().take(faults) {
            let size_m = 10.0 * 30_f64.powf(chance.uniform());
            *fault_m = if chance.uniform() < 0.5 { size_m } else { -size_m };
        }
        let mut monitor = Monitor::<f64, CAPACITY>::new(Requirements::non_precision_approach()).unwrap();
        for second in 0..120 {
            let mut epoch = Epoch::new(f64::from(second));
            for (index, (direction, fault_m)) in sky.iter().enumerate() {
                let constellation = [Constellation::Gps, Constellation::Galileo][index % systems];
                let mut seen = observe(satellite(constellation, index + 1), *direction, 0.0);
                seen.range_m += SIGMA_M * chance.normal() + if second >= from { *fault_m } else { 0.0 };
                epoch.push(seen).unwrap();
            }
            count.add(&monitor.process(&epoch), second >= from);
        }
    }
}

/// Faults that stay may pass for noise after their first alert, and then the levels bound them too.
/// No level is made for several faults, so that few positions are beyond theirs.
#[test]
fn several_faults_that_stay_raise_the_levels() {
    for from in [0, 60] {
        for faults in 2..=4 {
            let mut count = Count::default();
            several_faults(faults, from, &mut count);
            println!("{faults} faults from second {from}: {count:?}");
            assert!(count.beyond * 50 < count.protected, "{faults} from {from}: {count:?}");
        }
    }
}

/// Ranges that are made in another way come from the same receiver.
#[test]
fn noise_outlasts_a_change_of_ranges() {
    let mut monitor = Monitor::<f64, CAPACITY>::new(Requirements::non_precision_approach()).unwrap();
    let mut chance = Noise(3);
    for second in 0..60 {
        let mut epoch = Epoch::new(f64::from(second));
        for (index, direction) in DIRECTIONS.into_iter().enumerate() {
            let mut seen = observe(satellite(Constellation::Gps, index + 1), direction, 0.0);
            seen.range_m += 4.0 * SIGMA_M * chance.normal();
            epoch.push(seen).unwrap();
        }
        monitor.process(&epoch);
    }
    let before = monitor.noise(59.0);
    assert!(before > 9.0, "{before}");
    monitor.forget_residuals();
    assert_eq!(monitor.noise(59.0).to_bits(), before.to_bits());
}
