//! Integer orbits and clocks against the interface documents in double precision, over all accepted
//! elements.
//!
//! The reference is the table of [IS-GPS-200] 20-IV as printed: arc tangents, Newton's method until
//! it converges, the libm of the host. Elements are drawn in the units in which they are broadcast,
//! and every field is at its bounds as often as between them.

use std::f64::consts::PI;

use proptest::prelude::*;
use raim_core::frame::{Ecef, SPEED_OF_LIGHT_M_S};
use raim_core::satellite::SatelliteId;
use raim_firmware::ephemeris::{Broadcast, Ephemeris, Health, Source};
use raim_firmware::time::GpsTime;

use crate::walker;

/// Largest error of a position for any elements, m.
const POSITION_M: f64 = 5e-4;

/// Largest error of a clock for any elements, s.
const CLOCK_S: f64 = 1e-13;

/// Milliseconds of a day; an instant farther from the reference time is refused.
const DAY_MS: i64 = 86_400_000;

/// Returns a number of units within ±`limit`, half the time a bound or zero.
fn field(limit: i64) -> impl Strategy<Value = f64> {
    prop_oneof![Just(-limit), Just(0), Just(limit), -limit..=limit, -limit..=limit, -limit..=limit]
        .prop_map(|units| units as f64)
}

fn power(exponent: i32) -> f64 {
    2_f64.powi(exponent)
}

fn angle() -> impl Strategy<Value = f64> {
    field((1 << 31) - 1).prop_map(|units| units * power(-31))
}

/// Returns rates up to the accepted bound, 1e-6 semicircles per second.
fn rate() -> impl Strategy<Value = f64> {
    field(8_796_093).prop_map(|units| units * power(-43))
}

/// Returns harmonic corrections of the widest field, 18 bits.
fn harmonic(unit: f64) -> impl Strategy<Value = f32> {
    field(1 << 17).prop_map(move |units| (units * unit) as f32)
}

/// An orbit that a system has, as the module's documentation bounds it: message, satellite, √A,
/// eccentricity, inclination in degrees. Those of the geostationary satellites of `BeiDou` are
/// about the plane of their elements.
type Kind = (Source, u8, (f64, f64), (f64, f64), (f64, f64));

const KINDS: [Kind; 9] = [
    (Source::GpsLnav, 32, (5140.0, 5167.0), (0.0, 0.03), (49.0, 61.0)),
    (Source::QzssLnav, 193, (6478.0, 6508.0), (0.04, 0.12), (30.0, 50.0)),
    (Source::QzssLnav, 199, (6478.0, 6508.0), (0.0, 0.02), (0.0, 10.0)),
    (Source::GalileoFnav, 36, (5425.0, 5456.0), (0.0, 0.02), (51.0, 61.0)),
    (Source::GalileoInav, 14, (5275.0, 5304.0), (0.13, 0.2), (45.0, 55.0)),
    (Source::BeidouD1D2, 20, (5268.0, 5297.0), (0.0, 0.02), (49.0, 61.0)),
    (Source::BeidouD1D2, 10, (6478.0, 6508.0), (0.0, 0.03), (45.0, 65.0)),
    (Source::BeidouD1D2, 3, (6478.0, 6508.0), (0.0, 0.02), (4.0, 6.0)),
    (Source::BeidouD1D2, 59, (6478.0, 6508.0), (0.0, 0.02), (4.0, 6.0)),
];

fn satellite((source, number, ..): Kind) -> SatelliteId {
    match source {
        Source::QzssLnav => SatelliteId::qzss(number - 192).unwrap(),
        _ => SatelliteId::new(source.constellation(), number).unwrap(),
    }
}

/// Returns true for satellites whose elements are written in a tilted plane.
fn is_tilted(kind: Kind) -> bool {
    kind.0 == Source::BeidouD1D2 && matches!(kind.1, 1..=5 | 59..=63)
}

/// Returns the number at a fraction of the way between two bounds, in whole units and within both.
fn between((least, most): (f64, f64), fraction: f64, exponent: i32) -> f64 {
    let unit = power(exponent);
    let (least, most) = ((least / unit).ceil(), (most / unit).floor());
    (least + fraction * (most - least)).round() * unit
}

/// Returns fractions, of which half are 0 or 1.
fn fraction() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(1.0), 0.0..=1.0, 0.0..=1.0]
}

/// Returns the longitude of a node that is `away_sc` from 180° at the reference time, semicircles.
fn node_opposite_sc(toe_s: u32, away_sc: f64) -> f64 {
    const EARTH_RATE_RAD_S: f64 = 7.292115e-5;
    let of_system_s = f64::from((toe_s + 604_800 - 14) % 604_800);
    let node_sc = 1.0 + away_sc + EARTH_RATE_RAD_S * of_system_s / PI;
    let wrapped_sc = (node_sc + 1.0).rem_euclid(2.0) - 1.0;
    between((-1.0, 1.0 - power(-31)), f64::midpoint(wrapped_sc, 1.0), -31)
}

prop_compose! {
    fn broadcast()(
        kind in prop::sample::select(&KINDS[..]),
        shape in [fraction(), fraction(), fraction()],
        angles in [angle(), angle(), angle()],
        rates in [rate(), rate(), rate()],
        turns in [harmonic(power(-31)), harmonic(power(-31)), harmonic(power(-31)), harmonic(power(-31))],
        lengths in [harmonic(1.0 / 64.0), harmonic(1.0 / 64.0)],
        clock in (field((1 << 30) - 1), field(112_589_990), field(73_786_976)),
        toe_s in prop_oneof![Just(0_u32), Just(604_799), Just(13), Just(14), 0..604_800_u32],
        toc_behind_s in prop_oneof![Just(0_i64), Just(-86_400), Just(86_400), -7200..7200_i64],
    ) -> Broadcast {
        let (source, _, axes, eccentricities, inclinations_deg) = kind;
        let (least_deg, most_deg) = inclinations_deg;
        // Within 20° the orbit is inclined to the equator by no more than 2.1°.
        let omega0_sc = if is_tilted(kind) { node_opposite_sc(toe_s, angles[1] / 9.0) } else { angles[1] };
        let toe = GpsTime { week: 2111, tow_ms: toe_s * 1000 };
        Broadcast {
            satellite: satellite(kind),
            source,
            health: Health::GOOD,
            accuracy_m: Some(2.0),
            toe,
            toc: GpsTime::from_ms(toe.to_ms().checked_add_signed(toc_behind_s * 1000).unwrap()),
            sqrt_a_sqrt_m: between(axes, shape[0], -19),
            eccentricity: between(eccentricities, shape[1], -33),
            m0_sc: angles[0],
            omega0_sc,
            i0_sc: between((least_deg / 180.0, most_deg / 180.0), shape[2], -31),
            omega_sc: angles[2],
            delta_n_sc_s: rates[0],
            omegadot_sc_s: rates[1],
            idot_sc_s: rates[2],
            cuc_rad: turns[0],
            cus_rad: turns[1],
            cic_rad: turns[2],
            cis_rad: turns[3],
            crc_m: lengths[0],
            crs_m: lengths[1],
            af0_s: clock.0 * power(-34),
            af1_s_s: clock.1 * power(-50),
            af2_s_s2: clock.2 * power(-66),
            group_delays_s: [0.0, 0.0],
        }
    }
}

/// Returns position and clock by the table, at an instant of the satellite's own clock counted from
/// `toe`.
fn by_the_table(b: &Broadcast, shown_s: f64) -> (Ecef, f64) {
    let since_toc_s = shown_s - b.toc.since_ms(b.toe) as f64 * 1e-3;
    let polynomial_s = b.af0_s + (b.af1_s_s + b.af2_s_s2 * since_toc_s) * since_toc_s;
    let (mu, earth_rate) = match b.source {
        Source::GpsLnav | Source::QzssLnav => (3.986005e14_f64, 7.2921151467e-5),
        Source::BeidouD1D2 => (3.986004418e14, 7.292115e-5),
        _ => (3.986004418e14, 7.2921151467e-5),
    };
    let t = shown_s - polynomial_s;
    let (a, e) = (b.sqrt_a_sqrt_m * b.sqrt_a_sqrt_m, b.eccentricity);
    let mean = b.m0_sc * PI + (mu.sqrt() / (a * b.sqrt_a_sqrt_m) + b.delta_n_sc_s * PI) * t;
    let mut anomaly = mean;
    for _ in 0..50 {
        anomaly -= (anomaly - e * anomaly.sin() - mean) / (1.0 - e * anomaly.cos());
    }
    let phi = ((1.0 - e * e).sqrt() * anomaly.sin()).atan2(anomaly.cos() - e) + b.omega_sc * PI;
    let harmonic = |c: f32, s: f32| f64::from(c) * (2.0 * phi).cos() + f64::from(s) * (2.0 * phi).sin();
    let u = phi + harmonic(b.cuc_rad, b.cus_rad);
    let r = a * (1.0 - e * anomaly.cos()) + harmonic(b.crc_m, b.crs_m);
    let i = b.i0_sc * PI + harmonic(b.cic_rad, b.cis_rad) + b.idot_sc_s * PI * t;
    let behind_ms = if b.source == Source::BeidouD1D2 { 14_000 } else { 0 };
    let toe_s = f64::from((b.toe.tow_ms + 604_800_000 - behind_ms) % 604_800_000) * 1e-3;
    let rests = b.source == Source::BeidouD1D2 && matches!(b.satellite.number(), 1..=5 | 59..=63);
    let relative_rate = b.omegadot_sc_s * PI - if rests { 0.0 } else { earth_rate };
    let node = b.omega0_sc * PI + relative_rate * t - earth_rate * toe_s;
    let (along, across) = (r * u.cos(), r * u.sin());
    let x = along * node.cos() - across * i.cos() * node.sin();
    let y = along * node.sin() + across * i.cos() * node.cos();
    let z = across * i.sin();
    let position = if rests {
        let (tilt, turn) = (-5.0_f64.to_radians(), earth_rate * t);
        let (level, height) = (y * tilt.cos() + z * tilt.sin(), z * tilt.cos() - y * tilt.sin());
        Ecef::new(x * turn.cos() + level * turn.sin(), level * turn.cos() - x * turn.sin(), height)
    } else {
        Ecef::new(x, y, z)
    };
    let c = SPEED_OF_LIGHT_M_S;
    (position, polynomial_s - 2.0 * mu.sqrt() / (c * c) * e * b.sqrt_a_sqrt_m * anomaly.sin())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    #[test]
    fn orbits_and_clocks_in_integers_are_those_of_the_table(
        broadcast in broadcast(),
        after_ms in prop_oneof![Just(-DAY_MS), Just(DAY_MS), Just(0), -DAY_MS..=DAY_MS, -7_200_000..7_200_000_i64],
        range_m in prop_oneof![Just(0.0), Just(SPEED_OF_LIGHT_M_S), 2e7..4e7],
    ) {
        let ephemeris = Ephemeris::new(&broadcast).unwrap();
        let received = GpsTime::from_ms(broadcast.toe.to_ms().checked_add_signed(after_ms).unwrap());
        let have = ephemeris.at(received, range_m).unwrap();
        let (position, clock_s) = by_the_table(&broadcast, after_ms as f64 * 1e-3 - range_m / SPEED_OF_LIGHT_M_S);
        let error_m = have.position.distance_m(position);
        prop_assert!(error_m < POSITION_M, "{error_m} m");
        let error_s = (have.clock_s - clock_s).abs();
        prop_assert!(error_s < CLOCK_S, "{error_s:e} s");
    }
}

type Change = fn(&mut Broadcast, f64);

#[test]
fn the_largest_element_of_every_field_is_let_in_and_the_next_one_is_refused() {
    let time = GpsTime { week: 2111, tow_ms: 0 };
    let sound = Broadcast {
        toe: time,
        toc: time,
        sqrt_a_sqrt_m: 5153.0,
        eccentricity: 0.01,
        m0_sc: 0.0,
        omega0_sc: 0.0,
        ..walker::satellite(0)
    };
    let bounds: [(Change, f64); 9] = [
        (|b, v| b.eccentricity = v, 0.03),
        (|b, v| b.sqrt_a_sqrt_m = v, 5167.0),
        (|b, v| b.i0_sc = v, 61.0 / 180.0),
        (|b, v| b.m0_sc = v, 1.0),
        (|b, v| b.omegadot_sc_s = v, 1e-6),
        (|b, v| b.cus_rad = v as f32, power(-14)),
        (|b, v| b.crs_m = v as f32, 2048.0),
        (|b, v| b.af0_s = v, 0.0625),
        (|b, v| b.af2_s_s2 = v, 1e-12),
    ];
    for (index, (change, bound)) in bounds.into_iter().enumerate() {
        let with = |value| {
            let mut broadcast = sound;
            change(&mut broadcast, value);
            Ephemeris::new(&broadcast)
        };
        assert!(with(bound).is_ok(), "bound {index}");
        assert!(with(bound * 1.000_001).is_err(), "beyond bound {index}");
    }
}
