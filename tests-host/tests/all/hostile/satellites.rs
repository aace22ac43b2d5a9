//! Impossible satellites and ranges.
//!
//! The messages have no numbers for a range below −292 m or above 76,356 km, so the nearest values
//! represent negative ranges and 1e12 m. Values of a recording beyond these are counted when it is
//! encoded.

use raim_core::satellite::{Constellation, SatelliteId};
use rtcm_rs::Message;
use rtcm_rs::msg::{
    BdsSigId, GalSigId, GpsSigId, Msg1077Sig, Msg1077T, Msg1097Data, Msg1097Sig, Msg1097T, Msg1127Sig,
    Msg1127T, Msm57Sat,
};

use super::frames::{beidou, changed, frame, gps};
use super::module::{Module, Sky};

/// A range as the message splits it: whole ms, their fraction, and the fine part, ms.
#[derive(Clone, Copy)]
struct Split(Option<u8>, f64, Option<f64>);

const ZERO: Split = Split(Some(0), 0.0, Some(0.0));
/// Most that the fine part can subtract: −292 m.
const NEGATIVE: Split = Split(Some(0), 0.0, Some(-524_287.0 / 536_870_912.0));
/// Most that the rough and the fine part can hold: 76,447 km.
const LONGEST: Split = Split(Some(254), 1023.0 / 1024.0, Some(524_287.0 / 536_870_912.0));
/// Value that a receiver sends without a range.
const NONE: Split = Split(None, 0.0, None);

/// Replaces the ranges of the satellites that are `meant`.
fn spoil(message: &mut Message, split: Split, meant: impl Fn(usize) -> bool) {
    macro_rules! spoil {
        ($data:expr) => {{
            let hit: Vec<u8> = $data
                .satellite_data
                .iter_mut()
                .enumerate()
                .filter(|(index, _)| meant(*index))
                .map(|(_, satellite)| {
                    satellite.gnss_satellite_rough_range_integer_ms = split.0;
                    satellite.gnss_satellite_rough_range_mod1ms_ms = split.1;
                    satellite.satellite_id
                })
                .collect();
            for signal in $data.signal_data.iter_mut().filter(|signal| hit.contains(&signal.satellite_id)) {
                signal.gnss_signal_fine_pseudorange_ext_ms = split.2;
            }
        }};
    }
    match message {
        Message::Msg1077(gps) => spoil!(gps.data_segment),
        Message::Msg1127(beidou) => spoil!(beidou.data_segment),
        _ => {}
    }
}

#[test]
fn ranges_that_no_satellite_can_have_are_counted_and_left_out() {
    let sky = Sky::quiet(20);
    let mut module = Module::after(&sky, 3);
    let cases = [
        (ZERO, "ranges_out_of_bounds"),
        (NEGATIVE, "ranges_out_of_bounds"),
        (LONGEST, "ranges_out_of_bounds"),
        (NONE, "ranges_missing"),
    ];
    for ((split, counter), lumps) in cases.into_iter().zip(sky.lumps[3..].chunks_exact(4)) {
        module.note();
        // One satellite of each system is spoiled; the others suffice.
        module.recovers(&changed(&lumps[0], |message| spoil(message, split, |index| index == 0)));
        assert_eq!(module.grown(counter), 4, "two signals of one satellite in each system");
        module.has_no_fix(&changed(&lumps[1], |message| spoil(message, split, |_| true)));
        module.recovers(&lumps[2]);
    }
}

/// Returns a GPS message that comes before others of its epoch, with one satellite's range 3,000 m
/// too long.
fn lying(mut message: Msg1077T) -> (Vec<u8>, SatelliteId) {
    /// Light time of 3 km, in whole steps of the rough range, ms.
    const LONGER_MS: f64 = 10.0 / 1024.0;
    message.msm_multiple_message_flag = 1;
    let satellite = message
        .data_segment
        .satellite_data
        .iter_mut()
        .find(|satellite| satellite.gnss_satellite_rough_range_mod1ms_ms + LONGER_MS < 1.0)
        .expect("a satellite with room");
    satellite.gnss_satellite_rough_range_mod1ms_ms += LONGER_MS;
    let id = SatelliteId::new(Constellation::Gps, satellite.satellite_id).unwrap();
    (frame(&Message::Msg1077(message)), id)
}

#[test]
fn of_two_satellites_with_one_id_the_second_is_passed_over() {
    let sky = Sky::quiet(6);
    let mut module = Module::after(&sky, 3);
    let honest = gps(&sky.lumps[3]);
    let signals = honest.data_segment.signal_data.len() as u32;
    let (lie, _) = lying(honest.clone());
    let epoch = [frame(&Message::Msg1077(honest)), lie, frame(&Message::Msg1127(beidou(&sky.lumps[3])))];
    module.recovers(&epoch.concat());
    assert_eq!(module.grown("satellites_duplicate"), signals);
    module.recovers(&sky.lumps[4]);
}

#[test]
fn where_the_first_of_two_with_one_id_lies_it_is_excluded_by_name() {
    let sky = Sky::quiet(6);
    let mut module = Module::after(&sky, 3);
    let (lie, liar) = lying(gps(&sky.lumps[3]));
    let reported = module.receive(&[lie, sky.lumps[3].clone()].concat());
    let [only] = reported.as_slice() else { panic!("one epoch is one answer: {reported:?}") };
    let excluded: Vec<SatelliteId> = only.excluded.iter().map(|excluded| excluded.satellite).collect();
    assert_eq!((only.state.reason.as_str(), excluded), ("EXCLUDED", vec![liar]));
    assert!(module.grown("satellites_duplicate") > 0);
    module.recovers(&sky.lumps[4]);
}

/// Returns a range of 22,000 km for an absent satellite, ms: 73 and 396/1024.
fn ghost(satellite_id: u8) -> Msm57Sat {
    Msm57Sat {
        satellite_id,
        gnss_satellite_rough_range_integer_ms: Some(73),
        gnss_satellite_rough_range_mod1ms_ms: 396.0 / 1024.0,
        ..Msm57Sat::default()
    }
}

/// Builds a message that names all 64 satellites of its mask.
macro_rules! crowd {
    ($message:ident, $template:expr, $signal:ident, $id:expr) => {{
        let mut message = $template;
        message.msm_multiple_message_flag = 1;
        message.data_segment = Default::default();
        for satellite_id in 1..=64 {
            message.data_segment.satellite_data.push(ghost(satellite_id));
            message.data_segment.signal_data.push($signal {
                satellite_id,
                signal_id: $id,
                gnss_signal_fine_pseudorange_ext_ms: Some(0.0),
                ..$signal::default()
            });
        }
        frame(&Message::$message(message))
    }};
}

fn crowd_of_gps(template: Msg1077T) -> Vec<u8> {
    crowd!(Msg1077, template, Msg1077Sig, GpsSigId::new(1, 'C'))
}

fn crowd_of_beidou(template: Msg1127T) -> Vec<u8> {
    crowd!(Msg1127, template, Msg1127Sig, BdsSigId::new(2, 'I'))
}

fn crowd_of_galileo(gal_epoch_time_ms: u32) -> Vec<u8> {
    let template =
        Msg1097T { gal_epoch_time_ms, data_segment: Msg1097Data::default(), ..Msg1097T::default() };
    crowd!(Msg1097, template, Msg1097Sig, GalSigId::new(1, 'C'))
}

#[test]
fn sixty_four_satellites_that_are_not_there_fill_the_epoch_and_move_nothing() {
    let sky = Sky::quiet(8);
    let mut module = Module::after(&sky, 3);
    // They follow the true ranges of GPS. The mask has numbers up to 64; GPS has 32 satellites,
    // Galileo 36, BeiDou 63.
    let true_gps = gps(&sky.lumps[3]);
    let (tow_ms, true_beidou) = (true_gps.gps_epoch_time_ms, beidou(&sky.lumps[3]));
    let seen = (true_gps.data_segment.satellite_data.len(), true_beidou.data_segment.satellite_data.len());
    let epoch = [
        frame(&Message::Msg1077(true_gps.clone())),
        crowd_of_gps(true_gps),
        crowd_of_galileo(tow_ms),
        crowd_of_beidou(true_beidou.clone()),
        frame(&Message::Msg1127(true_beidou)),
    ];
    let reported = module.receive(&epoch.concat());
    assert_eq!(reported.len(), 1, "{reported:?}");
    assert_eq!(module.grown("satellites_unknown"), 32 + 28 + 1);
    assert_eq!(module.grown("satellites_duplicate") as usize, seen.0);
    // 32 of GPS and 32 of Galileo are 64; 4 of Galileo, 63 of BeiDou and both signals of those in
    // view exceed it.
    assert_eq!(module.grown("satellites_surplus") as usize, 4 + 63 + 2 * seen.1);
    assert_eq!(
        module.grown("ephemeris_missing"),
        32 + 1,
        "Galileo, and the GPS satellite that does not exist"
    );
    // Ranges that come twice with other values are an alert, so the satellites must agree for three
    // seconds.
    for lump in &sky.lumps[4..7] {
        module.receive(lump);
        assert!(!module.pin_is_high());
    }
    module.recovers(&sky.lumps[7]);
}

#[test]
fn a_crowd_before_the_true_ranges_does_not_raise_the_pin() {
    let sky = Sky::quiet(8);
    let mut module = Module::after(&sky, 3);
    let lies = [crowd_of_gps(gps(&sky.lumps[3])), crowd_of_beidou(beidou(&sky.lumps[3]))];
    module.receive(&[lies.concat(), sky.lumps[3].clone()].concat());
    assert!(!module.pin_is_high());
    assert!(module.grown("satellites_duplicate") > 0 && module.grown("satellites_surplus") > 0);
    // It was an alert, so the satellites must agree for three seconds.
    for lump in &sky.lumps[4..7] {
        module.receive(lump);
        assert!(!module.pin_is_high());
    }
    module.recovers(&sky.lumps[7]);
}
