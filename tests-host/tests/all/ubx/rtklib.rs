//! The encoder's bytes as RTKLIB reads them: `convbin` of Debian's package `rtklib`, if it is
//! installed.

use std::process::Command;

use raim::signal::calendar::readable;
use raim::signal::encode::ubx;
use raim::signal::encode::{Frequency, Selection};
use raim::signal::recording::Recording;
use raim::signal::sky::raw::Simulation;
use raim_firmware::time::GpsTime;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

/// Writes bytes, lets `convbin` convert them to RINEX and reads that; returns `None` without
/// `convbin`.
fn converted(bytes: &[u8], week: u16) -> Option<Recording> {
    if Command::new("convbin").output().is_err() {
        rig::skip::say("convbin (Debian's package rtklib)");
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    let (capture, observations, navigation) =
        (folder.path().join("a.ubx"), folder.path().join("a.obs"), folder.path().join("a.nav"));
    std::fs::write(&capture, bytes).unwrap();
    // The date determines the cycle of 1,024 weeks.
    let date = readable(GpsTime { week, tow_ms: 0 }).replace('-', "/");
    let (day, time) = date.split_once(' ').unwrap();
    let ran = Command::new("convbin")
        .args(["-r", "ubx", "-v", "3.03", "-tr", day, time, "-od", "-os"])
        .arg("-o")
        .arg(&observations)
        .arg("-n")
        .arg(&navigation)
        .arg(&capture)
        .output()
        .unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    Some(Recording::load(&[observations], &[navigation]).unwrap())
}

#[test]
fn rtklib_reads_the_ranges_and_orbits_that_were_encoded() {
    let mut recording = Simulation::above_xian(0.0, 20, 7).record();
    // RTKLIB writes NaN as such.
    let satellites = recording.epochs.iter_mut().flat_map(|epoch| &mut epoch.satellites);
    for signal in satellites.flat_map(|satellite| &mut satellite.signals) {
        signal.doppler_hz.get_or_insert(0.0);
    }
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection, None);
    let bytes: Vec<u8> = recording.epochs.iter().flat_map(|epoch| encoder.epoch(epoch).unwrap()).collect();
    let week = recording.epochs[0].time.week;
    let Some(have) = converted(&bytes, week) else { return };
    assert_eq!(have.epochs.len(), recording.epochs.len());
    let mut ranges = 0;
    for (have, want) in have.epochs.iter().zip(&recording.epochs) {
        assert_eq!(have.time, want.time);
        for satellite in &have.satellites {
            let sent = want.satellites.iter().find(|sent| sent.satellite == satellite.satellite).unwrap();
            for signal in &satellite.signals {
                let mut sent = sent.signals.iter().filter(|sent| sent.band == signal.band);
                // RINEX has millimetres.
                let same = sent.any(|sent| (sent.pseudorange_m - signal.pseudorange_m).abs() <= 0.000_51);
                assert!(same, "{} {signal:?}", satellite.satellite);
                ranges += 1;
            }
        }
    }
    assert!(ranges > 20 * 10, "{ranges} ranges");
    println!("{ranges} ranges, {} ephemerides", have.ephemerides.len());
    // RTKLIB keeps each ephemeris once, in RINEX's twelve digits.
    for ephemeris in &have.ephemerides {
        let (of_file, of_source) = (super::by_rtcm(ephemeris), |sent: &&_| super::by_rtcm(sent));
        let same = recording.ephemerides.iter().any(|sent| of_source(&sent) == of_file);
        assert!(same, "{ephemeris:?}");
    }
    assert!(have.ephemerides.len() >= 10, "{} ephemerides", have.ephemerides.len());
}

#[test]
fn rtklib_reads_random_elements_to_the_last_bit() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut equal = 0;
    for round in 0..12 {
        let ephemeris = match round % 2 {
            0 => super::bits::gps(&mut random),
            _ => super::bits::beidou(&mut random),
        };
        // RTKLIB takes the week from an epoch, and RINEX needs one.
        let mut bytes = epoch();
        bytes.extend(ubx::pages(&ephemeris, super::NOON).unwrap());
        bytes.extend(epoch());
        let Some(have) = converted(&bytes, super::NOON.week) else { return };
        let want = super::by_rtcm(&ephemeris);
        let found = have.ephemerides.iter().any(|read| super::by_rtcm(read) == want);
        assert!(found, "sent {ephemeris:?}\nread {:?}", have.ephemerides);
        equal += 1;
    }
    println!("{equal} equal");
}

/// Returns one range at noon.
fn epoch() -> Vec<u8> {
    use raim::signal::measurement::{MeasuredEpoch, MeasuredSatellite, MeasuredSignal};
    let satellite =
        raim_core::satellite::SatelliteId::new(raim_core::satellite::Constellation::Gps, 1).unwrap();
    let signal = MeasuredSignal {
        band: 1,
        attribute: 'C',
        pseudorange_m: 2.2e7,
        carrier_cycles: None,
        cn0_dbhz: Some(45.0),
        doppler_hz: Some(0.0),
    };
    let satellites = vec![MeasuredSatellite { satellite, signals: vec![signal] }];
    let mut encoder = ubx::Encoder::new(&[], Selection::new("G", Frequency::Single).unwrap(), None);
    encoder.epoch(&MeasuredEpoch { time: super::NOON, satellites }).unwrap()
}
