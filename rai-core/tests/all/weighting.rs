//! The error model, each term computed by hand.
#![allow(clippy::unwrap_used)]

use raim_core::satellite::{Constellation, SatelliteId};
use raim_core::weighting::{
    ErrorBudget, Ism, UserModel, ephemeris_sigma_m, integrity_sigma_m, ionosphere_sigma_m,
    noise_factor_from_cn0, obliquity, sigma_m,
};

const NOTHING: ErrorBudget = ErrorBudget {
    sin_elevation: 1.0,
    ephemeris_m: 0.0,
    noise_gain: 0.0,
    weakness: 1.0,
    ionosphere_m: 0.0,
    user: UserModel::Ground,
};

fn assert_variance(budget: ErrorBudget, want_m2: f32) {
    // Some roundings of single precision.
    assert_close(budget, want_m2, 1e-6);
}

fn assert_close(budget: ErrorBudget, want_m2: f32, within: f32) {
    let have_m2 = sigma_m(&budget).powi(2);
    assert!((have_m2 / want_m2 - 1.0).abs() < within, "{budget:?}: have {have_m2}, want {want_m2}");
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

/// Computed by hand: at 30° e^(−30/14) = 0.117319, so that the multipath is 0.386928 m and the
/// ionosphere 0.018 + 40/1161 m; at the zenith 0.340646 m and 0.018 + 40/8361 m.
#[test]
fn the_airborne_model_is_that_of_the_standard_for_the_pair_and_the_grounds_for_one_frequency() {
    let airborne = ErrorBudget { user: UserModel::Airborne, ..NOTHING };
    let pair = ErrorBudget { noise_gain: 2.59, ..airborne };
    let zenith_m2 = 0.16 + 0.340_646_1_f32.powi(2) + (0.018_f32 + 40.0 / 8361.0).powi(2);
    assert_close(pair, zenith_m2 + 0.0144 / 1.1025, 2e-6);
    let low_m2 = 0.16 + 0.386_928_f32.powi(2) + (0.018_f32 + 40.0 / 1161.0).powi(2);
    assert_close(ErrorBudget { sin_elevation: 0.5, ..pair }, low_m2 + 0.0144 / 0.3025, 2e-6);
    assert_variance(ErrorBudget { noise_gain: 1.0, ..airborne }, 0.18 + 0.0144 / 1.1025);
    // Three times as noisy as a strong signal: the zenith's own noise and multipath count nine
    // times.
    let weak_m2 = 9.0 * (0.16 + 0.340_646_1_f32.powi(2)) + (0.018_f32 + 40.0 / 8361.0).powi(2);
    assert_close(ErrorBudget { weakness: 3.0, ..pair }, weak_m2 + 0.0144 / 1.1025, 2e-6);
}

/// `URA² + σ_user² + 0.12² 1.001²/(0.002001 + sin² el)`, the part of the user as above.
#[test]
fn what_integrity_is_told_has_the_users_part_of_where_the_antenna_is() {
    let support = Ism::ICAO_AIRBORNE.of(Constellation::Gps);
    let budget =
        ErrorBudget { sin_elevation: 0.5, noise_gain: 2.59, user: Ism::ICAO_AIRBORNE.user, ..NOTHING };
    let user_m2 = 0.16 + 0.386_928_f32.powi(2) + (0.018_f32 + 40.0 / 1161.0).powi(2);
    let want_m2 = 2.4 * 2.4 + user_m2 + 0.014_428_8 / 0.252_001;
    let have_m2 = integrity_sigma_m(&support, 0.0, &budget).powi(2);
    assert!((have_m2 / want_m2 - 1.0).abs() < 1e-5, "have {have_m2}, want {want_m2}");
    let on_ground = integrity_sigma_m(&support, 0.0, &ErrorBudget { user: Ism::ICAO.user, ..budget }).powi(2);
    let want_m2 = 2.4 * 2.4 + 2.59 * 2.59 * 0.45 + 0.014_428_8 / 0.252_001;
    assert!((on_ground / want_m2 - 1.0).abs() < 1e-5, "have {on_ground}, want {want_m2}");
}

#[test]
fn below_three_degrees_the_error_stays() {
    // sin el = 0.05: 0.09 + 0.09/0.0025 = 36.09 m², and (0.12/0.1)² = 1.44 m².
    for sin_elevation in [0.05, 0.02, 0.0, -0.7] {
        assert_variance(ErrorBudget { sin_elevation, noise_gain: 1.0, ..NOTHING }, 37.53);
    }
}

#[test]
fn a_normal_promise_is_replaced_and_a_worse_one_accepted() {
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
                f32::abs(have_m - want_m) < 1e-6,
                "{constellation:?} {number}: have {have_m}, want {want_m}"
            );
        }
        assert!(f32::abs(sigma_m(constellation, number, 3.3) - 3.3) < 1e-6);
    }
}

#[test]
fn the_ionosphere_has_the_floor_of_the_standard_and_a_fifth_of_a_large_delay() {
    let sc = |degrees: f32| degrees / 180.0;
    let close = |have: f32, want: f32| assert!((have / want - 1.0).abs() < 1e-5, "have {have}, want {want}");
    // At the zenith the floor itself: 9 m below 20 degrees of geomagnetic latitude, 4.5 m to 55, 6
    // m beyond.
    for (latitude_deg, want_m) in
        [(0.0, 9.0), (-19.9, 9.0), (20.1, 4.5), (-54.9, 4.5), (55.1, 6.0), (-80.0, 6.0)]
    {
        close(ionosphere_sigma_m(0.0, 1.0, sc(latitude_deg), true), want_m);
        close(ionosphere_sigma_m(0.0, 1.0, sc(latitude_deg), false), 2.0 * want_m);
    }
    close(ionosphere_sigma_m(40.0, 1.0, sc(40.0), true), 8.0);
    // 1/sqrt(1 - (6378.1363 cos 10 deg / 6728.1363)^2), computed by hand: 2.79037.
    let sine = 10.0_f32.to_radians().sin();
    close(obliquity(sine), 2.790_373);
    close(ionosphere_sigma_m(0.0, sine, sc(40.0), true), 4.5 * 2.790_373);
}

#[test]
fn a_weak_signal_is_noisier_and_one_of_unknown_strength_is_not() {
    let close = |have: f32, want: f32| assert!((have / want - 1.0).abs() < 1e-5, "have {have}, want {want}");
    close(noise_factor_from_cn0(None), 1.0);
    close(noise_factor_from_cn0(Some(45.0)), 1.0);
    close(noise_factor_from_cn0(Some(42.0)), 1.0);
    // Ten decibels are a tenth of the power, and the root of ten in the noise.
    close(noise_factor_from_cn0(Some(32.0)), 10.0_f32.sqrt());
    assert!(
        noise_factor_from_cn0(Some(f32::NAN)) > 10.0
            && noise_factor_from_cn0(Some(f32::NEG_INFINITY)).is_finite()
    );
}

#[test]
fn elevation_and_weakness_tell_of_the_same_error_and_the_larger_counts() {
    let troposphere_m2 = 0.0144 / 0.3025;
    let budget = |weakness| ErrorBudget { sin_elevation: 0.5, noise_gain: 1.0, weakness, ..NOTHING };
    // By elevation 0.09 + 0.09/0.25 = 0.45 m²; 1.5² x 0.18 = 0.405 m² are less, 2² x 0.18 = 0.72 m²
    // are more.
    assert_variance(budget(1.5), 0.45 + troposphere_m2);
    assert_variance(budget(2.0), 0.72 + troposphere_m2);
}
