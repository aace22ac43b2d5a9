//! A ramp on one of few satellites beside a forecast clock: the attack on a clock that confirms
//! itself.
//!
//! A clock learned from satellites that only its own forecast confirms follows any ramp. The
//! requirement: no protected position is farther off than its level.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use crate::noise::Noise;
use crate::sky::{self, CAPACITY, SIGMA_M, receiver, satellite};
use raim_core::epoch::Epoch;
use raim_core::frame::LocalFrame;
use raim_core::monitor::{Monitor, Strategy};
use raim_core::report::{Report, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation;

const GEOMETRIES: u64 = 40;

/// Satellites while the clock is learned, s of learning, and s of the ramp.
const MANY: usize = 12;
const LEARNING_S: u32 = 40;
const RAMP_S: u32 = 150;

/// A receiver whose clock drifts steadily, under satellites that stand still.
struct Scene {
    directions: Vec<(f64, f64)>,
    noise: Noise,
}

impl Scene {
    fn new(seed: u64) -> Self {
        let mut noise = Noise(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let lowest = 10_f64.to_radians().sin();
        let mut direction =
            || (360.0 * noise.uniform(), (lowest + (1.0 - lowest) * noise.uniform()).asin().to_degrees());
        let directions = (0..MANY).map(|_| direction()).collect();
        Self { directions, noise }
    }

    /// Returns the first `count` satellites at a second; the first of them is off by `bias_m`.
    fn epoch(&mut self, second: u32, count: usize, systems: usize, bias_m: f64) -> Epoch<CAPACITY> {
        let mut epoch = Epoch::new(f64::from(second));
        for (index, &direction) in self.directions.iter().take(count).enumerate() {
            let constellation = [Constellation::Gps, Constellation::Galileo][index % systems];
            let clock_m = 3000.0 + 45.0 * f64::from(second);
            let mut observation = sky::observe(satellite(constellation, index + 1), direction, clock_m);
            observation.range_m += SIGMA_M * self.noise.normal();
            if index == 0 {
                observation.range_m += bias_m;
            }
            epoch.push(observation).unwrap();
        }
        epoch
    }
}

fn is_protected(report: &Report<CAPACITY>) -> bool {
    matches!(report.verdict, Verdict::Protected(_))
}

/// Excess of a protected position's error over its level, m; negative within the level.
fn beyond_m(report: &Report<CAPACITY>) -> Option<f64> {
    let (Some(solution), Some(levels)) = (&report.solution, report.protection) else { return None };
    let error = LocalFrame::at(receiver()).rotate(solution.position - receiver());
    is_protected(report).then(|| error.horizontal() - levels.hpl_m)
}

/// Epochs protected beyond their level, and epochs protected at all, while few satellites are left.
fn attack(seed: u64, count: usize, systems: usize, ramp_m_s: f64) -> (usize, usize) {
    let (mut scene, mut monitor) =
        (Scene::new(seed), Monitor::<f32, CAPACITY>::new(Requirements::non_precision_approach()).unwrap());
    monitor.set_strategy(Strategy::DEFAULT.with_clock_aid(true)).unwrap();
    monitor.start_from(receiver());
    for second in 0..LEARNING_S {
        monitor.process(&scene.epoch(second, MANY, systems, 0.0));
    }
    (0..RAMP_S).fold((0, 0), |(beyond, protected), since_s| {
        let bias_m = ramp_m_s * f64::from(since_s);
        let report = monitor.process(&scene.epoch(LEARNING_S + since_s, count, systems, bias_m));
        let is_beyond = beyond_m(&report).is_some_and(|beyond_m| beyond_m > 0.0);
        (beyond + usize::from(is_beyond), protected + usize::from(is_protected(&report)))
    })
}

#[test]
fn no_ramp_takes_a_forecast_clock_along() {
    for systems in [1, 2] {
        for count in [4, 5, 6] {
            for ramp_m_s in [2.0, 10.0] {
                let sums = (0..GEOMETRIES).map(|seed| attack(seed, count, systems, ramp_m_s));
                let (beyond, protected) = sums.fold((0, 0), |(b, p), (beyond, held)| (b + beyond, p + held));
                println!(
                    "{count} satellites, {systems} systems, {ramp_m_s} m/s: {beyond} of {protected} protected beyond"
                );
                assert_eq!(beyond, 0, "{count} satellites, {systems} systems, {ramp_m_s} m/s");
            }
        }
    }
}

#[test]
fn hold_over_ends_by_itself() {
    let (mut scene, mut monitor) =
        (Scene::new(3), Monitor::<f32, CAPACITY>::new(Requirements::non_precision_approach()).unwrap());
    monitor.set_strategy(Strategy::DEFAULT.with_clock_aid(true)).unwrap();
    monitor.start_from(receiver());
    for second in 0..LEARNING_S {
        monitor.process(&scene.epoch(second, MANY, 1, 0.0));
    }
    // Four satellites cannot test each other: for a minute only the forecast tests them.
    let tested: Vec<u32> = (LEARNING_S..LEARNING_S + RAMP_S)
        .filter(|&second| monitor.process(&scene.epoch(second, 4, 1, 0.0)).test.is_some())
        .collect();
    let want: Vec<u32> = (LEARNING_S..LEARNING_S + 60).collect();
    assert_eq!(tested, want);
}
