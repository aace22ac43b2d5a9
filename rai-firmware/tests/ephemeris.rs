//! Orbits, clocks, group delays and the store.

mod orbits;

use orbits::{CASES, Case};
use proptest::prelude::*;
use rai_core::frame::Ecef;
use rai_core::satellite::{Constellation, SatelliteId};
use rai_firmware::ephemeris::{
    Broadcast, BroadcastError, CAPACITY, Ephemeris, EphemerisError, GroupDelay, Insertion, Source, Store,
};
use rai_firmware::signal::{Band, Signal, choose};
use rai_firmware::time::GpsTime;

type Spoil = fn(&mut Broadcast, GpsTime);

const GPS: usize = 0;
const GALILEO: usize = 2;
const BEIDOU_GEO: usize = 4;

fn after(time: GpsTime, seconds: i64) -> GpsTime {
    GpsTime::from_ms(time.to_ms().checked_add_signed(seconds * 1000).unwrap())
}

fn ephemeris(case: &Case) -> Ephemeris {
    Ephemeris::new(&case.broadcast()).unwrap()
}

fn changed(case: &Case, change: impl FnOnce(&mut Broadcast)) -> Result<Ephemeris, BroadcastError> {
    let mut broadcast = case.broadcast();
    change(&mut broadcast);
    Ephemeris::new(&broadcast)
}

#[test]
fn positions_and_clocks_of_all_orbit_kinds_agree_with_a_separate_program() {
    for case in &CASES {
        for want in &case.want {
            let received =
                GpsTime::from_ms(case.toe().to_ms().checked_add_signed(want.after_toe_ms).unwrap());
            let have = ephemeris(case).at(received, want.range_m).unwrap();
            let [x, y, z] = want.position_m;
            let error_m = have.position.distance_m(Ecef::new(x, y, z));
            assert!(error_m < 5e-4, "{}: {error_m} m, have {have:?}", case.id());
            let error_s = (have.clock_s - want.clock_s).abs();
            assert!(error_s < 1e-13, "{}: {error_s:e} s, have {have:?}", case.id());
        }
    }
}

#[test]
fn an_ephemeris_that_no_satellite_sends_is_refused_by_field() {
    let later = after(CASES[GPS].toe(), 2 * 86_400);
    let refused: [(Spoil, BroadcastError); 12] = [
        (|b, _| b.eccentricity = 1.0, BroadcastError::Eccentricity),
        (|b, _| b.eccentricity = f64::NAN, BroadcastError::Eccentricity),
        (|b, _| b.eccentricity = -0.01, BroadcastError::Eccentricity),
        (|b, _| b.sqrt_a_sqrt_m = 0.0, BroadcastError::SemiMajorAxis),
        (|b, _| b.sqrt_a_sqrt_m = f64::INFINITY, BroadcastError::SemiMajorAxis),
        (|b, _| b.m0_sc = 3.0, BroadcastError::Angle),
        (|b, _| b.omegadot_sc_s = f64::NAN, BroadcastError::Correction),
        (|b, _| b.crs_m = 1e9, BroadcastError::Correction),
        (|b, _| b.af0_s = f64::NAN, BroadcastError::Clock),
        (|b, _| b.group_delays_s = [f32::INFINITY, 0.0], BroadcastError::Clock),
        (|b, later| b.toc = later, BroadcastError::ReferenceTime),
        (|b, _| b.satellite = SatelliteId::new(Constellation::Gps, 33).unwrap(), BroadcastError::Satellite),
    ];
    for (change, want) in refused {
        assert_eq!(changed(&CASES[GPS], |b| change(b, later)), Err(want));
    }
}

#[test]
fn a_satellite_without_health_or_promise_is_unhealthy() {
    let time = CASES[GALILEO].toe();
    let ill = changed(&CASES[GALILEO], |b| b.healthy = false).unwrap();
    let silent = changed(&CASES[GALILEO], |b| b.accuracy_m = None).unwrap();
    assert_eq!(ill.usable_at(time), Err(EphemerisError::Unhealthy));
    assert_eq!(silent.usable_at(time), Err(EphemerisError::Unhealthy));
}

#[test]
fn an_old_ephemeris_is_stale_and_a_far_future_one_too() {
    for (case, hours) in [(&CASES[GPS], 2), (&CASES[GALILEO], 4), (&CASES[BEIDOU_GEO], 2)] {
        let (toe, ephemeris) = (case.toe(), ephemeris(case));
        assert_eq!(ephemeris.usable_at(after(toe, hours * 3600)), Ok(()));
        assert_eq!(ephemeris.usable_at(after(toe, -hours * 3600)), Ok(()));
        assert_eq!(ephemeris.usable_at(after(toe, hours * 3600 + 61)), Err(EphemerisError::Stale));
        assert_eq!(ephemeris.usable_at(after(toe, -7 * 86_400)), Err(EphemerisError::Stale));
    }
}

#[test]
fn a_range_that_is_no_distance_gives_no_position() {
    let (toe, ephemeris) = (CASES[GPS].toe(), ephemeris(&CASES[GPS]));
    for range_m in [f64::NAN, f64::INFINITY, -1.0, 1e12] {
        assert_eq!(ephemeris.at(toe, range_m), Err(EphemerisError::TravelTime), "{range_m}");
    }
}

#[test]
fn the_orbit_goes_on_over_the_roll_over_of_the_week() {
    let at_edge = GpsTime { week: 2111, tow_ms: 604_799_000 };
    let ephemeris = changed(&CASES[BEIDOU_GEO], |b| (b.toe, b.toc) = (at_edge, at_edge)).unwrap();
    let before = ephemeris.at(at_edge, 0.0).unwrap().position;
    let behind = ephemeris.at(GpsTime { week: 2112, tow_ms: 0 }, 0.0).unwrap().position;
    // A geostationary satellite with 1.7° inclination moves by less than 100 m in the second between.
    assert!(before.distance_m(behind) < 100.0, "{before:?} {behind:?}");
}

#[test]
fn a_new_issue_in_mid_pass_replaces_and_an_older_one_does_not() {
    let (mut store, case) = (Store::new(), &CASES[GPS]);
    let (toe, now) = (case.toe(), Some(case.toe()));
    let at = |seconds: i64, af0_s: f64| {
        changed(case, |b| (b.toe, b.toc, b.af0_s) = (after(toe, seconds), after(toe, seconds), af0_s))
            .unwrap()
    };
    assert_eq!(store.get(case.id(), toe), Err(EphemerisError::Missing));
    assert_eq!(store.insert(at(0, 1e-5), now), Insertion::Taken);
    assert_eq!(store.insert(at(7200, 2e-5), now), Insertion::Taken);
    assert_eq!(store.insert(at(0, 1e-5), now), Insertion::Older);
    assert_eq!(store.insert(at(7200, 3e-5), now), Insertion::Taken);
    assert_eq!(*store.get(case.id(), toe).unwrap(), at(7200, 3e-5));
}

#[test]
fn a_reference_time_in_the_far_future_does_not_block_the_true_one() {
    let (mut store, case) = (Store::new(), &CASES[GPS]);
    let far = after(case.toe(), 30 * 86_400);
    store.insert(changed(case, |b| (b.toe, b.toc) = (far, far)).unwrap(), Some(case.toe()));
    assert_eq!(store.get(case.id(), case.toe()), Err(EphemerisError::Stale));
    assert_eq!(store.insert(ephemeris(case), Some(case.toe())), Insertion::Taken);
    assert!(store.get(case.id(), case.toe()).is_ok());
}

#[test]
fn a_reference_time_in_the_far_future_does_not_displace_a_set_in_use() {
    let (mut store, case) = (Store::new(), &CASES[GPS]);
    let (satellite, now) = (ephemeris(case).satellite(), after(case.toe(), 600));
    store.insert(ephemeris(case), Some(now));
    for hours in [3, 30, 24 * 365] {
        let far = changed(case, |b| {
            b.toe = after(b.toe, hours * 3600);
            b.toc = b.toe;
        });
        assert_eq!(store.insert(far.unwrap(), Some(now)), Insertion::Older, "{hours} h ahead");
        assert_eq!(store.get(satellite, now).unwrap().toe(), case.toe(), "{hours} h ahead");
    }
}

#[test]
fn galileo_fnav_serves_until_inav_comes_and_does_not_replace_it() {
    let (mut store, case) = (Store::new(), &CASES[GALILEO]);
    let (toe, now) = (case.toe(), Some(case.toe()));
    let fnav = |seconds| {
        let time = after(toe, seconds);
        changed(case, |b| (b.source, b.toe, b.toc) = (Source::GalileoFnav, time, time)).unwrap()
    };
    assert_eq!(store.insert(fnav(0), now), Insertion::Taken);
    assert_eq!(store.insert(ephemeris(case), now), Insertion::Taken);
    assert_eq!(store.insert(fnav(600), now), Insertion::Older);
    assert_eq!(store.insert(fnav(5 * 3600), Some(after(toe, 5 * 3600))), Insertion::Taken);
}

#[test]
fn a_full_store_lets_the_oldest_go() {
    let mut store = Store::new();
    let toe = CASES[BEIDOU_GEO].toe();
    let satellites = (1..=32).map(|n| (&CASES[GPS], n)).chain((1..=36).map(|n| (&CASES[GALILEO], n)));
    let satellites: Vec<_> = satellites.chain((1..=63).map(|n| (&CASES[BEIDOU_GEO], n))).collect();
    assert!(satellites.len() > CAPACITY);
    for (age, (case, number)) in (0..).zip(&satellites) {
        let satellite = SatelliteId::new(case.satellite.0, *number).unwrap();
        let time = after(toe, age - 200);
        store.insert(changed(case, |b| (b.satellite, b.toe, b.toc) = (satellite, time, time)).unwrap(), None);
    }
    assert_eq!(store.len(), CAPACITY);
    let first = SatelliteId::new(Constellation::Gps, 1).unwrap();
    let last = SatelliteId::new(Constellation::Beidou, 63).unwrap();
    assert_eq!(store.get(first, toe), Err(EphemerisError::Missing));
    assert!(store.get(last, toe).is_ok());
}

/// The clock of a band against the broadcast clock, in nanoseconds, as the documents print it.
#[test]
fn group_delays_are_those_of_the_interface_documents() {
    let delays = |case: &Case, source, group_delays_s| {
        changed(case, |b| (b.source, b.group_delays_s) = (source, group_delays_s)).unwrap()
    };
    let gps = delays(&CASES[GPS], Source::GpsLnav, [-1e-8, 0.0]);
    let fnav = delays(&CASES[GALILEO], Source::GalileoFnav, [4e-9, 0.0]);
    let inav = delays(&CASES[GALILEO], Source::GalileoInav, [4e-9, 5e-9]);
    let beidou = delays(&CASES[BEIDOU_GEO], Source::BeidouD1D2, [1.4e-8, -1.0e-8]);
    let want = [
        (&gps, Band::L1, Some(-10.0)),
        (&gps, Band::L2, Some(-10.0 * (77.0f64 / 60.0).powi(2))),
        (&gps, Band::E1, None),
        (&fnav, Band::E1, Some(4.0)),
        (&fnav, Band::E5a, Some(4.0 * (154.0f64 / 115.0).powi(2))),
        (&fnav, Band::E5b, None),
        (&inav, Band::E1, Some(5.0)),
        (&inav, Band::E5b, Some(5.0 * (154.0f64 / 118.0).powi(2))),
        (&beidou, Band::B1I, Some(14.0)),
        (&beidou, Band::B2I, Some(-10.0)),
        (&beidou, Band::B3I, Some(0.0)),
    ];
    for (ephemeris, band, want) in want {
        let have = ephemeris.group_delay(band).map(|delay| delay.seconds() * 1e9);
        assert!(have.is_some() == want.is_some(), "{band:?}: have {have:?}, want {want:?}");
        assert!((have.unwrap_or(0.0) - want.unwrap_or(0.0)).abs() < 1e-6, "{band:?}: {have:?}, {want:?}");
    }
    assert!(matches!(gps.group_delay(Band::L5), Some(GroupDelay::Uncalibrated(_))));
    assert!(matches!(beidou.group_delay(Band::B2a), Some(GroupDelay::Uncalibrated(_))));
}

fn signal(band: Band, range_m: f64) -> Signal {
    Signal { band, cn0_dbhz: 45.0, range_m }
}

#[test]
fn the_pair_that_the_clock_refers_to_needs_no_group_delay() {
    let delayed = |case: &Case, source| {
        changed(case, |b| (b.source, b.group_delays_s) = (source, [7e-9, -3e-9])).unwrap()
    };
    for (ephemeris, first, second) in [
        (delayed(&CASES[GPS], Source::GpsLnav), Band::L1, Band::L2),
        (delayed(&CASES[GALILEO], Source::GalileoFnav), Band::E1, Band::E5a),
        (delayed(&CASES[GALILEO], Source::GalileoInav), Band::E1, Band::E5b),
    ] {
        let have = choose(&[signal(first, 2.2e7), signal(second, 2.2e7)], &ephemeris).unwrap();
        assert!((have.range_m - 2.2e7).abs() < 1e-6, "{first:?} {second:?}: {have:?}");
        assert_eq!((have.bands, have.uncalibrated_m), ((first, Some(second)), 0.0));
    }
}

#[test]
fn the_beidou_pair_b1i_b3i_bears_its_share_of_tgd1() {
    let ephemeris = changed(&CASES[BEIDOU_GEO], |b| b.group_delays_s = [1e-8, 0.0]).unwrap();
    let have = choose(&[signal(Band::B1I, 3.8e7), signal(Band::B3I, 3.8e7)], &ephemeris).unwrap();
    // f1² / (f1² − f3²) = 2.943682..., times 10 ns times c.
    let share = 1561.098f64.powi(2) / (1561.098f64.powi(2) - 1268.52f64.powi(2));
    let want = 3.8e7 - share * 2.997_924_58;
    assert!((have.range_m - want).abs() < 1e-6, "have {have:?}, want {want}");
    assert!((have.noise_factor - share.hypot(share - 1.0)).abs() < 1e-12, "{have:?}");
}

#[test]
fn galileo_e5a_with_the_inav_clock_is_the_fnav_clock() {
    // The two clocks describe one satellite: E1 at BGD_b after the I/NAV clock is E1 at BGD_a after the F/NAV clock.
    let (bgd_a, bgd_b) = (4e-9, 6e-9);
    let inav = changed(&CASES[GALILEO], |b| b.group_delays_s = [bgd_a, bgd_b]).unwrap();
    let have = choose(&[signal(Band::E1, 2.4e7), signal(Band::E5a, 2.4e7)], &inav).unwrap();
    let want = 2.4e7 - f64::from(bgd_b - bgd_a) * 299_792_458.0;
    assert!((have.range_m - want).abs() < 1e-6, "have {have:?}, want {want}");
}

#[test]
fn one_signal_alone_keeps_the_ionosphere_and_takes_its_group_delay() {
    let ephemeris = changed(&CASES[GPS], |b| b.group_delays_s = [1e-8, 0.0]).unwrap();
    let have = choose(&[signal(Band::L1, 2.2e7)], &ephemeris).unwrap();
    assert!((have.range_m - (2.2e7 - 2.997_924_58)).abs() < 1e-6, "{have:?}");
    assert_eq!((have.bands, have.noise_factor), ((Band::L1, None), 1.0));
    assert_eq!(choose(&[], &ephemeris), None);
    assert_eq!(choose(&[signal(Band::E1, 2.2e7)], &ephemeris), None);
}

proptest! {
    /// Whatever the fields hold: refused, or a finite state that can be a satellite's.
    #[test]
    fn no_accepted_ephemeris_gives_a_position_that_is_not_finite(
        numbers in prop::collection::vec(prop::num::f64::ANY, 16),
        sane in prop::collection::vec(any::<bool>(), 16),
        range_m in prop::num::f64::ANY,
        case in 0..CASES.len(),
        seconds in -100_000i64..100_000,
    ) {
        let mut b = CASES[case].broadcast();
        let mut values = numbers.iter().zip(&sane);
        let mut spoil = |field: &mut f64| if let Some((value, false)) = values.next() { *field = *value };
        for field in [&mut b.eccentricity, &mut b.sqrt_a_sqrt_m, &mut b.m0_sc, &mut b.omega0_sc, &mut b.i0_sc,
            &mut b.omega_sc, &mut b.delta_n_sc_s, &mut b.omegadot_sc_s, &mut b.idot_sc_s, &mut b.af0_s,
            &mut b.af1_s_s, &mut b.af2_s_s2] {
            spoil(field);
        }
        if let Ok(ephemeris) = Ephemeris::new(&b) {
            for range_m in [range_m, 2.2e7] {
                if let Ok(state) = ephemeris.at(after(b.toe, seconds), range_m) {
                    prop_assert!((5e6..1e8).contains(&state.position.radius_m()), "{:?}", state);
                    prop_assert!(state.clock_s.abs() < 1.0, "{:?}", state);
                }
            }
        }
    }
}
