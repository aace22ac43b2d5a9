//! QZSS: the bits of GPS under another number, and the clock that its ranges share.

use raim::signal::encode::ubx;
use raim::signal::measurement::{Ephemeris, TimedEphemeris};
use raim_core::epoch::Epoch;
use raim_core::frame::{Ecef, SPEED_OF_LIGHT_M_S};
use raim_core::satellite::SatelliteId;
use raim_firmware::correction::{Site, Sky, Tally, locate};
use raim_firmware::ephemeris::Store;
use raim_firmware::input::{Event, Input};
use raim_firmware::navigator::Navigator;
use raim_firmware::settings::{Configuration, Systems};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rig::stations::{ESBC, STATIC_BASE, Station};
use rtcm_rs::msg::{Msg1019T, Msg1044T};
use rtcm_rs::{Message, MessageBuilder};

use super::bits::gps;
use super::streams::{STREAMS, Stream};
use super::{NOON, reported};

/// Returns the same elements as a QZSS satellite's RTCM message.
fn message_1044(number: u8, m: &Msg1019T) -> Msg1044T {
    Msg1044T {
        qzss_satellite_id: number,
        toc_s: m.toc_s,
        af2_s_s2: m.af2_s_s2,
        af1_s_s: m.af1_s_s,
        af0_s: m.af0_s,
        iode: m.iode,
        crs_m: m.crs_m,
        delta_n_sc_s: m.delta_n_sc_s,
        m0_sc: m.m0_sc,
        cuc_rad: m.cuc_rad,
        eccentricity: m.eccentricity,
        cus_rad: m.cus_rad,
        sqrt_a_sqrt_m: m.sqrt_a_sqrt_m,
        toe_s: m.toe_s,
        cic_rad: m.cic_rad,
        omega0_sc: m.omega0_sc,
        cis_rad: m.cis_rad,
        i0_sc: m.i0_sc,
        crc_m: m.crc_m,
        omega_sc: m.omega_sc,
        omegadot_sc_s: m.omegadot_sc_s,
        idot_sc_s: m.idot_sc_s,
        code_on_l2_ind: m.code_on_l2_ind,
        qzss_week_number: m.gps_week_number,
        ura_index: m.ura_index,
        sv_health_ind: m.sv_health_ind,
        tgd_s: m.tgd_s,
        iodc: m.iodc,
        fit_interval_ind: m.fit_interval_ind,
    }
}

#[test]
fn every_bit_of_lnav_is_as_rtcm_says_it() {
    let mut random = ChaCha8Rng::seed_from_u64(12);
    for index in 0..250_u32 {
        let number = (index % 10 + 1) as u8;
        let mut broadcast = gps(&mut random);
        let Ephemeris::Gps(elements) = &mut broadcast.message else { unreachable!("of GPS") };
        // From an orbit of GPS to one of QZSS, in whole units of the fields.
        elements.sqrt_a_sqrt_m += 1339.0;
        elements.eccentricity += 0.0625;
        elements.i0_sc -= 0.0625;
        let mut builder = MessageBuilder::new();
        let frame = builder.build_message(&Message::Msg1044(message_1044(number, elements))).unwrap();
        let (want, counters) = reported(frame);
        assert_eq!(want.ephemerides.len(), 1, "{broadcast:?} {counters:?}");
        let satellite = SatelliteId::qzss(number).unwrap();
        let as_qzss = TimedEphemeris { satellite, ..broadcast.clone() };
        let (have, counters) = reported(&ubx::pages(&as_qzss, NOON).unwrap());
        assert_eq!(have.ephemerides, want.ephemerides, "{broadcast:?} {counters:?}");
        assert_eq!(have.ephemerides[0].satellite().to_string(), format!("J{number:02}"));
    }
}

/// Elevation mask of three degrees, rad, because in Denmark QZSS is low.
const MASK_RAD: f64 = 0.0524;

/// Returns the mean difference between corrected ranges of QZSS and of GPS, m, and their number:
/// pairs of L1 and L2C, whose delays the broadcast clocks include.
fn beside_gps(stream: &Stream, station: &Station) -> Option<(f64, usize)> {
    let bytes = stream.bytes()?;
    let (mut input, mut store, mut tally) = (Input::new(), Store::new(), Tally::default());
    let systems = Systems::of("GJ").unwrap();
    let (mut sum_m, mut count) = (0.0, 0);
    input.feed(&bytes, 0, |event| match event {
        Event::Ephemeris(ephemeris) => {
            store.insert(ephemeris, Some(ephemeris.toe()));
        }
        Event::Epoch(raw, _) => {
            let (mut sky, mut epoch) = (Sky::new(), Epoch::new(0.0));
            locate(raw, &store, 28.0, systems, &mut tally, &mut sky);
            let pairs = sky.into_iter().filter(raim_firmware::correction::Located::has_pair).collect();
            let site = Site::new(station.truth, raw.time, MASK_RAD, None);
            site.correct(&pairs, &mut tally, &mut epoch);
            let clocks = epoch.observations().iter().map(|seen| {
                (seen.satellite.is_qzss(), seen.range_m - distance_m(seen.position, station.truth))
            });
            let (qzss, gps): (Vec<_>, Vec<_>) = clocks.partition(|(is_qzss, _)| *is_qzss);
            if qzss.is_empty() || gps.len() < 4 {
                return;
            }
            let clock_m = gps.iter().map(|(_, clock_m)| clock_m).sum::<f64>() / gps.len() as f64;
            sum_m += qzss.iter().map(|(_, own_m)| own_m - clock_m).sum::<f64>();
            count += qzss.len();
        }
        _ => {}
    });
    Some((sum_m / count as f64, count))
}

/// Returns the path of the signal while the earth turned, m.
fn distance_m(satellite: Ecef, receiver: Ecef) -> f64 {
    const EARTH_RATE_RAD_S: f64 = 7.292_115e-5;
    let turned_m =
        EARTH_RATE_RAD_S / SPEED_OF_LIGHT_M_S * (satellite.x_m * receiver.y_m - satellite.y_m * receiver.x_m);
    satellite.distance_m(receiver) + turned_m
}

/// Orbits and clocks of the two systems have errors of half a metre each: the mean of a satellite
/// or two over minutes is accurate to 2 m at three sigmas. Receiver clocks of two separate systems
/// differ by tens to hundreds of metres.
#[test]
fn its_ranges_touch_the_clock_of_gps() {
    for (name, station) in [("static1hz_base", &STATIC_BASE), ("esbc_4h", &ESBC)] {
        let stream = STREAMS.iter().find(|stream| stream.name == name).unwrap();
        let Some((mean_m, count)) = beside_gps(stream, station) else { return };
        println!("{name}: {count} ranges of QZSS are {mean_m:.2} m longer than those of GPS");
        assert!(count > 100 && mean_m.abs() < 2.0, "{name}: {mean_m} m, {count} ranges");
        let folder = name.split('_').next().unwrap_or_default();
        rig::document::must_say("results/receivers.md", &format!("{:.2} m (`{folder}`)", mean_m.abs()));
    }
}

/// Returns the rms distance to the truth, m, and the number of QZSS satellites used.
fn error_m(bytes: &[u8], truth: Ecef, systems: &str) -> (f64, usize) {
    let mut configuration = Configuration::at_start();
    configuration.systems = Systems::of(systems).unwrap();
    let mut navigator = Navigator::new(configuration.requirements()).unwrap();
    let (mut input, mut now, mut squares_m2, mut fixes, mut used) = (Input::new(), None, 0.0, 0, 0);
    input.feed(bytes, 0, |event| match event {
        Event::Epoch(raw, came_ms) => {
            now = Some(raw.time);
            let report = navigator.judge(raw, came_ms, &configuration);
            used += report.used.iter().filter(|satellite| satellite.is_qzss()).count();
            if let Some(solution) = &report.solution {
                squares_m2 += solution.position.distance_m(truth).powi(2);
                fixes += 1;
            }
        }
        Event::Ephemeris(ephemeris) => drop(navigator.learn(ephemeris, now)),
        _ => {}
    });
    ((squares_m2 / f64::from(fixes)).sqrt(), used)
}

#[test]
fn positions_with_it_are_no_worse_than_without() {
    let stream = STREAMS.iter().find(|stream| stream.name == "static1hz_base").unwrap();
    let Some(bytes) = stream.bytes() else { return };
    for (without, with) in [("G", "GJ"), ("GCE", "GCEJ")] {
        let (want_m, _) = error_m(&bytes, STATIC_BASE.truth, without);
        let (have_m, used) = error_m(&bytes, STATIC_BASE.truth, with);
        println!("{without}: {want_m:.2} m; {with}: {have_m:.2} m, {used} times a satellite of QZSS");
        assert!(used > 300 && have_m < 1.1 * want_m, "{with}: {have_m} m instead of {want_m} m");
    }
}
