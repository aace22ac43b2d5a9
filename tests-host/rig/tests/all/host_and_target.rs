//! Equality of host and target: the same epochs give the same reports, to the last bit of every
//! number.
//!
//! Thousands of random epochs, with every method, policy and aiding, go through the core twice:
//! here, compiled for this machine, and in the measuring image on the emulated processor. That one
//! formats its reports as `Debug` does: the shortest text that stands for exactly these bits.

use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::{Ecef, Enu, LocalFrame};
use raim_core::internals::integrity::raim::detection::threshold::policy::Policy;
use raim_core::internals::integrity::raim::isolation::parity;
use raim_core::internals::numeric::real::Real;
use raim_core::monitor::{Method, Monitor, Strategy};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::correction::CAPACITY;
use rand::RngExt;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rig::board::is_installed;
use rig::laboratory::{Bench, Scalar, Stage, epoch_bytes, point_bytes};

/// Methods in the order of the image's numbers.
const METHODS: [Method; 8] = [
    Method::Baarda,
    Method::Parity(parity::Isolation::Simultaneous),
    Method::Parity(parity::Isolation::Sequential),
    Method::Parity(parity::Isolation::Hybrid),
    Method::Parity(parity::Isolation::Grouping),
    Method::Ransac,
    Method::Araim,
    Method::Auto,
];
const POLICIES: [Policy; 3] = [Policy::T1, Policy::T2, Policy::TOp];

/// Number of epochs of one monitor.
const EPOCHS: usize = 12;

/// One monitor: its strategy, its start, and its epochs.
struct Life {
    strategy: (usize, usize, bool),
    start: Ecef,
    epochs: Vec<Epoch<CAPACITY>>,
}

impl Life {
    /// Returns a receiver anywhere on earth, a random sky with up to four faults, and the same
    /// satellites with other noise from epoch to epoch.
    fn random(number: usize) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(number as u64);
        let place = place(&mut random);
        let sky = sky(&mut random, place);
        let start =
            if random.random_bool(0.5) { Ecef::CENTRE } else { place + Ecef::new(300.0, -500.0, 700.0) };
        let epochs = (0..EPOCHS).map(|second| epoch(&mut random, place, &sky, second as f64)).collect();
        let strategy =
            (number % METHODS.len(), number / METHODS.len() % POLICIES.len(), number.is_multiple_of(5));
        Self { strategy, start, epochs }
    }

    fn bytes(&self) -> Vec<u8> {
        let (method, policy, clock_aid) = self.strategy;
        let mut bytes = vec![method as u8, policy as u8, u8::from(clock_aid)];
        bytes.extend(point_bytes(self.start));
        bytes.push(self.epochs.len() as u8);
        bytes.extend(self.epochs.iter().flat_map(epoch_bytes));
        bytes
    }

    /// Returns the reports of this machine on the first `N` satellites.
    fn reports<T: Real, const N: usize>(&self) -> Vec<String> {
        let (method, policy, clock_aid) = self.strategy;
        let mut monitor =
            Monitor::<T, N>::new(Requirements::non_precision_approach()).expect("in the tables");
        monitor
            .set_strategy(
                Strategy::CLASSIC
                    .with_method(METHODS[method])
                    .with_policy(POLICIES[policy])
                    .with_clock_aid(clock_aid),
            )
            .expect("every method is built in");
        monitor.start_from(self.start);
        let first = |epoch: &Epoch<CAPACITY>| {
            let mut first = Epoch::<N>::new(epoch.time_s());
            epoch.observations().iter().take(N).for_each(|seen| first.push(*seen).expect("room"));
            first
        };
        self.epochs.iter().map(|epoch| format!("{:?}", monitor.process(&first(epoch)))).collect()
    }
}

fn place(random: &mut ChaCha8Rng) -> Ecef {
    let (latitude_rad, longitude_rad): (f64, f64) =
        (random.random_range(-1.5..1.5), random.random_range(-3.1..3.1));
    raim_core::frame::Geodetic { latitude_rad, longitude_rad, height_m: random.random_range(-100.0..9e3) }
        .to_ecef()
}

/// Returns four to 45 satellites of up to four constellations, with their sigmas and faults.
fn sky(random: &mut ChaCha8Rng, place: Ecef) -> Vec<(Observation, f64)> {
    let frame = LocalFrame::at(place);
    let count = random.random_range(4..=45);
    let constellations = random.random_range(1..=4);
    let faults = random.random_range(0..=4);
    let satellite = |random: &mut ChaCha8Rng, index: usize| {
        let azimuth_rad: f64 = random.random_range(0.0..std::f64::consts::TAU);
        let elevation_rad: f64 = random.random_range(0.05..1.57);
        let distance_m = random.random_range(2.0e7..3.9e7);
        let horizontal_m = distance_m * elevation_rad.cos();
        let (east, north) = (horizontal_m * azimuth_rad.sin(), horizontal_m * azimuth_rad.cos());
        let position = place + frame.unrotate(Enu { east, north, up: distance_m * elevation_rad.sin() });
        let satellite =
            SatelliteId::new(Constellation::ALL[index % constellations], index as u8 + 1).expect("a number");
        let sigma_m = random.random_range(0.5..8.0);
        let fault_m = if index < faults { random.random_range(-300.0..300.0) } else { 0.0 };
        (Observation { satellite, position, range_m: place.distance_m(position), sigma_m }, fault_m)
    };
    (0..count).map(|index| satellite(random, index)).collect()
}

fn epoch(random: &mut ChaCha8Rng, place: Ecef, sky: &[(Observation, f64)], time_s: f64) -> Epoch<CAPACITY> {
    /// Effect of the earth's rotation on a range.
    const RATE: f64 = 7.292_115_146_7e-5 / 299_792_458.0;
    let clock_m = 2e4 + 30.0 * time_s;
    let mut epoch = Epoch::new(time_s);
    for (observation, fault_m) in sky {
        let satellite = observation.position;
        let rotation_m = RATE * (satellite.x_m * place.y_m - satellite.y_m * place.x_m);
        let noise_m = observation.sigma_m * random.random_range(-1.7..1.7);
        let range_m = observation.range_m + rotation_m + clock_m + noise_m + fault_m;
        epoch.push(Observation { range_m, ..*observation }).expect("a plausible range");
    }
    epoch
}

fn compare<T: Real>(scalar: Scalar, lives: std::ops::Range<usize>) {
    let lives: Vec<Life> = lives.map(Life::random).collect();
    let mut bench = Bench::default();
    for life in &lives {
        bench.request(Stage::Judge, scalar, &life.bytes());
    }
    let have = bench.run().expect("the image comes to its end");
    let want: Vec<String> = lives.iter().flat_map(Life::reports::<T, CAPACITY>).collect();
    assert_eq!(have.len(), want.len());
    for (number, (have, want)) in have.iter().zip(&want).enumerate() {
        assert_eq!(have.result, *want, "epoch {} of life {}", number % EPOCHS, number / EPOCHS);
    }
    let count = |word: &str| want.iter().filter(|report| report.contains(word)).count();
    let (protected, alert) = (count("verdict: Protected"), count("verdict: Alert"));
    println!("{} epochs identical: {protected} protected, {alert} alerts", want.len());
    let count = want.len();
    let words =
        if count < 1000 { count.to_string() } else { format!("{},{:03}", count / 1000, count % 1000) };
    let precision = if scalar == Scalar::Single {
        format!("{words} epochs in `f32`")
    } else {
        format!("{words} in `f64` identical")
    };
    rig::document::must_say("results/adversary.md", &precision);
    // Faults that stay are alerts at first. Then they may pass for noise.
    let refused = want.len() - protected;
    assert!(
        protected.min(refused) * 10 > want.len() && alert > 1,
        "too few of a kind to mean anything: {protected} protected, {alert} alerts"
    );
}

/// Returns the bytes of the deepest stack for each method, of the monitor and of its memory.
fn bytes_of_judging<const N: usize>(stage: Stage) -> ([usize; METHODS.len()], [usize; 2]) {
    let lives: Vec<Life> = (0..4 * METHODS.len() * POLICIES.len()).map(Life::random).collect();
    let mut bench = Bench::default();
    for life in &lives {
        bench.request(stage, Scalar::Single, &life.bytes());
    }
    let answers = bench.run().expect("the image comes to its end");
    let (mut deepest, mut sizes) = ([0; METHODS.len()], [0; 2]);
    for (life, answers) in lives.iter().zip(answers.chunks(EPOCHS + 1)) {
        let (bytes, reports) = answers.split_last().expect("an answer");
        let reports: Vec<&str> = reports.iter().map(|answer| answer.result.as_str()).collect();
        assert_eq!(reports, life.reports::<f32, N>());
        let numbers = bytes.result.trim_matches(['[', ']']).split(", ");
        let numbers: Vec<usize> = numbers.map(|number| number.parse().expect("bytes")).collect();
        let deepest = &mut deepest[life.strategy.0];
        *deepest = numbers[0].max(*deepest);
        sizes = [numbers[1], numbers[2]];
    }
    println!("{N} satellites: stack {deepest:?} by method, monitor and memory {sizes:?}");
    (deepest, sizes)
}

/// Every method and policy on the emulated processor, on a stack of its own.
#[test]
fn judging_in_given_memory_needs_the_bytes_that_the_library_states() {
    if !is_installed() {
        return;
    }
    let row = |satellites: usize, (deepest, [monitor, memory]): ([usize; METHODS.len()], [usize; 2])| {
        let [.., usual] = deepest;
        let all = deepest.into_iter().max().unwrap_or(0);
        (usual, format!("| {satellites} | {monitor} | {memory} | {usual} | {all} |\n"))
    };
    let (usual, small) = row(16, bytes_of_judging::<16>(Stage::JudgeSixteenInAThread));
    let (_, large) = row(CAPACITY, bytes_of_judging::<CAPACITY>(Stage::JudgeInAThread));
    let head = "| `N` | `Monitor<f32, N>` | `MonitorMemory<f32, N>` | stack, default method | stack, any method |\n\
                |---|---|---|---|---|\n";
    rig::document::must_have("rai-core/README.md", "judging", &[head, &small, &large].concat());
    assert!(usual <= 4096, "{usual} bytes of stack must be at most 4096");
}

#[test]
fn every_report_in_single_precision_is_the_same_to_the_last_bit() {
    if is_installed() {
        compare::<f32>(Scalar::Single, 0..180);
    }
}

/// What no image does, but the library offers.
mod at_length {
    use super::*;

    #[test]
    fn every_report_in_double_precision_is_the_same_to_the_last_bit() {
        if is_installed() {
            compare::<f64>(Scalar::Double, 180..200);
        }
    }
}
