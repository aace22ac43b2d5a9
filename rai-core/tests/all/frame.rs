//! Frames against closed forms of the ellipsoid.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::float_cmp)]

use raim_core::frame::{Ecef, Enu, FLATTENING, Geodetic, LocalAxes, LocalFrame, SEMI_MAJOR_AXIS_M};

fn assert_close(what: &str, have: f64, want: f64, tolerance: f64) {
    assert!((have - want).abs() <= tolerance, "{what}: have {have}, want {want}");
}

#[test]
fn equator_and_poles_have_the_axes_of_the_ellipsoid() {
    let equator = LocalFrame::at(Ecef::new(0.0, SEMI_MAJOR_AXIS_M + 100.0, 0.0)).geodetic();
    assert_close("latitude", equator.latitude_rad, 0.0, 1e-15);
    assert_close("longitude", equator.longitude_rad, std::f64::consts::FRAC_PI_2, 1e-15);
    assert_close("height", equator.height_m, 100.0, 1e-8);

    let semi_minor_axis_m = SEMI_MAJOR_AXIS_M * (1.0 - FLATTENING);
    let pole = LocalFrame::at(Ecef::new(0.0, 0.0, -semi_minor_axis_m - 25.0)).geodetic();
    assert_close("latitude", pole.latitude_rad, -std::f64::consts::FRAC_PI_2, 1e-15);
    assert_close("height", pole.height_m, 25.0, 1e-8);
}

#[test]
fn latitude_and_height_survive_the_way_to_ecef_and_back() {
    for latitude_deg in (-90..=90).step_by(5) {
        for height_m in [-500.0, 0.0, 8_848.0, 400e3, 30_000e3] {
            let want =
                Geodetic { latitude_rad: f64::from(latitude_deg).to_radians(), longitude_rad: 2.5, height_m };
            let have = LocalFrame::at(want.to_ecef()).geodetic();
            assert_close("latitude", have.latitude_rad, want.latitude_rad, 1e-11);
            assert_close("height", have.height_m, want.height_m, 1e-4);
        }
    }
}

#[test]
fn up_points_away_from_the_ellipsoid() {
    let ground = Geodetic { latitude_rad: 0.7, longitude_rad: -1.9, height_m: 0.0 };
    let above = Geodetic { height_m: 1000.0, ..ground };
    let frame = LocalFrame::at(ground.to_ecef());
    let have = frame.rotate(above.to_ecef() - ground.to_ecef());
    assert_close("up", have.up, 1000.0, 1e-8);
    assert_close("horizontal", have.horizontal(), 0.0, 1e-5);
    assert_close("sine of elevation", frame.sin_elevation(ground.to_ecef(), above.to_ecef()), 1.0, 1e-12);
}

#[test]
fn north_of_a_point_has_a_larger_latitude() {
    let point = Geodetic { latitude_rad: 0.5, longitude_rad: 1.0, height_m: 0.0 }.to_ecef();
    let frame = LocalFrame::at(point);
    let north = LocalFrame::at(point + frame.unrotate(Enu { east: 0.0, north: 100.0, up: 0.0 })).geodetic();
    let east = LocalFrame::at(point + frame.unrotate(Enu { east: 100.0, north: 0.0, up: 0.0 })).geodetic();
    assert!(north.latitude_rad > 0.5 && (north.longitude_rad - 1.0).abs() < 1e-12);
    assert!(east.longitude_rad > 1.0 && (east.latitude_rad - 0.5).abs() < 1e-9);
}

#[test]
fn the_centre_of_the_earth_and_nonsense_still_have_a_frame() {
    for point in [Ecef::CENTRE, Ecef::new(f64::NAN, 0.0, 0.0), Ecef::new(0.0, f64::INFINITY, 1.0)] {
        let have = LocalFrame::at(point).rotate(Ecef::new(1.0, 0.0, 0.0));
        let finite = have.up.is_finite() && have.east.is_finite() && have.north.is_finite();
        assert!(finite, "{point:?} gives {have:?}");
    }
}

#[test]
fn distances_are_those_of_a_box() {
    // 2² + 3² + 6² = 7², whatever the order and the sign.
    let (point, other) = (Ecef::new(1.0, -2.0, 5.0), Ecef::new(3.0, 1.0, -1.0));
    assert_eq!((point.distance_m(other), other.distance_m(point)), (7.0, 7.0));
    assert_eq!(Ecef::new(2.0, -3.0, 6.0).radius_m(), 7.0);
    assert_eq!(Enu { east: -3.0, north: 4.0, up: 12.0 }.horizontal(), 5.0);
}

#[test]
fn a_position_is_finite_when_every_coordinate_is() {
    assert!(Ecef::new(1.0, -2.0, 3.0).is_finite());
    for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let mut coordinates = [1.0, 2.0, 3.0];
            coordinates[axis] = nonsense;
            let [x, y, z] = coordinates;
            assert!(!Ecef::new(x, y, z).is_finite(), "{nonsense} on axis {axis}");
        }
    }
}

#[test]
fn sine_of_the_latitude_has_its_sign() {
    for latitude_rad in [-1.5, -0.3, 0.0, 0.7, 1.5_f64] {
        let point = Geodetic { latitude_rad, longitude_rad: 2.0, height_m: 40.0 }.to_ecef();
        assert_close("sine", LocalFrame::at(point).sin_latitude(), latitude_rad.sin(), 1e-11);
    }
}

#[test]
fn the_centre_of_the_earth_lies_a_radius_below_the_ground() {
    assert_eq!(LocalFrame::at(Ecef::CENTRE).height_m(), -SEMI_MAJOR_AXIS_M);
}

#[test]
fn on_the_axis_the_longitude_is_zero() {
    let frame = LocalFrame::at(Ecef::new(0.0, 0.0, 7e6));
    assert_eq!(frame.geodetic().longitude_rad, 0.0);
    assert_close("east", frame.rotate(Ecef::new(0.0, 1.0, 0.0)).east, 1.0, 1e-15);
    assert_close("north", frame.rotate(Ecef::new(1.0, 0.0, 0.0)).north, -1.0, 1e-15);
}

#[test]
fn elevation_is_that_of_the_triangle() {
    let origin = Geodetic { latitude_rad: 0.7, longitude_rad: -1.9, height_m: 0.0 }.to_ecef();
    let frame = LocalFrame::at(origin);
    let up_of = |direction| frame.sin_elevation(origin, origin + frame.unrotate(direction));
    assert_close("3-4-5", up_of(Enu { east: 0.0, north: 4e6, up: 3e6 }), 0.6, 1e-12);
    assert_close("below", up_of(Enu { east: -4e6, north: 0.0, up: -3e6 }), -0.6, 1e-12);
    assert_close("horizon", up_of(Enu { east: 1e6, north: 1e6, up: 0.0 }), 0.0, 1e-12);
    assert_eq!(frame.sin_elevation(origin, origin), 1.0, "a point at the origin is overhead");
}

#[test]
fn axes_and_height_in_single_precision_are_those_of_the_ellipsoid() {
    for (latitude_deg, longitude_deg) in (-90_i32..=90).step_by(3).zip((-180_i32..180).step_by(11).cycle()) {
        for height_m in [-500.0, 0.0, 8_848.0, 20e3, 400e3] {
            let [latitude_rad, longitude_rad] =
                [latitude_deg, longitude_deg].map(|degrees| f64::from(degrees).to_radians());
            let have = LocalAxes::at(Geodetic { latitude_rad, longitude_rad, height_m }.to_ecef());
            let ((sin, cos), (sin_l, cos_l)) = (latitude_rad.sin_cos(), longitude_rad.sin_cos());
            let want =
                [[-sin_l, cos_l, 0.0], [-sin * cos_l, -sin * sin_l, cos], [cos * cos_l, cos * sin_l, sin]];
            // At a pole every direction is east.
            let rows = if latitude_deg.abs() == 90 { 2..3 } else { 0..3 };
            for (have, want) in have.east_north_up()[rows.clone()].iter().zip(&want[rows]) {
                for (have, want) in have.iter().zip(want) {
                    assert_close("axis", f64::from(*have), *want, 3e-7);
                }
            }
            assert_close("sine", f64::from(have.sin_latitude()), sin, 3e-7);
            // One centimetre, and as much again for each 20 km, where the air has ended.
            let tolerance_m = 0.01 * (1.0 + height_m.abs() / 20e3);
            assert_close("height", f64::from(have.height_m()), height_m, tolerance_m);
            let [latitude, longitude] = have.latitude_and_longitude_rad();
            assert_close("latitude", f64::from(latitude), latitude_rad, 5e-7);
            if latitude_deg.abs() < 90 {
                assert_close("longitude", f64::from(longitude), longitude_rad, 5e-7);
            }
        }
    }
    assert_eq!(LocalAxes::at(Ecef::CENTRE).height_m(), -SEMI_MAJOR_AXIS_M as f32);
}
