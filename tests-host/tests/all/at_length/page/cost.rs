//! Time and memory of long recordings: an hour, or as many epochs as `RAI_EPOCHS` says.
//!
//! Time is that of the processor for the thread that judges, which is what a person waits for but for
//! the picture: what else the computer does is not in it. Others that share a processor's caches make both
//! the page and `rai replay` slower, to twice their time: the bars in seconds hold for a computer on which
//! `rai replay` takes [`OWN_HOUR_S`], and grow with it.

use std::fs::File;
use std::io::{BufWriter, Write as _};

use raim::signal::encode::{Frequency, Selection, ubx};
use raim::signal::sky::Fleet;
use raim::signal::sky::raw::Simulation;

use super::*;

/// Longest time to the first verdict on the screen, ms.
const FIRST_MS: f64 = 300.0;

/// Most memory of the program, bytes: the browser refuses more than 256 MiB.
const MEMORY: f64 = 256.0 * 1024.0 * 1024.0;

/// Most time of the page, in that of `rai replay` on the same computer.
const TIMES: f64 = 2.5;

/// Most time of a day, s, and of the same for a part of it.
const DAY_S: f64 = 12.0;

/// Time of `rai replay` for an hour on a computer that does nothing else, s (results/cost.md).
const OWN_HOUR_S: f64 = 0.30;

/// Number of epochs in a day.
const DAY: f64 = 86_400.0;

/// Most time of an hour that is judged first, s: the browser compiles the program meanwhile.
const HOUR_S: f64 = 1.0;

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

/// Returns the time that a processor works for the thread of the page with a recording, s.
fn judged_s(browser: &mut Browser, path: &Path) -> f64 {
    let before_s = browser.threads_worked_s().unwrap();
    assert_eq!(judged(browser, &[path.to_owned()]), "done");
    // It is the same thread until a judgement is cancelled.
    browser.threads_worked_s().unwrap() - before_s
}

/// Returns the time that the processors work for the same with `rai replay`, s: the shell's own account
/// of its children, the last line of which is `0m0.31s 0m0.02s`.
fn replayed_s(folder: &Path) -> f64 {
    let line = format!(
        "{} replay long.ubx --report report --csv epochs.csv --nmea sentences.nmea >/dev/null 2>&1 && times",
        program().display()
    );
    let output = Command::new("sh").args(["-c", &line]).current_dir(folder).output().unwrap();
    assert!(output.status.success());
    let said = String::from_utf8(output.stdout).unwrap();
    let parts = said.lines().last().unwrap().split_whitespace();
    parts
        .map(|part| {
            let (minutes, seconds) = part.trim_end_matches('s').split_once('m').unwrap();
            60.0 * minutes.parse::<f64>().unwrap() + seconds.parse::<f64>().unwrap()
        })
        .sum()
}

#[test]
fn an_hour_takes_little_more_than_on_a_computer_and_its_first_verdict_comes_at_once() {
    let Some(built) = Built::new() else { return };
    let epochs = std::env::var("RAI_EPOCHS").ok().and_then(|text| text.parse().ok()).unwrap_or(3600);
    let path = built.folder.path().join("long.ubx");
    write(&path, epochs);
    let own_s = (0..2).map(|_| replayed_s(built.folder.path())).fold(f64::INFINITY, f64::min);
    let mut browser = built.open(DESK, "light");
    let (mut took_s, mut first_ms, mut memory) = (Vec::new(), f64::INFINITY, 0.0_f64);
    for _ in 0..3 {
        took_s.push(judged_s(&mut browser, &path));
        let mut value =
            |name: &str| number(&mut browser, &format!("document.getElementById('work').dataset.{name}"));
        // The least of three, because a clock on the wall counts what others do meanwhile.
        first_ms = first_ms.min(value("first"));
        memory = memory.max(value("memory"));
    }
    let (cold_s, warm_s) = (took_s[0], took_s[1].min(took_s[2]));
    println!(
        "{epochs} epochs: {cold_s:.2} s, again {warm_s:.2} s; rai replay {own_s:.2} s; first verdict \
         {first_ms:.0} ms, {:.1} MiB",
        memory / f64::from(1 << 20)
    );
    let plain = text(&mut browser, "document.getElementById('plain').textContent");
    assert!(plain.contains(&format!("{epochs} epochs")), "{plain}");
    assert!(first_ms < FIRST_MS, "{first_ms} ms");
    assert!(memory < MEMORY, "{memory} bytes");
    let part = f64::from(epochs) / DAY;
    let slower = (own_s / (24.0 * OWN_HOUR_S * part)).max(1.0);
    println!("this computer now takes {slower:.2} times what it takes alone");
    assert!(cold_s < slower * HOUR_S.max(DAY_S * part), "{cold_s} s");
    assert!(warm_s < slower * DAY_S * part, "{warm_s} s");
    assert!(warm_s < TIMES * own_s, "{warm_s} s, beside {own_s} s of rai replay");
    assert_eq!(browser.complaints, [""; 0]);
}
