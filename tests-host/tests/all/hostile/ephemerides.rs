//! Orbits and clocks that are impossible, must not be used, or change.
//!
//! The messages have no numbers for an eccentricity of 1 or for a NaN: the field of the
//! eccentricity ends below 0.5, and all fields are integers. `tests-host/tests/module/ephemeris.rs`
//! tests the check behind the messages with those; here the nearest possible values are sent.

use raim::signal::checksum::rtcm_frame;
use rand::rngs::ChaCha8Rng;
use rand::{Rng, SeedableRng};
use rtcm_rs::Message;
use rtcm_rs::msg::{Msg1019T, Msg1042T};

use super::frames::{changed, claiming, gps, is_ephemeris, only};
use super::module::{Module, Sky};

/// Highest number of a 32-bit field in units of 2⁻³³.
const HIGHEST_ECCENTRICITY: f64 = 4_294_967_295.0 / 8_589_934_592.0;

/// Highest of them that is accepted.
const ECCENTRICITY_LET_IN: f64 = 0.02;

type ChangeGps = fn(&mut Msg1019T);
type ChangeBeidou = fn(&mut Msg1042T);

/// Returns all ephemerides of a lump, changed.
fn spoiled(lump: &[u8], of_gps: ChangeGps, of_beidou: ChangeBeidou) -> Vec<u8> {
    changed(&only(lump, is_ephemeris), |message| match message {
        Message::Msg1019(gps) => of_gps(gps),
        Message::Msg1042(beidou) => of_beidou(beidou),
        _ => {}
    })
}

/// Returns the ephemeris of the first GPS satellite in view, changed.
fn of_one(sky: &Sky, change: impl Fn(&mut Msg1019T)) -> Vec<u8> {
    let seen = gps(&sky.lumps[0]).data_segment.satellite_data[0].satellite_id;
    let mine = |message: &Message| matches!(message, Message::Msg1019(gps) if gps.gps_satellite_id == seen);
    changed(&only(&sky.lumps[0], mine), |message| {
        if let Message::Msg1019(gps) = message {
            change(gps);
        }
    })
}

#[test]
fn orbits_that_cannot_be_are_refused_and_the_known_ones_stay_in_use() {
    let cases: [(&str, ChangeGps, ChangeBeidou); 5] = [
        (
            "the highest eccentricity of a message",
            |m| m.eccentricity = HIGHEST_ECCENTRICITY,
            |m| m.eccentricity = HIGHEST_ECCENTRICITY,
        ),
        ("axis of zero", |m| m.sqrt_a_sqrt_m = 0.0, |m| m.sqrt_a_sqrt_m = 0.0),
        ("axis of 67,000 km", |m| m.sqrt_a_sqrt_m = 8191.0, |m| m.sqrt_a_sqrt_m = 8191.0),
        ("time beyond the week", |m| m.toe_s = 604_800.0, |m| m.toe_s = 604_800.0),
        ("clock and orbit days apart", |m| m.toc_s = 345_600.0, |m| m.toc_s = 345_600.0),
    ];
    let sky = Sky::quiet(10);
    let mut module = Module::after(&sky, 3);
    for ((name, of_gps, of_beidou), lump) in cases.into_iter().zip(&sky.lumps[3..]) {
        module.note();
        let bytes = spoiled(&sky.lumps[0], of_gps, of_beidou);
        assert!(module.receive(&bytes).is_empty());
        assert!(module.grown("ephemerides_invalid") > 40, "{name}: {}", module.grown("ephemerides_invalid"));
        assert_eq!(module.grown("ephemerides"), 0, "{name}");
        module.recovers(lump);
    }
}

#[test]
fn the_highest_eccentricity_that_is_let_in_is_found_out_by_the_set_before_it() {
    let sky = Sky::quiet(8);
    let mut module = Module::after(&sky, 3);
    let reported = module
        .receive(&[of_one(&sky, |m| m.eccentricity = ECCENTRICITY_LET_IN), sky.lumps[3].clone()].concat());
    let [only] = reported.as_slice() else { panic!("one epoch is one answer: {reported:?}") };
    let healthy = Module::after(&sky, 3).receive(&sky.lumps[3]);
    assert_eq!(only.state.used + 1, healthy[0].state.used, "{only:?}");
    assert_eq!((module.grown("ephemerides_disputed"), module.grown("ephemeris_disputed")), (1, 1));
    // All are changed, so that every satellite is contradicted.
    module.receive(&spoiled(
        &sky.lumps[0],
        |m| m.eccentricity = ECCENTRICITY_LET_IN,
        |m| m.eccentricity = ECCENTRICITY_LET_IN,
    ));
    module.has_no_fix(&sky.lumps[4]);
    assert!(!module.pin_is_high());
    module.receive(&only_ephemerides(&sky));
    module.recovers(&sky.lumps[5]);
}

fn only_ephemerides(sky: &Sky) -> Vec<u8> {
    only(&sky.lumps[0], is_ephemeris)
}

#[test]
fn ephemerides_of_random_bits_make_no_number_that_is_none() {
    let sky = Sky::quiet(80);
    let mut module = Module::after(&sky, 3);
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for _ in 0..18 {
        module.note();
        let mut random = |number: u16| {
            let mut payload = claiming(number, 80, 0);
            rng.fill_bytes(&mut payload[2..]);
            rtcm_frame(&payload)
        };
        let burst: Vec<u8> = [1019, 1042, 1045, 1046].repeat(8).into_iter().flat_map(&mut random).collect();
        assert!(module.receive(&burst).is_empty());
        assert!(module.grown("ephemerides_invalid") > 0);
        module.receive(&sky.lumps[module.second()]);
        module.receive(&only_ephemerides(&sky));
        module.recovers(&sky.lumps[module.second()]);
    }
}

#[test]
fn an_unhealthy_satellite_is_left_out_and_an_unhealthy_sky_is_no_fix() {
    let sky = Sky::quiet(8);
    let mut module = Module::after(&sky, 3);
    module.receive(&of_one(&sky, |m| m.sv_health_ind = 1));
    module.recovers(&sky.lumps[3]);
    assert_eq!(module.grown("satellite_unhealthy"), 1);
    module.receive(&spoiled(&sky.lumps[0], |m| m.sv_health_ind = 63, |m| m.sv_health_flag = 1));
    module.has_no_fix(&sky.lumps[4]);
    assert!(module.grown("satellite_unhealthy") > 10);
    module.receive(&only_ephemerides(&sky));
    module.recovers(&sky.lumps[5]);
}

#[test]
fn a_sky_that_stays_unhealthy_is_unavailable_and_never_stale() {
    let sky = Sky::quiet(30);
    let mut module = Module::after(&sky, 3);
    module.receive(&spoiled(&sky.lumps[0], |m| m.sv_health_ind = 63, |m| m.sv_health_flag = 1));
    // Each epoch has one answer, and there is no other between them, although the time to alert
    // passes twice.
    sky.lumps[3..].iter().for_each(|lump| module.has_no_fix(lump));
    assert_eq!(module.grown("line_stale"), 0);
    assert_eq!(module.silence(11_000).len(), 1, "but silence is");
}

#[test]
fn ephemerides_hours_ahead_do_not_displace_those_in_use() {
    let sky = Sky::quiet(5);
    let mut module = Module::after(&sky, 3);
    module.receive(&spoiled(&sky.lumps[0], |m| m.toe_s += 14_400.0, |m| m.toe_s += 14_400.0));
    // The plane of the geostationary ones turns with the reference time, so that theirs are no
    // orbits of theirs.
    assert!(module.grown("ephemerides_kept") + module.grown("ephemerides_invalid") > 40);
    module.recovers(&sky.lumps[3]);
}

#[test]
fn ephemerides_of_hours_ago_are_no_fix_until_new_ones_come() {
    let (before, later) = (Sky::quiet(3), Sky::from(5.0 * 3600.0, 4));
    let mut module = Module::after(&before, 3);
    module.has_no_fix(&only(&later.lumps[0], |message| !is_ephemeris(message)));
    assert!(module.grown("ephemeris_stale") > 10);
    module.receive(&only(&later.lumps[0], is_ephemeris));
    module.recovers(&later.lumps[1]);
    // The old ones do not return to use when they are repeated.
    module.note();
    module.receive(&only_ephemerides(&before));
    assert!(module.grown("ephemerides_kept") > 40);
    module.recovers(&later.lumps[2]);
}

#[test]
fn a_new_issue_in_the_middle_of_a_pass_is_taken_without_a_gap() {
    // The ephemerides of the second hour are sent half an hour before it.
    let sky = Sky::from(5397.0, 6);
    let mut module = Module::after(&sky, 3);
    assert!(sky.lumps[3].len() > sky.lumps[2].len(), "the fourth epoch brings the new issue");
    module.recovers(&sky.lumps[3]);
    assert!(module.grown("ephemerides") > 40);
    assert_eq!(module.grown("ephemerides_kept"), 0);
    module.recovers(&sky.lumps[4]);
}

#[test]
fn a_new_issue_that_is_wrong_by_kilometres_is_contradicted_and_the_satellite_not_used() {
    let sky = Sky::quiet(8);
    let mut module = Module::after(&sky, 3);
    // 1e-4 semicircles along the orbit are 8 km.
    let wrong = of_one(&sky, |m| {
        m.iode = m.iode.wrapping_add(1);
        m.m0_sc += if m.m0_sc > 0.0 { -1e-4 } else { 1e-4 };
    });
    module.note();
    let reported = module.receive(&[wrong, sky.lumps[3].clone()].concat());
    assert!(reported[0].state.is_protected() && reported[0].excluded.is_empty(), "{reported:?}");
    assert_eq!((module.grown("ephemerides_disputed"), module.grown("ephemeris_disputed")), (1, 1));
    module.receive(&of_one(&sky, |m| m.iode = m.iode.wrapping_add(2)));
    module.recovers(&sky.lumps[4]);
    assert_eq!(module.grown("ephemeris_disputed"), 1);
}
