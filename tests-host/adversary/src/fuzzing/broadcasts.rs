//! A starting broadcast of each navigation message, with a valid orbit.

use raim::signal::measurement::{Ephemeris, TimedEphemeris};
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::time::{BEIDOU_WEEK_OFFSET, GALILEO_WEEK_OFFSET, GpsTime};
use rtcm_rs::msg::{Msg1019T, Msg1020T, Msg1042T, Msg1045T, Msg1046T};

/// Time of the broadcasts: 2020-06-25 12:00:00.
pub(super) const NOON: GpsTime = GpsTime { week: 2111, tow_ms: NOON_S * 1000 };
const NOON_S: u32 = 4 * 86_400 + 43_200;

/// Builds a message with the elements of an ordinary orbit and a clock of 0.1 ms.
macro_rules! message {
    ($type:ident, sqrt_a: $sqrt_a:expr, offset: $offset:ident, $($field:ident: $value:expr),*) => {
        $type {
            toc_s: NOON_S as f32,
            toe_s: NOON_S as f32,
            $offset: 1e-4,
            sqrt_a_sqrt_m: $sqrt_a,
            eccentricity: 0.01,
            m0_sc: 0.25,
            omega0_sc: -0.5,
            omegadot_sc_s: -2.6e-9,
            i0_sc: 0.3,
            omega_sc: 0.75,
            crs_m: 20.0,
            $($field: $value,)*
            ..$type::default()
        }
    };
}

/// Rotation of the earth, semicircles/s.
const EARTH_RATE_SC_S: f64 = 7.292_115e-5 / std::f64::consts::PI;

/// Returns one of each form, in the order of [`super::navigation_bits::MESSAGES`].
pub(super) fn of_each() -> [TimedEphemeris; 6] {
    let gps = message!(Msg1019T, sqrt_a: 5153.7, offset: af0_s,
        gps_satellite_id: 7, gps_week_number: NOON.week % 1024, iode: 77, iodc: 77);
    let inav = message!(Msg1046T, sqrt_a: 5440.6, offset: af0_s,
        gal_satellite_id: 8, gal_week_number: NOON.week - GALILEO_WEEK_OFFSET, iodnav: 99, sisa_e1_e5b_index: 107);
    let fnav = message!(Msg1045T, sqrt_a: 5440.6, offset: af0_s,
        gal_satellite_id: 9, gal_week_number: NOON.week - GALILEO_WEEK_OFFSET, iodnav: 99, sisa_e1_e5a_index: 107);
    let beidou = |number, sqrt_a| {
        message!(Msg1042T, sqrt_a: sqrt_a, offset: a0_s,
            bds_satellite_id: number, bds_week_number: NOON.week - BEIDOU_WEEK_OFFSET)
    };
    // Its plane lies in the equator: tilted by 5° about the axis that the node is opposite to at
    // the reference time.
    let toe_s = f64::from(NOON.tow_ms) * 1e-3;
    let node_sc = 1.0 + EARTH_RATE_SC_S * toe_s;
    let geostationary = Msg1042T {
        i0_sc: 5.0 / 180.0,
        omega0_sc: (node_sc + 1.0).rem_euclid(2.0) - 1.0,
        ..beidou(3, 6493.3)
    };
    [
        timed(Constellation::Gps, 7, Ephemeris::Gps(gps)),
        timed(Constellation::Galileo, 8, Ephemeris::GalileoInav(inav)),
        timed(Constellation::Galileo, 9, Ephemeris::GalileoFnav(fnav)),
        timed(Constellation::Beidou, 23, Ephemeris::Beidou(beidou(23, 5282.6))),
        timed(Constellation::Beidou, 3, Ephemeris::Beidou(geostationary)),
        timed(Constellation::Glonass, 10, Ephemeris::Glonass(glonass(10))),
    ]
}

/// Returns a state vector on a circle of GLONASS's size, at 11:45 UTC.
fn glonass(number: u8) -> Msg1020T {
    Msg1020T {
        glo_satellite_id: number,
        tb_min: 14 * 60 + 45,
        xn_km: 10_039.629,
        yn_km: 15_403.305,
        zn_km: 17_680.557,
        xn_first_deriv_km_s: -2.0402,
        yn_first_deriv_km_s: -1.3093,
        zn_first_deriv_km_s: 2.2991,
        xn_second_deriv_km_s2: 1.9e-9,
        tau_n_s: 1e-5,
        glo_m_ft_ind: 2,
        glo_m_n4_year: 2020,
        ..Msg1020T::default()
    }
}

fn timed(constellation: Constellation, number: u8, message: Ephemeris) -> TimedEphemeris {
    let satellite = SatelliteId::new(constellation, number).expect("1 to 99");
    TimedEphemeris { satellite, toe: NOON, sent: NOON, message }
}
