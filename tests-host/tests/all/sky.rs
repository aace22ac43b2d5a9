//! The simulated sky against published tables, closed forms and the geometry of well-known sites.

use oracle::vectors;
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::sky::broadcast::SatelliteClock;
use raim::signal::sky::linear::{Sigma, rows};
use raim::signal::sky::orbit::{GEOSYNCHRONOUS_AXIS_M, Orbit};
use raim::signal::sky::raw::Simulation;
use raim::signal::sky::{Fleet, Noise, Oscillator, ReceiverClock, Site, sights};
use raim_core::frame::{EARTH_ROTATION_RAD_S, Ecef, SPEED_OF_LIGHT_M_S};
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::input::{Event, Input};
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::time::GpsTime;

const DAY_S: f64 = 86_164.090_5;

fn angle_between(a: f64, b: f64) -> f64 {
    (a - b + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
}

#[test]
fn every_fleet_has_the_published_elements() {
    let table = std::fs::read_to_string(vectors::path("constellations.csv")).unwrap();
    for fleet in Fleet::OF_PAPERS {
        let wanted: Vec<Vec<f64>> = table
            .lines()
            .filter_map(|line| line.strip_prefix(fleet.name())?.strip_prefix(','))
            .map(|line| line.split(',').map(|field| field.parse().unwrap()).collect())
            .collect();
        let satellites = fleet.satellites();
        assert_eq!(satellites.len(), wanted.len(), "{}", fleet.name());
        for (satellite, want) in satellites.iter().zip(wanted) {
            let have = satellite.orbit;
            let close = |have: f64, want: f64, tolerance: f64| (have - want).abs() <= tolerance;
            let agrees = close(f64::from(satellite.id.number()), want[0], 0.0)
                && close(have.semi_major_axis_m, want[1], 1e-3)
                && close(have.eccentricity, want[2], 1e-12)
                && close(have.inclination_rad, want[3], 1e-12)
                && close(angle_between(have.node_rad, want[4]), 0.0, 1e-12)
                && close(angle_between(have.perigee_rad, want[5]), 0.0, 1e-12)
                && close(angle_between(have.mean_anomaly_rad, want[6]), 0.0, 1e-12)
                && close(have.node_rate_rad_s, want[7], 1e-18);
            assert!(agrees, "{} {}: have {have:?}, want {want:?}", fleet.name(), satellite.id);
        }
    }
}

/// Seventeen revolutions in ten sidereal days of Galileo, in eight of GLONASS, thirteen in seven of
/// `BeiDou`; the system documents print 14 h 4 min 42 s, 11 h 15 min 44 s and 12 h 53 min.
#[test]
fn walker_fleets_repeat_their_ground_tracks() {
    for (fleet, period_s) in
        [(Fleet::Galileo24, 50_682.0), (Fleet::Glonass24, 40_544.0), (Fleet::Beidou24, 46_396.0)]
    {
        let satellites = fleet.satellites();
        assert_eq!(satellites.len(), 24, "{}", fleet.name());
        let mut nodes_deg: Vec<i64> =
            satellites.iter().map(|one| one.orbit.node_rad.to_degrees().round() as i64).collect();
        nodes_deg.dedup();
        assert_eq!(nodes_deg, [0, 120, 240], "{}", fleet.name());
        for satellite in &satellites {
            let have_s = std::f64::consts::TAU / satellite.orbit.mean_motion_rad_s;
            assert!((have_s - period_s).abs() < 20.0, "{}: have {have_s} s", fleet.name());
        }
        // Neighbours in a plane are 45° apart, and each plane leads the last by 15°.
        let argument_deg = |index: usize| satellites[index].orbit.mean_anomaly_rad.to_degrees();
        assert!((argument_deg(1) - argument_deg(0) - 45.0).abs() < 1e-9);
        assert!((argument_deg(8) - argument_deg(0) - 15.0).abs() < 1e-9);
    }
}

#[test]
fn geostationary_satellite_stands_still_over_its_longitude() {
    let want = Ecef::new(
        GEOSYNCHRONOUS_AXIS_M * 110.5_f64.to_radians().cos(),
        GEOSYNCHRONOUS_AXIS_M * 110.5_f64.to_radians().sin(),
        0.0,
    );
    let satellite = Fleet::BeidouRegional.satellites()[2];
    for hour in 0..24 {
        let have = satellite.orbit.position(f64::from(hour) * 3600.0);
        assert!(have.distance_m(want) < 1e-3, "hour {hour}: have {have:?}, want {want:?}");
    }
}

#[test]
fn inclined_satellite_repeats_its_figure_of_eight_over_118_east() {
    let orbit = Fleet::BeidouRegional.satellites()[5].orbit;
    // The satellite is 118° past its node at first, so it is back at the node after the other 242°.
    let knot_s = 242.0_f64.to_radians() / EARTH_ROTATION_RAD_S;
    let knot = orbit.position(knot_s);
    let have = (knot.y_m.atan2(knot.x_m).to_degrees(), knot.z_m);
    assert!((have.0 - 118.0).abs() < 1e-9 && have.1.abs() < 1e-3, "have {have:?}, want (118, 0)");
    let turn_s = std::f64::consts::TAU / EARTH_ROTATION_RAD_S;
    let have = orbit.position(knot_s + turn_s);
    assert!(have.distance_m(knot) < 1e-2, "after a turn: have {have:?}, want {knot:?}");
    let highest = (0..1440).map(|minute| orbit.position(f64::from(minute) * 60.0).z_m).fold(0.0, f64::max);
    let want = GEOSYNCHRONOUS_AXIS_M * 55.0_f64.to_radians().sin();
    assert!((highest - want).abs() < 500.0, "have {highest}, want {want}");
}

#[test]
fn gps_repeats_its_ground_track_after_a_sidereal_day() {
    // The oblateness of the earth, which the model omits, changes the period by 1e-4.
    let orbit = Fleet::Gps24.satellites()[0].orbit;
    let period_s = std::f64::consts::TAU / orbit.mean_motion_rad_s;
    assert!(
        (period_s - DAY_S / 2.0).abs() < 1e-4 * DAY_S / 2.0 * 1.5,
        "have {period_s} s, want {} s",
        DAY_S / 2.0
    );
}

#[test]
fn eccentric_orbit_obeys_kepler_at_perigee_and_apogee() {
    let circle = Orbit::circular(26_560_000.0, 0.9, 0.3, 0.0);
    let orbit = Orbit { eccentricity: 0.02, ..circle };
    let half_s = std::f64::consts::PI / orbit.mean_motion_rad_s;
    let have = [orbit.position(0.0).radius_m(), orbit.position(half_s).radius_m()];
    let want = [26_560_000.0 * 0.98, 26_560_000.0 * 1.02];
    assert!((have[0] - want[0]).abs() < 1e-3 && (have[1] - want[1]).abs() < 1e-3, "{have:?} {want:?}");
}

#[test]
fn earth_rotation_lengthens_the_path_as_the_first_order_formula_says() {
    let site = Site::geodetic(34.17, 108.57, 400.0);
    for sight in sights(&Fleet::BeidouGlobal.satellites(), &site, 1000.0, 0.0) {
        let (from, to) = (sight.position, site.position);
        let rotation_m = EARTH_ROTATION_RAD_S / SPEED_OF_LIGHT_M_S * (from.x_m * to.y_m - from.y_m * to.x_m);
        let want = from.distance_m(to) + rotation_m;
        // Second order: half the square of the angle turned, times the distance to the axis: below
        // 1 mm.
        assert!((sight.range_m - want).abs() < 1e-3, "{}: {} {want}", sight.satellite, sight.range_m);
    }
}

#[test]
fn geostationary_satellites_stand_where_antennas_in_xian_point() {
    // Elevation and azimuth of a geostationary satellite, spherical earth:
    // tan E = (cos φ cos Δλ − 0.1512) / √(1 − cos²φ cos²Δλ),  A = 180° + atan(tan Δλ_west / sin φ).
    let site = Site::geodetic(34.17, 108.57, 0.0);
    let seen = sights(&Fleet::BeidouRegional.satellites()[..5], &site, 0.0, 0.0);
    assert_eq!(seen.len(), 5);
    for (sight, longitude_deg) in seen.iter().zip([58.75, 80.0, 110.5, 140.0, 160.0_f64]) {
        let (latitude, west) = (34.17_f64.to_radians(), (108.57 - longitude_deg).to_radians());
        let cosine = latitude.cos() * west.cos();
        let elevation_deg = (cosine - 0.1512).atan2((1.0 - cosine * cosine).sqrt()).to_degrees();
        let azimuth_deg = 180.0 + (west.tan() / latitude.sin()).atan().to_degrees();
        let have = (sight.elevation_rad().to_degrees(), sight.azimuth_rad().to_degrees());
        let agrees = (have.0 - elevation_deg).abs() < 0.3 && (have.1 - azimuth_deg).abs() < 0.3;
        assert!(agrees, "{longitude_deg} E: have {have:?}, want ({elevation_deg}, {azimuth_deg})");
    }
}

#[test]
fn xian_sees_13_to_19_satellites_of_the_global_system() {
    // [Yang2015] §3, mask 5°; its satellites' phases are not published, so the count may differ by
    // one satellite.
    let site = Site::geodetic(34.17, 108.57, 400.0);
    let satellites = Fleet::BeidouGlobal.satellites();
    let mask_rad = 5.0_f64.to_radians();
    let count = |step| sights(&satellites, &site, f64::from(step) * 300.0, mask_rad).len();
    let (low, high) = (0..288).map(count).fold((99, 0), |(low, high), n| (low.min(n), high.max(n)));
    assert!((12..=14).contains(&low) && (18..=20).contains(&high), "have {low} to {high}, want 13 to 19");
}

/// Returns the Allan variance of phase samples one step apart, over `m` steps.
fn allan_variance(phase_s: &[f64], m: usize, step_s: f64) -> f64 {
    let squares: Vec<f64> = phase_s
        .windows(2 * m + 1)
        .map(|window| (window[2 * m] - 2.0 * window[m] + window[0]).powi(2))
        .collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    mean / (2.0 * (m as f64 * step_s).powi(2))
}

#[test]
fn each_noise_of_the_oscillator_has_its_allan_variance() {
    let silent = Oscillator { white_s: 0.0, flicker: 0.0, walk_hz: 0.0, frequency_offset: 1e-7 };
    let pi_squared = std::f64::consts::PI.powi(2);
    let cases = [
        ("white", Oscillator { white_s: 1e-20, ..silent }, [0.5e-20, 0.5e-21]),
        ("flicker", Oscillator { flicker: 1e-21, ..silent }, [2.0 * 2.0_f64.ln() * 1e-21; 2]),
        (
            "walk",
            Oscillator { walk_hz: 1e-21, ..silent },
            [2.0 / 3.0 * pi_squared * 1e-21, 2.0 / 3.0 * pi_squared * 1e-20],
        ),
    ];
    for (name, oscillator, [_, want]) in cases {
        let mut clock = ReceiverClock::new(oscillator, 1.0, 0.0, 7);
        let phase_s: Vec<f64> = (0..20_000).map(|_| clock.advance()).collect();
        // After ten steps the discrete filters agree with the continuous power laws.
        let have = allan_variance(&phase_s, 10, 1.0);
        assert!((have / want - 1.0).abs() < 0.15, "{name}: have {have:e}, want {want:e}");
    }
}

#[test]
fn clock_drifts_by_its_frequency_offset() {
    let silent = Oscillator { white_s: 0.0, flicker: 0.0, walk_hz: 0.0, frequency_offset: 1e-7 };
    let mut clock = ReceiverClock::new(silent, 0.5, 1e-3, 1);
    let have = (0..120).map(|_| clock.advance()).last().unwrap();
    assert!((have - (1e-3 + 60e-7)).abs() < 1e-15, "have {have}");
}

#[test]
fn noise_is_standard_normal_and_independent_across_satellites() {
    let noise = Noise::new(3);
    let [first, second] = [1, 2].map(|number| SatelliteId::new(Constellation::Gps, number).unwrap());
    let pairs: Vec<(f64, f64)> =
        (0..40_000).map(|epoch| (noise.normal(first, 0, epoch), noise.normal(second, 0, epoch))).collect();
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>() / pairs.len() as f64;
    // Four standard errors of each moment at 40,000 samples.
    assert!(mean(&|p| p.0).abs() < 0.02, "mean {}", mean(&|p| p.0));
    assert!((mean(&|p| p.0 * p.0) - 1.0).abs() < 0.0285, "variance {}", mean(&|p| p.0 * p.0));
    assert!((mean(&|p| p.0.powi(4)) - 3.0).abs() < 0.2, "kurtosis {}", mean(&|p| p.0.powi(4)));
    assert!(mean(&|p| p.0 * p.1).abs() < 0.02, "correlation {}", mean(&|p| p.0 * p.1));
}

#[test]
fn same_seed_gives_the_same_rows_whatever_else_is_in_sight() {
    let site = Site::geodetic(34.17, 108.57, 400.0);
    let satellites = Fleet::Gps31.satellites();
    let all = sights(&satellites, &site, 0.0, 0.0);
    let clocks_m = [1000.0, 0.0, 0.0, 0.0];
    let whole = rows(&all, Sigma::Constant(6.0), clocks_m, &Noise::new(1), 5);
    let part = rows(&all[2..], Sigma::Constant(6.0), clocks_m, &Noise::new(1), 5);
    assert_eq!(whole[2..], part[..]);
    assert_ne!(whole, rows(&all, Sigma::Constant(6.0), clocks_m, &Noise::new(2), 5));
}

/// Returns the satellites of a recording's ephemerides as the module decodes them from the wire.
fn read_back(simulation: &Simulation) -> Vec<raim_firmware::ephemeris::Ephemeris> {
    let recording = simulation.record();
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    let bytes = Encoder::new(&recording.ephemerides, selection).epoch(&recording.epochs[0]).unwrap();
    let mut found = Vec::new();
    Input::new().feed(&bytes, 0, |event| {
        if let Event::Ephemeris(ephemeris) = event {
            found.push(ephemeris);
        }
    });
    found
}

#[test]
fn module_reads_the_simulated_orbits_and_clocks_from_the_messages() {
    let simulation = Simulation::above_xian(5400.0, 1, 1);
    let ephemerides = read_back(&simulation);
    assert_eq!(ephemerides.len(), simulation.satellites.len());
    for satellite in &simulation.satellites {
        let ephemeris = ephemerides.iter().find(|ephemeris| ephemeris.satellite() == satellite.id).unwrap();
        for t_s in [3600.0, 5400.0, 7000.0] {
            let clock_s = SatelliteClock::of(satellite.id).at(t_s) + satellite.orbit.relativity_s(t_s);
            // The signal left at `t_s` by true time and took 80 ms.
            let received = GpsTime::from_ms(simulation.origin.to_ms() + (t_s * 1e3) as u64 + 80);
            let state = ephemeris.at(received, (0.08 - clock_s) * SPEED_OF_LIGHT_M_S).unwrap();
            let off_m = state.position.distance_m(satellite.orbit.position(t_s));
            assert!(off_m < 0.35, "{} at {t_s} s: {off_m} m off", satellite.id);
            let clock_off_m = (state.clock_s - clock_s).abs() * SPEED_OF_LIGHT_M_S;
            assert!(clock_off_m < 0.15, "{} at {t_s} s: clock {clock_off_m} m off", satellite.id);
        }
    }
}

#[test]
fn module_finds_the_site_under_the_simulated_sky() {
    let simulation = Simulation::above_xian(3600.0, 60, 1);
    let recording = simulation.record();
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    let mut encoder = Encoder::new(&recording.ephemerides, selection);
    let boot = Boot::on_host("test");
    let mut receiver = Receiver::new(MemoryPin::default(), boot).unwrap();
    let mut reported: Vec<u8> = Vec::new();
    for (epoch, now_ms) in recording.epochs.iter().zip((0..).step_by(1000)) {
        receiver.gnss(&encoder.epoch(epoch).unwrap(), now_ms, &mut reported);
    }
    let epochs = raim::sentence::epochs(std::str::from_utf8(&reported).unwrap()).unwrap();
    assert_eq!(epochs.len(), 60);
    for epoch in &epochs {
        let error =
            simulation.site.frame.rotate(epoch.position.unwrap().to_ecef() - simulation.site.position);
        // Five sigma of the ionosphere-free noise at good geometry.
        assert!(error.horizontal() < 4.0 && error.up.abs() < 7.0, "{error:?}");
        assert!(epoch.state.is_protected() && epoch.excluded.is_empty(), "{:?}", epoch.state);
    }
    let mean_m = |part: &dyn Fn(&raim::verdict::EpochOutput) -> f64| {
        epochs.iter().map(part).sum::<f64>() / epochs.len() as f64
    };
    let up_m = mean_m(&|epoch| epoch.position.unwrap().height_m - 400.0);
    assert!(up_m.abs() < 1.5, "height is off by {up_m} m on average: the models of the air disagree");
    let statistic = mean_m(&|epoch| epoch.state.statistic.unwrap());
    assert!((0.5..1.1).contains(&statistic), "statistic {statistic} on average");
}
