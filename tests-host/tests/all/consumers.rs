//! Programs that read the module's output: their results for an epoch that is protected, and for
//! one that must not be used.
//!
//! | consumer | method |
//! |---|---|
//! | `pymavlink` | decodes our frames with its own dialect, and encodes the same again, byte for byte |
//! | `pynmea2` | reads the sentences |
//! | `ArduPilot` | the rules of its NMEA driver restated, `libraries/AP_GPS/AP_GPS_NMEA.cpp` (`_have_new_message`, `_term_complete`) |
//! | PX4 | the rules of its NMEA driver restated, PX4-GPSDrivers `src/nmea.cpp` |
//! | ROS | the rules of `nmea_navsat_driver` restated, `src/libnmea_navsat_driver/driver.py` (`add_sentence`), `parser.py` |
//!
//! gpsd has its own tests. `cargo xtask setup --consumers` installs gpsd and the Python packages;
//! without them a test reports that it is skipped, and is counted.

use std::io::Write as _;
use std::process::{Command, Stdio};

use raim_core::frame::Geodetic;
use raim_core::report::{
    Alert, Protected, ProtectionLevels, Report, Solution, TestStatistic, Unavailable, Verdict,
};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::output::mavlink::Sender;
use raim_firmware::output::nmea::{GPS_MINUS_UTC_S, write_epoch};
use raim_firmware::output::schedule::{Due, Item, Schedule};
use raim_firmware::output::{Interference, Motion, Statement};
use raim_firmware::time::GpsTime;
use rig::setup;
use rig::skip;
use serde_json::Value;

/// Time of the reports: 2026-01-06, 12:00:00 UTC.
const NOON: GpsTime = GpsTime { week: 2400, tow_ms: (2 * 86_400 + 12 * 3600 + 18) * 1000 };

fn report(verdict: Verdict) -> Report<64> {
    let geodetic = Geodetic {
        latitude_rad: 55.493_712_3_f64.to_radians(),
        longitude_rad: (-8.456_789_f64).to_radians(),
        height_m: 59.875,
    };
    {
        let mut report = Report::nothing();
        report.verdict = verdict;
        report.solution = Some({
            let mut solution = Solution::at(geodetic.to_ecef(), geodetic);
            solution.covariance_m2 = [0.25, 0.0, 0.0, 0.5, 0.0, 4.0];
            solution.hdop = 0.75;
            solution.vdop = 1.25;
            solution
        });
        report.test = Some(TestStatistic::new(0.912, 1.873, 12));
        report.protection = Some(ProtectionLevels::new(12.301, 18.2));
        report.excluded = heapless::Vec::new();
        report.used = (1..10).filter_map(|number| SatelliteId::new(Constellation::Gps, number)).collect();
        report.residual_rms_m = 0.934;
        report.tracked = 10;
        report
    }
}

/// Returns the output for a report.
fn told(
    report: &Report<64>,
    motion: Option<Motion>,
    tell: impl FnOnce(&Statement<'_, 64>, &mut Vec<u8>),
) -> Vec<u8> {
    let requirements = Requirements::non_precision_approach();
    let statement = Statement {
        report,
        time: NOON,
        gps_minus_utc_s: GPS_MINUS_UTC_S,
        requirements: &requirements,
        motion,
        interference: Interference { jamming: 2, spoofing: 1, ..Interference::default() },
        settings_hash: 0,
        unhealthy_l5: 0,
        in_view: None,
    };
    let mut bytes = Vec::new();
    tell(&statement, &mut bytes);
    bytes
}

const MOTION: Motion = Motion { east_m_s: 3.0, north_m_s: 4.0, up_m_s: 0.5, sigma_m_s: 0.125 };

fn sentences(report: &Report<64>, motion: Option<Motion>) -> String {
    let all = Schedule::AT_START.due(0);
    let bytes =
        told(report, motion, |statement, out| write_epoch(statement, all, out).expect("a vector takes all"));
    String::from_utf8(bytes).expect("ASCII")
}

fn frames(report: &Report<64>, motion: Option<Motion>) -> Vec<u8> {
    let every = [Item::Heartbeat, Item::GpsInput, Item::GnssIntegrity];
    let due: Due = every.into_iter().fold(Schedule::AT_START, |all, item| all.with(item, 1)).due(0);
    told(report, motion, |statement, out| Sender::default().write_epoch(statement, due, out).expect("room"))
}

/// Runs Python with standard input, and returns what it prints as JSON; `None`, and a report of the
/// skip, if it or a package is missing.
fn python(package: &str, script: &str, input: &[u8]) -> Option<Value> {
    printed(package, script, input).map(|printed| serde_json::from_slice(&printed).expect("its answer"))
}

/// Runs Python with standard input, and returns what it prints; `None`, and a report of the skip, if
/// it or a package is missing.
pub(crate) fn printed(package: &str, script: &str, input: &[u8]) -> Option<Vec<u8>> {
    let python = setup::python();
    let has_package = Command::new(&python).args(["-c", &format!("import {package}")]).output();
    if !has_package.is_ok_and(|output| output.status.success()) {
        skip::say(&format!("{package} for Python (cargo xtask setup --consumers)"));
        return None;
    }
    let mut child = Command::new(&python)
        .args(["-c", script])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3 was there a moment ago");
    child.stdin.take().expect("a pipe").write_all(input).expect("it reads");
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success(), "{package} refuses what we send");
    Some(output.stdout)
}

/// Script that decodes every frame, encodes it again with the same number and sender, and compares
/// the bytes.
const MAVLINK: &str = r"
import sys, json, math
from pymavlink.dialects.v20 import development as dialect
data = sys.stdin.buffer.read()
link = dialect.MAVLink(None)
out = []
for message in link.parse_buffer(data) or []:
    fields = message.to_dict()
    name = fields.pop('mavpackettype')
    again = dialect.MAVLink(None, srcSystem=message.get_srcSystem(), srcComponent=message.get_srcComponent())
    again.seq = message.get_seq()
    out.append({'name': name, 'fields': fields, 'same': bytes(message.pack(again)) == bytes(message.get_msgbuf())})
print(json.dumps(out))
";

#[test]
fn pymavlink_reads_our_frames_and_writes_the_same_bytes() {
    let report = report(Verdict::Protected(Protected::Ok));
    let Some(have) = python("pymavlink.dialects.v20.development", MAVLINK, &frames(&report, Some(MOTION)))
    else {
        return;
    };
    let names: Vec<&str> =
        have.as_array().expect("a list").iter().filter_map(|one| one["name"].as_str()).collect();
    assert_eq!(names, ["HEARTBEAT", "GPS_INPUT", "GNSS_INTEGRITY"]);
    for message in have.as_array().expect("a list") {
        assert_eq!(message["same"], true, "{message}");
    }
    // MAV_TYPE_GPS, MAV_AUTOPILOT_INVALID, MAV_STATE_ACTIVE of minimal.xml.
    let heartbeat = &have[0]["fields"];
    assert_eq!([&heartbeat["type"], &heartbeat["autopilot"], &heartbeat["system_status"]], [29, 8, 4]);
    let position = &have[1]["fields"];
    assert_eq!([&position["lat"], &position["lon"], &position["fix_type"]], [554_937_123, -84_567_890, 3]);
    assert_eq!(
        [&position["time_week"], &position["time_week_ms"], &position["satellites_visible"]],
        [2400, 216_018_000, 9]
    );
    // 2026-01-06T12:00:00Z in UNIX time.
    assert_eq!(position["time_usec"], 1_767_700_800_000_000_u64);
    assert_eq!([&position["hdop"], &position["vdop"]], [0.75, 1.25]);
    assert_eq!(
        [&position["vn"], &position["ve"], &position["vd"], &position["speed_accuracy"]],
        [4.0, 3.0, -0.5, 0.125]
    );
    assert_eq!(position["ignore_flags"], 0);
    let near = |field: &str, want: f64| {
        let have = position[field].as_f64().unwrap_or(f64::NAN);
        assert!((have - want).abs() < 1e-5, "{field}: have {have}, want {want}");
    };
    // 59.875 m above the ellipsoid. By EGM96 the geoid is 58.1 m above it there, by the table 58.4
    // m.
    near("alt", 59.875 - 58.4);
    // The accuracy is not better than the levels: 12.301 / 5.33 is above the horizontal sigma of
    // √0.75 m, 18.2 / 5.33 above 2 m.
    near("horiz_accuracy", 12.301 / 5.33);
    near("vert_accuracy", 18.2 / 5.33);
    let integrity = &have[2]["fields"];
    assert_eq!([&integrity["raim_state"], &integrity["raim_hfom"], &integrity["raim_vfom"]], [2, 1231, 1820]);
    assert_eq!([&integrity["jamming_state"], &integrity["spoofing_state"]], [2, 1]);
}

#[test]
fn an_autopilot_gets_no_position_that_is_not_protected() {
    let cases = [
        (Verdict::Alert(Alert::Fault), true, [1, 3, 5]),
        (Verdict::Alert(Alert::Spoofed), true, [1, 3, 5]),
        (Verdict::Unavailable(Unavailable::Hpl), true, [1, 0, 3]),
        (Verdict::Unavailable(Unavailable::NoFix), false, [0, 0, 3]),
    ];
    for (verdict, has_position, [fix_type, raim_state, system_status]) in cases {
        let mut report = report(verdict);
        if !has_position {
            report.solution = None;
            report.used.clear();
        }
        let Some(have) =
            python("pymavlink.dialects.v20.development", MAVLINK, &frames(&report, Some(MOTION)))
        else {
            return;
        };
        assert_eq!(have[0]["fields"]["system_status"], system_status, "{verdict:?}");
        let position = &have[1]["fields"];
        assert_eq!(position["fix_type"], fix_type, "{verdict:?}");
        assert_eq!([&position["lat"], &position["lon"]], [0, 0], "{verdict:?}");
        let integrity = &have[2]["fields"];
        assert_eq!(integrity["raim_state"], raim_state, "{verdict:?}");
        assert_eq!([&integrity["raim_hfom"], &integrity["raim_vfom"]], [65_535, 65_535], "{verdict:?}");
    }
}

const NMEA: &str = r"
import sys, json, pynmea2
out = {}
for line in sys.stdin.read().splitlines():
    if line[1:3] != 'GN':
        continue
    message = pynmea2.parse(line, check=True)
    values = {name: getattr(message, name) for name, *_ in (field[1:] for field in message.fields) if hasattr(message, name)}
    out[message.sentence_type] = {name: str(value) for name, value in values.items()}
    if hasattr(message, 'latitude') and message.lat:
        out[message.sentence_type].update(latitude=str(message.latitude), longitude=str(message.longitude))
print(json.dumps(out))
";

#[test]
fn pynmea2_reads_position_velocity_and_date() {
    let report = report(Verdict::Protected(Protected::Ok));
    let Some(have) = python("pynmea2", NMEA, sentences(&report, Some(MOTION)).as_bytes()) else { return };
    let near = |text: &Value, want: f64| {
        let have: f64 = text.as_str().and_then(|text| text.parse().ok()).unwrap_or(f64::NAN);
        assert!((have - want).abs() < 1e-6 * want.abs().max(1000.0), "have {text}, want {want}");
    };
    for sentence in ["RMC", "GGA", "GNS"] {
        near(&have[sentence]["latitude"], 55.493_712_3);
        near(&have[sentence]["longitude"], -8.456_789);
    }
    assert_eq!(
        (&have["RMC"]["datestamp"], &have["RMC"]["status"]),
        (&Value::from("2026-01-06"), &Value::from("A"))
    );
    near(&have["RMC"]["spd_over_grnd"], 5.0 * 3600.0 / 1852.0);
    assert_eq!([&have["ZDA"]["day"], &have["ZDA"]["month"], &have["ZDA"]["year"]], ["6", "1", "2026"]);
}

/// Returns the fields of one sentence.
fn fields<'t>(text: &'t str, formatter: &str) -> Option<Vec<&'t str>> {
    let line = text.lines().find(|line| line.get(3..6) == Some(formatter))?;
    Some(line.split('*').next()?.split(',').skip(1).collect())
}

/// Returns `ArduPilot`'s result for an epoch: `None` for no message, otherwise true for a fix.
///
/// There is no message until `RMC` and `GGA` have come within 150 ms of each other, and `VTG` too
/// once one has. Data are good with status `A`, a quality that is not 0, and a mode that is not
/// `N`; without that there is no fix. All sentences of an epoch leave the port within `span_ms`.
fn ardupilot(text: &str, span_ms: u32, saw_velocity_before: bool) -> Option<bool> {
    let rmc = fields(text, "RMC")?.get(1) == Some(&"A");
    let gga = fields(text, "GGA")?.get(5) != Some(&"0");
    let vtg = fields(text, "VTG").is_some_and(|vtg| vtg.get(8) != Some(&"N"));
    if !rmc || !gga {
        return Some(false);
    }
    let is_complete = span_ms <= 150 && (vtg || !saw_velocity_before);
    is_complete.then_some(true)
}

/// Returns the time between the first and the last of three sentences at 115200 baud, ten bits a
/// byte, ms.
fn span_ms(text: &str) -> u32 {
    let from = text.find("$GNRMC").expect("RMC");
    let to = text.find("$GNVTG").and_then(|at| Some(at + text[at..].find('\n')?)).expect("VTG");
    ((to - from) * 10 * 1000).div_ceil(115_200) as u32
}

#[test]
fn ardupilot_gets_a_fix_while_protected_and_none_in_an_alert() {
    let protected = sentences(&report(Verdict::Protected(Protected::Ok)), Some(MOTION));
    assert_eq!(ardupilot(&protected, span_ms(&protected), true), Some(true));
    let alert = sentences(&report(Verdict::Alert(Alert::Fault)), Some(MOTION));
    assert_eq!(ardupilot(&alert, span_ms(&alert), true), Some(false));
}

/// `ArduPilot` reads an empty speed as zero. Once it has received a velocity it therefore must not
/// accept an epoch without one, and by its own rule does not.
#[test]
fn ardupilot_takes_no_epoch_whose_velocity_has_gone() {
    let still = sentences(&report(Verdict::Protected(Protected::Ok)), None);
    assert_eq!(ardupilot(&still, span_ms(&still), true), None);
}

/// PX4 publishes after position, velocity and time have come: `_POS_received` by GGA,
/// `_VEL_received` by VTG or RMC. It takes the fix from the quality of GGA, where 0 is none.
#[test]
fn px4_gets_position_and_velocity_while_protected_and_no_fix_in_an_alert() {
    let has_fix = |text: &str| fields(text, "GGA").is_some_and(|gga| gga[5] != "0");
    let has_velocity = |text: &str| fields(text, "RMC").is_some_and(|rmc| !rmc[6].is_empty());
    let protected = sentences(&report(Verdict::Protected(Protected::Ok)), Some(MOTION));
    assert!(has_fix(&protected) && has_velocity(&protected));
    let alert = sentences(&report(Verdict::Alert(Alert::Fault)), Some(MOTION));
    assert!(!has_fix(&alert) && !has_velocity(&alert));
}

/// Returns the output of ROS for an epoch: status of the fix, and true for a velocity.
///
/// The status follows from the quality of `GGA` (−1 for 0, 0 for 1), which ROS accepts only from
/// the talkers GP and GN. The velocity is that of an `RMC` with status `A`. An empty field becomes
/// NaN.
fn ros(text: &str) -> (i8, bool) {
    let heard: String = text
        .lines()
        .filter(|line| line.starts_with("$GN") || line.starts_with("$GP"))
        .fold(String::new(), |heard, line| heard + line + "\n");
    let status = match fields(&heard, "GGA").map(|gga| gga[5].to_owned()).as_deref() {
        Some("1") => 0,
        _ => -1,
    };
    let velocity = fields(&heard, "RMC").filter(|rmc| rmc[1] == "A");
    (status, velocity.is_some_and(|rmc| rmc[6].parse::<f64>().is_ok() && rmc[7].parse::<f64>().is_ok()))
}

#[test]
fn ros_gets_a_fix_and_a_velocity_while_protected_and_neither_in_an_alert() {
    let protected = sentences(&report(Verdict::Protected(Protected::Ok)), Some(MOTION));
    assert_eq!(ros(&protected), (0, true));
    let alert = sentences(&report(Verdict::Alert(Alert::Fault)), Some(MOTION));
    assert_eq!(ros(&alert), (-1, false));
    let still = sentences(&report(Verdict::Protected(Protected::Ok)), None);
    assert_eq!(ros(&still), (0, false));
}
