//! The verdicts of the module: health, alert, settings and the sentence that says what is in use.

use std::collections::BTreeSet;

use raim::sentence::command;
use raim::signal::encode::ubx::{self, CnavMessage};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::sky::raw::Simulation;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};

use super::cnav;

/// Number of epochs, one a second.
const EPOCHS: u32 = 12;

/// Returns a sky of GPS and `BeiDou` whose GPS satellites send L1 C/A and a second band, and its GPS
/// satellites in view throughout.
fn sky(second: (u8, char)) -> (Vec<Vec<u8>>, Vec<SatelliteId>) {
    let mut recording = Simulation::above_xian(3600.0, EPOCHS, 11).record();
    for satellite in recording.epochs.iter_mut().flat_map(|epoch| &mut epoch.satellites) {
        if satellite.satellite.constellation() == Constellation::Gps {
            for signal in satellite.signals.iter_mut().filter(|signal| signal.band == 2) {
                // The ionosphere of L2 is no concern here: on L5 it is 13 % larger.
                (signal.band, signal.attribute) = second;
            }
        }
    }
    let seen = recording.epochs[0].satellites.iter().map(|seen| seen.satellite);
    let seen = seen.filter(|one| one.constellation() == Constellation::Gps).collect();
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection, None);
    (recording.epochs.iter().map(|epoch| encoder.epoch(epoch).unwrap()).collect(), seen)
}

/// What the module says of a sky.
struct Reported {
    used: BTreeSet<SatelliteId>,
    /// The last field of `PRAIE` in the last epoch.
    unhealthy: Option<u8>,
    sentences: String,
}

/// Judges a sky whose satellites have sent `bits` before the first epoch.
fn judged(lumps: &[Vec<u8>], bits: &[u8], setup: &[(&str, &str)]) -> Reported {
    let mut receiver = Receiver::new(MemoryPin::default(), Boot::on_host("cnav")).unwrap();
    for (key, values) in setup {
        receiver.set(key, Some(values), &mut Vec::new()).unwrap();
    }
    receiver.gnss(bits, 0, &mut Vec::new());
    let mut sentences = Vec::new();
    for (second, lump) in (1..).zip(lumps) {
        sentences.clear();
        receiver.gnss(lump, 1000 * second, &mut sentences);
    }
    let sentences = String::from_utf8(sentences).unwrap();
    let used = receiver.last_report().unwrap().used.iter().copied().collect();
    let unhealthy = sentences.lines().find(|line| line.starts_with("$PRAIE")).map(|line| {
        let (body, _) = line.split_once('*').unwrap();
        let fields: Vec<&str> = body.split(',').collect();
        assert_eq!(fields.len(), 10, "{line}");
        assert_eq!(fields[2..9].concat(), "", "the receiver says nothing: {line}");
        fields[9].parse().unwrap()
    });
    Reported { used, unhealthy, sentences }
}

fn of_gps(reported: &Reported) -> usize {
    reported.used.iter().filter(|one| one.constellation() == Constellation::Gps).count()
}

fn health(satellites: &[SatelliteId], out: [bool; 3]) -> Vec<u8> {
    satellites.iter().flat_map(|one| cnav(*one, CnavMessage::Health(out), false)).collect()
}

#[test]
fn an_alert_closes_a_satellite_until_its_next_frame_takes_it_back() {
    let (lumps, seen) = sky((2, 'L'));
    let all = judged(&lumps, &[], &[]);
    assert!(of_gps(&all) >= 6, "{:?}", all.used);
    for satellite in all.used.iter().filter(|one| one.constellation() == Constellation::Gps) {
        let mut bits = cnav(*satellite, CnavMessage::Other(33), true);
        let have = judged(&lumps, &bits, &[]);
        let want: BTreeSet<SatelliteId> = all.used.iter().copied().filter(|one| one != satellite).collect();
        assert_eq!(have.used, want, "{satellite}");
        bits.extend(cnav(*satellite, CnavMessage::Other(11), false));
        assert_eq!(judged(&lumps, &bits, &[]).used, all.used, "{satellite}");
    }
    let every: Vec<u8> = seen.iter().flat_map(|one| cnav(*one, CnavMessage::Other(33), true)).collect();
    assert_eq!(of_gps(&judged(&lumps, &every, &[])), 0);
}

#[test]
fn a_band_out_of_service_is_not_used_and_the_satellite_falls_back_to_the_other() {
    let (lumps, seen) = sky((2, 'L'));
    let without = |second| {
        let mut recording = Simulation::above_xian(3600.0, EPOCHS, 11).record();
        for satellite in recording.epochs.iter_mut().flat_map(|epoch| &mut epoch.satellites) {
            if satellite.satellite.constellation() == Constellation::Gps {
                satellite.signals.retain(|signal| (signal.band == 2) == second);
                for signal in satellite.signals.iter_mut().filter(|signal| signal.band == 2) {
                    signal.attribute = 'L';
                }
            }
        }
        let selection = Selection::new("GC", Frequency::Dual).unwrap();
        let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection, None);
        recording.epochs.iter().map(|epoch| encoder.epoch(epoch).unwrap()).collect::<Vec<_>>()
    };
    let states = |reported: &Reported| {
        let lines = reported.sentences.lines();
        lines
            .filter(|line| line.starts_with("$PRAIS") || line.starts_with("$GNGGA"))
            .collect::<Vec<_>>()
            .join("\n")
    };
    for (out, alone) in [([false, true, false], without(false)), ([true, false, false], without(true))] {
        let have = judged(&lumps, &health(&seen, out), &[]);
        let want = judged(&alone, &[], &[]);
        assert!(of_gps(&have) >= 6, "{:?}", have.used);
        assert_eq!(states(&have), states(&want), "{out:?}");
    }
    assert_eq!(of_gps(&judged(&lumps, &health(&seen, [true, true, true]), &[])), 0);
}

#[test]
fn an_unhealthy_l5_in_use_is_said_and_healthy_leaves_it_out() {
    let (lumps, seen) = sky((5, 'Q'));
    let l1 = {
        let (mut lumps, _) = sky((5, 'Q'));
        // L5 alone is called out of service, so that L1 remains.
        lumps.truncate(EPOCHS as usize);
        lumps
    };
    let bad = health(&seen, [false, false, true]);
    let good = health(&seen, [false; 3]);
    // All satellites in use have L5 in a pair.
    let dual = ("FREQ", "DUAL");
    let tracked = judged(&lumps, &bad, &[dual]);
    assert!(tracked.unhealthy.is_some_and(|many| usize::from(many) == of_gps(&tracked) && many >= 6));
    assert_eq!(judged(&lumps, &bad, &[dual, ("L5", "HEALTHY")]).unhealthy, None);
    for l5 in ["TRACKED", "HEALTHY"] {
        let have = judged(&lumps, &good, &[dual, ("L5", l5)]);
        assert_eq!((have.unhealthy, of_gps(&have)), (None, of_gps(&tracked)), "{l5}: healthy");
        assert_eq!(judged(&lumps, &[], &[dual, ("L5", l5)]).unhealthy, None, "{l5}: nothing was said");
    }
    let single = judged(&l1, &bad, &[("FREQ", "SINGLE")]);
    assert_eq!((single.unhealthy, of_gps(&single) >= 6), (None, true), "L1 alone is in use");
}

#[test]
fn separation_with_a_preset_of_icao_uses_healthy_l5_alone() {
    let (lumps, seen) = sky((5, 'Q'));
    let bad = health(&seen, [false, false, true]);
    let with = |setup: &[(&str, &str)]| {
        let reported = judged(&lumps, &bad, &[&[("FREQ", "DUAL"), ("METHOD", "SEPARATION")], setup].concat());
        (
            reported.unhealthy.is_some(),
            reported.sentences.lines().find(|line| line.starts_with("$PRAIM")).map(str::to_owned),
        )
    };
    for preset in ["ICAO", "ICAO-AIR"] {
        let of_icao = with(&[("ISM", preset)]);
        assert!(!of_icao.0, "{preset}");
        assert_eq!(of_icao, with(&[("ISM", preset), ("L5", "HEALTHY")]), "{preset} is as HEALTHY");
        let overridden = with(&[("ISM", preset), ("ISM", "G,2.4,2.4,0.75,1e-5,1e-4")]);
        assert!(!overridden.0, "{preset} with other numbers for GPS");
    }
    for preset in ["RESEARCH", "RESEARCH-AIR"] {
        assert!(with(&[("ISM", preset)]).0, "{preset}");
        assert!(!with(&[("ISM", preset), ("L5", "HEALTHY")]).0, "{preset}");
    }
}

#[test]
fn the_setting_is_reported_where_it_is_not_as_at_start_and_takes_a_promise_back() {
    let (lumps, _) = sky((2, 'L'));
    let mut receiver = Receiver::new(MemoryPin::default(), Boot::on_host("cnav")).unwrap();
    for (second, lump) in (1..).zip(&lumps) {
        receiver.gnss(lump, 1000 * second, &mut Vec::new());
    }
    assert!(receiver.pin().high, "a healthy sky");
    let mut reported = Vec::new();
    receiver.command(command("L5").as_bytes(), &mut reported);
    receiver.command(command("L5,HEALTHY").as_bytes(), &mut reported);
    assert!(!receiver.pin().high, "the promise rested on it");
    receiver.tick(30_000, &mut reported);
    let reported = String::from_utf8(reported).unwrap();
    assert!(reported.contains("$PRAIA,L5,TRACKED,OK*"), "{reported}");
    assert!(reported.contains("$PRAIA,L5,HEALTHY,OK*"), "{reported}");
    assert!(reported.contains(",A,STALE,") || reported.contains(",U,SETTINGS,"), "{reported}");
    assert!(
        reported.lines().any(|line| line.starts_with("$PRAIQ") && line.contains(",L5,HEALTHY,")),
        "{reported}"
    );
}
