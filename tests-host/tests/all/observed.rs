//! Verdicts by the observer beside the sentences of the same module: they must be equal, because
//! tables and pages have the former, and a program behind the host port the latter.

use std::collections::BTreeSet;

use raim::replay::{self, Window};
use raim::satellites::Views;
use raim::sentence::{command, epochs, sentences};
use raim::signal::capture::{Bytes, Lumps};
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::fault::{Fault, Injector};
use raim::signal::osnma::Secret;
use raim::signal::recording::Recording;
use raim::signal::sky::Fleet;
use raim::signal::sky::raw::Simulation;
use raim::verdict::EpochOutput;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use rig::shared;

use crate::pin_in_time::{SignedLumps, signed_lumps};

/// A module of which everything is compared.
struct Pair {
    receiver: Receiver<MemoryPin, Views>,
    now_ms: u64,
    all: Vec<EpochOutput>,
}

impl Pair {
    fn new(settings: &[&str]) -> Self {
        let (pin, boot) = (MemoryPin::default(), Boot::on_host("test"));
        let receiver = Receiver::observed(pin, Views::new(false), boot).unwrap();
        let mut pair = Self { receiver, now_ms: 0, all: Vec::new() };
        for setting in settings {
            pair.command(setting);
        }
        pair
    }

    /// Compares the verdicts since the last call with the sentences.
    fn compare(&mut self, reported: &[u8]) {
        let by_sentences = epochs(&sentences(reported).unwrap()).unwrap();
        let seen = self.receiver.observer_mut().take();
        let by_observer: Vec<EpochOutput> = seen.into_iter().map(|seen| seen.output).collect();
        assert_eq!(by_observer, by_sentences, "{}", String::from_utf8_lossy(reported));
        self.all.extend(by_observer);
    }

    fn command(&mut self, body: &str) {
        let mut reported = Vec::new();
        self.receiver.command(command(body).as_bytes(), &mut reported);
        self.compare(&reported);
    }

    /// Sends an epoch, a second after the last one.
    fn epoch(&mut self, bytes: &[u8]) {
        let mut reported = Vec::new();
        self.now_ms += 1000;
        self.receiver.gnss(bytes, self.now_ms, &mut reported);
        self.compare(&reported);
    }

    fn wait(&mut self, for_ms: u64) {
        for now_ms in (self.now_ms..self.now_ms + for_ms).step_by(100).skip(1) {
            let mut reported = Vec::new();
            self.receiver.tick(now_ms, &mut reported);
            self.compare(&reported);
        }
        self.now_ms += for_ms;
    }

    /// Requires that each of these reasons has occurred.
    fn require(&self, reasons: &[&str]) {
        for reason in reasons {
            assert!(self.all.iter().any(|output| output.state.reason == *reason), "{reason}");
        }
    }
}

fn sky() -> Recording {
    let fleets = [Fleet::Gps31, Fleet::Galileo24, Fleet::Beidou24];
    let satellites = fleets.into_iter().flat_map(Fleet::satellites).collect();
    Simulation { satellites, ..Simulation::above_xian(0.0, 60, 5) }.record()
}

/// Plays a minute with these faults; the epochs of 20 s to 40 s follow a change of the settings, and
/// a silence ends it.
fn play(systems: &str, faults: &[&str], settings: &[&str], change: &str) -> Pair {
    let recording = sky();
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new(systems, Frequency::Dual).unwrap());
    let faults = faults.iter().map(|text| Fault::parse_inject(text).unwrap()).collect();
    let mut pair = Pair::new(settings);
    for (second, epoch) in (0..).zip(Injector::new(recording.epochs.into_iter(), faults)) {
        if second == 20 {
            pair.command(change);
        }
        pair.epoch(&encoder.epoch(&epoch).unwrap());
    }
    pair.wait(30_000);
    pair.require(&["STALE"]);
    pair
}

/// Returns the names of satellites of a system that the module uses.
fn names(letter: char, count: usize) -> Vec<String> {
    let (recording, mut pair) = (sky(), Pair::new(&[]));
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new("GCE", Frequency::Dual).unwrap());
    for epoch in recording.epochs.iter().take(3) {
        pair.epoch(&encoder.epoch(epoch).unwrap());
    }
    let used = &pair.receiver.last_report().unwrap().used;
    let names = used.iter().map(ToString::to_string).filter(|name| name.starts_with(letter));
    names.take(count).collect()
}

#[test]
fn faults_exclusions_silence_and_changed_settings() {
    let [one, two] = names('G', 2).try_into().unwrap();
    let single = format!("{one}:+300@10..30");
    let pair = play("GCE", &[&single], &[], "HAL,40");
    pair.require(&["OK", "EXCLUDED", "SETTINGS"]);
    assert!(pair.all.iter().any(|output| output.excluded.len() == 1 && output.position.is_some()));
    // Two faults at once.
    let both = [format!("{one}:+300@10..30"), format!("{two}:-250@10..")];
    let both: Vec<&str> = both.iter().map(String::as_str).collect();
    let pair = play("GCE", &both, &["HAL,9999", "VAL,9999"], "METHOD,BAARDA");
    let reasons: BTreeSet<&str> = pair.all.iter().map(|output| output.state.reason.as_str()).collect();
    let most = pair.all.iter().map(|output| output.excluded.len()).max();
    assert!(most >= Some(2) || reasons.len() > 4, "{reasons:?}, {most:?} left out");
}

#[test]
fn araim_few_satellites_and_other_sentences_of_a_position() {
    let [one] = names('E', 1).try_into().unwrap();
    let fault = format!("{one}:+100@10..30");
    play("GCE", &[&fault], &["PHASE,LPV200", "OUTPUT,GNS,0", "OUTPUT,GGA,1"], "PHASE,NPA").require(&["OK"]);
    let kept = names('G', 2);
    let all = sky().epochs[0].satellites.iter().map(|seen| seen.satellite.to_string()).collect::<Vec<_>>();
    let lost = all.iter().filter(|name| name.starts_with('G') && !kept.contains(name));
    let lost: Vec<String> = lost.map(|name| format!("{name}:lost@10..")).collect();
    let lost: Vec<&str> = lost.iter().map(String::as_str).collect();
    play("G", &lost, &[], "VAL,50").require(&["NOFIX"]);
}

#[test]
fn ephemerides_that_are_proved_and_false() {
    let SignedLumps { lumps, key, .. } = signed_lumps(Secret::test(), 8, Some(3));
    let mut pair = Pair::new(&[&key, "AUTH,PREFER"]);
    for lump in &lumps {
        pair.epoch(lump);
        pair.wait(900);
        pair.now_ms -= 900;
    }
    let last = pair.all.last().and_then(|output| output.authentication.clone()).unwrap();
    assert_eq!((last.state.as_str(), last.proved, last.wrong), ("UNDATED", 7, 1));
}

#[test]
fn recordings() {
    let files = ["ubx/urban_m8t.ubx.gz", "consumer/car_shanghai.rtcm3.gz", "sbf/mosaic_12s.sbf.gz"];
    for file in files.map(|file| format!("data/{file}")) {
        let Some(path) = shared::path_or_skip(&file) else { return };
        let bytes = Bytes::open(path.to_str().unwrap(), f64::INFINITY).unwrap();
        let mut pair = Pair::new(&[]);
        for lump in Lumps::of(bytes, None, &[], &Window { to_s: 600.0, ..Window::ALL }).unwrap() {
            pair.epoch(&lump.unwrap().bytes);
        }
        pair.require(&["OK"]);
    }
}

/// Positions in the sentences can be rarer than epochs; tables have all of them.
#[test]
fn table_has_the_positions_that_sentences_leave_out() {
    let recording = Simulation::above_xian(0.0, 20, 1).record();
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    let lumps = replay::encode(&recording, &selection, &[], &Window::ALL).unwrap();
    let setup = ["OUTPUT,GNS,0", "OUTPUT,GGA,0"].map(str::to_owned);
    let run = replay::on_host(&lumps, &setup, replay::Pace::Recorded, |_| ()).unwrap();
    let has_position =
        |reported: &replay::Reported| reported.output().is_some_and(|output| output.position.is_some());
    assert!(run.reported.iter().all(has_position));
    assert!(epochs(&run.sentences()).unwrap().iter().all(|output| output.position.is_none()));
}
