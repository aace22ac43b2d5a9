//! Small skies aided by a coasting clock: tests that a forecast row makes possible, and values that
//! must not reach the forecasts.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use crate::noise::Noise;
use nalgebra::Vector3;
use raim_core::epoch::{Aiding, Epoch, Observation};
use raim_core::frame::Ecef;
use raim_core::internals::clock::{Clocks, Forecast, HOLD_OVER_STEPS, SolvedClocks, satellites_alone};
use raim_core::internals::integrity::raim::detection::detect;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::hypotheses::separability::separable;
use raim_core::internals::integrity::raim::isolation::baarda::{exclude_sequentially, identify};
use raim_core::internals::integrity::raim::isolation::exclusion::{ExclusionOutcome, Unidentified};
use raim_core::internals::least_squares::Snapshot;
use raim_core::internals::least_squares::equations::{LinearEpoch, MAX_ROWS};
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::{Constellation, SatelliteId};

use crate::solved::solved;

const GPS: Constellation = Constellation::Gps;
const BEIDOU: Constellation = Constellation::Beidou;
const SIGMA_M: f64 = 2.0;
const LEARNING_S: usize = 70;

/// Azimuth and elevation in degrees. In the first four and the first five alone, every fault shows,
/// and in a way of its own.
const SKY: [(f64, f64); 8] = [
    (320.0, 15.0),
    (150.0, 65.0),
    (290.0, 20.0),
    (30.0, 65.0),
    (50.0, 20.0),
    (200.0, 25.0),
    (100.0, 10.0),
    (240.0, 40.0),
];

type Sky<T> = Snapshot<'static, T>;

fn thresholds() -> Thresholds<'static> {
    let probability = |tail| Probability::new(tail).expect("a tail");
    Thresholds::from_tables(probability(1e-5), probability(1e-3)).expect("committed probabilities")
}

fn direction((azimuth_deg, elevation_deg): (f64, f64)) -> Vector3<f64> {
    let (azimuth, elevation) = (f64::to_radians(azimuth_deg), f64::to_radians(elevation_deg));
    Vector3::new(elevation.cos() * azimuth.sin(), elevation.cos() * azimuth.cos(), elevation.sin())
}

/// A receiver at the origin whose clock is a second off, drifts by 300 m/s and wanders by 0.2 m
/// each second.
struct Receiver {
    noise: Noise,
    second: usize,
    clock_m: f64,
}

impl Receiver {
    fn new(seed: u64) -> Self {
        Self { noise: Noise(seed), second: 0, clock_m: 299_792_458.0 }
    }

    fn time_s(&self) -> f64 {
        self.second as f64
    }

    fn wait(&mut self, seconds: usize) {
        for _ in 0..seconds {
            self.second += 1;
            self.clock_m += 300.0 + 0.2 * self.noise.normal();
        }
    }

    /// Returns the sky one second later: ranges to the first `satellites`, one of them faulty, and
    /// a forecast clock.
    fn next<T: Real>(
        &mut self,
        satellites: usize,
        fault: Option<(usize, f64)>,
        aid: Option<Forecast>,
    ) -> Sky<T> {
        let mut epoch = LinearEpoch::new();
        for (index, &place) in SKY[..satellites].iter().enumerate() {
            let bias_m = fault.filter(|fault| fault.0 == index).map_or(0.0, |fault| fault.1);
            let range_m = self.clock_m + SIGMA_M * self.noise.normal() + bias_m;
            epoch.satellite(GPS, direction(place), range_m, SIGMA_M).expect("a sound row");
        }
        if let Some(forecast) = aid {
            epoch.clock(GPS, forecast.value_m, forecast.sigma_m).expect("a sound row");
        }
        solved(epoch).expect("a usable sky")
    }
}

fn passes<T: Real>(snapshot: &Sky<T>) -> bool {
    detect(snapshot, &thresholds()).is_some_and(|detection| !detection.fault())
}

/// Returns a receiver after a minute under an open sky, and the clocks learned from it.
fn after_a_minute<T: Real>(seed: u64) -> (Receiver, Clocks<T>) {
    let (mut receiver, mut clocks) = (Receiver::new(seed), Clocks::new());
    for _ in 0..LEARNING_S {
        receiver.wait(1);
        let snapshot = receiver.next::<T>(SKY.len(), None, None);
        if passes(&snapshot) {
            clocks.learn(receiver.time_s(), &SolvedClocks::of(&snapshot));
        }
    }
    (receiver, clocks)
}

fn forecast<T: Real>(clocks: &Clocks<T>, receiver: &Receiver) -> Option<Forecast> {
    clocks.of(GPS).and_then(|clock| clock.forecast(receiver.time_s()))
}

/// Returns the sky one second later, aided, with `satellites` left.
fn aided_second(seed: u64, satellites: usize, fault: Option<(usize, f64)>) -> Sky<f32> {
    let (mut receiver, clocks) = after_a_minute::<f32>(seed);
    receiver.wait(1);
    let aid = forecast(&clocks, &receiver);
    assert!(aid.is_some(), "a minute makes a forecast");
    receiver.next(satellites, fault, aid)
}

#[test]
fn four_satellites_alone_cannot_be_tested_and_with_the_clock_they_can() {
    let alone: Sky<f32> = Receiver::new(1).next(4, Some((2, 100.0)), None);
    assert!(detect(&alone, &thresholds()).is_none());
    for seed in 0..100 {
        let aided = aided_second(seed, 4, None);
        assert_eq!(aided.dof(), 1);
        assert!(passes(&aided), "false alarm with seed {seed}");
    }
}

#[test]
fn fault_of_100_m_on_any_of_four_satellites_is_detected_and_named_on_none() {
    for (seed, satellite, bias_m) in
        (0..20).flat_map(|seed| (0..4).flat_map(move |s| [(seed, s, 100.0), (seed, s, -100.0)]))
    {
        let aided = aided_second(seed, 4, Some((satellite, bias_m)));
        assert!(!passes(&aided), "seed {seed}: {bias_m} m on {satellite} is not detected");
        assert_eq!(identify(&aided, &thresholds()), Err(Unidentified::NoRedundancy));
    }
}

#[test]
fn fault_of_100_m_on_any_of_five_satellites_is_excluded_and_the_position_holds() {
    for (seed, satellite, bias_m) in
        (0..20).flat_map(|seed| (0..5).flat_map(move |s| [(seed, s, 100.0), (seed, s, -100.0)]))
    {
        let mut aided = aided_second(seed, 5, Some((satellite, bias_m)));
        let exclusion = exclude_sequentially(&mut aided, &thresholds());
        let excluded: Vec<usize> = exclusion.rows.iter().map(|row| row.index).collect();
        assert_eq!(
            (exclusion.outcome, excluded),
            (ExclusionOutcome::Isolated, vec![satellite]),
            "seed {seed}, {bias_m} m"
        );
        assert!(separable(&mut aided, &exclusion, &thresholds()), "seed {seed}, {bias_m} m on {satellite}");
        // The receiver is at the origin; what is left are four satellites and a clock of 3 m.
        assert!(aided.correction().norm() < 30.0, "seed {seed}: {} m off", aided.correction().norm());
    }
}

#[test]
fn clock_jump_of_300_m_is_the_clock_and_no_satellite() {
    for (seed, satellites, jump_m) in
        (0..20).flat_map(|seed| [(seed, 5, 300.0), (seed, 6, -300.0), (seed, 8, 300.0)])
    {
        let (mut receiver, mut clocks) = after_a_minute::<f32>(seed);
        receiver.wait(1);
        receiver.clock_m += jump_m;
        let mut aided: Sky<f32> = receiver.next(satellites, None, forecast(&clocks, &receiver));
        let exclusion = exclude_sequentially(&mut aided, &thresholds());
        let excluded: Vec<usize> = exclusion.rows.iter().map(|row| row.index).collect();
        // The row after the satellites is the clock's.
        assert_eq!(
            (exclusion.outcome, excluded),
            (ExclusionOutcome::Isolated, vec![satellites]),
            "seed {seed}"
        );

        clocks.learn(receiver.time_s(), &SolvedClocks::of(&aided));
        receiver.wait(1);
        assert_eq!(forecast(&clocks, &receiver), None, "the window goes on across the jump");
    }
}

#[test]
fn clock_that_jumped_is_learned_anew() {
    let (mut receiver, mut clocks) = after_a_minute::<f32>(3);
    receiver.clock_m += 299_792.458;
    for _ in 0..20 {
        receiver.wait(1);
        clocks.learn(receiver.time_s(), &SolvedClocks::of(&receiver.next::<f32>(8, None, None)));
    }
    receiver.wait(1);
    let have = forecast(&clocks, &receiver).expect("a new window");
    assert!((have.value_m - receiver.clock_m).abs() < 10.0, "{have:?}, want {}", receiver.clock_m);
}

#[test]
fn forecast_holds_over_half_a_minute_without_satellites() {
    for satellite in 0..4 {
        let (mut receiver, clocks) = after_a_minute::<f32>(5);
        receiver.wait(30);
        let aid = forecast(&clocks, &receiver);
        assert_eq!(aid.map(|forecast| forecast.steps), Some(30));
        assert!(passes(&receiver.next::<f32>(4, None, aid)));
        assert!(!passes(&receiver.next::<f32>(4, Some((satellite, 100.0)), aid)), "satellite {satellite}");
    }
    let (mut receiver, clocks) = after_a_minute::<f32>(5);
    receiver.wait(HOLD_OVER_STEPS + 1);
    assert_eq!(forecast(&clocks, &receiver), None);
}

#[test]
fn lasting_fault_of_one_of_four_satellites_never_reaches_the_forecasts() {
    let (mut receiver, mut clocks) = after_a_minute::<f32>(7);
    for second in 0..HOLD_OVER_STEPS {
        receiver.wait(1);
        let faulty = (5..40).contains(&second);
        let aid = forecast(&clocks, &receiver);
        let error_m = aid.expect("within the hold-over").value_m - receiver.clock_m;
        assert!(error_m.abs() < 25.0, "{second} s: the forecast is {error_m} m off");
        let snapshot: Sky<f32> = receiver.next(4, faulty.then_some((1, 100.0)), aid);
        assert_eq!(passes(&snapshot), !faulty, "{second} s");
        if passes(&snapshot) {
            clocks.learn(receiver.time_s(), &SolvedClocks::of(&snapshot));
        }
    }
}

#[test]
fn clock_is_learned_as_the_satellites_alone_have_it() {
    for satellites in [4, 5, 8] {
        let (mut receiver, clocks) = after_a_minute::<f64>(11);
        receiver.wait(1);
        let aid = forecast(&clocks, &receiver);
        let seed = receiver.noise.0;
        let aided: Sky<f64> = receiver.next(satellites, None, aid);
        receiver.noise = Noise(seed);
        let unaided: Sky<f64> = receiver.next(satellites, None, None);

        let have = satellites_alone(&aided, GPS).expect("enough satellites");
        let want_m = unaided.clock_m(GPS).expect("a clock");
        let want_sigma_m = unaided.clock_variance(GPS).expect("a clock").sqrt();
        assert!((have.value_m - want_m).abs() < 1e-6, "have {}, want {want_m}", have.value_m);
        assert!(
            (have.sigma_m / want_sigma_m - 1.0).abs() < 1e-9,
            "have {}, want {want_sigma_m}",
            have.sigma_m
        );
        assert!(aided.clock_variance(GPS).expect("a clock") < unaided.clock_variance(GPS).expect("a clock"));
    }
}

#[test]
fn clock_of_four_satellites_on_the_horizon_and_one_above_is_the_mean_of_the_four() {
    let mut epoch = LinearEpoch::<f64, MAX_ROWS>::new();
    for place in [(0.0, 0.0), (90.0, 0.0), (180.0, 0.0), (270.0, 0.0), (0.0, 90.0)] {
        epoch.satellite(GPS, direction(place), 0.0, SIGMA_M).expect("a sound row");
    }
    let snapshot = solved(epoch).expect("a usable sky");
    // Satellites on the horizon do not measure the height, the one above does alone.
    let have = snapshot.clock_variance(GPS).expect("a clock");
    assert!((have - SIGMA_M * SIGMA_M / 4.0).abs() < 1e-12, "have {have}");
}

#[test]
fn lone_satellite_of_a_constellation_teaches_no_clock() {
    let (mut receiver, mut clocks) = (Receiver::new(13), Clocks::<f32>::new());
    for _ in 0..20 {
        receiver.wait(1);
        let mut epoch = LinearEpoch::<f32, MAX_ROWS>::new();
        for (index, &place) in SKY.iter().enumerate() {
            let constellation = if index == 0 { BEIDOU } else { GPS };
            epoch.satellite(constellation, direction(place), receiver.clock_m, SIGMA_M).expect("a sound row");
        }
        clocks.learn(receiver.time_s(), &SolvedClocks::of(&solved(epoch).expect("a usable sky")));
    }
    let forecasts = |constellation| clocks.of(constellation).and_then(|clock| clock.forecast(21.0)).is_some();
    assert!(forecasts(GPS) && !forecasts(BEIDOU));
}

/// Clocks of two constellations, `BeiDou`'s from noisier ranges.
fn two_constellations() -> Clocks<f32> {
    let mut clocks = Clocks::new();
    for second in 1..=20 {
        let clock_m = 300.0 * f64::from(second);
        let mut epoch = LinearEpoch::<f32, MAX_ROWS>::new();
        for (index, &place) in SKY.iter().enumerate() {
            let (constellation, sigma_m) = if index % 2 == 0 { (GPS, 1.0) } else { (BEIDOU, 10.0) };
            epoch.satellite(constellation, direction(place), clock_m, sigma_m).expect("a sound row");
        }
        clocks.learn(f64::from(second), &SolvedClocks::of(&solved(epoch).expect("a usable sky")));
    }
    clocks
}

fn observed(constellations: &[Constellation]) -> Epoch<12> {
    let mut epoch = Epoch::new(21.0);
    for &constellation in constellations {
        let satellite = SatelliteId::new(constellation, 5).expect("a satellite");
        let position = Ecef::new(15.6e6, 0.0, 21.6e6);
        epoch
            .push(Observation { satellite, position, range_m: 2.1e7, sigma_m: 1.0 })
            .expect("a sound observation");
    }
    epoch
}

#[test]
fn surest_clock_of_those_observed_aids_the_epoch() {
    let clocks = two_constellations();
    let aid = |constellations: &[Constellation]| match clocks.aiding(&observed(constellations).view()) {
        Some(Aiding::Clock { constellation, value_m, .. }) => {
            assert!((value_m - 6300.0).abs() < 0.01, "{value_m} m");
            Some(constellation)
        }
        _ => None,
    };
    assert_eq!(aid(&[BEIDOU, GPS]), Some(GPS));
    assert_eq!(aid(&[BEIDOU]), Some(BEIDOU));
    assert_eq!(aid(&[Constellation::Galileo]), None);
    assert_eq!(aid(&[]), None);
}
