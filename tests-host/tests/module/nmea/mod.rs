//! Sentences of an epoch, read by independent readers: the `nmea` crate, or plain splitting at
//! commas.

mod alerts;
mod extremes;
mod read_back;

use heapless::Vec as Fixed;
use nmea::sentences::gnss_type::GnssSystemId;
use nmea::sentences::gsa::GsaMode2;
use nmea::{ParseResult, parse_str};
use raim_core::frame::Geodetic;
use raim_core::report::{
    Alert, Protected, ProtectionLevels, Report, Solution, Suspect, TestStatistic, Unavailable, Verdict,
};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::output::nmea::{GPS_MINUS_UTC_S, MAX_LENGTH, write_epoch};
use raim_firmware::output::schedule::{Due, Item, Schedule};
use raim_firmware::output::{Interference, Motion, Statement};
use raim_firmware::publisher::Publisher;
use raim_firmware::time::GpsTime;

const CAPACITY: usize = 64;

/// Tuesday of GPS week 2400, 12:00:00 UTC.
const NOON: GpsTime = GpsTime { week: 2400, tow_ms: (2 * 86_400 + 12 * 3600 + 18) * 1000 };

/// Returns the sentences, checked for length, line end and checksum.
fn lines(bytes: &[u8]) -> Vec<String> {
    let text = std::str::from_utf8(bytes).expect("ASCII");
    assert!(text.is_empty() || text.ends_with("\r\n"), "unfinished line in {text:?}");
    let lines: Vec<String> = text.split_terminator("\r\n").map(String::from).collect();
    for line in &lines {
        assert!(line.len() + 2 <= MAX_LENGTH, "{} characters: {line}", line.len() + 2);
        let (body, checksum) = line.strip_prefix('$').and_then(|rest| rest.split_once('*')).expect("a frame");
        let want = body.bytes().fold(0, |sum, byte| sum ^ byte);
        assert_eq!(u8::from_str_radix(checksum, 16), Ok(want), "{line}");
    }
    lines
}

fn statement<'r>(report: &'r Report<CAPACITY>, requirements: &'r Requirements) -> Statement<'r, CAPACITY> {
    Statement {
        report,
        time: NOON,
        gps_minus_utc_s: GPS_MINUS_UTC_S,
        requirements,
        motion: None,
        interference: Interference { jamming: 1, spoofing: 0, ..Interference::default() },
        settings_hash: 0x0123_ABCD,
        unhealthy_l5: 0,
        in_view: None,
    }
}

fn told(statement: &Statement<'_, CAPACITY>, due: Due) -> Vec<String> {
    let mut bytes = Vec::new();
    write_epoch(statement, due, &mut Growing(&mut bytes)).expect("a vector takes all");
    lines(&bytes)
}

fn sentences(report: &Report<CAPACITY>, requirements: &Requirements) -> Vec<String> {
    told(&statement(report, requirements), Schedule::AT_START.due(0))
}

/// Returns the bodies of sentences, without the checksum.
fn bodies(lines: &[String]) -> Vec<&str> {
    lines.iter().filter_map(|line| line.split('*').next()).collect()
}

/// Returns the fields after the address.
fn fields<'l>(lines: &'l [String], address: &str) -> Vec<&'l str> {
    let line = lines.iter().find(|line| line[1..].starts_with(address)).expect("the sentence");
    line.split('*').next().expect("a body").split(',').skip(1).collect()
}

fn satellite(constellation: Constellation, number: u8) -> SatelliteId {
    SatelliteId::new(constellation, number).expect("a satellite number")
}

fn solution(latitude_deg: f64, longitude_deg: f64, height_m: f64) -> Solution {
    let geodetic = Geodetic {
        latitude_rad: latitude_deg.to_radians(),
        longitude_rad: longitude_deg.to_radians(),
        height_m,
    };
    {
        let mut solution = Solution::at(geodetic.to_ecef(), geodetic);
        solution.covariance_m2 = [0.36, 0.09, 0.0, 0.49, 0.0, 1.96];
        solution.hdop = 0.8;
        solution.vdop = 1.2;
        solution
    }
}

fn report() -> Report<CAPACITY> {
    let mut used = Fixed::new();
    for number in 1..=8 {
        used.push(satellite(Constellation::Gps, number)).expect("room");
        used.push(satellite(Constellation::Beidou, 20 + number)).expect("room");
    }
    {
        let mut report = Report::nothing();
        report.verdict = Verdict::Protected(Protected::Ok);
        report.solution = Some(solution(55.25, -10.5, 55.123));
        report.test = Some(TestStatistic::new(0.912, 1.873, 11));
        report.protection = Some(ProtectionLevels::new(12.34, 18.26));
        report.excluded = Fixed::new();
        report.suspect = Some(Suspect::new(satellite(Constellation::Beidou, 23), 1.5, -2.345, 1.5));
        report.used = used;
        report.residual_rms_m = 0.9;
        report.tracked = 17;
        report
    }
}

fn npa() -> Requirements {
    Requirements::non_precision_approach()
}

#[test]
fn an_epoch_is_these_sentences_in_this_order() {
    let have = sentences(&report(), &npa());
    // Each number is the report's, converted by hand. The geoid is 58.53 m above the ellipsoid
    // there, by hand from the corners 59, 59, 57 and 56 of the table.
    let want = [
        "$GNRMC,120000.00,A,5515.0000000,N,01030.0000000,W,,,060126,,,A,S",
        "$GNGGA,120000.00,5515.0000000,N,01030.0000000,W,1,16,0.80,-3.377,M,58.5,M,,",
        "$GNGNS,120000.00,5515.0000000,N,01030.0000000,W,A,16,0.80,-3.377,58.5,,,S",
        "$GNVTG,,T,,M,,N,,K,N",
        "$GNZDA,120000.00,06,01,2026,00,00",
        "$GPGSA,A,3,01,02,03,04,05,06,07,08,,,,,1.44,0.80,1.20,1",
        "$GBGSA,A,3,21,22,23,24,25,26,27,28,,,,,1.44,0.80,1.20,4",
        "$GNGST,120000.00,0.900,0.732,0.560,27.1,0.700,0.600,1.400",
        "$GNGBS,120000.00,0.700,0.600,1.400,23,0.001,-2.345,1.500,4,0",
        "$PRAIS,120000.00,P,OK,17,16,11,0.912,1.873,12.3,18.3,556.0,",
        "$PRAIN,120000.00,0123ABCD,10,1,0",
    ];
    assert_eq!(bodies(&have), want);
}

#[test]
fn exclusions_follow_the_verdict() {
    let mut report = report();
    report.verdict = Verdict::Protected(Protected::Excluded);
    for (number, bias_m) in [(5, 80.04), (31, -1234.56)] {
        let satellite = satellite(Constellation::Galileo, number);
        let suspect = Suspect::new(satellite, bias_m / 2.0, bias_m, 2.0);
        report.excluded.push(suspect).expect("room");
    }
    let lines = sentences(&report, &npa());
    let have = &bodies(&lines)[lines.len() - 3..lines.len() - 1];
    let want = ["$PRAIX,120000.00,2,E05,40.020,80.0", "$PRAIX,120000.00,2,E31,-617.280,-1234.6"];
    assert_eq!(have, want);
    assert_eq!(fields(&lines, "PRAIS")[1..3], ["P", "EXCLUDED"]);
}

#[test]
fn each_verdict_has_its_navigational_status_state_and_reason() {
    let unavailable = Verdict::Unavailable;
    let cases = [
        (Verdict::Protected(Protected::Ok), true, "S", "P", "OK"),
        (Verdict::Protected(Protected::Excluded), true, "S", "P", "EXCLUDED"),
        (Verdict::Alert(Alert::Fault), true, "U", "A", "FAULT"),
        (Verdict::Alert(Alert::Ambiguous), true, "U", "A", "AMBIGUOUS"),
        (Verdict::Alert(Alert::Time), true, "U", "A", "TIME"),
        (Verdict::Alert(Alert::Stale), false, "U", "A", "STALE"),
        (Verdict::Alert(Alert::Source), false, "U", "A", "SOURCE"),
        (Verdict::Alert(Alert::Jump), true, "U", "A", "JUMP"),
        (Verdict::Alert(Alert::Clock), true, "U", "A", "CLOCK"),
        (Verdict::Alert(Alert::Track), true, "U", "A", "TRACK"),
        (Verdict::Alert(Alert::Spoofed), true, "U", "A", "SPOOFED"),
        (unavailable(Unavailable::NoFix), false, "V", "U", "NOFIX"),
        (unavailable(Unavailable::Redundancy), true, "C", "U", "REDUNDANCY"),
        (unavailable(Unavailable::Geometry), true, "C", "U", "GEOMETRY"),
        (unavailable(Unavailable::Risk), true, "C", "U", "RISK"),
        (unavailable(Unavailable::Hpl), true, "C", "U", "HPL"),
        (unavailable(Unavailable::Vpl), true, "C", "U", "VPL"),
        (unavailable(Unavailable::Emt), true, "C", "U", "EMT"),
        (unavailable(Unavailable::Accuracy), true, "C", "U", "ACCURACY"),
        (unavailable(Unavailable::Budget), true, "C", "U", "BUDGET"),
        (unavailable(Unavailable::Input), false, "V", "U", "INPUT"),
        (unavailable(Unavailable::Recovering), true, "C", "U", "RECOVERING"),
        (unavailable(Unavailable::Place), true, "C", "U", "PLACE"),
        (unavailable(Unavailable::Sigmas), true, "C", "U", "SIGMAS"),
        (unavailable(Unavailable::SelfTest), true, "C", "U", "SELFTEST"),
        (unavailable(Unavailable::Ephemeris), false, "V", "U", "EPHEMERIS"),
        (unavailable(Unavailable::Settings), true, "C", "U", "SETTINGS"),
    ];
    for (verdict, has_position, status, state, reason) in cases {
        let mut report = report();
        report.verdict = verdict;
        if !has_position {
            report.solution = None;
        }
        let lines = sentences(&report, &npa());
        assert_eq!(fields(&lines, "GNGNS").last(), Some(&status), "{verdict:?}");
        assert_eq!(fields(&lines, "PRAIS")[1..3], [state, reason], "{verdict:?}");
    }
}

/// Returns the first `GSA`, read by the crate.
fn gsa(lines: &[String]) -> nmea::sentences::GsaData {
    let line = lines.iter().find(|line| line.contains("GSA")).expect("a GSA");
    let ParseResult::GSA(gsa) = parse_str(line).expect("a GSA") else { panic!("{line}") };
    gsa
}

#[test]
fn an_alert_is_no_fix_to_a_reader_of_gsa() {
    let mut report = report();
    report.verdict = Verdict::Alert(Alert::Fault);
    let lines = sentences(&report, &npa());
    assert_eq!(gsa(&lines).mode2, GsaMode2::NoFix);
}

#[test]
fn without_a_position_every_number_is_missing() {
    let mut report = report();
    report.verdict = Verdict::Unavailable(Unavailable::NoFix);
    report.solution = None;
    report.test = None;
    report.protection = None;
    report.suspect = None;
    report.used.clear();
    report.tracked = 3;
    let have = sentences(&report, &npa());
    let want = [
        "$GNRMC,120000.00,V,,,,,,,060126,,,N,V",
        "$GNGGA,120000.00,,,,,0,00,,,M,,M,,",
        "$GNGNS,120000.00,,,,,N,00,,,,,,V",
        "$GNVTG,,T,,M,,N,,K,N",
        "$GNGST,120000.00,,,,,,,",
        "$PRAIS,120000.00,U,NOFIX,3,0,,,,,,556.0,",
        "$PRAIN,120000.00,0123ABCD,0,1,0",
    ];
    assert_eq!(bodies(&have), want);
    for line in &have[..5] {
        assert!(parse_str(line).is_ok(), "{line}");
    }
}

#[test]
fn a_system_with_more_than_twelve_satellites_takes_two_gsa() {
    let mut report = report();
    report.used.clear();
    for number in 1..=32 {
        report.used.push(satellite(Constellation::Gps, number)).expect("room");
    }
    let mut have = Vec::new();
    for line in sentences(&report, &npa()).iter().filter(|line| line.contains("GSA")) {
        let ParseResult::GSA(gsa) = parse_str(line).expect("a GSA") else { panic!("{line}") };
        have.extend(gsa.fix_sats_prn);
    }
    assert_eq!(have, (1..=32).collect::<Vec<u32>>());
}

#[test]
fn glonass_counts_from_65_in_its_own_system() {
    let mut report = report();
    report.used.clear();
    report.used.push(satellite(Constellation::Glonass, 3)).expect("room");
    let lines = sentences(&report, &npa());
    let gsa = gsa(&lines);
    assert_eq!((gsa.system_id, gsa.fix_sats_prn.as_slice()), (Some(GnssSystemId::Glonass), &[67][..]));
}

/// A position that must not be used is in no sentence.
#[test]
fn an_alert_leaves_nothing_that_a_careless_reader_could_use() {
    for alert in [Alert::Fault, Alert::Ambiguous, Alert::Time, Alert::Jump, Alert::Spoofed] {
        let mut report = report();
        report.verdict = Verdict::Alert(alert);
        let motion = Some(Motion { east_m_s: 3.0, north_m_s: 4.0, up_m_s: 0.0, sigma_m_s: 0.1 });
        let npa = npa();
        let statement = Statement { motion, ..statement(&report, &npa) };
        let lines = told(&statement, Schedule::AT_START.due(0));
        let rmc = fields(&lines, "GNRMC");
        assert_eq!((rmc[1], &rmc[2..8], rmc[11], rmc[12]), ("V", &[""; 6][..], "N", "U"), "{alert:?}");
        assert_eq!(fields(&lines, "GNGGA")[1..6], ["", "", "", "", "0"], "{alert:?}");
        assert_eq!(
            fields(&lines, "GNGNS")[1..],
            ["", "", "", "", "N", "16", "", "", "", "", "", "U"],
            "{alert:?}"
        );
        assert_eq!(fields(&lines, "GNVTG"), ["", "T", "", "M", "", "N", "", "K", "N"], "{alert:?}");
        assert!(lines.iter().all(|line| !line.contains("ZDA")), "{alert:?}");
        // The basis of the verdict is reported, a protection level is not.
        assert_eq!(fields(&lines, "PRAIS")[5..10], ["11", "0.912", "1.873", "", ""], "{alert:?}");
        assert_eq!(fields(&lines, "PRAIN")[2], "0", "{alert:?}");
    }
}

#[test]
fn velocity_is_said_where_there_is_one() {
    let (report, npa) = (report(), npa());
    // 30 knots to the west-south-west: 30 · 1852 / 3600 m/s, 240° from north.
    let (speed_m_s, course) = (30.0_f32 * 1852.0 / 3600.0, 240.0_f32.to_radians());
    let motion = Motion {
        east_m_s: speed_m_s * course.sin(),
        north_m_s: speed_m_s * course.cos(),
        up_m_s: 0.2,
        sigma_m_s: 0.1,
    };
    let lines =
        told(&Statement { motion: Some(motion), ..statement(&report, &npa) }, Schedule::AT_START.due(0));
    let near = |text: &str, want: f64| {
        let have: f64 = text.parse().expect("a number");
        assert!((have - want).abs() < 0.011, "have {have}, want {want}");
    };
    let rmc = fields(&lines, "GNRMC");
    near(rmc[6], 30.0);
    near(rmc[7], 240.0);
    let vtg = fields(&lines, "GNVTG");
    near(vtg[0], 240.0);
    near(vtg[4], 30.0);
    near(vtg[6], 30.0 * 1.852);
    assert_eq!(vtg[8], "A");
    for line in lines.iter().filter(|line| line.contains("RMC") || line.contains("VTG")) {
        assert!(parse_str(line).is_ok(), "{line}");
    }
}

/// At rest, noise determines the course.
#[test]
fn a_receiver_at_rest_has_a_speed_and_no_course() {
    let (report, npa) = (report(), npa());
    let motion = Some(Motion { east_m_s: 0.01, north_m_s: -0.02, up_m_s: 0.0, sigma_m_s: 0.1 });
    let lines = told(&Statement { motion, ..statement(&report, &npa) }, Schedule::AT_START.due(0));
    assert_eq!(fields(&lines, "GNRMC")[6..8], ["0.043", ""]);
    assert_eq!(fields(&lines, "GNVTG")[..5], ["", "T", "", "M", "0.043"]);
}

#[test]
fn what_is_not_due_is_not_said_and_the_verdict_always_is() {
    let (mut report, npa) = (report(), npa());
    report.verdict = Verdict::Unavailable(Unavailable::Hpl);
    let items = [Item::Rmc, Item::Gga, Item::Gns, Item::Vtg, Item::Zda, Item::Gsa, Item::Gst, Item::Gbs];
    let none = items.iter().fold(Schedule::AT_START.due(0), |due, item| due.without(*item));
    let lines = told(&statement(&report, &npa), none);
    let addresses: Vec<&str> = lines.iter().map(|line| &line[1..6]).collect();
    assert_eq!(addresses, ["PRAIS", "PRAIN"]);
    let item_names = ["RMC", "GGA", "GNS", "VTG", "ZDA", "GSA", "GST", "GBS"];
    for (item, name) in items.into_iter().zip(item_names) {
        let lines = told(&statement(&report, &npa), Schedule::AT_START.due(0).without(item));
        assert!(lines.iter().all(|line| !line[3..].starts_with(name)), "{name}");
    }
}

#[test]
fn whoever_wants_few_epochs_hears_at_once_of_a_worse_state() {
    use Protected::Ok;
    use Verdict::{Alert, Protected as Promised, Unavailable};
    let worse = raim_core::report::Unavailable::Hpl;
    let worst = raim_core::report::Alert::Fault;
    let schedule = Schedule::AT_START.with(Item::Rmc, 100).with(Item::GnssIntegrity, 100);
    let (mut publisher, requirements) = (Publisher::new(0), npa());
    for (index, (verdict, want)) in [
        (Promised(Ok), true),
        (Promised(Ok), false),
        (Unavailable(worse), true),
        (Unavailable(worse), false),
        (Alert(worst), true),
        (Alert(worst), false),
        (Promised(Ok), false),
        (Alert(worst), true),
    ]
    .into_iter()
    .enumerate()
    {
        let (report, mut bytes) = (
            {
                let mut report = report();
                report.verdict = verdict;
                report
            },
            Vec::new(),
        );
        let statement = statement(&report, &requirements);
        publisher.tell(&statement, &schedule, &mut Growing(&mut bytes)).expect("a vector takes all");
        let has_sentence = bytes.windows(3).any(|word| word == b"RMC");
        // A frame of MAVLink begins with this byte, and no sentence contains it.
        let has_frame = bytes.contains(&0xFD);
        assert_eq!((has_sentence, has_frame), (want, want), "epoch {index}");
    }
}

/// Writer that takes everything, a few bytes at a time, like a UART with a short buffer.
struct Growing<'v>(&'v mut Vec<u8>);

impl embedded_io::ErrorType for Growing<'_> {
    type Error = core::convert::Infallible;
}

impl embedded_io::Write for Growing<'_> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        let taken = bytes.len().min(5);
        self.0.extend_from_slice(&bytes[..taken]);
        Ok(taken)
    }

    fn flush(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}
