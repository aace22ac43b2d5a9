//! Wrong files: one sentence each that says what to do, and the page goes on.

use std::io::Write as _;
use std::time::Instant;

use flate2::Compression;
use flate2::write::GzEncoder;
use raim::replay::{Window, encode};
use raim::signal::checksum::nmea_line;
use raim::signal::encode::{Frequency, Selection};
use raim::signal::sky::raw::Simulation;

use super::*;

fn gzip(content: &[u8]) -> Vec<u8> {
    let mut packer = GzEncoder::new(Vec::new(), Compression::fast());
    packer.write_all(content).unwrap();
    packer.finish().unwrap()
}

/// Returns a minute of a simulated receiver, as RTCM 3.
fn capture(seed: u64) -> Vec<u8> {
    let recording = Simulation::above_xian(3600.0, 60, seed).record();
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    encode(&recording, &selection, &[], &Window::ALL)
        .unwrap()
        .into_iter()
        .flat_map(|lump| lump.bytes)
        .collect()
}

fn rinex(letter: char) -> Vec<u8> {
    format!("{:9}{:11}{letter:<20}{:20}RINEX VERSION / TYPE\n{:60}END OF HEADER\n", "     3.04", "", "M", "")
        .into_bytes()
}

#[test]
fn every_wrong_file_gets_a_sentence_that_says_what_to_do() {
    let Some(built) = Built::new() else { return };
    let mut browser = built.open(DESK, "light");
    let positions: String = (0..60)
        .map(|second| {
            nmea_line(&format!("GNGGA,1200{second:02}.00,4703.6,N,00121.0,W,1,12,0.6,37.5,M,47.4,M,,"))
        })
        .collect();
    let packed = gzip(&capture(5));
    let all: [(&[(&str, Vec<u8>)], &str); 8] = [
        (&[("empty.ubx", Vec::new())], "empty.ubx: is empty. Drop what a receiver sent"),
        (
            &[("photo.jpg", b"\xFF\xD8\xFF\xE0\0\x10JFIF".to_vec())],
            "it is a picture. Drop what a receiver sent",
        ),
        (&[("head.gz", packed[..8].to_vec())], "head.gz: "),
        (
            &[("positions.nmea", positions.into_bytes())],
            "holds 60 lines of NMEA. missing: ranges and orbits: RXM-RAWX",
        ),
        (&[("brdc.nav", rinex('N'))], "brdc.nav holds orbits and no ranges: drop the observation file"),
        (&[("site.obs", rinex('O'))], "site.obs holds observations and no orbits: drop the navigation file"),
        (
            &[("one.rtcm3", capture(5)), ("two.rtcm3", capture(6))],
            "begin with the same epoch: copies, or captures of two receivers",
        ),
        (&[("site.obs", rinex('O')), ("one.rtcm3", capture(5))], "drop one of the two"),
    ];
    for (files, want) in all {
        let paths: Vec<PathBuf> = files.iter().map(|(name, content)| built.file(name, content)).collect();
        assert_eq!(judged(&mut browser, &paths), "failed", "{want}");
        let have = text(&mut browser, "document.getElementById('problem').textContent");
        assert!(have.contains(want) && have.ends_with('.'), "{want}: {have}");
        let shown = browser.value("document.getElementById('problem').hidden").unwrap();
        assert_eq!(shown, false, "{have}");
    }
    // A file that is cut off is judged as far as it goes, and the next one as if nothing had been.
    let cut = built.file("cut.rtcm3.gz", &packed[..packed.len() / 2]);
    assert_eq!(judged(&mut browser, &[cut]), "done");
    let notes = text(&mut browser, "document.getElementById('notes').textContent");
    assert!(notes.contains("is cut off, and read as far as the gzip data goes"), "{notes}");
    assert_eq!(browser.complaints, [""; 0]);
}

/// A gigabyte from a megabyte, and four gigabytes that the disk does not have: their reader stays
/// small, says how far it is, and ends at once when it is told to.
#[test]
fn huge_files_take_little_memory_and_are_cancelled_in_a_tenth_of_a_second() {
    let Some(built) = Built::new() else { return };
    let mut browser = built.open(DESK, "light");
    let mut packer = GzEncoder::new(Vec::new(), Compression::fast());
    for _ in 0..64 {
        packer.write_all(&vec![0; 1 << 20]).unwrap();
    }
    // Members of gzip follow each other, and are one file.
    let bomb = built.file("bomb.gz", &packer.finish().unwrap().repeat(16));
    assert_eq!(judged(&mut browser, &[bomb]), "failed");
    let memory = number(&mut browser, "document.getElementById('work').dataset.memory");
    assert!(memory < f64::from(64 << 20), "{memory} bytes");
    let huge = built.folder.path().join("huge.ubx");
    std::fs::File::create(&huge).unwrap().set_len(4 << 30).unwrap();
    browser.value("document.body.dataset.state = ''").unwrap();
    browser.choose("#files", &[huge]).unwrap();
    browser.wait_for("document.getElementById('share').value > 0.005", PATIENCE).unwrap();
    let start = Instant::now();
    browser.value("document.getElementById('cancel').click()").unwrap();
    browser.wait_for("document.body.dataset.state === 'cancelled'", PATIENCE).unwrap();
    assert!(start.elapsed() < Duration::from_millis(100), "{:?}", start.elapsed());
    browser.value("document.getElementById('sample').click()").unwrap();
    assert_eq!(finished(&mut browser), "done");
    assert_eq!(browser.complaints, [""; 0]);
}
