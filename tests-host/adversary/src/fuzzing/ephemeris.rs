//! Target: any fields of an ephemeris, first checked by the module and then evaluated.
//!
//! An accepted ephemeris must describe an orbit. With the apsides `a(1 ± e)` widened by the
//! harmonic corrections,
//!
//! ```text
//! a(1−e) − δ ≤ |X| ≤ a(1+e) + δ        |X(t+1 s) − X(t)| ≤ 1.1 v_p (1 + Δn/n) + r (ω_e + Ω̇ + i̇)
//! ```
//!
//! where `v_p = √(µ/a · (1+e)/(1−e))` is the speed at perigee. References: Kepler's laws alone, no
//! interface document.

use std::f64::consts::PI;

use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::ephemeris::{Broadcast, Ephemeris, EphemerisError, Health, Source};
use raim_firmware::time::GpsTime;

use super::tape::Tape;

/// Gravity constant of the earth, m³/s², to the digits that all systems share.
const MU_M3_S2: f64 = 3.986e14;

/// Rotation of the earth, rad/s.
const EARTH_RATE_RAD_S: f64 = 7.3e-5;

/// Largest clock correction within two days, s: 0.0625 + 1e-7 t + 1e-12 t², and 2 µs of relativity.
const CLOCK_S: f64 = 0.0625 + 0.0173 + 0.0299 + 2e-6;

/// Reads an ephemeris and computes positions from it until the bytes end.
pub fn run(input: &[u8]) {
    let mut tape = Tape::new(input);
    let broadcast = broadcast(&mut tape);
    let Ok(ephemeris) = Ephemeris::new(&broadcast) else { return };
    assert!(numbers(&broadcast).all(f64::is_finite), "let in: {broadcast:?}");
    while !tape.is_over() {
        let received = near(broadcast.toe, &mut tape);
        let range_m = tape.number(0.0, 6e7);
        fly(&broadcast, &ephemeris, received, range_m);
    }
}

/// Roots of the axes of GPS, `BeiDou`, the geosynchronous satellites, Galileo, and its two
/// eccentric satellites, √m.
const AXES_SQRT_M: [f64; 5] = [5153.6, 5282.6, 6493.4, 5440.6, 5289.4];

fn broadcast(tape: &mut Tape<'_>) -> Broadcast {
    use Constellation::{Beidou, Galileo, Glonass, Gps};
    let constellation = tape.one_of(&[Gps, Beidou, Galileo, Glonass]);
    let number = tape.byte() % 99 + 1;
    let toe = GpsTime { week: tape.word() as u16, tow_ms: tape.word() % 700_000_000 };
    Broadcast {
        satellite: SatelliteId::new(constellation, number).expect("1 to 99"),
        source: source(constellation, tape),
        health: Health::of_satellite(tape.byte() != 0),
        accuracy_m: (tape.byte() != 0).then(|| tape.number(0.0, 1e4) as f32),
        toc: near(toe, tape),
        toe,
        sqrt_a_sqrt_m: tape.one_of(&AXES_SQRT_M) + tape.number(-20.0, 20.0),
        eccentricity: tape.one_of(&[0.0, 0.0, 0.0, 0.15]) + tape.number(-0.01, 0.05),
        m0_sc: tape.number(-1.0, 1.0),
        omega0_sc: tape.number(-1.0, 1.0),
        i0_sc: tape.one_of(&[0.3, 0.3, 0.3, 0.03]) + tape.number(-0.06, 0.06),
        omega_sc: tape.number(-1.0, 1.0),
        delta_n_sc_s: tape.number(-1e-6, 1e-6),
        omegadot_sc_s: tape.number(-1e-6, 1e-6),
        idot_sc_s: tape.number(-1e-6, 1e-6),
        cuc_rad: tape.number(-6.1e-5, 6.1e-5) as f32,
        cus_rad: tape.number(-6.1e-5, 6.1e-5) as f32,
        crc_m: tape.number(-2048.0, 2048.0) as f32,
        crs_m: tape.number(-2048.0, 2048.0) as f32,
        cic_rad: tape.number(-6.1e-5, 6.1e-5) as f32,
        cis_rad: tape.number(-6.1e-5, 6.1e-5) as f32,
        af0_s: tape.number(-0.0625, 0.0625),
        af1_s_s: tape.number(-1e-7, 1e-7),
        af2_s_s2: tape.number(-1e-12, 1e-12),
        group_delays_s: [tape.number(-1e-6, 1e-6) as f32, tape.number(-1e-6, 1e-6) as f32],
    }
}

/// Returns mostly the system's own message, because another one is refused at once.
fn source(constellation: Constellation, tape: &mut Tape<'_>) -> Source {
    let own = match constellation {
        Constellation::Beidou => Source::BeidouD1D2,
        Constellation::Galileo => Source::GalileoInav,
        _ => Source::GpsLnav,
    };
    tape.one_of(&[own, own, own, own, own, own, Source::GalileoFnav, Source::GpsLnav])
}

/// Returns an instant within three days of another.
fn near(time: GpsTime, tape: &mut Tape<'_>) -> GpsTime {
    const DAY_MS: i64 = 86_400_000;
    let offset_ms = i64::from(tape.word()) % (6 * DAY_MS) - 3 * DAY_MS;
    GpsTime::from_ms(time.to_ms().saturating_add_signed(offset_ms))
}

fn numbers(b: &Broadcast) -> impl Iterator<Item = f64> {
    let narrow = [
        b.cuc_rad,
        b.cus_rad,
        b.crc_m,
        b.crs_m,
        b.cic_rad,
        b.cis_rad,
        b.group_delays_s[0],
        b.group_delays_s[1],
    ];
    let wide = [
        b.sqrt_a_sqrt_m,
        b.eccentricity,
        b.m0_sc,
        b.omega0_sc,
        b.i0_sc,
        b.omega_sc,
        b.delta_n_sc_s,
        b.omegadot_sc_s,
        b.idot_sc_s,
        b.af0_s,
        b.af1_s_s,
        b.af2_s_s2,
    ];
    wide.into_iter().chain(narrow.map(f64::from))
}

fn fly(broadcast: &Broadcast, ephemeris: &Ephemeris, received: GpsTime, range_m: f64) {
    if broadcast.health.is_bad() {
        assert_eq!(ephemeris.usable_at(received), Err(EphemerisError::Unhealthy));
    }
    let Ok(here) = ephemeris.at(received, range_m) else { return };
    let axis_m = broadcast.sqrt_a_sqrt_m.powi(2);
    let (e, rate_rad_s) = (broadcast.eccentricity, (MU_M3_S2 / axis_m.powi(3)).sqrt());
    let harmonics_m = f64::from(broadcast.crc_m.abs() + broadcast.crs_m.abs()) + 1.0;
    let (perigee_m, apogee_m) = (axis_m * (1.0 - e) - harmonics_m, axis_m * (1.0 + e) + harmonics_m);
    let radius_m = here.position.radius_m();
    assert!((perigee_m..=apogee_m).contains(&radius_m), "radius {radius_m} of {broadcast:?}");
    assert!(here.clock_s.abs() <= CLOCK_S, "clock {} of {broadcast:?}", here.clock_s);

    let Ok(later) = ephemeris.at(GpsTime::from_ms(received.to_ms() + 1000), range_m) else { return };
    let at_perigee_m_s = (MU_M3_S2 / axis_m * (1.0 + e) / (1.0 - e)).sqrt();
    let turns_rad_s = EARTH_RATE_RAD_S + 2.0 * PI * 1e-6;
    let limit_m = 1.1 * at_perigee_m_s * (1.0 + PI * 1e-6 / rate_rad_s) + apogee_m * turns_rad_s;
    let moved_m = later.position.distance_m(here.position);
    assert!(moved_m <= limit_m, "{moved_m} m in a second, not {limit_m}: {broadcast:?}");
}
