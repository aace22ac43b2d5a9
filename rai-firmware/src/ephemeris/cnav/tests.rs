use raim_core::satellite::Constellation;

use super::*;
use crate::raw::Carrier;

const DAY_MS: u64 = 86_400_000;

fn gps(number: u8) -> SatelliteId {
    SatelliteId::new(Constellation::Gps, number).expect("a satellite")
}

fn frame(satellite: SatelliteId, content: CnavContent) -> CnavFrame {
    CnavFrame { satellite, is_alert: false, content }
}

/// Returns the delay of a signal with this code.
fn of(word: Word<'_>, code: Code) -> Option<GroupDelay> {
    word.delay(&RawSignal::new(Carrier::of(Band::L1), 2.2e7).with_code(code))
}

fn delay(word: Word<'_>, code: Code) -> Option<f32> {
    of(word, code).map(|delay| {
        let is_corrected = matches!(delay, GroupDelay::Corrected(_) | GroupDelay::CorrectedL5(_));
        assert!(is_corrected && delay.seconds().is_finite(), "{delay:?}");
        delay.seconds()
    })
}

/// Delays of G24 on 2025-02-15, metres: 0.70, 0.01, −0.43, 0.44, 0.83.
const G24: SignalDelays = SignalDelays { steps: [80, 1, -49, 50, 95] };

#[test]
fn delay_of_a_signal_is_the_group_delay_less_its_correction() {
    let mut cnav = Cnav::new();
    cnav.receive(&frame(gps(24), CnavContent::Delays(G24)), 0);
    let word = cnav.word(gps(24));
    let step_s = 2_f64.powi(-35);
    for (code, steps) in
        [(Code::Ca, 79.0), (Code::L2c, 129.0), (Code::I5, 30.0), (Code::Q5, -15.0), (Code::Both5, 7.5)]
    {
        let have = f64::from(delay(word, code).expect("a known delay"));
        assert!((have - steps * step_s).abs() < 1e-16, "{code:?}: {have}");
    }
    assert_eq!(delay(word, Code::Other), None);
    assert!(of(cnav.word(gps(23)), Code::Ca).is_none(), "another satellite");
}

#[test]
fn sigmas_make_what_was_measured_in_pairs() {
    let mut cnav = Cnav::new();
    cnav.receive(&frame(gps(24), CnavContent::Delays(G24)), 0);
    let sigma_m = |code| f64::from(of(cnav.word(gps(24)), code).expect("a known delay").uncalibrated_m());
    // Factors of the combination: (f1/f5)² is (154/115)², (f1/f2)² is (154/120)².
    for (second, denominator, want_m) in
        [(Code::Q5, 115.0, 0.35), (Code::I5, 115.0, 0.35), (Code::L2c, 120.0, 0.2)]
    {
        let squared = f64::powi(154.0 / denominator, 2);
        let first = squared / (squared - 1.0);
        let have_m = f64::hypot(first * sigma_m(Code::Ca), (1.0 - first) * sigma_m(second));
        assert!((have_m - want_m).abs() < 0.005, "{second:?}: {have_m}");
    }
}

#[test]
fn unknown_delays_are_those_of_lnav_and_the_ends_of_the_fields_are_finite() {
    let mut cnav = Cnav::new();
    let mut reported = |steps: [i16; 5]| {
        cnav.receive(&frame(gps(1), CnavContent::Delays(SignalDelays { steps })), 0);
        [Code::Ca, Code::L2c, Code::I5, Code::Q5, Code::Both5].map(|code| delay(cnav.word(gps(1)), code))
    };
    assert_eq!(reported([-4096, 1, 2, 3, 4]), [None; 5], "without TGD none is known");
    let [ca, l2c, i5, q5, both] = reported([5, -4096, 2, -4096, 4]);
    assert!(ca.is_none() && i5.is_none() && both.is_none() && l2c.is_some() && q5.is_some());
    let [ca, .., i5, q5, both] = reported([5, 1, 2, 0, 0]);
    assert!(ca.is_some(), "{ca:?}");
    assert_eq!([i5, q5, both], [None; 3], "a satellite without L5 sends zeros");
    assert!(reported([5, 1, 2, 0, 1]).iter().all(Option::is_some));
    for steps in [[4095, -4095, -4095, -4095, -4095], [-4095, 4095, 4095, 4095, 4095]] {
        for have in reported(steps) {
            let have = f64::from(have.expect("a known delay")) * 2_f64.powi(35);
            assert!((have.abs() - 8190.0).abs() < 1e-3, "{have}");
        }
    }
}

#[test]
fn alert_and_health_of_l1_and_l2_count_always_and_that_of_l5_as_ordered() {
    let bands = [Band::L1, Band::L2, Band::L5];
    for out in 0..8_u8 {
        let out = [out & 4 != 0, out & 2 != 0, out & 1 != 0];
        for needs_healthy_l5 in [false, true] {
            let mut cnav = Cnav::new();
            cnav.prepare(0, needs_healthy_l5);
            let before = bands.map(|band| cnav.word(gps(7)).serves(band));
            assert_eq!(before, [true, true, !needs_healthy_l5], "nothing was said");
            cnav.receive(&frame(gps(7), CnavContent::Health { out }), 0);
            let want = [!out[0], !out[1], !(out[2] && needs_healthy_l5)];
            assert_eq!(bands.map(|band| cnav.word(gps(7)).serves(band)), want, "{out:?}");
            assert_eq!(cnav.word(gps(7)).l5_is_out, out[2]);
            let alert = CnavFrame { is_alert: true, ..frame(gps(7), CnavContent::Other) };
            cnav.receive(&alert, 0);
            assert_eq!(bands.map(|band| cnav.word(gps(7)).serves(band)), [false; 3]);
            cnav.receive(&frame(gps(7), CnavContent::Other), 0);
            assert_eq!(
                bands.map(|band| cnav.word(gps(7)).serves(band)),
                want,
                "the next frame takes it back"
            );
            assert!(bands.iter().all(|band| cnav.word(gps(8)).serves(*band) || needs_healthy_l5));
        }
    }
}

#[test]
fn what_was_said_has_an_age() {
    let mut cnav = Cnav::new();
    cnav.prepare(0, true);
    cnav.receive(&frame(gps(3), CnavContent::Delays(G24)), 0);
    cnav.receive(&frame(gps(3), CnavContent::Health { out: [false, true, false] }), 0);
    let reported = |cnav: &mut Cnav, now_ms| {
        cnav.prepare(now_ms, true);
        let word = cnav.word(gps(3));
        (of(word, Code::Ca).is_some(), word.serves(Band::L2), word.serves(Band::L5))
    };
    assert_eq!(reported(&mut cnav, 7_200_000), (true, false, true));
    assert_eq!(reported(&mut cnav, 7_300_000), (true, false, false), "good health lasts two hours");
    assert_eq!(reported(&mut cnav, DAY_MS - 2_000), (true, false, false));
    assert_eq!(reported(&mut cnav, DAY_MS + 2_000), (false, true, false), "bad health and delays a day");
    // A clock that goes back is no reason to keep them.
    cnav.receive(&frame(gps(3), CnavContent::Delays(G24)), 3 * DAY_MS);
    assert!(!reported(&mut cnav, DAY_MS).0);
}

#[test]
fn every_satellite_with_cnav_has_a_place_of_its_own() {
    let mut cnav = Cnav::new();
    let all = || (1..=32).chain(193..=202).map(gps);
    for satellite in all() {
        let steps = [i16::from(satellite.number()), 0, 0, 1, 1];
        cnav.receive(&frame(satellite, CnavContent::Delays(SignalDelays { steps })), 0);
    }
    for satellite in all() {
        let have = f64::from(delay(cnav.word(satellite), Code::Ca).expect("a known delay"));
        assert!((have * 2_f64.powi(35) - f64::from(satellite.number())).abs() < 1e-3, "{satellite}");
    }
    for other in [gps(33), gps(99), SatelliteId::new(Constellation::Galileo, 1).expect("E01")] {
        cnav.receive(&frame(other, CnavContent::Delays(G24)), 0);
        assert!(of(cnav.word(other), Code::Ca).is_none(), "{other}");
    }
}
