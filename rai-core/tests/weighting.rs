//! The error model, each term worked out by hand.
#![allow(clippy::unwrap_used)]

use rai_core::satellite::{Constellation, SatelliteId};
use rai_core::weighting::{ErrorBudget, ephemeris_sigma_m, sigma_m};

const NOTHING: ErrorBudget =
    ErrorBudget { sin_elevation: 1.0, ephemeris_m: 0.0, noise_gain: 0.0, ionosphere_m: 0.0 };

fn assert_variance(budget: ErrorBudget, want_m2: f64) {
    let have_m2 = sigma_m(&budget).powi(2);
    assert!((have_m2 / want_m2 - 1.0).abs() < 1e-9, "{budget:?}: have {have_m2}, want {want_m2}");
}

#[test]
fn terms_add_in_squares() {
    // At sin el = 0.5 the code has 0.09 + 0.09/0.25 = 0.45 m², the troposphere (0.12/0.55)² m².
    let troposphere_m2 = 0.0144 / 0.3025;
    let low = ErrorBudget { sin_elevation: 0.5, ..NOTHING };
    assert_variance(low, troposphere_m2);
    assert_variance(ErrorBudget { ephemeris_m: 0.7, ..low }, 0.49 + troposphere_m2);
    assert_variance(ErrorBudget { noise_gain: 3.0, ..low }, 4.05 + troposphere_m2);
    assert_variance(ErrorBudget { ionosphere_m: 2.5, ..low }, 6.25 + troposphere_m2);
    let all = ErrorBudget { ephemeris_m: 0.7, noise_gain: 3.0, ionosphere_m: 2.5, ..low };
    assert_variance(all, 0.49 + 4.05 + 6.25 + troposphere_m2);
}

#[test]
fn zenith_has_noise_and_multipath_alike() {
    assert_variance(ErrorBudget { noise_gain: 1.0, ..NOTHING }, 0.18 + 0.0144 / 1.1025);
}

#[test]
fn below_three_degrees_the_error_stays() {
    // sin el = 0.05: 0.09 + 0.09/0.0025 = 36.09 m², and (0.12/0.1)² = 1.44 m².
    for sin_elevation in [0.05, 0.02, 0.0, -0.7] {
        assert_variance(ErrorBudget { sin_elevation, noise_gain: 1.0, ..NOTHING }, 37.53);
    }
}

#[test]
fn a_normal_promise_is_replaced_and_a_worse_one_believed() {
    use Constellation::{Beidou, Galileo, Glonass, Gps};
    let sigma_m = |constellation, number, promised_m| {
        ephemeris_sigma_m(SatelliteId::new(constellation, number).unwrap(), promised_m)
    };
    let cases = [
        (Gps, 5, 1.2),
        (Galileo, 5, 0.7),
        (Glonass, 5, 3.0),
        (Beidou, 18, 4.0),
        (Beidou, 19, 1.2),
        (Beidou, 1, 4.0),
    ];
    for (constellation, number, want_m) in cases {
        // 3.2 m is the largest promise of the normal state.
        for promised_m in [0.1, 2.0, 3.2] {
            let have_m = sigma_m(constellation, number, promised_m);
            assert!(
                (have_m - want_m).abs() < 1e-12,
                "{constellation:?} {number}: have {have_m}, want {want_m}"
            );
        }
        assert!((sigma_m(constellation, number, 3.3) - 3.3).abs() < 1e-12);
    }
}
