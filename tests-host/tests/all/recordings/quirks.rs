//! Quirks of real files, each in the smallest possible input.

use raim::signal::measurement::Ephemeris;
use raim::signal::measurement::{MeasuredEpoch, MeasuredSatellite};
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::time::GpsTime;

use super::read;

/// RINEX 3.02: B1I is `C1I`, a satellite's number has a blank, time tags are off the second,
/// trailing blanks are cut, the header claims GPS only, names a system unused here, and a comment
/// is not ASCII.
pub(crate) const OBSERVATIONS_3: &str =
    "     3.02           OBSERVATION DATA    G                   RINEX VERSION / TYPE
B\u{f8}rge's receiver                                            COMMENT
  6378137.0000        0.0000        0.0000                  APPROX POSITION XYZ
G    5 C1C L1C S1C C2W D1C                                  SYS / # / OBS TYPES
C    3 C1I C7I C1X                                          SYS / # / OBS TYPES
S    1 C1C                                                  SYS / # / OBS TYPES
  2024    06    24    08    00   33.9970000     GPS         TIME OF FIRST OBS
                                                            END OF HEADER
> 2024 06 24 08 00 33.9970000  0  3
G 2  24503597.381 7 127596785.10007        44.250    24503599.481 6
C05  41654777.792 6                  41654770.001
S23  39000000.000
> 2024 06 24 08 01  3.9970000  4  2
G    1 C2W                                                  SYS / # / OBS TYPES
a comment                                                   COMMENT
> 2024 06 24 08 01 33.9970000  1  1
G12  20000000.001
";

/// RINEX 3: trailing blanks are cut and the spare fields of the last line are missing.
pub(crate) const NAVIGATION_3: &str =
    "     3.04           N: GNSS NAV DATA    M: MIXED            RINEX VERSION / TYPE
GPSA   1.8626E-08  2.2352E-08 -1.1921E-07 -5.9605E-08       IONOSPHERIC CORR
GPSB   1.2902E+05  1.6384E+05 -1.9661E+05 -2.6214E+05       IONOSPHERIC CORR
BDSA   9.9999E-01  9.9999E-01  9.9999E-01  9.9999E-01 U 22  IONOSPHERIC CORR
BDSA   8.8888E-01  8.8888E-01  8.8888E-01  8.8888E-01 U 23  IONOSPHERIC CORR
                                                            END OF HEADER
G05 2024 06 24 10 00 00-1.774230040610E-04-1.364242052659E-12 0.000000000000E+00
     7.200000000000E+01-9.821875000000E+01 4.293035965037E-09 1.714815412488E+00
    -5.291774868965E-06 5.927642923780E-03 1.830980181694E-06 5.153635631561E+03
     1.224000000000E+05 3.352761268616E-08 2.520897825810E+00-5.774199962616E-08
     9.719266524177E-01 3.536250000000E+02 1.273307347665E+00-8.275344701323E-09
    -2.610823036973E-10 1.000000000000E+00 2.320000000000E+03 0.000000000000E+00
     2.000000000000E+00 0.000000000000E+00-1.071020960808E-08 7.200000000000E+01
     1.152180000000E+05
R07 2024 06 24 08 15 00 1.000000000000E-05 0.000000000000E+00 1.152000000000E+05
     1.000000000000E+04 0.000000000000E+00 0.000000000000E+00 0.000000000000E+00
     1.000000000000E+04 0.000000000000E+00 0.000000000000E+00 0.000000000000E+00
     1.000000000000E+04 0.000000000000E+00 0.000000000000E+00 0.000000000000E+00
";

/// RINEX 2: numbers without system, exponents of Fortran, an unknown time of transmission.
const NAVIGATION_2: &str = "     2              NAVIGATION DATA                         RINEX VERSION / TYPE
    0.2235D-07  0.0000D+00 -0.5960D-07  0.1192D-06          ION ALPHA
    0.1454D+06 -0.1966D+06  0.0000D+00  0.1966D+06          ION BETA
                                                            END OF HEADER
 2 24  1 10  0  0  0.0-0.503205228597D-03 0.557065504836D-11 0.000000000000D+00
    0.100000000000D+03 0.265937500000D+02 0.458876256895D-08 0.312831851676D+01
    0.143237411976D-05 0.163042363711D-01-0.146217644215D-05 0.515390379334D+04
    0.259200000000D+06 0.307336449623D-06-0.183991279683D+01 0.242143869400D-06
    0.967376152105D+00 0.407437500000D+03-0.126773068786D+01-0.822641409174D-08
    0.610739725475D-10 0.100000000000D+01 0.229600000000D+04 0.000000000000D+00
    0.200000000000D+01 0.000000000000D+00-0.176951289177D-07 0.100000000000D+03
    0.999900000000D+09 0.000000000000D+00
";

fn id(name: &str) -> SatelliteId {
    let constellation = Constellation::from_letter(name.chars().next().unwrap()).unwrap();
    SatelliteId::new(constellation, name[1..].parse().unwrap()).unwrap()
}

/// Returns the pseudoranges of a satellite as RINEX 3.05 codes, m.
fn codes(satellite: &MeasuredSatellite) -> Vec<(String, f64)> {
    let code =
        |signal: &raim::signal::measurement::MeasuredSignal| format!("C{}{}", signal.band, signal.attribute);
    satellite.signals.iter().map(|signal| (code(signal), signal.pseudorange_m)).collect()
}

fn named(pairs: &[(&str, f64)]) -> Vec<(String, f64)> {
    pairs.iter().map(|(code, range_m)| ((*code).to_owned(), *range_m)).collect()
}

fn satellite<'a>(epoch: &'a MeasuredEpoch, name: &str) -> &'a MeasuredSatellite {
    epoch.satellites.iter().find(|satellite| satellite.satellite == id(name)).unwrap()
}

#[test]
fn b1i_of_version_302_is_band_2() {
    let recording = read(OBSERVATIONS_3, NAVIGATION_3).unwrap();
    let have = codes(satellite(&recording.epochs[0], "C05"));
    assert_eq!(have, named(&[("C2I", 41654777.792), ("C2X", 41654770.001)]));
}

#[test]
fn b1c_of_version_304_stays_band_1() {
    let newer = OBSERVATIONS_3.replacen("3.02", "3.04", 1).replace("C7I C1X", "C2I C1X");
    let recording = read(&newer, NAVIGATION_3).unwrap();
    let have = codes(satellite(&recording.epochs[0], "C05"));
    // C1I exists in 3.02 only; in later versions it means B1I.
    assert_eq!(have, named(&[("C2I", 41654777.792), ("C1X", 41654770.001)]));
}

#[test]
fn a_satellite_with_a_blank_in_its_number_is_read_with_all_it_measured() {
    let recording = read(OBSERVATIONS_3, NAVIGATION_3).unwrap();
    let have = satellite(&recording.epochs[0], "G02");
    assert_eq!(codes(have), named(&[("C1C", 24503597.381), ("C2W", 24503599.481)]));
    assert_eq!(have.signals[0].carrier_cycles, Some(127596785.1));
    assert_eq!(have.signals[0].cn0_dbhz, Some(44.25));
    // No S2W: the digit beside the pseudorange, 6, is the class from 36 to 42 dB-Hz.
    assert_eq!((have.signals[1].carrier_cycles, have.signals[1].cn0_dbhz), (None, Some(39.0)));
}

#[test]
fn time_tags_off_the_second_stay_off_the_second() {
    let recording = read(OBSERVATIONS_3, NAVIGATION_3).unwrap();
    let have: Vec<GpsTime> = recording.epochs.iter().map(|epoch| epoch.time).collect();
    // 2024-06-24 is the Monday of week 2320; 8 h 0 min 33.997 s.
    let want = [115_233_997, 115_293_997].map(|tow_ms| GpsTime { week: 2320, tow_ms });
    assert_eq!(have, want);
}

#[test]
fn header_lines_inside_an_event_are_obeyed() {
    let recording = read(OBSERVATIONS_3, NAVIGATION_3).unwrap();
    assert_eq!(codes(satellite(&recording.epochs[1], "G12")), named(&[("C2W", 20000000.001)]));
}

#[test]
fn only_gps_coefficients_of_the_ionosphere_count() {
    let have = read(OBSERVATIONS_3, NAVIGATION_3).unwrap().klobuchar;
    let want = [1.8626e-8, 2.2352e-8, -1.1921e-7, -5.9605e-8, 1.2902e5, 1.6384e5, -1.9661e5, -2.6214e5];
    assert_eq!(have, Some(want));
}

#[test]
fn coefficients_of_the_ionosphere_are_found_in_records_of_version_4() {
    let record = "> ION G29 LNAV
    2024 06 24 09 59 48 1.024454832077E-08 2.235174179077E-08-5.960464477539E-08
    -1.192092895508E-07 9.625600000000E+04 1.310720000000E+05-6.553600000000E+04
    -5.898240000000E+05 0.000000000000E+00
> EPH C20 CNV1
C20 2024 06 24 10 00 00 this is a message of another kind, passed over
> EPH G05 LNAV
G05";
    let header = NAVIGATION_3.replacen("3.04", "4.00", 1).replace("GPS", "XXX");
    let have = read(OBSERVATIONS_3, &header.replacen("G05", record, 1).replace("R07", "> EPH R07 FDMA\nR07"))
        .unwrap();
    let want = [
        1.024454832077e-8,
        2.235174179077e-8,
        -5.960464477539e-8,
        -1.192092895508e-7,
        96256.0,
        131072.0,
        -65536.0,
        -589824.0,
    ];
    assert_eq!(have.klobuchar, Some(want));
    assert_eq!(have.ephemerides, read(OBSERVATIONS_3, NAVIGATION_3).unwrap().ephemerides);
}

#[test]
fn an_ephemeris_with_cut_lines_keeps_what_is_there() {
    let recording = read(OBSERVATIONS_3, NAVIGATION_3).unwrap();
    let [ephemeris, glonass] = recording.ephemerides.as_slice() else {
        panic!("{:?}", recording.ephemerides)
    };
    assert_eq!((glonass.satellite, glonass.toe), (id("R07"), GpsTime { week: 2320, tow_ms: 116_118_000 }));
    assert_eq!(ephemeris.toe, GpsTime { week: 2320, tow_ms: 122_400_000 });
    assert_eq!(ephemeris.sent, GpsTime { week: 2320, tow_ms: 115_218_000 });
    let Ephemeris::Gps(have) = &ephemeris.message else { panic!("{ephemeris:?}") };
    assert_eq!((have.iode, have.iodc, have.gps_week_number, have.fit_interval_ind), (72, 72, 2320 % 1024, 0));
    assert_eq!((have.ura_index, have.sv_health_ind, have.toc_s), (0, 0, 122_400.0));
}

#[test]
fn version_2_reads_bare_numbers_and_exponents_of_fortran() {
    let recording = read(include_str!("compact.obs"), NAVIGATION_2).unwrap();
    let [ephemeris] = recording.ephemerides.as_slice() else { panic!("{:?}", recording.ephemerides) };
    assert_eq!(ephemeris.satellite, id("G02"));
    // Sent at 0.9999e9 s: unknown, so the time of clock counts, midnight of Wednesday, 2024-01-10.
    assert_eq!(ephemeris.sent, GpsTime { week: 2296, tow_ms: 259_200_000 });
    let Ephemeris::Gps(have) = &ephemeris.message else { panic!("{ephemeris:?}") };
    assert!((have.sqrt_a_sqrt_m - 5153.90379334).abs() < 1e-9, "{}", have.sqrt_a_sqrt_m);
    let want = [2.235e-8, 0.0, -5.96e-8, 1.192e-7, 145_400.0, -196_600.0, 0.0, 196_600.0];
    assert_eq!(recording.klobuchar, Some(want));
}

#[test]
fn version_2_names_more_satellites_than_a_line_holds() {
    let recording = read(include_str!("compact.obs"), NAVIGATION_2).unwrap();
    let have: Vec<usize> = recording.epochs.iter().map(|epoch| epoch.satellites.len()).collect();
    assert_eq!(have, [13, 13, 12, 13]);
    let first = &recording.epochs[0];
    let want = [("C1C", 20000000.123), ("C2W", 20000003.323), ("C5X", 19999999.023), ("C2X", 20000000.823)];
    assert_eq!(codes(satellite(first, "G21")), named(&want));
    assert_eq!(codes(satellite(first, "E32")), named(&[("C1X", 20300001.623), ("C5X", 20300000.523)]));
}

#[test]
fn compact_version_1_equals_the_text_it_was_made_of() {
    // Made by the reference implementation, RNX2CRX 4.1.0: arcs that end and begin again, a
    // satellite that leaves and returns, an event, and 13 satellites.
    let have = read(include_str!("compact.crx"), NAVIGATION_2).unwrap();
    let want = read(include_str!("compact.obs"), NAVIGATION_2).unwrap();
    assert_eq!(have.epochs, want.epochs);
}

#[test]
fn version_2_may_leave_the_only_system_blank() {
    let blank = include_str!("compact.obs").replace("M (MIXED)", "G        ").replace("G02", "  2");
    let recording = read(&blank, NAVIGATION_2).unwrap();
    assert!(codes(satellite(&recording.epochs[0], "G02")).contains(&("C1C".to_owned(), 20100000.623)));
}
