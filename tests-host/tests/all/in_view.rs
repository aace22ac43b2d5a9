//! `GSV` of a module under a simulated sky of three systems, as `pynmea2` reads it, against the
//! true directions of that sky.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::process::{Command, Stdio};

use raim::signal::encode::{Frequency, Selection, ubx};
use raim::signal::sky::Fleet;
use raim::signal::sky::raw::Simulation;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use rig::{setup, skip};
use serde_json::Value;

/// Epochs of the sky.
const EPOCHS: u32 = 12;

/// Prints talker, number of sentences, number, satellites, and the fields of the satellites of each
/// `GSV`.
const READ: &str = r"
import sys, json, pynmea2
out = []
for line in sys.stdin.read().splitlines():
    if line[3:6] != 'GSV':
        continue
    m = pynmea2.parse(line, check=True)
    of = lambda n: [getattr(m, name + '_' + str(n), '') for name in ('sv_prn_num', 'elevation_deg', 'azimuth', 'snr')]
    out.append([m.talker, m.num_messages, m.msg_num, m.num_sv_in_view, [of(n) for n in (1, 2, 3, 4)]])
print(json.dumps(out))
";

fn sky() -> Simulation {
    let fleets = [Fleet::Gps31, Fleet::Galileo24, Fleet::Beidou24];
    Simulation {
        satellites: fleets.into_iter().flat_map(Fleet::satellites).collect(),
        mask_rad: 0.0,
        ..Simulation::above_xian(3600.0, EPOCHS, 5)
    }
}

/// Returns the sentences of the last epoch.
fn sentences(sky: &Simulation) -> String {
    let mut recording = sky.record();
    // A module has no room for the orbits of every satellite at once.
    let seen = recording.epochs[0].satellites.clone();
    recording.ephemerides.retain(|set| seen.iter().any(|one| one.satellite == set.satellite));
    let selection = Selection::new("GCE", Frequency::Dual).expect("systems");
    let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection, None);
    let mut receiver = Receiver::new(MemoryPin::default(), Boot::on_host("test")).expect("a module");
    receiver.set("OUTPUT", Some("GSV,1"), &mut Vec::new()).expect("a setting");
    let mut reported = Vec::new();
    let time = recording.epochs[0].time;
    for set in &recording.ephemerides {
        receiver.gnss(&ubx::pages(set, time).expect("pages"), 0, &mut reported);
    }
    for (second, epoch) in (0..).zip(&recording.epochs) {
        reported.clear();
        receiver.gnss(&encoder.epoch(epoch).expect("messages"), second * 1000, &mut reported);
    }
    String::from_utf8(reported).expect("ASCII")
}

/// A sentence as the package reads it: talker, sentences, number, satellites in view, and four of
/// them.
type Sentence = (String, String, String, String, [[Value; 4]; 4]);

#[test]
fn pynmea2_reads_every_satellite_with_its_direction_and_strength() {
    let python = setup::python();
    if !Command::new(&python).args(["-c", "import pynmea2"]).output().is_ok_and(|done| done.status.success())
    {
        return skip::say("pynmea2 for Python (cargo xtask setup --consumers)");
    }
    let sky = sky();
    let text = sentences(&sky);
    let mut reader = Command::new(&python)
        .args(["-c", READ])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3");
    reader.stdin.take().expect("it").write_all(text.as_bytes()).expect("it reads");
    let output = reader.wait_with_output().expect("python3");
    let groups: Vec<Sentence> = serde_json::from_slice(&output.stdout).expect("its answer");
    let mut have = BTreeMap::new();
    let mut place = BTreeMap::new();
    for (talker, sentences, number, in_view, satellites) in &groups {
        let letter = BTreeMap::from([("GP", 'G'), ("GA", 'E'), ("GB", 'C')])[talker.as_str()];
        let expected = place.entry(talker).and_modify(|next| *next += 1).or_insert(1);
        assert_eq!(number, &expected.to_string(), "{text}");
        let many: usize = in_view.parse().expect("a number");
        assert_eq!(sentences, &many.div_ceil(4).to_string(), "{text}");
        for [prn, values @ ..] in satellites {
            // Behind the last satellite the package takes the signal id for a satellite.
            let values: Vec<f64> = values.iter().filter_map(|value| value.as_str()?.parse().ok()).collect();
            let (Some(prn), [elevation, azimuth, cn0]) = (prn.as_str(), &values[..]) else { continue };
            have.insert(format!("{letter}{prn:0>2}"), [*elevation, *azimuth, *cn0]);
        }
    }
    let sights = sky.sights_at(EPOCHS - 1);
    assert_eq!(have.len(), sights.len(), "{text}");
    assert!(sights.len() > 20, "{}", sights.len());
    for sight in &sights {
        let name = sight.satellite.to_string();
        let [elevation_deg, azimuth_deg, cn0_dbhz] = have[&name];
        let [elevation_rad, azimuth_rad] = [sight.elevation_rad(), sight.azimuth_rad()];
        assert!((elevation_deg - elevation_rad.to_degrees()).abs() < 0.51, "{name}: {elevation_deg}");
        let turn_deg = (azimuth_deg - azimuth_rad.to_degrees() + 180.0).rem_euclid(360.0) - 180.0;
        assert!(turn_deg.abs() < 0.51, "{name}: {azimuth_deg}");
        // The message has whole dB-Hz.
        assert!((cn0_dbhz - (36.0 + 14.0 * elevation_rad.sin())).abs() < 1.1, "{name}: {cn0_dbhz}");
    }
}
