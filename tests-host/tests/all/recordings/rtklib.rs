//! RTKLIB reads the stream: an independent reader of RTCM, and an independent position.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use raim::signal::calendar::readable;
use raim::signal::encode::{Frequency, Selection};
use raim::signal::recording::Recording;
use raim_core::frame::{Ecef, LocalFrame};

use super::{ESBC, STATIC1HZ, lumps};

/// Returns the horizontal and vertical distance of RTKLIB's mean single-point position from the
/// truth, m, and the number of epochs that it solved.
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
    // RTCM has only the time within the week, so the week is given here.
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

/// Returns options for single point positions of GPS, Galileo and `BeiDou`, with earth-fixed
/// coordinates.
fn rtklib_options(frequency: Frequency) -> String {
    let ionosphere = if frequency == Frequency::Dual { "dual-freq" } else { "brdc" };
    format!(
        "pos1-posmode=single\npos1-elmask=10\npos1-ionoopt={ionosphere}\npos1-tropopt=saas\npos1-navsys=41\n\
         out-solformat=xyz\n"
    )
}

/// Puts the recording's ionosphere coefficients, which no RTCM message carries, into a navigation
/// file.
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

/// Parses date, time, x, y, z of a solution line.
fn position(line: &str) -> Option<Ecef> {
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    let coordinate = |index: usize| words.get(index)?.parse().ok();
    let is_solution = !line.starts_with('%');
    is_solution.then(|| Some(Ecef::new(coordinate(2)?, coordinate(3)?, coordinate(4)?)))?
}

#[test]
fn rtklib_finds_the_antenna_in_the_stream() {
    if Command::new("convbin").output().is_err() || Command::new("rnx2rtkp").output().is_err() {
        return rig::skip::say("convbin and rnx2rtkp (Debian package rtklib)");
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
        let stream = lumps(&recording, Selection::new(letters, frequency).unwrap()).concat();
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
