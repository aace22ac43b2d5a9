//! Inputs of the properties: plausible skies and implausible inputs.

use nalgebra::Vector3;
use proptest::prelude::*;
use proptest::sample::select;
use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::{EARTH_ROTATION_RAD_S, Ecef, Enu, Geodetic, LocalFrame, SPEED_OF_LIGHT_M_S};
use raim_core::internals::integrity::raim::detection::threshold::policy::Policy;
use raim_core::internals::integrity::raim::isolation::parity;
use raim_core::internals::integrity::raim::levels::Levels;
use raim_core::internals::least_squares::equations::{LinearEpoch, MAX_ROWS};
use raim_core::internals::numeric::real::Real;
use raim_core::monitor::{Method, Strategy as Monitoring};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};

pub(crate) use crate::sky::CAPACITY;

/// Most satellites of a plausible sky.
const MOST: usize = 24;

/// A receiver and the satellites that it observes.
#[derive(Clone, Debug)]
pub(crate) struct Sky {
    /// Position of the receiver.
    pub(crate) receiver: Ecef,
    /// Observations of the receiver.
    pub(crate) observations: Vec<Observation>,
}

impl Sky {
    /// Returns the epoch of these observations.
    pub(crate) fn epoch(&self) -> Epoch<CAPACITY> {
        epoch_of(&self.observations)
    }

    /// Returns the equations about the receiver, with residuals less 20,000 km, in a unit of which
    /// a metre has `units_per_m`.
    pub(crate) fn linearised<T: Real>(&self, units_per_m: f64) -> LinearEpoch<T, MAX_ROWS> {
        let frame = LocalFrame::at(self.receiver);
        let mut epoch = LinearEpoch::new();
        for observation in &self.observations {
            let sight = frame.rotate(observation.position - self.receiver);
            let direction = Vector3::new(sight.east, sight.north, sight.up).normalize();
            let residual = (observation.range_m - 2e7) * units_per_m;
            let sigma = observation.sigma_m * units_per_m;
            epoch.satellite(observation.satellite.constellation(), direction, residual, sigma).unwrap();
        }
        epoch
    }

    /// Returns the same sky with each observation changed.
    pub(crate) fn map(&self, change: impl FnMut(&Observation) -> Observation) -> Self {
        Self { receiver: self.receiver, observations: self.observations.iter().map(change).collect() }
    }
}

/// Returns an epoch with the observations that it accepts.
pub(crate) fn epoch_of(observations: &[Observation]) -> Epoch<CAPACITY> {
    let mut epoch = Epoch::new(0.0);
    for observation in observations {
        let _ = epoch.push(*observation);
    }
    epoch
}

/// Returns every double, NaN among them, and often a plausible number.
fn any_number(meant: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    prop_oneof![2 => meant, 1 => proptest::num::f64::ANY]
}

/// Observations without any check.
pub(crate) fn any_observations() -> impl Strategy<Value = Vec<Observation>> {
    let position = [any_number(-3e7..3e7), any_number(-3e7..3e7), any_number(-3e7..3e7)];
    let one = (any_satellite(), position, any_number(1e7..4e7), any_number(0.1..50.0));
    let one = one.prop_map(|(satellite, [x_m, y_m, z_m], range_m, sigma_m)| Observation {
        satellite,
        position: Ecef::new(x_m, y_m, z_m),
        range_m,
        sigma_m,
    });
    proptest::collection::vec(one, 0..2 * CAPACITY)
}

fn any_satellite() -> impl Strategy<Value = SatelliteId> {
    (select(&Constellation::ALL[..]), 1..=60_u8)
        .prop_map(|(constellation, number)| SatelliteId::new(constellation, number).unwrap())
}

/// Returns every way to monitor.
pub(crate) fn any_monitoring() -> impl Strategy<Value = Monitoring> {
    use parity::Isolation::{Grouping, Hybrid, HybridWithoutGrouping, Sequential, Simultaneous};
    let parity = [Simultaneous, Sequential, HybridWithoutGrouping, Hybrid, Grouping].map(Method::Parity);
    let methods = [&[Method::Baarda, Method::Ransac], &parity[..]].concat();
    (
        select(&[Policy::T1, Policy::T2, Policy::TOp][..]),
        select(methods),
        select(&[Levels::Bound, Levels::Slope][..]),
        any::<bool>(),
    )
        .prop_map(|(policy, method, levels, clock_aid)| {
            let aided = Monitoring::CLASSIC.with_clock_aid(clock_aid);
            aided.with_policy(policy).with_method(method).with_levels(levels)
        })
}

/// Returns every phase of flight.
pub(crate) fn any_requirements() -> impl Strategy<Value = Requirements> {
    select(vec![
        Requirements::en_route(),
        Requirements::terminal(),
        Requirements::non_precision_approach(),
        Requirements::lpv200(),
    ])
}

/// Random values of one satellite.
#[derive(Clone, Copy, Debug)]
struct Draw {
    constellation: Constellation,
    azimuth_rad: f64,
    elevation_rad: f64,
    distance_m: f64,
    sigma_m: f64,
    /// Error in units of sigma.
    noise: f64,
}

/// Returns a sky with noise of at most two sigma, where up to `faults` satellites are wrong by 10 m
/// to 1000 km.
pub(crate) fn any_sky(faults: usize) -> impl Strategy<Value = Sky> {
    let place = (-1.5..1.5_f64, -3.1..3.1_f64, -100.0..10_000.0_f64);
    let clocks_m = proptest::array::uniform4(-3e5..3e5_f64);
    let draws = proptest::collection::vec(any_draw(), 4..=MOST);
    let biases = proptest::collection::vec(any_bias(), 0..=faults);
    (place, clocks_m, draws, biases)
        .prop_map(|(place, clocks_m, draws, biases)| sky(place, clocks_m, &draws, &biases))
}

/// Returns a sky in which the first satellite is wrong by 10 km to the largest range.
pub(crate) fn grossly_wrong_sky() -> impl Strategy<Value = Sky> {
    (any_sky(0), 4.0..8.95_f64, any::<bool>()).prop_map(|(mut sky, decades, late)| {
        if let Some(first) = sky.observations.first_mut() {
            first.range_m += 10_f64.powf(decades) * if late { 1.0 } else { -1.0 };
        }
        sky
    })
}

fn any_draw() -> impl Strategy<Value = Draw> {
    let direction = (0.0..std::f64::consts::TAU, 0.08..1.57_f64, 2.0e7..4.0e7_f64);
    // GPS more often than the others, so that some skies have one constellation only.
    let constellation = prop_oneof![Just(Constellation::Gps), select(&Constellation::ALL[..])];
    (constellation, direction, -0.7..3.4_f64, -2.0..2.0_f64).prop_map(
        |(constellation, (azimuth_rad, elevation_rad, distance_m), ln_sigma, noise)| Draw {
            constellation,
            azimuth_rad,
            elevation_rad,
            distance_m,
            sigma_m: ln_sigma.exp(),
            noise,
        },
    )
}

/// Returns a satellite and its bias, m.
fn any_bias() -> impl Strategy<Value = (prop::sample::Index, f64)> {
    (any::<prop::sample::Index>(), 1.0..6.0_f64, any::<bool>())
        .prop_map(|(index, decades, late)| (index, 10_f64.powf(decades) * if late { 1.0 } else { -1.0 }))
}

fn sky(
    (latitude_rad, longitude_rad, height_m): (f64, f64, f64),
    clocks_m: [f64; 4],
    draws: &[Draw],
    biases: &[(prop::sample::Index, f64)],
) -> Sky {
    let receiver = Geodetic { latitude_rad, longitude_rad, height_m }.to_ecef();
    let numbered = draws.iter().zip(1..);
    let mut observations: Vec<Observation> =
        numbered.map(|(draw, number)| observe(receiver, draw, number, clocks_m)).collect();
    for (index, bias_m) in biases {
        let count = observations.len();
        observations[index.index(count)].range_m += bias_m;
    }
    Sky { receiver, observations }
}

/// Returns the range that a satellite's signal travels while the earth turns under it, with clock
/// and noise.
fn observe(receiver: Ecef, draw: &Draw, number: u8, clocks_m: [f64; 4]) -> Observation {
    let horizontal = draw.distance_m * draw.elevation_rad.cos();
    let position = receiver
        + LocalFrame::at(receiver).unrotate(Enu {
            east: horizontal * draw.azimuth_rad.sin(),
            north: horizontal * draw.azimuth_rad.cos(),
            up: draw.distance_m * draw.elevation_rad.sin(),
        });
    let mut travelled_m = draw.distance_m;
    for _ in 0..4 {
        let angle_rad = EARTH_ROTATION_RAD_S * travelled_m / SPEED_OF_LIGHT_M_S;
        travelled_m = turned(position, -angle_rad).distance_m(receiver);
    }
    Observation {
        satellite: SatelliteId::new(draw.constellation, number).unwrap(),
        position,
        range_m: travelled_m + clocks_m[draw.constellation as usize] + draw.noise * draw.sigma_m,
        sigma_m: draw.sigma_m,
    }
}

/// Returns a point turned about the earth's axis.
pub(crate) fn turned(point: Ecef, angle_rad: f64) -> Ecef {
    let (sin, cos) = angle_rad.sin_cos();
    Ecef::new(point.x_m * cos - point.y_m * sin, point.x_m * sin + point.y_m * cos, point.z_m)
}
