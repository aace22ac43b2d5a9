//! The error model, each term computed by hand.
#![allow(clippy::unwrap_used)]

use raim_core::internals::weighting::ionosphere::{IonosphereError, obliquity};
use raim_core::internals::weighting::{
    ErrorBudget, Ism, UserModel, ephemeris_sigma_m, integrity_sigma_m, noise_factor_from_cn0, reflection_m2,
    sigma_m,
};
use raim_core::satellite::{Constellation, SatelliteId};

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

/// Returns the error of the model along the path, m.
fn ionosphere_sigma_m(delay_m: f32, sin_elevation: f32, geomagnetic_sc: f32, is_modelled: bool) -> f32 {
    IonosphereError::of(delay_m, sin_elevation, geomagnetic_sc, is_modelled).slant_m
}

/// The obliquity in double precision.
fn thin_shell(sine: f64) -> f64 {
    let cosine_at_ground = (1.0 - sine * sine).sqrt();
    let ratio = 6_378.136_3 / 6_728.136_3;
    1.0 / (1.0 - (ratio * cosine_at_ground).powi(2)).sqrt()
}

#[test]
fn clock_and_height_absorb_all_but_a_quarter_of_a_common_delay() {
    let left = |tenth_deg: u32| {
        let sine = (f64::from(tenth_deg) / 10.0).to_radians().sin();
        (thin_shell(sine) - (3.04 - 2.28 * sine)).abs()
    };
    let largest = (50..=900).map(left).fold(0.0, f64::max);
    assert!(largest < 0.25, "{largest}");
}

#[test]
fn a_quarter_of_the_floor_and_all_beyond_it_differs_from_range_to_range() {
    let close = |have: f32, want: f32| assert!((have / want - 1.0).abs() < 1e-5, "have {have}, want {want}");
    let middle = |delay_m, is_modelled| IonosphereError::of(delay_m, 1.0, 40.0 / 180.0, is_modelled);
    close(middle(0.0, true).own_m, 1.125);
    close(middle(0.0, false).own_m, 2.25);
    // A fifth of 40 m is 8 m, 3.5 m above the floor.
    close(middle(40.0, true).own_m, 1.125 + 3.5);
    close(middle(40.0, true).shared.common_m, 8.0);
    close(middle(0.0, true).shared.common_m, 6.0);
    close(middle(0.0, false).shared.common_m, 12.0);
    close(IonosphereError::of(0.0, 1.0, 0.0, true).shared.common_m, 9.0);
    close(middle(0.0, true).times(1.5).own_m, 1.5 * 1.125);
    close(middle(0.0, true).undivided().own_m, 4.5);
    close(middle(0.0, true).undivided().shared.common_m, 4.5);
}

#[test]
fn a_slope_grows_with_the_distance_to_the_pierce_point() {
    for elevation_deg in [10.0_f64, 30.0, 60.0, 85.0] {
        let elevation = elevation_deg.to_radians();
        let at_shell = (6_378.136_3 / 6_728.136_3 * elevation.cos()).asin();
        let central = std::f64::consts::FRAC_PI_2 - elevation - at_shell;
        let distance_km = 6_728.136_3 * central.sin();
        let want_m = 4.5 * thin_shell(elevation.sin()) * distance_km / 4000.0;
        let error = IonosphereError::of(0.0, elevation.sin() as f32, 40.0 / 180.0, true);
        let have_m = f64::from(error.shared.slope_m) * elevation.cos();
        assert!((have_m / want_m - 1.0).abs() < 1e-4, "{elevation_deg}: have {have_m}, want {want_m}");
    }
}

#[test]
fn a_signal_weaker_than_its_elevation_explains_may_be_a_reflection() {
    let close = |(sin_elevation, weakness): (f32, f32), want_m: f32| {
        let have_m = reflection_m2(sin_elevation, weakness, true).sqrt();
        assert!((have_m - want_m).abs() < 1e-4, "{sin_elevation} {weakness}: have {have_m}, want {want_m}");
    };
    close((1.0, 1.0), 0.0);
    close((1.0, 1.44_f32.sqrt()), 20.0 * 0.44);
    close((1.0, 2.0), 14.0);
    // At 30 degrees the open sky explains (0.09 + 0.36)/0.18 = 2.5 times the power.
    close((0.5, 1.58), 0.0);
    close((0.5, 2.7_f32.sqrt()), 20.0 * 0.2);
    close((0.5, 10.0_f32.sqrt()), 14.0);
    close((0.0, 1.0), 0.0);
}

#[test]
fn a_signal_below_any_direct_path_counts_as_a_reflection_alone() {
    // 10 and 20 dB below 42 dB-Hz the power is a tenth and a hundredth.
    for (cn0_dbhz, single_m2, pair_m2) in
        [(32.0, 14.0 * 14.0, 0.0), (22.0, 14.0 * 14.0 + 25.0 * 88.0, 25.0 * 75.0)]
    {
        let weakness = noise_factor_from_cn0(Some(cn0_dbhz));
        for (is_single, want_m2) in [(true, single_m2), (false, pair_m2)] {
            let have_m2 = reflection_m2(1.0, weakness, is_single);
            assert!((have_m2 - want_m2).abs() < 1e-2, "{cn0_dbhz} {is_single}: {have_m2}, want {want_m2}");
        }
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
