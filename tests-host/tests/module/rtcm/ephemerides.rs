//! Ephemerides and station positions on the wire.

use super::names_of_nonzero;
use crate::orbits::CASES;
use crate::wire::Bits;
use crate::wire::Seen;
use crate::wire::ephemeris;
use crate::wire::feed;
use crate::wire::frame;
use raim_core::frame::Ecef;
use raim_firmware::ephemeris::Source;
use raim_firmware::input::Input;
use raim_firmware::raw::Band;
use raim_firmware::time::GpsTime;

#[test]
fn the_two_galileo_messages_differ_in_what_their_clock_refers_to() {
    let step_s = 2f64.powi(-32);
    let mut case = CASES[2];
    for (source, want) in [
        (
            Source::GalileoInav,
            [(Band::E1, Some(9.0 * step_s)), (Band::E5b, Some(9.0 * step_s * (154f64 / 118.0).powi(2)))],
        ),
        (Source::GalileoFnav, [(Band::E1, Some(-3.0 * step_s)), (Band::E5b, None)]),
    ] {
        case.source = source;
        let seen = feed(&mut Input::new(), &ephemeris(&case));
        let [Seen::Ephemeris(have)] = seen.as_slice() else { panic!("{seen:?}") };
        assert_eq!(have.source(), source);
        assert!((have.accuracy_m((Band::E1, None)).unwrap() - 3.12).abs() < 1e-6);
        for (band, want) in want {
            let have = have.group_delay(band).map(|delay| f64::from(delay.seconds()));
            assert_eq!(have.is_some(), want.is_some(), "{band:?}");
            assert!((have.unwrap_or(0.0) - want.unwrap_or(0.0)).abs() < 1e-15, "{band:?} {have:?} {want:?}");
        }
    }
}

#[test]
fn ephemerides_on_the_wire_give_the_positions_of_a_separate_program() {
    let mut input = Input::new();
    for case in &CASES[..7] {
        let seen = feed(&mut input, &ephemeris(case));
        let [Seen::Ephemeris(have)] = seen.as_slice() else { panic!("{}: {seen:?}", case.id()) };
        assert_eq!((have.satellite(), have.toe()), (case.id(), case.toe()));
        for want in &case.want {
            let received =
                GpsTime::from_ms(case.toe().to_ms().checked_add_signed(want.after_toe_ms).unwrap());
            let state = have.at(received, want.range_m).unwrap();
            let [x, y, z] = want.position_m;
            assert!(state.position.distance_m(Ecef::new(x, y, z)) < 5e-4, "{}: {state:?}", case.id());
            assert!((state.clock_s - want.clock_s).abs() < 1e-13, "{}: {state:?}", case.id());
        }
    }
}

#[test]
fn the_standard_s_own_example_of_1005_is_read() {
    // The example of the standard's section 4: frame and coordinates.
    let bytes = [
        0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98, 0x0E, 0xDE, 0xEF, 0x34, 0xB4, 0xBD, 0x62, 0xAC,
        0x09, 0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98,
    ];
    let seen = feed(&mut Input::new(), &bytes);
    let [Seen::Position(have)] = seen.as_slice() else { panic!("{seen:?}") };
    let want = Ecef::new(1_114_104.599_9, -4_850_729.710_8, 3_975_521.464_3);
    assert!(have.distance_m(want) < 1e-4, "have {have:?}, want {want:?}");
}

#[test]
fn a_position_at_the_centre_of_the_earth_is_none() {
    let mut input = Input::new();
    let bytes = frame(&Bits::default().put(12, 1005).put(60, 0).put(60, 0).put(20, 0).bytes());
    assert!(feed(&mut input, &bytes).is_empty());
    assert_eq!(names_of_nonzero(input.counters()), [("positions_invalid", 1)]);
}
