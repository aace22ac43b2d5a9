//! chrony behind the service, as an integrator connects it: the service sends it the time of
//! protected epochs (`refclock SOCK`), or serves its sentences on a TCP port, from which gpsd writes
//! the time to shared memory (`refclock SHM 0`). gpsd writes no time of a pseudo-terminal, which it
//! takes for a test.

use std::os::unix::net::UnixDatagram;
use std::time::SystemTime;

use oracle::chrony::{self, Chronyd};
use oracle::gpsd::Gpsd;
use raim::signal::sky::Site;
use raim_firmware::output::nmea::GPS_MINUS_UTC_S;
use raim_firmware::time::GpsTime;
use rig::skip;

use super::*;

/// Most epochs of the receiver, one a second.
const EPOCHS: u32 = 24;

/// Start of GPS time in Unix time, ms: 1980-01-06 00:00:00 UTC.
const GPS_BEGAN_MS: u64 = 315_964_800_000;

/// Times of a sky start at a multiple of this, ms.
const GRID_MS: u64 = 16_000;

fn unix_ms() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap();
    u64::try_from(since.as_millis()).unwrap()
}

/// Returns a sky of the present whose first epoch is at this time.
fn sky_from(first_ms: u64) -> Simulation {
    let gps_ms = first_ms - GPS_BEGAN_MS + u64::from(GPS_MINUS_UTC_S) * 1000;
    let origin_ms = gps_ms / GRID_MS * GRID_MS;
    let mut simulation = Simulation::above_xian((gps_ms - origin_ms) as f64 * 1e-3, EPOCHS, 11);
    simulation.origin = GpsTime::from_ms(origin_ms);
    simulation
}

/// Epochs after a leap in which it is an alert: the way takes ten seconds at the greatest speed.
const ALERT: usize = 8;

/// Sends epochs in their second, each followed by `then`: good ones until it returns true, then
/// those of a receiver that has leapt by 5 km.
fn send_in_time(line: &mut impl Write, mut then: impl FnMut(bool) -> bool) {
    let first_ms = unix_ms() / 1000 * 1000 + 2000;
    let (good, mut stray) = (sky_from(first_ms), sky_from(first_ms));
    stray.site = Site::geodetic(34.125, 108.57, 400.0);
    let (good, stray) = (pieces_of(&good), pieces_of(&stray));
    line.write_all(&good[0]).unwrap();
    let (mut has_leapt, mut left) = (false, ALERT);
    for (second, due_ms) in (1..good.len()).zip((first_ms..).step_by(1000)) {
        thread::sleep(Duration::from_millis(due_ms.saturating_sub(unix_ms())));
        line.write_all(if has_leapt { &stray[second] } else { &good[second] }).unwrap();
        thread::sleep(Duration::from_millis(200));
        left -= usize::from(has_leapt);
        has_leapt |= then(has_leapt);
        if left == 0 {
            return;
        }
    }
    panic!("the good epochs did not suffice");
}

/// Many seconds each.
mod at_length {
    use super::*;

    #[test]
    fn chrony_follows_the_time_of_the_service_through_gpsd() {
        if !chrony::is_possible() {
            return skip::say("chrony (apt-get install chrony) and the rights of the superuser");
        }
        let folder = tempfile::tempdir().unwrap();
        let (receiver, input) = receiver();
        let clients = free_address();
        let output = vec![format!("tcp://{clients}")];
        let set = vec!["TTA=10".to_owned()];
        // chronyd compares the time with the clock of the computer.
        let clock = Clock::of_the_computer();
        let arguments = Arguments { input, output, set, ..Arguments::default() };
        let _service = Service::start_by(folder.path(), arguments, clock);
        let (mut line, _) = receiver.accept().unwrap();
        drop(client(clients));
        let Some(mut gpsd) = Gpsd::on_port_apart_or_skip(clients).unwrap() else { return };
        let chronyd = Chronyd::beside(&gpsd).unwrap();
        let first_ms = unix_ms() / 1000 * 1000 + 2000;
        let mut told = None;
        let pieces = pieces_of(&sky_from(first_ms));
        line.write_all(&pieces[0]).unwrap();
        for (piece, due_ms) in pieces[1..].iter().zip((first_ms..).step_by(1000)) {
            thread::sleep(Duration::from_millis(due_ms.saturating_sub(unix_ms())));
            line.write_all(piece).unwrap();
            let _ = gpsd.objects().unwrap();
            told = chronyd.source().unwrap();
            if told.is_some_and(|told| told.is_followed && told.reach.count_ones() >= 4) {
                break;
            }
        }
        let told = told.expect("chronyd answers");
        assert!(told.is_followed && told.reach.count_ones() >= 4, "{told:?}");
        // An epoch is sent as its second begins. It is late by the way through the programs, and not by
        // a leap second.
        assert!(told.ahead_s.abs() < 0.5, "{told:?}");
    }

    /// A receiver of datagrams that knows the layout from chrony's documentation: `struct timeval`,
    /// offset, pulse, leap, padding, magic.
    #[test]
    #[cfg(target_pointer_width = "64")]
    fn time_is_sent_for_protected_epochs_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("chrony.rai.sock");
        let socket = UnixDatagram::bind(&path).unwrap();
        socket.set_nonblocking(true).unwrap();
        let (receiver, input) = receiver();
        let output = vec![format!("chrony:{}", path.display())];
        let set = vec!["TTA=10".to_owned()];
        let arguments = Arguments { input, output, set, ..Arguments::default() };
        let _service = Service::start_by(folder.path(), arguments, Clock::of_the_computer());
        let (mut line, _) = receiver.accept().unwrap();
        let (mut good, mut seconds) = (0, 0);
        send_in_time(&mut line, |has_leapt| {
            let mut bytes = [0; 64];
            let is_high = is_high(folder.path());
            let count = socket.recv(&mut bytes).unwrap_or(0);
            seconds += 1;
            if has_leapt {
                assert!(!is_high, "the position has leapt");
            }
            assert_eq!(count > 0, is_high, "second {seconds}");
            if count > 0 {
                assert_eq!(count, 40);
                let long = |at: usize| i64::from_ne_bytes(bytes[at..at + 8].try_into().unwrap());
                let int = |at: usize| i32::from_ne_bytes(bytes[at..at + 4].try_into().unwrap());
                let offset_s = f64::from_ne_bytes(bytes[16..24].try_into().unwrap());
                // The bytes come within some milliseconds of the epoch, which is a full second of UTC.
                assert!(offset_s.abs() < 0.1, "{offset_s}");
                let sent_s = long(0) as f64 + long(8) as f64 * 1e-6 + offset_s;
                assert!((sent_s - sent_s.round()).abs() < 1e-3, "{sent_s}");
                assert_eq!([int(24), int(28), int(36)], [0, 0, 0x534F_434B]);
                good += 1;
            }
            good == 4
        });
        assert_eq!(good, 4);
    }

    #[test]
    fn chrony_loses_its_source_in_an_alert_within_the_time_to_alert() {
        if !chrony::is_possible() {
            return skip::say("chrony (apt-get install chrony) and the rights of the superuser");
        }
        let folder = tempfile::tempdir().unwrap();
        let (chronyd, path) = Chronyd::with_socket().unwrap();
        let (receiver, input) = receiver();
        let output = vec![format!("chrony:{}", path.display())];
        let set = vec!["TTA=6".to_owned()];
        let arguments = Arguments { input, output, set, ..Arguments::default() };
        let _service = Service::start_by(folder.path(), arguments, Clock::of_the_computer());
        let (mut line, _) = receiver.accept().unwrap();
        let (mut followed, mut after) = (None, Vec::new());
        send_in_time(&mut line, |has_leapt| {
            let told = chronyd.source().unwrap().expect("chronyd answers");
            if has_leapt {
                after.push(told.reach);
            } else if told.is_followed && told.reach.count_ones() >= 4 {
                followed = Some(told);
            }
            followed.is_some()
        });
        let followed = followed.expect("chronyd follows the protected time");
        assert!(followed.ahead_s.abs() < 0.1, "{followed:?}");
        // One poll a second: within the time to alert, the last polls found nothing.
        assert!(after[6..].iter().all(|reach| reach.trailing_zeros() >= 2), "{after:?}");
    }
}

/// Starts the service as a process of another user, which is that of nobody.
fn start_as_nobody(program: &Path, arguments: &[String]) -> std::process::Child {
    let mut service = std::process::Command::new("runuser");
    service.args(["-u", "nobody", "--"]).arg(program);
    let mut service = started_by(service, &arguments.join("\n"));
    let nowhere = std::process::Stdio::null;
    service.stdin(nowhere()).stdout(nowhere()).stderr(nowhere()).spawn().unwrap()
}

/// Three programs of three users: chronyd, gpsd, which gives up the rights of the superuser, and the
/// service, which is killed and started again under both.
#[test]
fn gpsd_and_chronyd_go_on_within_ten_seconds_after_the_service_is_killed_and_started_again() {
    use std::os::unix::fs::{PermissionsExt as _, chown};
    if !chrony::is_possible() {
        return skip::say("chrony (apt-get install chrony) and the rights of the superuser");
    }
    let run = std::process::Command::new("runuser").args(["-u", "nobody", "--", "id", "-u"]).output();
    let Some(nobody) = run.ok().and_then(|output| String::from_utf8(output.stdout).ok()?.trim().parse().ok())
    else {
        return skip::say("runuser and the user nobody");
    };
    let datagrams = std::net::UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let Some(mut gpsd) = Gpsd::on_datagrams_or_skip(datagrams).unwrap() else { return };
    let (chronyd, socket) = Chronyd::with_socket().unwrap();
    let folder = tempfile::tempdir().unwrap();
    chown(folder.path(), Some(nobody), None).unwrap();
    fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o755)).unwrap();
    let program = folder.path().join("program");
    fs::copy(std::env::current_exe().unwrap(), &program).unwrap();
    // What a drop-in of chrony's unit does.
    while !socket.exists() {
        thread::sleep(Duration::from_millis(10));
    }
    fs::set_permissions(socket.parent().unwrap(), fs::Permissions::from_mode(0o755)).unwrap();
    fs::set_permissions(&socket, fs::Permissions::from_mode(0o666)).unwrap();
    let (receiver, input) = receiver();
    let arguments = [
        format!("--input={}", input.unwrap()),
        format!("--output=udp://{datagrams}"),
        format!("--output=chrony:{}", socket.display()),
        format!("--pin=file:{}", folder.path().join("pin").display()),
    ];
    let first_ms = unix_ms() / 1000 * 1000 + 3000;
    let mut sky = sky_from(first_ms);
    sky.epochs = 60;
    let pieces = pieces_of(&sky);
    let mut rest = pieces[1..].iter().zip((first_ms..).step_by(1000));
    for run in 0..2 {
        let mut service = start_as_nobody(&program, &arguments);
        let (mut line, _) = receiver.accept().unwrap();
        let started = Instant::now();
        line.write_all(&pieces[0]).unwrap();
        let (mut fixes, mut polls) = (0, 0);
        while fixes < 2 || polls < 2 {
            let (piece, due_ms) = rest.find(|(_, due_ms)| *due_ms > unix_ms()).expect("an epoch");
            thread::sleep(Duration::from_millis(due_ms.saturating_sub(unix_ms())));
            line.write_all(piece).unwrap();
            let end = Instant::now() + Duration::from_millis(500);
            while Instant::now() < end {
                let objects = gpsd.objects().unwrap();
                fixes +=
                    objects.iter().filter(|object| object["class"] == "TPV" && object["mode"] == 3).count();
            }
            let reach = chronyd.source().unwrap().map_or(0, |told| told.reach);
            polls = (!reach).trailing_zeros();
            let taken = started.elapsed();
            assert!(taken < Duration::from_secs(10), "start {run}: {fixes} positions, {polls} polls");
        }
        assert!(is_high(folder.path()));
        // The child is `runuser`, whose end does not end the service.
        let own = service.id();
        let children = fs::read_to_string(format!("/proc/{own}/task/{own}/children")).unwrap();
        let killed =
            std::process::Command::new("kill").arg("-KILL").args(children.split_whitespace()).status();
        assert!(killed.unwrap().success(), "{children:?}");
        service.wait().unwrap();
        // gpsd and chronyd have nothing for some polls.
        thread::sleep(Duration::from_secs(3));
        while !gpsd.objects().unwrap().is_empty() {}
    }
}
