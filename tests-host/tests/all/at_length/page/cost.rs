//! Time and memory of long recordings: an hour, or as many epochs as `RAI_EPOCHS` says.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::time::Instant;

use raim::signal::encode::{Frequency, Selection, ubx};
use raim::signal::sky::Fleet;
use raim::signal::sky::raw::Simulation;

use super::*;

/// Longest time to the first verdict, ms.
const FIRST_MS: f64 = 300.0;

/// Most memory of the program, bytes: the browser refuses more than 256 MiB.
const MEMORY: f64 = 256.0 * 1024.0 * 1024.0;

/// Most time of the page, in that of `rai replay` on the same computer at the same moment.
const TIMES: f64 = 2.5;

/// Time in which a browser makes the program faster while it runs, s: it compiles it twice.
const WARMING_S: f64 = 1.0;

/// Writes a recording of 28 satellites of three systems on two frequencies at 1 Hz, as UBX.
fn write(path: &Path, epochs: u32) {
    let fleets = [Fleet::Gps31, Fleet::Galileo24, Fleet::Beidou24];
    let satellites = fleets.into_iter().flat_map(Fleet::satellites).collect();
    let sky = Simulation { satellites, mask_rad: 0.0, ..Simulation::above_xian(0.0, epochs, 7) };
    let selection = Selection::new("GCE", Frequency::Dual).unwrap();
    let mut encoder = ubx::Encoder::new(&sky.ephemerides(), selection, None).as_receiver();
    let mut file = BufWriter::new(File::create(path).unwrap());
    for mut epoch in sky.epochs() {
        epoch.satellites.truncate(28);
        file.write_all(&encoder.epoch(&epoch).unwrap()).unwrap();
    }
    file.flush().unwrap();
}

#[test]
fn an_hour_takes_little_more_than_on_a_computer_and_its_first_verdict_comes_at_once() {
    let Some(built) = Built::new() else { return };
    let epochs = std::env::var("RAI_EPOCHS").ok().and_then(|text| text.parse().ok()).unwrap_or(3600);
    let path = built.folder.path().join("long.ubx");
    write(&path, epochs);
    let mut browser = built.open(DESK, "light");
    // The least of three, because the computer does something else meanwhile.
    let (mut took, mut first, mut memory) = (f64::INFINITY, f64::INFINITY, 0.0_f64);
    for _ in 0..3 {
        assert_eq!(judged(&mut browser, std::slice::from_ref(&path)), "done");
        let mut value =
            |name: &str| number(&mut browser, &format!("document.getElementById('work').dataset.{name}"));
        (took, first) = (took.min(value("took")), first.min(value("first")));
        memory = memory.max(value("memory"));
    }
    println!(
        "{epochs} epochs: {:.2} s, first verdict {first:.0} ms, {:.1} MiB",
        took * 1e-3,
        memory / f64::from(1 << 20)
    );
    let plain = text(&mut browser, "document.getElementById('plain').textContent");
    assert!(plain.contains(&format!("{epochs} epochs")), "{plain}");
    assert!(first < FIRST_MS, "{first} ms");
    assert!(memory < MEMORY, "{memory} bytes");
    let start = Instant::now();
    let status = Command::new(program())
        .args(["replay", "long.ubx", "--report", "report", "--csv", "epochs.csv", "--nmea", "sentences.nmea"])
        .current_dir(built.folder.path())
        .output()
        .unwrap()
        .status;
    assert!(status.success());
    let own_s = start.elapsed().as_secs_f64();
    println!("rai replay: {own_s:.2} s");
    assert!(took * 1e-3 < TIMES * own_s + WARMING_S, "{took} ms, beside {own_s} s of rai replay");
    assert_eq!(browser.complaints, [""; 0]);
}
