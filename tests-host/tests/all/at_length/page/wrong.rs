//! Wrong files: one sentence each that says what to do, and the page goes on.

use std::io::{Read as _, Write as _};
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

/// Returns an epoch of one satellite in RINEX, with a range in whole metres.
fn observations(range_m: u32) -> Vec<u8> {
    let line = |text: &str, label: &str| format!("{text:60}{label}\n");
    let head = format!("{:9}{:11}{:20}M", "     3.04", "", "OBSERVATION DATA");
    let body = format!("> 2024 06 24 08 00  0.0000000  0  1\nG05  {range_m}.381\n");
    [
        line(&head, "RINEX VERSION / TYPE"),
        line("G    1 C1C", "SYS / # / OBS TYPES"),
        line("", "END OF HEADER"),
        body,
    ]
    .concat()
    .into_bytes()
}

/// An ephemeris of that satellite.
const NAVIGATION: &[u8] = include_bytes!("../../../../vectors/one_ephemeris.nav");

fn rinex(letter: char) -> Vec<u8> {
    format!("{:9}{:11}{letter:<20}{:20}RINEX VERSION / TYPE\n{:60}END OF HEADER\n", "     3.04", "", "M", "")
        .into_bytes()
}

/// Most memory of the program for a wrong file, bytes.
const MEMORY: f64 = 64.0 * 1024.0 * 1024.0;

/// Name and content of a file.
type File<'f> = (&'f str, Vec<u8>);

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
    let all: [(&[File], &str); 9] = [
        (&[("empty.ubx", Vec::new())], "empty.ubx: is empty: give what a receiver sent"),
        (
            &[("photo.jpg", b"\xFF\xD8\xFF\xE0\0\x10JFIF".to_vec())],
            "it is a picture: give what a receiver sent",
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
        (
            &[
                ("one.obs", observations(24_503_597)),
                ("two.obs", observations(24_503_697)),
                ("day.nav", NAVIGATION.to_vec()),
            ],
            "one.obs and two.obs are recordings of two receivers at the same time: give one of the two",
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
        let memory = number(&mut browser, "document.getElementById('work').dataset.memory");
        assert!(memory < MEMORY, "{want}: {memory} bytes");
    }
    // A file that is cut off is judged as far as it goes, and the next one as if nothing had been.
    let cut = built.file("cut.rtcm3.gz", &packed[..packed.len() / 2]);
    assert_eq!(judged(&mut browser, &[cut]), "done");
    let notes = text(&mut browser, "document.getElementById('notes').textContent");
    assert!(notes.contains("is cut off, and read as far as the gzip data goes"), "{notes}");
    assert_eq!(browser.complaints, [""; 0]);
}

/// Opens a file of four gigabytes that the disk does not have; returns when a part of it is read.
fn open_huge(built: &Built, browser: &mut Browser) -> PathBuf {
    let huge = built.folder.path().join("huge.ubx");
    std::fs::File::create(&huge).unwrap().set_len(4 << 30).unwrap();
    browser.value("document.body.dataset.state = ''").unwrap();
    browser.choose("#files", std::slice::from_ref(&huge)).unwrap();
    browser.wait_for("document.getElementById('share').value > 0.005", PATIENCE).unwrap();
    huge
}

/// A gigabyte from a megabyte, and four gigabytes that the disk does not have: their reader stays
/// small, says how far it is, and ends at once when it is told to.
#[test]
fn huge_files_take_little_memory_and_are_cancelled_in_a_tenth_of_a_second() {
    let Some(built) = Built::new() else { return };
    let mut browser = built.open(DESK, "light");
    let mut packer = GzEncoder::new(Vec::new(), Compression::best());
    for _ in 0..64 {
        packer.write_all(&vec![0; 1 << 20]).unwrap();
    }
    // Members of gzip follow each other, and are one file.
    let bomb = packer.finish().unwrap().repeat(16);
    assert!(bomb.len() < 1_100_000, "{} bytes", bomb.len());
    let bomb = built.file("bomb.gz", &bomb);
    assert_eq!(judged(&mut browser, &[bomb]), "failed");
    let have = text(&mut browser, "document.getElementById('problem').textContent");
    assert!(have.starts_with("bomb.gz: ") && have.contains("give what a receiver sent"), "{have}");
    let memory = number(&mut browser, "document.getElementById('work').dataset.memory");
    assert!(memory < MEMORY, "{memory} bytes");
    open_huge(&built, &mut browser);
    let start = Instant::now();
    browser.value("document.getElementById('cancel').click()").unwrap();
    browser.wait_for("document.body.dataset.state === 'cancelled'", PATIENCE).unwrap();
    assert!(start.elapsed() < Duration::from_millis(100), "{:?}", start.elapsed());
    browser.value("document.getElementById('sample').click()").unwrap();
    assert_eq!(finished(&mut browser), "done");
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn a_file_that_grows_while_it_is_read_is_told() {
    let Some(built) = Built::new() else { return };
    let mut browser = built.open(DESK, "light");
    let huge = open_huge(&built, &mut browser);
    std::fs::OpenOptions::new().append(true).open(huge).unwrap().write_all(b"more").unwrap();
    assert_eq!(finished(&mut browser), "failed");
    let have = text(&mut browser, "document.getElementById('problem').textContent");
    assert!(
        have.contains("huge.ubx has changed since it was chosen") && have.ends_with("choose it again."),
        "{have}"
    );
    browser.value("document.body.dataset.state = ''; document.getElementById('sample').click()").unwrap();
    assert_eq!(finished(&mut browser), "done");
}

/// The program cannot trap, so that here the system under it does: it fails at the second megabyte of
/// one file, which passes through the program as a trap of its own.
#[test]
fn a_trap_is_told_with_the_bytes_around_it_and_the_next_file_is_judged() {
    let Some(built) = Built::new() else { return };
    let page = std::fs::read_to_string(&built.path).unwrap();
    let (call, trap) =
        ("    fd_read: (fd, at, count, into) => {", "new WebAssembly.RuntimeError('unreachable')");
    assert_eq!(page.matches(call).count(), 1);
    let trapping =
        format!("{call} if (open.get(fd)?.name === 'trap.ubx' && open.get(fd).at > 1e6) throw {trap};");
    let other = built.file("trapping.html", page.replace(call, &trapping).as_bytes());
    let address = format!("file://{}", other.display());
    let mut browser = opened(Browser::open_in(built.browser, &address, DESK, "light", &[]).unwrap());
    let trap = built.file("trap.ubx", &[capture(5), vec![0; 2 << 20]].concat());
    assert_eq!(judged(&mut browser, &[trap]), "failed");
    let have = text(&mut browser, "document.getElementById('problem').textContent");
    assert!(have.contains("The program stopped, which it must not do (RuntimeError: unreachable)"), "{have}");
    browser
        .value("URL.createObjectURL = (blob) => { window.saved = blob.size; return 'blob:nothing'; }; 1")
        .unwrap();
    let offered = browser.value("document.getElementById('offer').hidden").unwrap();
    assert_eq!(offered, false, "{have}");
    browser
        .value("HTMLAnchorElement.prototype.click = () => {}; document.getElementById('around').click()")
        .unwrap();
    let saved = number(&mut browser, "window.saved");
    assert!((1e6..4.1e6).contains(&saved), "{saved} bytes");
    let next = built.file("next.rtcm3", &capture(5));
    assert_eq!(judged(&mut browser, &[next]), "done");
    assert_eq!(browser.value("document.getElementById('offer').hidden").unwrap(), true);
}

/// Changes some bytes, cuts, doubles or repeats a part of each file, judges the result and counts what
/// stopped the program. `SEEDS` are Base64, by name.
const MUTATED: &str = "(async () => {
  const seeds = SEEDS.map(([name, text]) => [name, Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0))]);
  let state = 1n;
  const random = (below) => {
    state = (state * 6364136223846793005n + 1442695040888963407n) & 0xffffffffffffffffn;
    return Number((state >> 33n) % BigInt(Math.max(1, below)));
  };
  const mutate = (bytes) => {
    const at = random(bytes.length), length = random(400);
    switch (random(5)) {
      case 0: return bytes.slice(0, at);
      case 1: return Uint8Array.from([...bytes.slice(0, at), ...bytes.slice(at + length)]);
      case 2: return Uint8Array.from([...bytes.slice(0, at), ...bytes.slice(at, at + length), ...bytes.slice(at)]);
      default: {
        const copy = bytes.slice();
        for (let count = 1 + random(20); count > 0; count--) copy[random(copy.length)] = random(3) ? random(256) : 255 * random(2);
        return copy;
      }
    }
  };
  const stopped = [], codes = [0, 0];
  let memory = 0;
  for (let number = 0; number < COUNT; number++) {
    const chosen = random(seeds.length);
    const files = seeds.filter(([name], index) => index === chosen || name.split('.')[0] === seeds[chosen][0].split('.')[0])
      .map(([name, bytes]) => ({ name, file: new File([mutate(bytes)], name) }));
    const names = files.map(({ name }) => name);
    const words = names.length === 1 ? names : ['--obs', names[0], '--nav', names[1]];
    const answer = await rai.ask(['rai', 'replay', ...words, '--report', 'report'], { files });
    if (answer.trap) stopped.push(`${number} ${names[0]}: ${answer.trap} ${answer.error}`);
    codes[answer.code] += 1;
    memory = Math.max(memory, answer.memory);
  }
  return JSON.stringify({ stopped, codes, memory });
})()";

/// Returns the corpus of a fuzzer in one file, as a receiver would send it: each piece alone holds no epoch.
fn corpus(fuzzer: &str) -> Vec<u8> {
    let folder = xtask::cargo::root().join("tests-host/fuzz/corpus").join(fuzzer);
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
    files.sort();
    files.iter().flat_map(|file| std::fs::read(file).unwrap()).take(30_000).collect()
}

/// Seeds are the formats that the page reads, and what fuzzers have found interesting; `RAI_MUTATED` says
/// how many files are made of them.
#[test]
fn mutated_files_never_stop_the_program() {
    let Some(built) = Built::new() else { return };
    let mut seeds =
        vec![("one.rtcm3", capture(5)[..12_000].to_vec()), ("packed.gz", gzip(&capture(5)[..8_000]))];
    seeds.extend(
        [
            ("fuzzed.rtcm3", "stream"),
            ("fuzzed2.ubx", "ubx"),
            ("fuzzed3.sbf", "sbf"),
            ("fuzzed4.ubx", "navigation_bits"),
        ]
        .map(|(name, fuzzer)| (name, corpus(fuzzer))),
    );
    let shared = [
        ("pair.obs", "data/cases/geo-inclined/geo.obs"),
        ("pair.nav", "data/cases/geo-inclined/geo.nav"),
        ("week.rtcm3", "data/cases/weekend-mixed.rtcm3"),
    ];
    seeds.extend(
        shared.iter().filter_map(|(name, path)| Some((*name, std::fs::read(rig::shared::path(path)?).ok()?))),
    );
    let packed =
        [("blocks.sbf", "data/sbf/mosaic_12s.sbf.gz"), ("frames.ubx", "data/ubx/static1hz_base.ubx.gz")];
    seeds.extend(packed.iter().filter_map(|(name, path)| {
        let mut bytes = Vec::new();
        let file = std::fs::File::open(rig::shared::path(path)?).ok()?;
        flate2::read::MultiGzDecoder::new(file).take(30_000).read_to_end(&mut bytes).ok()?;
        Some((*name, bytes))
    }));
    let count = std::env::var("RAI_MUTATED").unwrap_or_else(|_| "500".to_owned());
    let mut browser = built.open(DESK, "light");
    let seeds: Vec<_> = seeds.iter().map(|(name, bytes)| (name, base64_text(bytes))).collect();
    let script = MUTATED.replace("SEEDS", &serde_json::json!(seeds).to_string()).replace("COUNT", &count);
    // Longer than the browser's answer may take.
    browser
        .value(&format!("window.mutated = null; {script}.then((text) => {{ window.mutated = text; }}); 1"))
        .unwrap();
    browser.wait_for("window.mutated !== null", Duration::from_hours(2)).unwrap();
    let reported = text(&mut browser, "window.mutated");
    println!("{count} files: {reported}");
    let reported: serde_json::Value = serde_json::from_str(&reported).unwrap();
    assert_eq!(reported["stopped"], serde_json::json!([]));
    assert!(reported["codes"][0].as_u64() > Some(0) && reported["codes"][1].as_u64() > Some(0), "{reported}");
    assert!(reported["memory"].as_u64() < Some(64 << 20), "{reported}");
}
