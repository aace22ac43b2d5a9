//! Sentences, table and report, beside those of the program `rai` on the same files.

use oracle::browser::firefox::Firefox;
use rig::shared;

use super::server::serve;
use super::*;

/// Recordings of the reference folder; the files of each make one.
const RECORDINGS: [&[&str]; 25] = [
    &["ubx/static1hz_base.ubx.gz"],
    &["ubx/static1hz_rover_f9p_noise.ubx.gz"],
    &["ubx/tlse_x20p_fnav.ubx.gz"],
    &["ubx/urban_m8t.ubx.gz"],
    &["ubx/esbc_4h.ubx.gz"],
    &["sbf/mosaic_12s.sbf.gz"],
    &["sbf/static1hz_base.sbf.gz"],
    &["sbf/tlse_x20p_fnav.sbf.gz"],
    &["real/f9r_rtcm_ubx.log.gz"],
    &["real/gmsd7_2012.rtcm3.gz"],
    &["real/x20p_walk.ubx.gz", "real/x20p_walk_truth.csv"],
    &["consumer/car_shanghai.rtcm3.gz"],
    &["consumer/car_berlin.obs.gz", "consumer/car_berlin.nav.gz"],
    &["dgar/dgar0100.24o.gz", "dgar/brdc0100.24n.gz"],
    &["esbc/ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz", "esbc/ESBC00DNK_R_20201770000_01D_MN.rnx.gz"],
    &["kms3/KMS300DNK_R_20221591000_01H_30S_MO.crx", "kms3/KMS300DNK_R_20221591000_01H_MN.rnx.gz"],
    &["static1hz/base.obs.gz", "static1hz/base.nav.gz"],
    &["tlse/TLSE00FRA_R_20240011200_15M_01S_MO.crx.gz", "tlse/BRDC00IGS_R_20240010000_01D_MN.rnx.gz"],
    &["urban/car.obs.gz", "urban/beidou.nav.gz", "urban/gps.nav.gz", "urban/truth.csv"],
    &["cases/weekend-mixed.rtcm3"],
    &["cases/weekend-gps.rtcm3"],
    &["cases/geo-inclined/geo.obs", "cases/geo-inclined/geo.nav"],
    &["cases/no-first-band/nfb.obs", "cases/no-first-band/nfb.nav"],
    &["sbas/cres.obs.gz", "sbas/cres.nav.gz"],
    &["static1hz/rover.obs.gz", "static1hz/base.nav.gz"],
];

/// What the page offers to save, with the names that `rai replay` gives to the same.
const OUTPUTS: [(&str, &str); 3] =
    [("sentences", "sentences.nmea"), ("table", "epochs.csv"), ("report", "report/report.html")];

/// Results of the program `rai` for files.
struct Wanted {
    folder: tempfile::TempDir,
    line: String,
}

impl Wanted {
    /// Replays by the command that the page shows, in a folder with the same files.
    fn of(rai: &Path, line: String, files: &[PathBuf]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for file in files {
            std::fs::copy(file, folder.path().join(name(file))).unwrap();
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(words[..2], ["rai", "replay"], "{line}");
        let output = Command::new(rai).args(&words[1..]).current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        Self { folder, line }
    }

    /// Compares with what the page has.
    fn compare(&self, page: &mut impl Tab) {
        let line = &self.line;
        assert_eq!(command(page), *line);
        for (key, file) in OUTPUTS {
            let want = std::fs::read_to_string(self.folder.path().join(file)).unwrap();
            let have = text(page, &format!("rai.outputs().{key}.text()"));
            assert!(want.len() > 100, "{line}: {file} is short");
            let differs = have.lines().zip(want.lines()).find(|(have, want)| have != want);
            assert!(have == want, "{line}: {file} differs: {differs:?}");
        }
    }
}

/// Returns the command that gives the same on a computer.
fn command(page: &mut impl Tab) -> String {
    text(page, "document.getElementById('line').textContent")
}

fn compare(browser: &mut impl Tab, rai: &Path, files: &[PathBuf]) {
    Wanted::of(rai, command(browser), files).compare(browser);
}

/// Returns the files of a recording, if they are here.
fn found(files: &[&str]) -> Option<Vec<PathBuf>> {
    files.iter().map(|file| shared::path_or_skip(&format!("data/{file}"))).collect()
}

#[test]
fn page_says_of_the_sample_what_the_program_says_with_and_without_a_fault() {
    let Some(built) = Built::new() else { return };
    let (rai, mut browser) = (program(), built.open(DESK, "light"));
    let sample = built.file("sample.rtcm3", b"");
    for (button, want) in
        [("sample", "all the time, in 60 epochs."), ("faulty", "left out: G06 (in 20 epochs).")]
    {
        browser.value("document.body.dataset.state = ''").unwrap();
        browser.value(&format!("document.getElementById('{button}').click()")).unwrap();
        assert_eq!(finished(&mut browser), "done");
        let plain = text(&mut browser, "document.getElementById('plain').textContent");
        assert!(plain.ends_with(want), "{plain}");
        let bytes = text(
            &mut browser,
            "rai.files()[0].arrayBuffer().then((all) => btoa(Array.from(new Uint8Array(all), (one) => String.fromCharCode(one)).join('')))",
        );
        std::fs::write(&sample, unpacked(&bytes)).unwrap();
        compare(&mut browser, &rai, std::slice::from_ref(&sample));
    }
    // A setting judges again.
    browser.value("document.body.dataset.state = ''; const one = document.getElementById('set-PHASE'); one.value = 'LPV200'; one.dispatchEvent(new Event('change', {bubbles: true}))").unwrap();
    assert_eq!(finished(&mut browser), "done");
    let line = text(&mut browser, "document.getElementById('line').textContent");
    assert!(line.contains("--set PHASE=LPV200"), "{line}");
    compare(&mut browser, &rai, &[sample]);
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn page_says_of_every_recording_what_the_program_says_from_a_disk_and_from_a_server() {
    let Some(built) = Built::new() else { return };
    let rai = program();
    let (served, _) = serve(std::fs::read(&built.path).unwrap());
    let mut pages = [built.address(), served]
        .map(|address| opened(Browser::open_in(built.browser, &address, DESK, "light", &[]).unwrap()));
    for files in RECORDINGS {
        let Some(files) = found(files) else { return };
        let mut wanted = None;
        for page in &mut pages {
            let state = judged(page, &files);
            assert_eq!(state, "done", "{files:?}: {}", text(page, "document.body.innerText"));
            wanted.get_or_insert_with(|| Wanted::of(&rai, command(page), &files)).compare(page);
            println!(
                "{}: {:.2} s, {:.1} MiB",
                name(&files[0]),
                number(page, "document.getElementById('work').dataset.took") * 1e-3,
                number(page, "document.getElementById('work').dataset.memory") / f64::from(1 << 20)
            );
        }
    }
    for page in pages {
        assert_eq!(page.complaints, [""; 0]);
    }
}

/// Another engine compiles the program and answers its system calls with the same results, for every
/// recording from a disk and for the first ones from a server.
#[test]
fn firefox_says_the_same() {
    let Some(built) = Built::new() else { return };
    let (served, _) = serve(std::fs::read(&built.path).unwrap());
    let rai = program();
    for (address, count) in [(built.address(), RECORDINGS.len()), (served, 2)] {
        let Some(mut page) = Firefox::open(&address).unwrap() else {
            return skip::say("Firefox (apt-get install firefox-esr)");
        };
        page.wait_for("Boolean(document.body?.dataset.ready)", 4 * PATIENCE).unwrap();
        // It offers a port where the browser has some.
        let agrees = "document.getElementById('ports').hidden === !('serial' in navigator)";
        assert_eq!(page.value(agrees).unwrap(), true);
        for files in RECORDINGS.into_iter().take(count) {
            let Some(files) = found(files) else { return };
            let state = judged(&mut page, &files);
            assert_eq!(state, "done", "{files:?}: {}", text(&mut page, "document.body.innerText"));
            compare(&mut page, &rai, &files);
        }
    }
}

/// Returns the bytes of Base64 (RFC 4648).
fn unpacked(text: &str) -> Vec<u8> {
    let value = |letter: u8| match letter {
        b'A'..=b'Z' => u32::from(letter - b'A'),
        b'a'..=b'z' => u32::from(letter - b'a') + 26,
        b'0'..=b'9' => u32::from(letter - b'0') + 52,
        b'+' => 62,
        _ => 63,
    };
    let mut bytes = Vec::new();
    for four in text.as_bytes().chunks(4) {
        let known = four.iter().filter(|letter| **letter != b'=').count();
        let bits =
            four.iter().take(known).fold(0, |bits, letter| bits << 6 | value(*letter)) << (6 * (4 - known));
        bytes.extend(bits.to_be_bytes()[1..known].iter());
    }
    bytes
}
