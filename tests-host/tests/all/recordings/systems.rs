//! GLONASS navigation of RINEX 2, and QZSS from file to wire.

use raim::replay::{Pace, Window, encode, on_host};
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::measurement::Ephemeris;
use rtcm_rs::{Message, MsgFrameIter};

use super::made::{id, version_3};
use super::{ESBC, read};

/// A record as RINEX 3 has it; the columns of RINEX 2 are one less.
const GLONASS_3: &str = "     3.04           N: GNSS NAV DATA    M: MIXED            RINEX VERSION / TYPE
    18                                                      LEAP SECONDS
                                                            END OF HEADER
R07 2024 06 24 08 15 00 1.234527677298E-05-9.094947017729E-13 1.152000000000E+05
     1.003912353516E+04 1.234567642212E+00 9.313225746155E-10 0.000000000000E+00
     1.200112304688E+04-2.334567642212E+00-1.862645149231E-09 5.000000000000E+00
    -2.009312353516E+04 3.234567642212E-01 2.793967723846E-09 1.000000000000E+00
";

/// [RINEX-2.11] tables A10 and A11: type `G`, two-digit years, I2 for the satellite, rows indented
/// by three.
const GLONASS_2: &str = "     2.01           GLONASS NAV DATA                        RINEX VERSION / TYPE
  2024     1     1    0.123400000000D-06                    CORR TO SYSTEM TIME
    18                                                      LEAP SECONDS
                                                            END OF HEADER
 7 24  6 24  8 15  0.0 0.123452767730D-04-0.909494701773D-12 0.115200000000D+06
    0.100391235352D+05 0.123456764221D+01 0.931322574616D-09 0.000000000000D+00
    0.120011230469D+05-0.233456764221D+01-0.186264514923D-08 0.500000000000D+01
   -0.200931235352D+05 0.323456764221D+00 0.279396772385D-08 0.100000000000D+01
";

#[test]
fn glonass_navigation_of_version_2_is_that_of_version_3() {
    let want = read(&version_3(2), GLONASS_3).unwrap();
    let have = read(&version_3(2), GLONASS_2).unwrap();
    assert!(have.skipped.is_empty(), "{}", have.skipped);
    let ([have], [want]) = (have.ephemerides.as_slice(), want.ephemerides.as_slice()) else {
        panic!("{:?}", have.ephemerides)
    };
    assert_eq!((have.satellite, have.toe, have.sent), (want.satellite, want.toe, want.sent));
    assert_eq!(have.satellite, id("R07"));
    let (Ephemeris::Glonass(have), Ephemeris::Glonass(want)) = (&have.message, &want.message) else {
        panic!("{have:?}")
    };
    // The files have one digit more or less.
    let close =
        |have: f64, want: f64| assert!((have - want).abs() <= 1e-10 * want.abs().max(1e-9), "{have} {want}");
    close(have.xn_km, 10_039.123_535_16);
    close(have.yn_first_deriv_km_s, want.yn_first_deriv_km_s);
    close(have.zn_km, want.zn_km);
    close(have.tau_n_s, -1.234_527_677_3e-5);
    assert_eq!((have.glo_satellite_freq_chan_number, have.tb_min), (5, 675));
    assert_eq!(have.gamma_n.to_bits(), (-9.094_947e-13_f32).to_bits());
}

#[test]
fn a_bare_number_is_glonass_in_a_file_of_glonass_alone() {
    let have = read(&version_3(2), &GLONASS_2.replacen("GLONASS NAV DATA", "NAVIGATION DATA ", 1));
    // Four lines are no ephemeris of GPS.
    assert!(have.is_err());
}

/// Returns a record of QZSS by the rule of RINEX 3, of the numbers of a GPS record.
fn qzss_navigation() -> String {
    super::quirks::NAVIGATION_3.replacen("G05", "J02", 1)
}

#[test]
fn qzss_goes_from_the_file_to_its_own_messages() {
    let recording = read(&version_3(2), &qzss_navigation()).unwrap();
    let Ephemeris::Qzss(read) = &recording.ephemerides[0].message else {
        panic!("{:?}", recording.ephemerides)
    };
    assert_eq!((read.qzss_satellite_id, read.iode, read.qzss_week_number), (2, 72, 2320 % 1024));
    let numbers = |letters: &str| {
        let selection = Selection::new(letters, Frequency::Dual).unwrap();
        let mut encoder = Encoder::new(&recording.ephemerides, selection);
        let bytes = encoder.epoch(&recording.epochs[0]).unwrap();
        MsgFrameIter::new(&bytes).map(|frame| frame.get_message()).collect::<Vec<_>>()
    };
    let have: Vec<_> = numbers("GCEJ").iter().filter_map(Message::number).collect();
    assert_eq!(have, [1044, 1077, 1127, 1097, 1117]);
    let have: Vec<_> = numbers("GCE").iter().filter_map(Message::number).collect();
    assert_eq!(have, [1077, 1127, 1097]);
    let Some(Message::Msg1117(ranges)) = numbers("J").into_iter().next_back() else { panic!("no ranges") };
    let [satellite] = ranges.data_segment.satellite_data.as_slice() else { panic!("{ranges:?}") };
    assert_eq!((satellite.satellite_id, ranges.qzss_epoch_time_ms), (2, 115_200_000));
}

/// RTKLIB has a position in each epoch of such a recording (WTZR, 2020-06-25).
#[test]
fn glonass_alone_gives_positions() {
    let Some(recording) = ESBC.load() else { return };
    let selection = Selection::new("R", Frequency::Dual).unwrap();
    let window = Window { to_s: 3600.0, ..Window::ALL };
    let lumps = encode(&recording, &selection, &[], &window).unwrap();
    let commands = ["SYSTEMS,R".to_owned()];
    let run = on_host(&lumps, &commands, Pace::LockStep, |_| ()).unwrap();
    let fixes = run
        .reported
        .iter()
        .filter(|reported| reported.output().is_some_and(|epoch| epoch.position.is_some()))
        .count();
    assert_eq!((run.reported.len(), fixes), (120, 120), "{:?}", run.reported.first());
}
