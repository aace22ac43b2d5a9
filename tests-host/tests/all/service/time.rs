//! chrony behind the service, as an integrator connects it: the service serves its sentences on a
//! TCP port, gpsd reads them and writes the time to shared memory, and chrony takes it from there
//! (`refclock SHM 0`). gpsd writes no time of a pseudo-terminal, which it takes for a test.

use std::time::SystemTime;

use oracle::chrony::{self, Chronyd};
use oracle::gpsd::Gpsd;
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
