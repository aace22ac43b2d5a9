//! A simulated sky of thirty satellites on circular orbits, seen through an ionosphere.
#![allow(dead_code, reason = "each test program uses a part")]

use raim_core::frame::{EARTH_ROTATION_RAD_S, Ecef, Enu, LocalFrame, SPEED_OF_LIGHT_M_S};
use raim_core::satellite::SatelliteId;
use raim_firmware::ephemeris::{Broadcast, Ephemeris, Health, Source};
use raim_firmware::time::GpsTime;

pub(crate) const TOE: GpsTime = GpsTime { week: 2300, tow_ms: 7_200_000 };

/// Coefficients of a calm day, broadcast by GPS in 2020.
pub(crate) const CALM: [f64; 8] =
    [4.6566e-9, 1.4901e-8, -5.9605e-8, -5.9605e-8, 79_872.0, 65_536.0, -65_536.0, -393_216.0];

/// Returns satellite `index` of thirty in six planes of GPS.
pub(crate) fn satellite(index: u8) -> Broadcast {
    satellite_of(Source::GpsLnav, index)
}

/// Returns the same satellite of another system, whose planes lie between those of the others.
pub(crate) fn satellite_of(source: Source, index: u8) -> Broadcast {
    let (plane, slot) = (index % 6, index / 6);
    let shift = f64::from(source.constellation() as u8) / 17.0;
    let around = |turns: f64| (2.0 * turns + 1.0).rem_euclid(2.0) - 1.0;
    Broadcast {
        satellite: SatelliteId::new(
            source.constellation(),
            index + if source == Source::BeidouD1D2 { 19 } else { 1 },
        )
        .unwrap(),
        source,
        health: Health::GOOD,
        accuracy_m: Some(2.0),
        toe: TOE,
        toc: TOE,
        sqrt_a_sqrt_m: match source {
            Source::BeidouD1D2 => 5282.6,
            Source::GalileoInav | Source::GalileoFnav => 5440.6,
            _ => 5153.65,
        },
        eccentricity: 0.0,
        m0_sc: around(f64::from(slot) / 5.0 + f64::from(plane) / 13.0 + shift),
        omega0_sc: around(f64::from(plane) / 6.0 + shift),
        i0_sc: 55.0 / 180.0,
        omega_sc: 0.0,
        delta_n_sc_s: 0.0,
        omegadot_sc_s: 0.0,
        idot_sc_s: 0.0,
        cuc_rad: 0.0,
        cus_rad: 0.0,
        crc_m: 0.0,
        crs_m: 0.0,
        cic_rad: 0.0,
        cis_rad: 0.0,
        af0_s: 0.0,
        af1_s_s: 0.0,
        af2_s_s2: 0.0,
        group_delays_s: [0.0; 2],
    }
}

/// An ionosphere: electrons above the receiver, and their increase for each degree to the north.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ionosphere {
    pub(crate) tecu: f64,
    pub(crate) per_degree: f64,
}

impl Ionosphere {
    /// Returns the delay on L1 towards a satellite, m.
    pub(crate) fn delay_m(self, towards: Enu) -> f64 {
        const METRES_PER_TECU: f64 = 40.3e16 / (1575.42e6 * 1575.42e6);
        const RATIO: f64 = 6371.0 / 6721.0;
        let cosine = RATIO * towards.horizontal();
        let elevation = towards.up.asin();
        let central = std::f64::consts::FRAC_PI_2 - elevation - cosine.asin();
        let north_deg = central.to_degrees() * towards.north / towards.horizontal().max(1e-9);
        let vertical = (self.tecu + self.per_degree * north_deg).max(0.0);
        METRES_PER_TECU * vertical / (1.0 - cosine * cosine).sqrt()
    }
}

/// Returns the troposphere of the receiver's own model, so that only the ionosphere remains, m.
fn troposphere_m(frame: &LocalFrame, up: f64) -> f64 {
    let model =
        raim_firmware::correction::Troposphere::above(frame.height_m() as f32, frame.sin_latitude() as f32);
    f64::from(model.delay_m(up as f32))
}

/// Returns the measured range of a satellite, or `None` below the horizon.
pub(crate) fn range_m(
    ephemeris: &Ephemeris,
    time: GpsTime,
    receiver: Ecef,
    ionosphere: Ionosphere,
) -> Option<f64> {
    let frame = LocalFrame::at(receiver);
    let mut range_m = 2.3e7;
    for _ in 0..5 {
        let sent = ephemeris.at(time, range_m).unwrap();
        let from = sent.position;
        let towards = frame.rotate(from - receiver);
        let distance_m = from.distance_m(receiver);
        let (east, north, up) =
            (towards.east / distance_m, towards.north / distance_m, towards.up / distance_m);
        if up < 0.05 {
            return None;
        }
        let turned_m =
            EARTH_ROTATION_RAD_S / SPEED_OF_LIGHT_M_S * (from.x_m * receiver.y_m - from.y_m * receiver.x_m);
        let air_m = troposphere_m(&frame, up) + ionosphere.delay_m(Enu { east, north, up });
        range_m = distance_m + turned_m - SPEED_OF_LIGHT_M_S * sent.clock_s + air_m;
    }
    Some(range_m)
}
