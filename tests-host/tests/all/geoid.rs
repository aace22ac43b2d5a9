//! Altitudes above mean sea level against EGM96: published undulations, a sample of the grid, the
//! whole grid if it is at hand, and another program's table.

use oracle::geoid::{self, Egm96, Errors};
use raim_core::frame::Geodetic;
use raim_firmware::output::geoid::{Altitude, LARGEST_ERROR_M, RMS_ERROR_M};
use rig::shared;

/// Returns the firmware's undulation, m.
fn separation_m(latitude_deg: f64, longitude_deg: f64) -> f64 {
    let [latitude_rad, longitude_rad] = [latitude_deg, longitude_deg].map(f64::to_radians);
    Altitude::of(&Geodetic { latitude_rad, longitude_rad, height_m: 0.0 }).separation_m
}

/// Latitude and longitude in degrees, and undulation in m, that NGA publishes with EGM96 as the
/// results of its own program (`OUTINTPT.DAT`).
const PUBLISHED: [[f64; 3]; 6] = [
    [38.628_155_0, 269.779_155_0, -31.628],
    [-14.621_217_0, 305.021_114_0, -2.969],
    [46.874_319_0, 102.448_729_0, -43.575],
    [-23.617_446_0, 133.874_712_0, 15.871],
    [38.625_473_0, 359.999_500_0, 50.066],
    [-0.466_744_0, 0.002_300_0, 17.329],
];

#[test]
fn published_undulations_are_met_within_the_errors_that_the_table_states() {
    for [latitude_deg, longitude_deg, want_m] in PUBLISHED {
        let have_m = separation_m(latitude_deg, longitude_deg);
        // Two of three errors are below the root mean square, all of these places are flat land or
        // sea.
        assert!((have_m - want_m).abs() < RMS_ERROR_M, "{latitude_deg} {longitude_deg}: {have_m}, {want_m}");
    }
}

/// The sample lies apart from the corners of the cells in nine of ten places.
#[test]
fn sample_of_the_earth_has_the_errors_that_the_table_states() {
    let points = geoid::sample().expect("the sample is committed");
    let have = geoid::errors(points.into_iter().map(|[latitude_deg, longitude_deg, want_m]| {
        (latitude_deg, separation_m(latitude_deg, longitude_deg) - want_m)
    }));
    assert!((have.rms_m / RMS_ERROR_M - 1.0).abs() < 0.05 && have.largest_m <= LARGEST_ERROR_M, "{have:?}");
}

#[test]
fn committed_table_is_what_its_generator_writes_from_egm96() {
    let Some(grid) = shared::path_or_skip("data/geoid/WW15MGH.DAC") else { return };
    let source = Egm96::read(&grid).expect("the grid");
    let committed = std::fs::read_to_string(geoid::committed_path()).expect("the table is committed");
    assert_eq!(committed, source.render_table());
    let sample = std::fs::read_to_string(geoid::sample_path()).expect("the sample is committed");
    assert_eq!(sample, source.render_sample());
    let Errors { rms_m, most_m, largest_m } = source.errors(separation_m);
    // The firmware rounds to a decimetre.
    let is_near = |have: f64, want: f64| (have - want).abs() < 0.1;
    assert!(is_near(rms_m, RMS_ERROR_M) && most_m < 4.0 && is_near(largest_m, LARGEST_ERROR_M));
}
