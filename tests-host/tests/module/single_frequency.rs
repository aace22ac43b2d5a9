//! One frequency under ionospheres up to the strongest on record: levels hold for every residual of
//! the model.
//!
//! The skies have one system or two, thirty satellites each on circular orbits, seen from four
//! latitudes. The delay is that of a thin shell at 350 km, `0.162 m` of L1 for each TECU, and its
//! vertical content may slope to the north. All else is exact, so that the error is the
//! ionosphere's alone. The module has no coefficients of that day, or those of a calm one.

use crate::walker::{CALM, Ionosphere, TOE, range_m, satellite_of};
use raim_core::frame::{Ecef, Geodetic, LocalFrame};
use raim_core::report::Report;
use raim_firmware::correction::CAPACITY;
use raim_firmware::ephemeris::{Ephemeris, Source};
use raim_firmware::navigator::Navigator;
use raim_firmware::raw::{Band, Carrier, RawEpoch, RawSatellite, RawSignal};
use raim_firmware::settings::Configuration;
use raim_firmware::time::GpsTime;

/// Returns the module's report at an instant under an ionosphere.
fn judged(
    systems: &[(Source, Band)],
    receiver: Ecef,
    time: GpsTime,
    ionosphere: Ionosphere,
    coefficients: Option<[f64; 8]>,
) -> Report<CAPACITY> {
    let mut configuration = Configuration::at_start();
    configuration.klobuchar = coefficients;
    let mut navigator = Navigator::new(configuration.requirements()).unwrap();
    let mut raw = RawEpoch::new(time);
    let all = systems.iter().flat_map(|of| (0..30).map(move |index| (of, index)));
    for ((source, band), index) in all {
        let ephemeris = Ephemeris::new(&satellite_of(*source, index)).unwrap();
        navigator.learn(ephemeris, Some(time));
        let Some(range_m) = range_m(&ephemeris, time, receiver, ionosphere) else { continue };
        let signal = RawSignal::new(Carrier::of(*band), range_m).with_cn0_dbhz(45.0);
        let signals = [signal].into_iter().collect();
        raw.satellites.push(RawSatellite { satellite: ephemeris.satellite(), signals }).unwrap();
    }
    navigator.judge(&raw, raw.time.to_ms(), &configuration).clone()
}

/// Returns the largest ratio of an error to its level, horizontal and vertical, over an hour and
/// four latitudes.
fn largest_shares(
    systems: &[(Source, Band)],
    ionosphere: Ionosphere,
    coefficients: Option<[f64; 8]>,
) -> (f64, f64) {
    let mut largest = (0.0_f64, 0.0_f64);
    for latitude_deg in [0.0_f64, 15.0, 40.0, 65.0] {
        let place = Geodetic { latitude_rad: latitude_deg.to_radians(), longitude_rad: 0.35, height_m: 60.0 };
        let receiver = place.to_ecef();
        let frame = LocalFrame::at(receiver);
        for tenth in 0..12 {
            let time = GpsTime { tow_ms: TOE.tow_ms + tenth * 300_000, ..TOE };
            let report = judged(systems, receiver, time, ionosphere, coefficients);
            let (Some(solution), Some(levels)) = (report.solution, report.protection) else { continue };
            let error = frame.rotate(solution.position - receiver);
            largest.0 = largest.0.max(error.horizontal() / levels.hpl_m);
            largest.1 = largest.1.max(error.up.abs() / levels.vpl_m);
        }
    }
    largest
}

/// Systems with a signal on the frequency of L1, to which the simulated delay belongs.
const SYSTEMS: [(Source, Band); 2] = [(Source::GpsLnav, Band::L1), (Source::GalileoInav, Band::E1)];

fn levels_hold(systems: &[(Source, Band)]) {
    println!("{} systems\nTECU  /degree  coefficients  error/HPL  error/VPL", systems.len());
    for tecu in [0.0, 30.0, 60.0, 90.0, 120.0, 150.0] {
        for per_degree in [0.0, 0.03 * tecu, -0.03 * tecu] {
            for coefficients in [None, Some(CALM)] {
                let (horizontal, vertical) =
                    largest_shares(systems, Ionosphere { tecu, per_degree }, coefficients);
                println!(
                    "{tecu:4} {per_degree:8.1}  {:12}  {horizontal:9.2}  {vertical:9.2}",
                    coefficients.is_some()
                );
                assert!(horizontal < 1.0, "{tecu} TECU, {per_degree} per degree: {horizontal} of HPL");
                assert!(vertical < 1.0, "{tecu} TECU, {per_degree} per degree: {vertical} of VPL");
            }
        }
    }
}

#[test]
fn the_levels_hold_under_150_tecu_with_and_without_gradients_whatever_the_model_knows() {
    levels_hold(&SYSTEMS[..1]);
}

#[test]
fn the_levels_of_two_systems_hold_under_the_same() {
    levels_hold(&SYSTEMS);
}

#[test]
fn coefficients_that_are_all_zero_say_nothing() {
    let receiver = Geodetic { latitude_rad: 0.3, longitude_rad: 0.0, height_m: 0.0 }.to_ecef();
    let calm = Ionosphere { tecu: 10.0, per_degree: 0.0 };
    let levels = |coefficients| {
        judged(&SYSTEMS[..1], receiver, TOE, calm, coefficients).protection.expect("a position")
    };
    assert_eq!(levels(Some([0.0; 8])), levels(None));
    assert!(levels(Some(CALM)).hpl_m < levels(None).hpl_m, "what is known makes them smaller");
}
