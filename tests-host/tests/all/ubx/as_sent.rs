//! Navigation bits as real receivers sent them.
//!
//! | capture | receivers | how its values are known |
//! |---|---|---|
//! | `cases/lnav-as-sent.ubx` | ZED-F9P, X20P, NEO-M8T: GPS alone | RTKLIB's `convbin`, which reads elements and never checks the parity |
//! | `real/f9p_sfrbx.ubx` | ZED-F9P: GPS, Galileo, `BeiDou`, GLONASS | the receiver sends only frames that passed its own check |

use raim::signal::pieces::{Kind, pieces};
use raim_core::frame::Ecef;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::ephemeris::Ephemeris;
use raim_firmware::input::Counters;
use raim_firmware::raw::Band;
use raim_firmware::time::GpsTime;
use rig::shared;

use super::reported;

/// Returns a capture of the reference folder; counts the test as skipped if it is missing.
fn capture(relative: &str) -> Option<Vec<u8>> {
    Some(std::fs::read(shared::path_or_skip(&format!("data/{relative}"))?).unwrap())
}

/// Returns the number of RXM-SFRBX in a capture of the system with this number in UBX.
fn frames_of(bytes: &[u8], system: u8) -> u32 {
    let is_of = |piece: &raim::signal::pieces::Piece<'_>| {
        piece.kind == Kind::Ubx([0x02, 0x13]) && piece.bytes.get(6) == Some(&system)
    };
    pieces(bytes).filter(is_of).count() as u32
}

/// Asserts that nothing was refused for its bits.
fn assert_no_frame_refused(counters: &Counters) {
    let refused = [
        counters.crc_failures,
        counters.subframes_parity,
        counters.subframes_malformed,
        counters.subframes_mixed,
        counters.subframes_surplus,
        counters.ephemerides_invalid,
    ];
    assert_eq!(refused, [0; 6], "{counters:?}");
}

#[test]
fn lnav_of_three_receivers_passes_and_says_what_rtklib_reads() {
    let Some(bytes) = capture("cases/lnav-as-sent.ubx") else { return };
    let (reported, counters) = reported(&bytes);
    assert_no_frame_refused(&counters);
    assert_eq!(counters.subframes, 5);
    let [g02] = reported.ephemerides.as_slice() else { panic!("{:?}", reported.ephemerides) };
    assert_eq!(g02.satellite(), SatelliteId::new(Constellation::Gps, 2).unwrap());
    assert_eq!(g02.toe(), GpsTime { week: 2414, tow_ms: 144_000_000 });
    assert_eq!(g02.usable_at(g02.toe()), Ok(()), "health 0");
    assert_eq!(g02.accuracy_m((Band::L1, None)), Some(2.0));
    let delay_s = g02.group_delay(Band::L1).unwrap().seconds();
    assert!((delay_s + 1.77e-8).abs() < 1e-10, "{delay_s}");
    assert_is_at_reference(g02);
}

/// The elements of G02 that RTKLIB reads.
const AF0_S: f64 = 7.800_385_355_9e-5;
const SQRT_A: f64 = 5_153.770_572_06;
const ECCENTRICITY: f64 = 0.016_829_431_057;
const I0_RAD: f64 = 0.962_803_490_047;
const M0_RAD: f64 = 3.102_436_714_93;
const OMEGA0_RAD: f64 = 2.223_159_664_92;
const OMEGA_RAD: f64 = -0.783_470_470_393;

/// Asserts that position and clock at the reference time are those of the elements above, computed
/// in `f64` without the harmonic corrections, which move a satellite by less than a kilometre.
fn assert_is_at_reference(have: &Ephemeris) {
    const SECONDS_INTO_WEEK: f64 = 144_000.0;
    const EARTH_RATE_RAD_S: f64 = 7.292_115_146_7e-5;
    const RELATIVITY_S: f64 = -4.442_807_633e-10;
    let mut anomaly = M0_RAD;
    for _ in 0..20 {
        anomaly = M0_RAD + ECCENTRICITY * anomaly.sin();
    }
    let flattened = (1.0 - ECCENTRICITY * ECCENTRICITY).sqrt();
    let latitude = (flattened * anomaly.sin()).atan2(anomaly.cos() - ECCENTRICITY) + OMEGA_RAD;
    let radius_m = SQRT_A * SQRT_A * (1.0 - ECCENTRICITY * anomaly.cos());
    let node = OMEGA0_RAD - EARTH_RATE_RAD_S * SECONDS_INTO_WEEK;
    let (along_m, across_m) = (radius_m * latitude.cos(), radius_m * latitude.sin());
    let want = Ecef::new(
        along_m * node.cos() - across_m * I0_RAD.cos() * node.sin(),
        along_m * node.sin() + across_m * I0_RAD.cos() * node.cos(),
        across_m * I0_RAD.sin(),
    );
    let state = have.at(have.toe(), 0.0).unwrap();
    let moved_m = state.position.distance_m(want);
    assert!(moved_m < 1000.0, "{moved_m} m from {want:?}");
    let clock_s = AF0_S + RELATIVITY_S * ECCENTRICITY * SQRT_A * anomaly.sin();
    assert!((state.clock_s - clock_s).abs() < 1e-12, "{} s, {clock_s} s", state.clock_s);
}

#[test]
fn no_frame_of_a_real_f9p_is_refused() {
    /// GPS, Galileo, `BeiDou`, GLONASS as UBX numbers them.
    const SYSTEMS: [u8; 4] = [0, 2, 3, 6];
    let Some(bytes) = capture("real/f9p_sfrbx.ubx") else { return };
    let sent = SYSTEMS.map(|system| frames_of(&bytes, system));
    assert!(sent.iter().all(|frames| *frames > 0), "{sent:?}");
    assert_eq!(sent.iter().sum::<u32>(), 1125);
    let (reported, counters) = reported(&bytes);
    assert_no_frame_refused(&counters);
    println!("{sent:?} frames, {} ephemerides, {counters:?}", reported.ephemerides.len());
    assert!(counters.subframes + counters.subframes_other + counters.leap_unknown >= 1125);
    for of in [Constellation::Gps, Constellation::Galileo, Constellation::Beidou] {
        let of_it =
            reported.ephemerides.iter().filter(|ephemeris| ephemeris.satellite().constellation() == of);
        assert!(of_it.count() > 0, "{of:?}");
    }
}

/// Returns the Galileo sets of a real F9P, from the navigation bits of these signals alone.
fn galileo_of(bytes: &[u8], signals: &[u8]) -> Vec<Ephemeris> {
    let is_of = |piece: &raim::signal::pieces::Piece<'_>| matches!(piece.bytes, [_, _, 0x02, 0x13, _, _, 2, _, signal, ..] if signals.contains(signal));
    let kept: Vec<u8> = pieces(bytes).filter(is_of).flat_map(|piece| piece.bytes.to_vec()).collect();
    let (reported, counters) = reported(&kept);
    assert_no_frame_refused(&counters);
    reported.ephemerides
}

/// E15, E27, E30 and E34 sent words 1, 3, 5 on E1, then 2 and 4 of the same issue, as `pyubx2`
/// lists them.
#[test]
fn galileo_sets_of_a_real_f9p_come_from_either_signal_in_any_order() {
    let Some(bytes) = capture("real/f9p_sfrbx.ubx") else { return };
    let numbers = |sets: &[Ephemeris]| -> std::collections::BTreeSet<u8> {
        sets.iter().map(|set| set.satellite().number()).collect()
    };
    let [e1, e5b] = [&[1][..], &[5]].map(|signals| galileo_of(&bytes, signals));
    assert!(numbers(&e1).is_superset(&[15, 27, 30, 34].into()), "{:?}", numbers(&e1));
    assert!(numbers(&e5b).is_superset(&[15, 27, 30, 34].into()), "{:?}", numbers(&e5b));
    // The two signals of a satellite say the same.
    for set in &e1 {
        let is_same = |other: &&Ephemeris| other.satellite() == set.satellite() && other.toe() == set.toe();
        if let Some(other) = e5b.iter().find(is_same) {
            assert_eq!(set, other);
        }
    }
}
