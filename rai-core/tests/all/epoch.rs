//! Inputs that an epoch refuses, and that leave it unchanged.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use raim_core::epoch::{Aiding, Epoch, EpochError, Observation};
use raim_core::frame::Ecef;
use raim_core::internals::weighting::shared::SharedError;
use raim_core::satellite::{Constellation, SatelliteId};

fn observation(number: u8) -> Observation {
    Observation {
        satellite: SatelliteId::new(Constellation::Gps, number).unwrap(),
        position: Ecef::new(26_000e3, 0.0, 1e6),
        range_m: 21_000e3,
        sigma_m: 2.0,
    }
}

/// Returns true if two numbers have the same bits, NaN included.
fn same(have: f64, want: f64) -> bool {
    have.to_bits() == want.to_bits()
}

fn assert_refused(bad: Observation, is_wanted: impl Fn(EpochError) -> bool) {
    let mut epoch = Epoch::<4>::new(0.0);
    epoch.push(observation(1)).unwrap();
    let before = epoch.clone();
    assert!(epoch.push(bad).is_err_and(is_wanted), "{bad:?}");
    assert_eq!(epoch, before);
}

#[test]
fn numbers_that_are_none_or_absurd_are_refused_by_name() {
    let good = observation(2);
    for range_m in [f64::NAN, f64::INFINITY, 1e12, -1e12] {
        assert_refused(
            Observation { range_m, ..good },
            |error| matches!(error, EpochError::Range(value) if same(value, range_m)),
        );
    }
    for sigma_m in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e9, 1e-9] {
        assert_refused(
            Observation { sigma_m, ..good },
            |error| matches!(error, EpochError::Sigma(value) if same(value, sigma_m)),
        );
    }
    for x_m in [f64::NAN, f64::INFINITY, 0.0, 1e9] {
        assert_refused(
            Observation { position: Ecef::new(x_m, 0.0, 0.0), ..good },
            |error| matches!(error, EpochError::Position(value) if same(value.x_m, x_m)),
        );
    }
}

#[test]
fn a_satellite_enters_once() {
    assert_refused(observation(1), |error| error == EpochError::Duplicate);
}

#[test]
fn the_satellite_beyond_the_capacity_is_an_error() {
    let mut epoch = Epoch::<4>::new(0.0);
    for number in 1..=4 {
        epoch.push(observation(number)).unwrap();
    }
    assert_eq!(epoch.push(observation(5)), Err(EpochError::Full));
    assert_eq!(epoch.observations().len(), 4);
}

#[test]
fn one_clock_and_one_height_may_aid() {
    let clock = Aiding::Clock { constellation: Constellation::Gps, value_m: 10.0, sigma_m: 3.0 };
    let height = Aiding::Height { value_m: 120.0, sigma_m: 5.0 };
    let mut epoch = Epoch::<4>::new(f64::NAN);
    assert_eq!(epoch.time_s().to_bits(), 0.0_f64.to_bits());
    epoch.aid(clock).unwrap();
    assert_eq!(epoch.aid(clock), Err(EpochError::Duplicate));
    epoch.aid(height).unwrap();
    let refused = epoch.aid(Aiding::Height { value_m: f64::NAN, sigma_m: 5.0 });
    assert!(matches!(refused, Err(EpochError::Range(value)) if value.is_nan()));
    assert_eq!(epoch.aiding().len(), 2);
}

#[test]
fn an_epoch_that_is_begun_anew_holds_nothing_of_the_one_before() {
    let mut reused = Epoch::<4>::new(0.0);
    for second in 1..=5 {
        let mut fresh = Epoch::<4>::new(f64::from(second));
        reused.restart(f64::from(second));
        for number in 1..=4 {
            let common_m = f32::from(number) + second as f32;
            let shared = SharedError { common_m, slope_m: 0.5 * common_m };
            for epoch in [&mut reused, &mut fresh] {
                assert_eq!(epoch.push_sharing(observation(number), shared), Ok(()), "{second}: {number}");
            }
        }
        assert_eq!(reused, fresh);
    }
}
