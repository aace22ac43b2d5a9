//! Recordings: what the readers make of real RINEX, and what the wire makes of it.
#![allow(missing_docs, clippy::inconsistent_digit_grouping)]

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use rai_core::frame::{Ecef, LocalFrame};
use rai_core::satellite::Constellation;
use tests_host::encode::{Encoder, Frequency, Selection};
use tests_host::recording::{Recording, readable};
use tests_host::shared;

/// A reference recording: observations and navigation.
struct Files(&'static str, &'static str);

const ESBC: Files = Files(
    "data/esbc/ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz",
    "data/esbc/ESBC00DNK_R_20201770000_01D_MN.rnx.gz",
);
const STATIC1HZ: Files = Files("data/static1hz/base.obs.gz", "data/static1hz/base.nav.gz");
const TLSE: Files = Files(
    "data/tlse/TLSE00FRA_R_20240011200_15M_01S_MO.crx.gz",
    "data/tlse/BRDC00IGS_R_20240010000_01D_MN.rnx.gz",
);
const KMS3: Files = Files(
    "data/kms3/KMS300DNK_R_20221591000_01H_30S_MO.crx",
    "data/kms3/KMS300DNK_R_20221591000_01H_MN.rnx.gz",
);
const DGAR: Files = Files("data/dgar/dgar0100.24o.gz", "data/dgar/brdc0100.24n.gz");

impl Files {
    fn paths(&self) -> Option<(PathBuf, PathBuf)> {
        Some((shared::path_or_skip(self.0)?, shared::path_or_skip(self.1)?))
    }

    fn load(&self) -> Option<Recording> {
        let (observations, navigation) = self.paths()?;
        Some(Recording::load(&[observations], &[navigation]).unwrap())
    }
}

/// Epochs; satellites and pseudoranges of GPS, Galileo and `BeiDou`; and the sum of the pseudoranges in mm.
#[derive(Debug, PartialEq)]
struct Tally {
    epochs: usize,
    satellites: usize,
    pseudoranges: usize,
    sum_mm: i64,
}

fn tally(recording: &Recording) -> Tally {
    let satellites = || recording.epochs.iter().flat_map(|epoch| &epoch.satellites);
    let used = || satellites().filter(|of| of.satellite.constellation() != Constellation::Glonass);
    let signals = || used().flat_map(|satellite| &satellite.signals);
    Tally {
        epochs: recording.epochs.len(),
        satellites: used().count(),
        pseudoranges: signals().count(),
        sum_mm: signals().map(|signal| (signal.pseudorange_m * 1000.0).round() as i64).sum(),
    }
}

#[test]
fn real_recordings_hold_what_an_independent_reader_counts() {
    // Counted by a script over the plain text that the reference implementation of crx2rnx (4.1.0) makes.
    let want = [
        (
            ESBC,
            Tally { epochs: 2880, satellites: 91_093, pseudoranges: 309_887, sum_mm: 7_963_399_453_651_985 },
        ),
        (
            STATIC1HZ,
            Tally { epochs: 301, satellites: 13_740, pseudoranges: 37_016, sum_mm: 1_077_847_447_197_544 },
        ),
        (
            TLSE,
            Tally { epochs: 900, satellites: 28_105, pseudoranges: 113_529, sum_mm: 2_902_666_146_184_980 },
        ),
        (KMS3, Tally { epochs: 19, satellites: 616, pseudoranges: 2709, sum_mm: 71_140_231_178_837 }),
        (
            DGAR,
            Tally { epochs: 2880, satellites: 58_208, pseudoranges: 253_521, sum_mm: 6_166_681_397_682_689 },
        ),
    ];
    for (files, want) in want {
        let start = std::time::Instant::now();
        let Some(recording) = files.load() else { continue };
        println!("{} read in {:.1?}, {} ephemerides", files.0, start.elapsed(), recording.ephemerides.len());
        assert_eq!(tally(&recording), want, "{}", files.0);
    }
}

/// All of a recording as a receiver would send it.
fn stream(recording: &Recording, selection: Selection) -> Vec<u8> {
    let mut encoder = Encoder::new(&recording.ephemerides, selection);
    let stream = recording.epochs.iter().flat_map(|epoch| encoder.epoch(epoch).unwrap()).collect();
    assert_eq!(encoder.unsendable(), 0);
    stream
}

/// The horizontal and vertical distance of RTKLIB's mean single-point position from the truth, m, and how many
/// epochs it solved.
fn rtklib_position(
    folder: &Path,
    stream: &[u8],
    frequency: Frequency,
    recording: &Recording,
    truth: Ecef,
) -> (f64, f64, usize) {
    let file = |name: &str| folder.join(name).into_os_string();
    std::fs::write(file("a.rtcm3"), stream).unwrap();
    let mut convbin = Command::new("convbin");
    // RTCM says the time within the week; the week is given here.
    convbin
        .args(["-r", "rtcm3", "-v", "3.03", "-tr"])
        .args(readable(recording.epochs[0].time).replace('-', "/").split(' '));
    convbin.args([OsString::from("-o"), file("a.obs"), "-n".into(), file("a.nav"), file("a.rtcm3")]);
    assert!(convbin.output().unwrap().status.success(), "convbin");
    add_klobuchar(Path::new(&file("a.nav")), recording);
    std::fs::write(file("a.conf"), rtklib_options(frequency)).unwrap();
    let mut rnx2rtkp = Command::new("rnx2rtkp");
    let output = rnx2rtkp.args(["-k".into(), file("a.conf"), file("a.obs"), file("a.nav")]).output().unwrap();
    let positions: Vec<Ecef> =
        String::from_utf8(output.stdout).unwrap().lines().filter_map(position).collect();
    let count = positions.len();
    let sum = positions.iter().fold(Ecef::CENTRE, |sum, position| sum + *position);
    let mean = Ecef::new(sum.x_m / count as f64, sum.y_m / count as f64, sum.z_m / count as f64);
    let error = LocalFrame::at(truth).rotate(mean - truth);
    (error.horizontal(), error.up.abs(), count)
}

/// Single point positions of GPS, Galileo and `BeiDou`, earth-fixed coordinates out.
fn rtklib_options(frequency: Frequency) -> String {
    let ionosphere = if frequency == Frequency::Dual { "dual-freq" } else { "brdc" };
    format!(
        "pos1-posmode=single\npos1-elmask=10\npos1-ionoopt={ionosphere}\npos1-tropopt=saas\npos1-navsys=41\n\
         out-solformat=xyz\n"
    )
}

/// Puts the recording's ionosphere coefficients, which no RTCM message carries, into a navigation file.
fn add_klobuchar(path: &Path, recording: &Recording) {
    let k = recording.klobuchar.unwrap();
    let line = |name: &str, k: &[f64]| {
        format!("{name} {:12.4e}{:12.4e}{:12.4e}{:12.4e}       IONOSPHERIC CORR\n", k[0], k[1], k[2], k[3])
    };
    let lines = line("GPSA", &k[..4]) + &line("GPSB", &k[4..]);
    let text = std::fs::read_to_string(path).unwrap();
    let end = text.find("END OF HEADER").and_then(|label| text[..label].rfind('\n')).unwrap() + 1;
    std::fs::write(path, format!("{}{lines}{}", &text[..end], &text[end..])).unwrap();
}

/// Date, time, x, y, z of a solution line.
fn position(line: &str) -> Option<Ecef> {
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    let coordinate = |index: usize| words.get(index)?.parse().ok();
    let is_solution = !line.starts_with('%');
    is_solution.then(|| Some(Ecef::new(coordinate(2)?, coordinate(3)?, coordinate(4)?)))?
}

#[test]
fn rtklib_finds_the_antenna_in_the_stream() {
    if Command::new("convbin").output().is_err() || Command::new("rnx2rtkp").output().is_err() {
        eprintln!("skipped: needs convbin and rnx2rtkp (Debian package rtklib)");
        return;
    }
    let esbc = Ecef::new(3_582_104.9254, 532_590.2381, 5_232_755.2669);
    let static1hz = Ecef::new(-3_817_681.1213, 3_562_839.4311, 3_650_159.1593);
    let folder = tempfile::tempdir().unwrap();
    for (files, letters, frequency, truth) in [
        (STATIC1HZ, "GCE", Frequency::Dual, static1hz),
        (ESBC, "GCE", Frequency::Dual, esbc),
        (ESBC, "GC", Frequency::Single, esbc),
    ] {
        let Some(mut recording) = files.load() else { continue };
        recording.epochs.truncate(480);
        let stream = stream(&recording, Selection::new(letters, frequency).unwrap());
        let (horizontal_m, vertical_m, count) =
            rtklib_position(folder.path(), &stream, frequency, &recording, truth);
        println!(
            "{letters} {frequency:?}: {count} epochs, {horizontal_m:.2} m, {vertical_m:.2} m of {}",
            files.0
        );
        assert!(count * 100 >= recording.epochs.len() * 99, "{}: {count} solutions", files.0);
        assert!(
            horizontal_m < 3.0 && vertical_m < 3.0,
            "{letters} {frequency:?}: {horizontal_m} {vertical_m}"
        );
    }
}
