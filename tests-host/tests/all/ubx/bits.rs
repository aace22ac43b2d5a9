//! Navigation messages of random content: UBX gives the values of RTCM, bit for bit.

use raim::signal::encode::ubx;
use raim::signal::measurement::{Ephemeris, TimedEphemeris};
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::ephemeris::EphemerisError;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rtcm_rs::msg::{Msg1019T, Msg1042T, Msg1045T, Msg1046T};

use super::{NOON, by_rtcm, reported};

/// Draws a number of that many bits in two's complement, in units of `2^exponent`.
fn signed(random: &mut ChaCha8Rng, width: u32, exponent: i32) -> f64 {
    let half = 1_i64 << (width - 1);
    random.random_range(-half..half) as f64 * 2f64.powi(exponent)
}

/// Draws the same without a sign, between limits.
fn unsigned(random: &mut ChaCha8Rng, least: f64, most: f64, exponent: i32) -> f64 {
    let unit = 2f64.powi(exponent);
    (random.random_range(least..most) / unit).floor() * unit
}

/// Bounds of √A, of the eccentricity and of the inclination, degrees: within those of the system's
/// satellites.
type Orbit = ((f64, f64), (f64, f64), (f64, f64));
const GPS: Orbit = ((5141.0, 5166.0), (0.0, 0.03), (50.0, 60.0));
const GALILEO: Orbit = ((5426.0, 5455.0), (0.0, 0.02), (52.0, 60.0));
const BEIDOU: Orbit = ((5269.0, 5296.0), (0.0, 0.02), (50.0, 60.0));
/// About the plane in which their elements are written.
const BEIDOU_GEOSTATIONARY: Orbit = ((6479.0, 6507.0), (0.0, 0.02), (4.0, 6.0));

/// Draws the elements that all messages have, with the widths of their fields: harmonics of angles
/// and of the radius.
macro_rules! message {
    ($type:ident, $random:ident, orbit: $orbit:expr, angles: $angle:expr, lengths: $length:expr, clock: [$($field:ident: $clock:expr),*],
     $($other:ident: $value:expr),* $(; ..$base:expr)?) => {{
        let toe_s = (NOON.tow_ms / 1000) as f32;
        $type {
            toe_s,
            m0_sc: signed($random, 32, -31),
            omega0_sc: signed($random, 32, -31),
            i0_sc: unsigned($random, $orbit.2.0 / 180.0, $orbit.2.1 / 180.0, -31),
            omega_sc: signed($random, 32, -31),
            eccentricity: unsigned($random, $orbit.1.0, $orbit.1.1, -33),
            sqrt_a_sqrt_m: unsigned($random, $orbit.0.0, $orbit.0.1, -19),
            delta_n_sc_s: signed($random, 16, -43) as f32,
            omegadot_sc_s: signed($random, 24, -43),
            idot_sc_s: signed($random, 14, -43) as _,
            cuc_rad: signed($random, $angle.0, $angle.1) as f32,
            cus_rad: signed($random, $angle.0, $angle.1) as f32,
            cic_rad: signed($random, $angle.0, $angle.1) as f32,
            cis_rad: signed($random, $angle.0, $angle.1) as f32,
            crc_m: signed($random, $length.0, $length.1) as f32,
            crs_m: signed($random, $length.0, $length.1) as f32,
            $($field: signed($random, $clock.0, $clock.1) as _,)*
            $($other: $value,)*
            $(..$base)?
        }
    }};
}

pub(super) fn gps(random: &mut ChaCha8Rng) -> TimedEphemeris {
    let iodc = random.random_range(0..1024_u16);
    let number = random.random_range(1..=32);
    let message = message!(Msg1019T, random, orbit: GPS, angles: (16, -29), lengths: (16, -5),
        clock: [af0_s: (22, -31), af1_s_s: (16, -43), af2_s_s2: (8, -55)],
        gps_satellite_id: number, gps_week_number: NOON.week % 1024, iodc: iodc, iode: iodc as u8,
        toc_s: (NOON.tow_ms / 1000) as f32, ura_index: random.random_range(0..15),
        // The most negative value means that there is none.
        tgd_s: random.random_range(-127..128) as f32 * 2f32.powi(-31),
        sv_health_ind: if random.random_bool(0.2) { random.random_range(1..64) } else { 0 }; ..Msg1019T::default());
    timed(Constellation::Gps, number, Ephemeris::Gps(message))
}

pub(super) fn beidou(random: &mut ChaCha8Rng) -> TimedEphemeris {
    // A third of them are geostationary.
    let number = [random.random_range(6..=58), random.random_range(1..=5), random.random_range(6..=58)]
        [random.random_range(0..3)];
    let delay = |random: &mut ChaCha8Rng| random.random_range(-512..512) as f32 * 1e-10;
    let (tgd1_s, tgd2_s) = (delay(random), delay(random));
    let is_geostationary = matches!(number, 1..=5);
    let orbit = if is_geostationary { BEIDOU_GEOSTATIONARY } else { BEIDOU };
    let mut message = message!(Msg1042T, random, orbit: orbit, angles: (18, -31), lengths: (18, -6),
        clock: [a0_s: (24, -33), a1_s_s: (22, -50), a2_s_s2: (11, -66)],
        bds_satellite_id: number, bds_week_number: NOON.week - 1356, tgd1_s: tgd1_s, tgd2_s: tgd2_s,
        toc_s: (NOON.tow_ms / 1000) as f32, ura_index: random.random_range(0..15),
        aode: random.random_range(0..32), aodc: random.random_range(0..32),
        sv_health_flag: u8::from(random.random_bool(0.2)));
    if is_geostationary {
        // At the reference time the node is opposite to the axis of the tilt, give or take 20°.
        const EARTH_RATE_SC_S: f64 = 7.292_115e-5 / std::f64::consts::PI;
        let node_sc = 1.0 + EARTH_RATE_SC_S * f64::from(NOON.tow_ms / 1000) + message.omega0_sc / 9.0;
        message.omega0_sc =
            (((node_sc + 1.0).rem_euclid(2.0) - 1.0) * 2f64.powi(31)).floor() * 2f64.powi(-31);
    }
    timed(Constellation::Beidou, number, Ephemeris::Beidou(message))
}

pub(super) fn inav(random: &mut ChaCha8Rng) -> TimedEphemeris {
    let number = random.random_range(1..=36);
    let message = message!(Msg1046T, random, orbit: GALILEO, angles: (16, -29), lengths: (16, -5),
        clock: [af0_s: (31, -34), af1_s_s: (21, -46), af2_s_s2: (6, -59),
                bgd_e1_e5a_s: (10, -32), bgd_e1_e5b_s: (10, -32)],
        gal_satellite_id: number, gal_week_number: NOON.week - 1024, iodnav: random.random_range(0..1024),
        toc_s: (NOON.tow_ms / 1000) as f32, sisa_e1_e5b_index: random.random_range(0..126),
        e5b_sig_health_ind: random.random_range(0..4), e1_b_sig_health_ind: random.random_range(0..4),
        e5b_data_validity_flag: random.random_range(0..2), e1_b_data_validity_flag: random.random_range(0..2); ..Msg1046T::default());
    timed(Constellation::Galileo, number, Ephemeris::GalileoInav(message))
}

pub(super) fn fnav(random: &mut ChaCha8Rng) -> TimedEphemeris {
    let number = random.random_range(1..=36);
    let message = message!(Msg1045T, random, orbit: GALILEO, angles: (16, -29), lengths: (16, -5),
        clock: [af0_s: (31, -34), af1_s_s: (21, -46), af2_s_s2: (6, -59), bgd_e1_e5a_s: (10, -32)],
        gal_satellite_id: number, gal_week_number: NOON.week - 1024, iodnav: random.random_range(0..1024),
        toc_s: (NOON.tow_ms / 1000) as f32, sisa_e1_e5a_index: random.random_range(0..126),
        e5a_sig_health_ind: random.random_range(0..4), e5a_data_validity_flag: random.random_range(0..2); ..Msg1045T::default());
    timed(Constellation::Galileo, number, Ephemeris::GalileoFnav(message))
}

fn timed(constellation: Constellation, number: u8, message: Ephemeris) -> TimedEphemeris {
    let satellite = SatelliteId::new(constellation, number).unwrap();
    let toe = match constellation {
        // Its seconds of the week are 14 s behind.
        Constellation::Beidou => raim_firmware::time::GpsTime::from_ms(NOON.to_ms() + 14_000),
        _ => NOON,
    };
    TimedEphemeris { satellite, toe, sent: toe, message }
}

/// Function that returns a random message of one kind.
type Source = fn(&mut ChaCha8Rng) -> TimedEphemeris;

/// All sources.
pub(super) const SOURCES: [(&str, Source); 4] =
    [("LNAV", gps), ("D1 and D2", beidou), ("I/NAV", inav), ("F/NAV", fnav)];

#[test]
fn every_bit_of_every_ephemeris_is_as_rtcm_says_it() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for (name, source) in SOURCES {
        for _ in 0..250 {
            let ephemeris = source(&mut random);
            let want = by_rtcm(&ephemeris);
            assert_eq!(want.len(), 1, "{name}: {ephemeris:?}");
            let (have, counters) = reported(&ubx::pages(&ephemeris, NOON).unwrap());
            assert_eq!(have.ephemerides, want, "{name}: {ephemeris:?} {counters:?}");
        }
    }
}

/// Start of the words in a frame of RXM-SFRBX, and the bit of the second word that raises the
/// alert: bit 18 of 30 ([IS-GPS-200] figure 20-2).
const FIRST_WORD: usize = 6 + 8;
const ALERT: u32 = 1 << (30 - 18);

#[test]
fn satellite_that_raises_the_alert_promises_no_accuracy() {
    let mut ephemeris = gps(&mut ChaCha8Rng::seed_from_u64(3));
    let Ephemeris::Gps(message) = &mut ephemeris.message else { unreachable!("of GPS") };
    message.sv_health_ind = 0;
    let now = ephemeris.toe;
    let bytes = ubx::pages(&ephemeris, NOON).unwrap();
    let frames: Vec<&[u8]> = bytes.chunks(bytes.len() / 3).collect();
    let raised = |frame: &[u8]| {
        let words: Vec<u32> = frame[FIRST_WORD..frame.len() - 2]
            .chunks(4)
            .enumerate()
            .map(|(index, word)| {
                u32::from_le_bytes(word.try_into().unwrap()) | if index == 1 { ALERT } else { 0 }
            })
            .collect();
        ubx::subframe(ephemeris.satellite, 0, &ubx::Form::Lnav.sealed(&words).unwrap())
    };
    for alerted in [None, Some(0), Some(1), Some(2)] {
        let sent = frames
            .iter()
            .enumerate()
            .flat_map(|(index, frame)| if alerted == Some(index) { raised(frame) } else { frame.to_vec() });
        let (have, counters) = reported(&sent.collect::<Vec<u8>>());
        let [have] = have.ephemerides.as_slice() else { panic!("one ephemeris, {counters:?}") };
        let want = if alerted.is_some() { Err(EphemerisError::Unhealthy) } else { Ok(()) };
        assert_eq!(have.usable_at(now), want, "alert in {alerted:?}");
    }
}

#[test]
fn ionosphere_and_leap_second_come_from_the_bits() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let klobuchar = [-30, -27, -24, -24, 11, 14, 16, 16].map(|exponent| signed(&mut random, 8, exponent));
    // The change is past, no more than 128 weeks ago as the eight bits of its week require.
    let spoken = ubx::IonosphereAndUtc { klobuchar, leap_s: (17, 18), change: (2000, 7) };
    let gps = gps(&mut random);
    let selection =
        raim::signal::encode::Selection::new("G", raim::signal::encode::Frequency::Single).unwrap();
    let mut encoder = ubx::Encoder::new(std::slice::from_ref(&gps), selection, Some(spoken));
    let nothing = raim::signal::measurement::MeasuredEpoch { time: NOON, satellites: Vec::new() };
    let bytes = encoder.epoch(&nothing).unwrap();
    let mut input = raim_firmware::input::Input::new();
    let mut heard = super::Reported::default();
    input.feed(&bytes, 0, |event| heard.receive(&event));
    assert_eq!(heard.ionosphere, [(Constellation::Gps, klobuchar)]);
    assert_eq!(input.leap_second().map(|leap| leap.seconds), Some(18));
    // Galileo sends the same in its own word, once the date is known.
    let galileo = SatelliteId::new(Constellation::Galileo, 5).unwrap();
    let word = ubx::utc(galileo, &ubx::IonosphereAndUtc { leap_s: (18, 19), change: (2120, 1), ..spoken });
    input.feed(&word.unwrap(), 0, |_| ());
    assert_eq!(input.leap_second().map(|leap| leap.seconds), Some(18), "the change is to come");
    let word = ubx::utc(galileo, &ubx::IonosphereAndUtc { leap_s: (18, 19), change: (2111, 1), ..spoken });
    let word = word.unwrap();
    input.feed(&word, 0, |_| ());
    assert_eq!(input.leap_second().map(|leap| leap.seconds), Some(18), "one word alone");
    input.feed(&word, 0, |_| ());
    assert_eq!(input.leap_second().map(|leap| leap.seconds), Some(19), "the change is past");
}

/// Returns every order of five words.
fn orders() -> Vec<Vec<usize>> {
    (0..5).fold(vec![Vec::new()], |begun, _| {
        let longer = |order: &Vec<usize>| {
            let rest: Vec<usize> = (0..5).filter(|word| !order.contains(word)).collect();
            rest.into_iter().map(|word| [&order[..], &[word]].concat()).collect::<Vec<_>>()
        };
        begun.iter().flat_map(longer).collect()
    })
}

/// [OS-SIS-ICD] table 38: E1 sends the words in the order 2, 4, 1, 3, 5, E5b in the order 1, 3, 5,
/// 2, 4. A receiver may be switched on between any two of them.
///
/// [OS-SIS-ICD]: raim_firmware#references
#[test]
fn galileo_set_is_read_with_the_last_of_its_words_in_any_order() {
    let ephemeris = inav(&mut ChaCha8Rng::seed_from_u64(5));
    let want = by_rtcm(&ephemeris);
    let bytes = ubx::pages(&ephemeris, NOON).unwrap();
    let words: Vec<&[u8]> = bytes.chunks(bytes.len() / 5).collect();
    assert_eq!(orders().len(), 120);
    for order in orders() {
        let sent: Vec<u8> = order.iter().flat_map(|word| words[*word]).copied().collect();
        let (have, counters) = reported(&sent);
        assert_eq!(have.ephemerides, want, "{order:?} {counters:?}");
        assert_eq!(counters.subframes_mixed, 0, "{order:?}");
    }
}

#[test]
fn health_of_galileo_is_that_of_the_last_word_5() {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let with_health = |mut ephemeris: TimedEphemeris, health: u8| {
        let Ephemeris::GalileoInav(message) = &mut ephemeris.message else { unreachable!("I/NAV") };
        (message.e1_b_sig_health_ind, message.e5b_sig_health_ind) = (health, health);
        (message.e1_b_data_validity_flag, message.e5b_data_validity_flag) = (0, 0);
        (message.sisa_e1_e5b_index, message.iodnav) = (50, 7);
        ephemeris
    };
    let drawn = inav(&mut random);
    let now = drawn.toe;
    let pages = |health: u8| ubx::pages(&with_health(drawn.clone(), health), NOON).unwrap();
    let (well, ill) = (pages(0), pages(1));
    let word = |bytes: &[u8], place: usize| bytes.chunks(bytes.len() / 5).nth(place).unwrap().to_vec();
    // Words 1, 3, 5 come first, then 2 and 4, then the next half minute.
    let early: Vec<u8> = [2, 3, 4, 0, 1].into_iter().flat_map(|place| word(&well, place)).collect();
    let next: Vec<u8> = [2, 3, 4].into_iter().flat_map(|place| word(&ill, place)).collect();
    let (have, _) = reported(&[early, next].concat());
    let usable: Vec<_> = have.ephemerides.iter().map(|set| set.usable_at(now)).collect();
    assert_eq!(usable, [Ok(()), Err(EphemerisError::Unhealthy)]);
}
