//! Troposphere and ionosphere against published values.

use proptest::prelude::*;
use raim_firmware::correction::{Klobuchar, Place, Troposphere};
use raim_firmware::time::GpsTime;

fn towards(azimuth_deg: f32, elevation_deg: f32) -> [f32; 3] {
    let (sin_azimuth, cos_azimuth) = azimuth_deg.to_radians().sin_cos();
    let (up, horizontal) = elevation_deg.to_radians().sin_cos();
    [horizontal * sin_azimuth, horizontal * cos_azimuth, up]
}

fn place(latitude_deg: f32, longitude_deg: f32, time: GpsTime) -> Place {
    Place::at(latitude_deg.to_radians(), longitude_deg.to_radians(), time)
}

#[test]
fn the_known_worked_example_of_the_klobuchar_model_comes_out() {
    // The example with the model in textbooks' programs: 40° N 260° E, azimuth 210°, elevation 20°,
    // Saturday 20:45 GPS time, 23.784 m.
    let model = Klobuchar::new([3.82e-8, 1.49e-8, -1.79e-7, 0.0, 1.43e5, 0.0, -3.28e5, 1.13e5]).unwrap();
    let time = GpsTime { week: 2111, tow_ms: 593_100_000 };
    let have = model.slant(place(40.0, 260.0, time), towards(210.0, 20.0)).delay_m;
    assert!((have - 23.784).abs() < 1e-3, "have {have}");
}

#[test]
fn the_ionosphere_at_night_is_five_nanoseconds_upwards() {
    let model = Klobuchar::new([3.82e-8, 1.49e-8, -1.79e-7, 0.0, 1.43e5, 0.0, -3.28e5, 1.13e5]).unwrap();
    let midnight = GpsTime { week: 2111, tow_ms: 0 };
    let have = model.slant(place(40.0, 0.0, midnight), towards(0.0, 90.0)).delay_m;
    // 1 + 16 (0.53 − 0.5)³ times 5 ns of light.
    let want = 5e-9 * 299_792_458.0 * 1.000_432;
    assert!((have - want).abs() < 1e-6, "have {have}, want {want}");
}

#[test]
fn the_model_of_beidou_is_that_of_programs_with_another_ancestor() {
    // Coefficients that C05 broadcast on 2024-01-01. The expected delay on B1I, m, follows from the
    // equations of the interface document as in programs derived from RTKLIB, in double precision.
    let steps = [31.0, 16.0, -20.0, 31.0, 68.0, -24.0, 15.0, 1.0];
    let units = [-30, -27, -24, -24, 11, 14, 16, 16].map(|exponent| 2f64.powi(exponent));
    let model = Klobuchar::of_beidou(std::array::from_fn(|index| steps[index] * units[index])).unwrap();
    let to_l1 = (1_561.098_f64 / 1_575.42).powi(2);
    for (latitude_deg, longitude_deg, azimuth_deg, elevation_deg, time_of_day_s, want_m) in [
        (30.5, 114.5, 210.0, 20.0, 21_600, 21.265_667),
        (30.5, 114.5, 45.0, 75.0, 21_600, 8.765_059),
        (-33.9, 151.2, 330.0, 15.0, 10_800, 22.587_863),
        (43.56, 1.48, 100.0, 30.0, 43_920, 10.078_629),
        (55.5, 8.5, 180.0, 10.0, 32_400, 10.393_264),
        // Five nanoseconds at night, straight up.
        (30.5, 114.5, 0.0, 90.0, 64_800, 1.498_962),
    ] {
        let time = GpsTime { week: 2295, tow_ms: 86_400_000 + 1000 * time_of_day_s };
        let from = place(latitude_deg, longitude_deg, time);
        let have_m = f64::from(model.slant(from, towards(azimuth_deg, elevation_deg)).delay_m) / to_l1;
        assert!((have_m - want_m).abs() < 1e-3, "have {have_m}, want {want_m}");
    }
    assert_eq!(Klobuchar::of_beidou([0.0; 8]), None);
}

#[test]
fn coefficients_that_no_satellite_sends_are_refused() {
    assert_eq!(Klobuchar::new([f64::NAN; 8]), None);
    assert_eq!(Klobuchar::new([1.0, 0.0, 0.0, 0.0, 1e5, 0.0, 0.0, 0.0]), None);
    // Zeros mean that no value is known.
    assert_eq!(Klobuchar::new([0.0; 8]), None);
    assert_eq!(Klobuchar::new([0.0, 0.0, 0.0, 0.0, 1e5, 0.0, 0.0, 0.0]), None);
}

#[test]
fn the_zenith_delay_at_sea_level_is_that_of_the_standard_atmosphere() {
    // Dry part of Saastamoinen's formula at 1013.25 hPa and 45°: 2.3070 m. Wet part at 15 °C and
    // 70 %: e = 11.9 hPa and 0.002277 · (1255/288.15 + 0.05) · e = 0.1196 m.
    let have = Troposphere::above(0.0, 0.5f32.sqrt()).zenith_m();
    assert!((have - (2.3070 + 0.1196)).abs() < 1e-3, "have {have}");
}

#[test]
fn the_mapping_is_one_upwards_and_about_ten_at_five_degrees() {
    let troposphere = Troposphere::above(0.0, 0.7);
    let mapping =
        |elevation_deg: f32| troposphere.delay_m(elevation_deg.to_radians().sin()) / troposphere.zenith_m();
    assert!((mapping(90.0) - 1.0).abs() < 1e-4);
    // Niell's hydrostatic mapping function, middle latitudes: 5.60 at 10°, 10.15 at 5°.
    assert!((mapping(10.0) - 5.60).abs() < 0.05, "{}", mapping(10.0));
    assert!((mapping(5.0) - 10.15).abs() < 0.15, "{}", mapping(5.0));
}

#[test]
fn a_height_outside_the_model_counts_as_its_bound() {
    let zenith_m = |height_m| Troposphere::above(height_m, 0.7).zenith_m();
    let same = |have: f32, want: f32| have.to_bits() == want.to_bits();
    assert!(same(zenith_m(-6.378e6), zenith_m(-500.0)));
    assert!(same(zenith_m(1e9), zenith_m(20_000.0)));
    assert!(same(zenith_m(f32::NAN), zenith_m(0.0)));
    assert!(zenith_m(20_000.0) > 0.0 && zenith_m(20_000.0) < 0.2);
}

proptest! {
    #[test]
    fn no_input_gives_a_delay_that_is_not_finite_or_negative(
        height_m in prop::num::f32::ANY,
        sine in -2.0f32..2.0,
        coefficients in prop::array::uniform8(prop::num::f64::ANY),
        angles in prop::array::uniform4(-7.0f32..7.0),
        tow_ms in 0u32..604_800_000,
    ) {
        let troposphere = Troposphere::above(height_m, sine);
        prop_assert!((0.0..200.0).contains(&troposphere.delay_m(sine)));
        for model in [Klobuchar::new(coefficients), Klobuchar::of_beidou(coefficients)].into_iter().flatten() {
            let receiver = Place::at(angles[0], angles[1], GpsTime { week: 2111, tow_ms });
            let line_of_sight = towards(angles[2].to_degrees(), angles[3].to_degrees());
            let delay_m = model.slant(receiver, line_of_sight).delay_m;
            prop_assert!(delay_m.is_finite() && delay_m >= 0.0, "{}", delay_m);
        }
    }
}
