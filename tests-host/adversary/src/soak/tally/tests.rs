use raim_core::frame::Ecef;
use raim_core::satellite::Constellation;
use raim_firmware::time::GpsTime;

use super::super::incident::Falsified;
use super::*;
use raim::signal::checksum::nmea_line;

const TRUTH: Geodetic = Geodetic { latitude_rad: 0.5, longitude_rad: 0.25, height_m: 100.0 };

fn offer(tow_s: u32, falsified: Falsified) -> Offer {
    let truth: Ecef = TRUTH.to_ecef();
    let time = GpsTime { week: 2300, tow_ms: tow_s * 1000 };
    Offer { time, truth, falsified, accepted_error_m: Some(70.0), early: None, is_due: true }
}

/// Reports a position `north_m` north of the truth, and a verdict with a limit of 40 m, at 18 s
/// of GPS time: midnight UTC.
fn says(tally: &mut Tally, north_m: f64, state: &str) {
    let latitude_rad = TRUTH.latitude_rad + north_m / 6_350_000.0;
    let degrees_minutes = |angle_rad: f64| {
        let angle_deg = angle_rad.to_degrees();
        angle_deg.floor() * 100.0 + angle_deg.fract() * 60.0
    };
    let (latitude, longitude) = (degrees_minutes(latitude_rad), degrees_minutes(TRUTH.longitude_rad));
    tally.receive(
        nmea_line(&format!("GNGNS,000000.00,{latitude:.7},N,{longitude:.7},E,A,9,1.0,100.0,0.0,,,S"))
            .as_bytes(),
    );
    tally.receive(nmea_line(&format!("PRAIS,000000.00,{state},9,9,4,0.5,2.0,12.0,20.0,40.0,")).as_bytes());
}

fn after(falsified: Falsified, north_m: f64, state: &str) -> Tally {
    let mut tally = Tally::new(10.0);
    tally.offer(offer(18, falsified), true, 0.0);
    says(&mut tally, north_m, state);
    tally
}

#[test]
fn pin_high_beyond_the_limit_is_counted_apart_by_the_promise() {
    let one = after(Falsified::Satellites(1), 50.0, "P,OK");
    assert_eq!((one.hazardous, one.hazardous_beyond_promise, one.misleading), (1, 0, [1, 0]));
    let two = after(Falsified::Satellites(2), 50.0, "P,OK");
    assert_eq!((two.hazardous, two.hazardous_beyond_promise, two.misleading), (0, 1, [0, 1]));
    let within = after(Falsified::Constellation, 20.0, "P,OK");
    assert_eq!((within.hazardous_beyond_promise, within.misleading), (0, [0, 1]));
    let warned = after(Falsified::Satellites(1), 50.0, "A,FAULT");
    assert_eq!((warned.hazardous, warned.misleading, warned.false_alerts), (0, [0, 0], 0));
    assert_eq!(warned.accepted, [1, 0], "70 m, had every satellite been accepted");
    assert_eq!(after(Falsified::Satellites(0), 1.0, "A,FAULT").false_alerts, 1);
}

#[test]
fn protected_without_a_position_is_as_bad_as_a_wrong_one() {
    let mut tally = Tally::new(10.0);
    tally.offer(offer(18, Falsified::Satellites(0)), true, 0.0);
    tally.receive(nmea_line("PRAIS,000000.00,P,OK,9,9,4,0.5,2.0,12.0,20.0,40.0,").as_bytes());
    assert_eq!(tally.hazardous, 1);
}

#[test]
fn satellite_left_out_is_counted_where_no_range_was_false_and_none_of_its_ephemerides_was_early() {
    let left_out = |falsified, early: Option<u8>| {
        let mut tally = Tally::new(10.0);
        let early = early.and_then(|number| SatelliteId::new(Constellation::Gps, number));
        tally.offer(Offer { early, ..offer(18, falsified) }, true, 0.0);
        says(&mut tally, 0.0, "P,EXCLUDED");
        tally.receive(nmea_line("PRAIX,000000.00,1,G05,5.2,61.0").as_bytes());
        (tally.early, tally.left_out_sound.len())
    };
    assert_eq!(left_out(Falsified::Satellites(0), None), (0, 1));
    assert_eq!(left_out(Falsified::Satellites(1), None), (0, 0));
    assert_eq!(left_out(Falsified::Satellites(0), Some(5)), (1, 0));
    assert_eq!(left_out(Falsified::Satellites(0), Some(6)), (1, 1));
}

#[test]
fn early_ephemeris_excuses_its_satellite_for_as_long_as_the_true_one_may_be_away() {
    for (later, want) in [(RENEWAL_EPOCHS, 0), (RENEWAL_EPOCHS + 1, 1)] {
        let mut tally = Tally::new(10.0);
        let early = SatelliteId::new(Constellation::Gps, 5);
        tally.offer(Offer { early, ..offer(17, Falsified::Satellites(0)) }, false, 0.0);
        (1..later).for_each(|_| tally.offer(offer(17, Falsified::Satellites(0)), false, 0.0));
        tally.offer(offer(18, Falsified::Satellites(0)), true, 0.0);
        says(&mut tally, 0.0, "P,EXCLUDED");
        tally.receive(nmea_line("PRAIX,000000.00,1,G05,5.2,61.0").as_bytes());
        assert_eq!(tally.left_out_sound.len(), want, "{later} epochs later");
    }
}

#[test]
fn epoch_older_than_the_time_to_alert_is_stale() {
    let mut tally = Tally::new(10.0);
    tally.offer(offer(18, Falsified::Satellites(0)), true, 0.0);
    tally.offer(offer(29, Falsified::Satellites(0)), true, 11.0);
    says(&mut tally, 0.0, "P,OK");
    assert_eq!(tally.stale, 1);
}

#[test]
fn epoch_that_nobody_offered_and_epoch_never_spoken_of() {
    let mut tally = after(Falsified::Satellites(0), 0.0, "P,OK");
    tally.receive(nmea_line("PRAIS,000001.00,U,NOFIX,9,0,,,,,,40.0,").as_bytes());
    assert_eq!(tally.invented, 1);
    (100..129).for_each(|tow_s| tally.offer(offer(tow_s, Falsified::Satellites(0)), false, 0.0));
    assert_eq!(tally.unspoken.len(), 0, "the first was judged");
    tally.offer(offer(200, Falsified::Satellites(0)), true, 0.0);
    (300..329).for_each(|tow_s| tally.offer(offer(tow_s, Falsified::Satellites(0)), false, 0.0));
    assert_eq!(tally.unspoken.len(), 1);
}

#[test]
fn what_a_reset_may_have_cost_is_not_missed() {
    let mut tally = Tally::new(10.0);
    (0..8).for_each(|tow_s| tally.offer(offer(tow_s, Falsified::Satellites(0)), true, 0.0));
    tally.expect_start();
    (100..140).for_each(|tow_s| tally.offer(offer(tow_s, Falsified::Satellites(0)), false, 0.0));
    assert_eq!(tally.unspoken.len(), 8 - IN_FLIGHT_EPOCHS);
}

#[test]
fn limit_that_is_neither_of_before_the_restart_nor_set_since_is_lost() {
    let lost_at = |limit_m: &str| {
        let mut tally = Tally::new(10.0);
        tally.expect_limit(40.0);
        tally.expect_start();
        tally.receive(nmea_line("PRAIV,0.1.0,abc,UNKNOWN,PASS").as_bytes());
        tally.expect_limit(25.0);
        tally.receive(nmea_line(&format!("PRAIS,000000.00,A,STALE,9,9,4,0.5,2.0,,,{limit_m},")).as_bytes());
        tally.settings_lost.len()
    };
    assert_eq!(["40.0", "25.0", "556.0", ""].map(lost_at), [0, 0, 1, 1]);
}

#[test]
fn damaged_sentence_and_unasked_start_are_told_from_a_reset() {
    let mut tally = Tally::new(10.0);
    assert_eq!(tally.receive(nmea_line("PRAIV,0.1.0,abc,UNKNOWN,PASS").as_bytes()), Heard::Greeting);
    tally.expect_start();
    let cut = [b"$GNGNS,0000".as_slice(), nmea_line("PRAIV,0.1.0,abc,UNKNOWN,PASS").as_bytes()].concat();
    assert_eq!(tally.receive(&cut), Heard::Greeting);
    assert_eq!((tally.cut_off, tally.damaged.len(), tally.starts_unasked.len()), (1, 0, 0));
    tally.receive(&cut);
    assert_eq!((tally.cut_off, tally.damaged.len()), (1, 1), "nobody had asked");
    tally.receive(nmea_line("PRAIV,0.1.0,abc,UNKNOWN,PASS").as_bytes());
    tally.expect_start();
    tally.receive(nmea_line("PRAIV,0.1.0,abc,PANIC-0BADF00D,PASS").as_bytes());
    assert_eq!(tally.starts_unasked.len(), 2);
}
