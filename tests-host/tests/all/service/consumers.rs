//! Programs behind the service while it is protected and after the receiver has jumped: gpsd on its
//! pseudo-terminal, and `pymavlink` behind its UDP port.

use std::net::UdpSocket;
use std::process::{Child, ChildStdout, Command, Stdio};

use oracle::gpsd::Gpsd;
use raim::signal::sky::{Fleet, Site};
use raim_core::frame::Geodetic;
use rig::{setup, skip};
use serde_json::Value;

use super::*;

/// Epochs before the jump, and after it.
const EPOCHS: u32 = 30;

/// Real time that another program gets for the sentences of an epoch.
const TURN: Duration = Duration::from_millis(50);

/// Returns epochs of a receiver that is 5 km farther south from one epoch to the next: an alert.
fn jump() -> Vec<Vec<u8>> {
    let mut stray = sky(2 * EPOCHS);
    stray.site = Site::geodetic(34.125, 108.57, 400.0);
    let mut pieces = pieces(EPOCHS);
    pieces.extend(pieces_of(&stray).into_iter().skip(1 + EPOCHS as usize));
    pieces
}

/// Returns the instants of gpsd's positions with a fix, and those without.
fn instants(objects: &[Value]) -> [Vec<&str>; 2] {
    let with_mode = |is_fix: bool| {
        let of_mode =
            move |object: &&Value| object["class"] == "TPV" && (object["mode"].as_u64() >= Some(2)) == is_fix;
        objects.iter().filter(of_mode).filter_map(|object| object["time"].as_str()).collect()
    };
    [with_mode(true), with_mode(false)]
}

#[test]
fn gpsd_on_the_terminal_reports_each_epoch_once_and_its_sky_and_loses_the_fix_in_an_alert() {
    let folder = tempfile::tempdir().unwrap();
    let (receiver, input) = receiver();
    // The service makes the folder.
    let terminal = folder.path().join("run/nmea");
    let output = vec![format!("pty:{}", terminal.display())];
    let set = vec!["OUTPUT=GSV,1".to_owned()];
    let arguments = Arguments { input, output, set, ..Arguments::default() };
    let mut service = Service::start(folder.path(), arguments);
    let (mut line, _) = receiver.accept().unwrap();
    let Some(mut gpsd) = Gpsd::on_terminal_or_skip(&terminal).unwrap() else { return };
    let feed = thread::spawn(move || {
        service.send_each(&mut line, &jump(), || thread::sleep(TURN));
        // The last objects come by a real clock.
        thread::sleep(Duration::from_millis(500));
    });
    let mut objects = Vec::new();
    while !feed.is_finished() {
        objects.extend(gpsd.objects().unwrap());
    }
    feed.join().unwrap();
    let [fixes, without] = instants(&objects);
    // gpsd repeats its first epoch until it has recognised the end of a cycle.
    let settled: Vec<_> = fixes.iter().skip_while(|instant| **instant == fixes[0]).collect();
    assert!(settled.len() as u32 > EPOCHS / 2, "{fixes:?}");
    let mut once = settled.clone();
    once.dedup();
    assert_eq!(once, settled, "each epoch once");
    assert!(without.len() as u32 > EPOCHS / 2, "{without:?}");
    assert!(without.last() > fixes.last(), "the fix must be lost: {fixes:?} {without:?}");
    let position = objects.iter().rfind(|object| object["mode"].as_u64() == Some(3)).expect("a fix");
    let near = |field: &str, want: f64, within: f64| {
        let have = position[field].as_f64().unwrap_or(f64::NAN);
        assert!((have - want).abs() < within, "{field}: {have}, {want}");
    };
    near("lat", 34.17, 1e-3);
    near("lon", 108.57, 1e-3);
    near("altHAE", 400.0, 30.0);
    let last_fix = objects.iter().rposition(|object| object["mode"].as_u64() >= Some(2)).expect("a fix");
    let [before, after] = [&objects[..last_fix], &objects[last_fix..]].map(complete_sky);
    assert!(before.iter().any(|(.., used)| *used), "{before:?}");
    let want: Vec<_> = sky(1).sights_at(EPOCHS);
    // Both skies are of the same six seconds, and the stray antenna is 5 km away.
    for have in [before, after] {
        assert_eq!(have.len(), want.len(), "{have:?}");
        for sight in &want {
            let name = sight.satellite.to_string();
            let one = have.iter().find(|one| one.0 == name);
            let (_, [elevation_deg, azimuth_deg, cn0_dbhz], _) =
                one.unwrap_or_else(|| panic!("{name}: {have:?}"));
            let [elevation_rad, azimuth_rad] = [sight.elevation_rad(), sight.azimuth_rad()];
            // Half a degree is the rounding, a tenth the way of a satellite and of the antenna.
            assert!((elevation_deg - elevation_rad.to_degrees()).abs() < 0.6, "{name}: {elevation_deg}");
            let turn_deg = (azimuth_deg - azimuth_rad.to_degrees() + 180.0).rem_euclid(360.0) - 180.0;
            assert!(turn_deg.abs() * elevation_rad.cos() < 0.6, "{name}: {azimuth_deg}");
            assert!((cn0_dbhz - (36.0 + 14.0 * elevation_rad.sin())).abs() < 0.6, "{name}: {cn0_dbhz}");
        }
    }
}

/// The service is killed and started again under gpsd, which runs as a user of its own.
#[test]
#[cfg(target_os = "linux")]
fn gpsd_has_a_position_again_within_ten_seconds_of_a_restart() {
    let address = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let (receiver, input) = receiver();
    let start = || {
        let arguments = format!("--input={}\n--output=udp://{address}", input.as_deref().unwrap());
        service(&arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    };
    let Some(mut gpsd) = Gpsd::on_datagrams_or_skip(address).unwrap() else { return };
    let pieces = pieces(120);
    let mut rest = pieces[1..].iter();
    for run in 0..2 {
        let mut service = start();
        let started = Instant::now();
        let (mut line, _) = receiver.accept().unwrap();
        line.write_all(&pieces[0]).unwrap();
        let mut fixes = 0;
        while fixes < 3 {
            line.write_all(rest.next().expect("an epoch")).unwrap();
            let end = Instant::now() + Duration::from_secs(1) / RATE_HZ;
            while Instant::now() < end {
                let objects = gpsd.objects().unwrap();
                fixes +=
                    objects.iter().filter(|object| object["class"] == "TPV" && object["mode"] == 3).count();
            }
            assert!(started.elapsed() < Duration::from_secs(10), "start {run}: {fixes} positions");
        }
        // Nothing of the service lives on.
        service.kill().unwrap();
        service.wait().unwrap();
        while !gpsd.objects().unwrap().is_empty() {}
    }
}

/// A sky in which `BeiDou` fills two `GSA`.
#[test]
fn gpsd_marks_every_satellite_that_is_used_beside_a_full_beidou() {
    let folder = tempfile::tempdir().unwrap();
    let (receiver, input) = receiver();
    let terminal = folder.path().join("nmea");
    let output = vec![format!("pty:{}", terminal.display())];
    let set = ["OUTPUT=GSV,1", "MASK=0"].map(str::to_owned).to_vec();
    let arguments = Arguments { input, output, set, ..Arguments::default() };
    let mut service = Service::start(folder.path(), arguments);
    let (mut line, _) = receiver.accept().unwrap();
    let Some(mut gpsd) = Gpsd::on_terminal_or_skip(&terminal).unwrap() else { return };
    let fleets = [Fleet::Gps31, Fleet::Galileo24, Fleet::Beidou44];
    let full = Simulation {
        satellites: fleets.into_iter().flat_map(Fleet::satellites).collect(),
        mask_rad: 0.0,
        ..sky(EPOCHS)
    };
    let beidou = full.sights_at(0).iter().filter(|sight| sight.satellite.name().0 == 'C').count();
    assert!(beidou > 12, "{beidou} of BeiDou fill one sentence");
    // The store keeps the orbits of satellites in view, which it knows after the first epochs.
    let mut pieces = pieces_of(&full);
    pieces[4] = [pieces[0].clone(), pieces[4].clone()].concat();
    let feed = thread::spawn(move || {
        service.send_each(&mut line, &pieces, || thread::sleep(TURN));
        thread::sleep(Duration::from_millis(500));
    });
    let mut objects = Vec::new();
    while !feed.is_finished() {
        objects.extend(gpsd.objects().unwrap());
    }
    feed.join().unwrap();
    let sky = complete_sky(&objects);
    let used = |letter: char| sky.iter().filter(|one| one.2 && one.0.starts_with(letter)).count();
    let counts = ['G', 'E', 'C'].map(used);
    // gpsd does not mark a satellite of which it knows no C/N0.
    let known = |letter: char| sky.iter().filter(|one| one.0.starts_with(letter) && one.1[2] > 28.0).count();
    assert_eq!(counts, ['G', 'E', 'C'].map(known), "{sky:?}");
    assert!(counts[2] > 12, "{counts:?}");
}

/// Returns the satellites of gpsd's last sky with the most of them: name, elevation, azimuth and
/// C/N0, and true for one that is used.
fn complete_sky(objects: &[Value]) -> Vec<(String, [f64; 3], bool)> {
    let skies = objects.iter().filter_map(|object| object["satellites"].as_array());
    let satellite = |one: &Value| {
        let letter = ["G", "S", "E", "C"][one["gnssid"].as_u64().expect("a system") as usize];
        let values = ["el", "az", "ss"].map(|field| one[field].as_f64().unwrap_or(f64::NAN));
        let name = format!("{letter}{:02}", one["svid"].as_u64().expect("a number"));
        (name, values, one["used"] == true)
    };
    let longest = skies.max_by_key(|satellites| satellites.len()).expect("a sky");
    longest.iter().map(satellite).collect()
}

/// Reads until standard input is closed, and prints the last position with a fix and the last message of each kind.
const LISTEN: &str = r"
import sys, json, select
from pymavlink import mavutil
link = mavutil.mavlink_connection('udpin:127.0.0.1:' + sys.argv[1], dialect='development')
print('ready', flush=True)
out = {'bad': 0}
while True:
    message = link.recv_match(blocking=True, timeout=0.2)
    if message is None:
        # All has been read once the other side has closed standard input.
        if select.select([sys.stdin], [], [], 0)[0]:
            break
        continue
    name, fields = message.get_type(), message.to_dict()
    if name == 'BAD_DATA':
        out['bad'] += 1
        continue
    out[name] = fields
    if name == 'GPS_INPUT' and fields['fix_type'] == 3:
        out['fix'] = fields
print(json.dumps(out, default=str))
";

/// Returns a Python program that listens for `MAVLink` at a free port, its output, and the port.
fn listening(python: &Path, script: &str) -> (Child, std::io::BufReader<ChildStdout>, u16) {
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let mut listener = Command::new(python)
        .args(["-c", script, &port.to_string()])
        .env("MAVLINK20", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut reported = std::io::BufReader::new(listener.stdout.take().unwrap());
    let mut line = String::new();
    std::io::BufRead::read_line(&mut reported, &mut line).unwrap();
    assert_eq!(line, "ready\n");
    (listener, reported, port)
}

#[test]
fn pymavlink_behind_udp_gets_a_fix_while_protected_and_none_after_a_jump() {
    let python = setup::python();
    let has_package = Command::new(&python).args(["-c", "import pymavlink.mavutil"]).output();
    if !has_package.is_ok_and(|output| output.status.success()) {
        skip::say("pymavlink for Python (cargo xtask setup --consumers)");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (mut listener, mut reported, port) = listening(&python, LISTEN);
    let (receiver, input) = receiver();
    let output = vec![format!("mavlink-udp://127.0.0.1:{port}")];
    let set = ["HEARTBEAT", "GPS_INPUT", "GNSS_INTEGRITY"].map(|item| format!("OUTPUT={item},1")).to_vec();
    let arguments = Arguments { input, output, set, ..Arguments::default() };
    let mut service = Service::start(folder.path(), arguments);
    let (mut line, _) = receiver.accept().unwrap();
    service.send_each(&mut line, &jump(), || thread::sleep(TURN / 5));
    // All sentences are sent once the service has ended.
    drop(service);
    drop(listener.stdin.take());
    let mut answer = String::new();
    reported.read_to_string(&mut answer).unwrap();
    listener.wait().unwrap();
    let answer: Value = serde_json::from_str(&answer).expect("its answer");
    assert_eq!(answer["bad"], 0, "{answer}");
    let fix = &answer["fix"];
    // 1e-7 degrees.
    let want = Geodetic { latitude_rad: 34.17_f64, longitude_rad: 108.57, height_m: 400.0 };
    for (field, want) in [("lat", want.latitude_rad), ("lon", want.longitude_rad)] {
        let have = fix[field].as_f64().unwrap_or(f64::NAN) * 1e-7;
        assert!((have - want).abs() < 1e-3, "{field}: {have}");
    }
    // The geoid is 35.7 m below the ellipsoid there, by EGM96.
    let altitude_m = fix["alt"].as_f64().unwrap_or(f64::NAN);
    assert!((altitude_m - 435.7).abs() < 20.0, "{altitude_m} m");
    let last = &answer["GPS_INPUT"];
    assert!(last["fix_type"].as_u64() <= Some(1) && last["lat"] == 0, "{last}");
    assert_eq!(answer["GNSS_INTEGRITY"]["raim_state"], 3, "{answer}");
}

/// Reads until standard input is closed, and prints what PX4 would have got.
const PX4: &str = r"
import sys, json, select
from pymavlink import mavutil
link = mavutil.mavlink_connection('udpin:127.0.0.1:' + sys.argv[1], dialect='common')
print('ready', flush=True)
out, last = {'bad': 0, 'positions': 0, 'beats_after': 0, 'gaps': 0, 'others': []}, None
while True:
    message = link.recv_match(blocking=True, timeout=0.2)
    if message is None:
        if select.select([sys.stdin], [], [], 0)[0]:
            break
        continue
    name = message.get_type()
    if name == 'BAD_DATA':
        out['bad'] += 1
        continue
    number = message.get_seq()
    out['gaps'] += last is not None and number != (last + 1) % 256
    last = number
    if name == 'GLOBAL_POSITION_SENSOR':
        out['positions'] += 1
        out['beats_after'] = 0
        out['position'] = message.to_dict()
    elif name == 'HEARTBEAT':
        out['beats_after'] += 1
    else:
        out['others'].append(name)
print(json.dumps(out))
";

/// `pymavlink` has the layout and the seed of the checksum from the definitions themselves.
#[test]
fn pymavlink_gets_what_px4_reads_while_protected_and_no_position_after_a_jump() {
    let python = setup::python();
    let asked = "from pymavlink.dialects.v20 import common; common.MAVLink_global_position_sensor_message";
    let has_message = Command::new(&python).args(["-c", asked]).stderr(Stdio::null()).status();
    if !has_message.is_ok_and(|status| status.success()) {
        skip::say("pymavlink 2.4.50 or newer for Python (cargo xtask setup --consumers)");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (mut listener, mut reported, port) = listening(&python, PX4);
    let (receiver, input) = receiver();
    // No message is named: the output brings its own.
    let output = vec![format!("px4-udp://127.0.0.1:{port}")];
    let mut service = Service::start(folder.path(), Arguments { input, output, ..Arguments::default() });
    let (mut line, _) = receiver.accept().unwrap();
    let mut high = 0;
    service.send_each(&mut line, &jump(), || {
        high += i32::from(is_high(folder.path()));
        thread::sleep(TURN / 5);
    });
    drop(service);
    drop(listener.stdin.take());
    let mut answer = String::new();
    reported.read_to_string(&mut answer).unwrap();
    listener.wait().unwrap();
    let answer: Value = serde_json::from_str(&answer).expect("its answer");
    assert_eq!([&answer["bad"], &answer["gaps"]], [0, 0], "{answer}");
    assert_eq!(answer["others"], Value::Array(Vec::new()), "{answer}");
    assert!(answer["positions"].as_i64() == Some(high.into()) && high > 10, "{high}: {answer}");
    assert!(answer["beats_after"].as_u64() > Some(u64::from(EPOCHS) / 2), "{answer}");
    let position = &answer["position"];
    let number = |field: &str| position[field].as_f64().unwrap_or(f64::NAN);
    assert!((number("lat") * 1e-7 - 34.17).abs() < 1e-3, "{position}");
    assert!((number("lon") * 1e-7 - 108.57).abs() < 1e-3, "{position}");
    // The geoid is 35.7 m below the ellipsoid there, by EGM96. The table of the module is off by up to 4 m on 95 % of the earth.
    let below_m = number("alt") - number("alt_ellipsoid");
    assert!((below_m - 35.7).abs() < 4.0, "{position}");
    assert!((number("alt_ellipsoid") - 400.0).abs() < 20.0, "{position}");
    assert!((0.5..50.0).contains(&number("eph")) && (0.5..50.0).contains(&number("epv")), "{position}");
    assert_eq!([&position["id"], &position["source"], &position["flags"]], [1, 1, 0], "{position}");
}
