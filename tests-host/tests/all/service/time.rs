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
