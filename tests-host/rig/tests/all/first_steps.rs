//! Mistakes that a new user makes with a capture, and what `replay` answers.

use std::fs;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, Output};

use flate2::Compression;
use flate2::write::GzEncoder;
use raim::signal::encode::{Frequency, Selection, ubx};
use raim::signal::sky::raw::Simulation;

/// Epochs of the capture.
const EPOCHS: u32 = 20;

/// Returns the messages of a u-blox receiver in Xi'an: orbits first, then one epoch in each piece.
fn pieces() -> Vec<Vec<u8>> {
    let recording = Simulation::above_xian(3600.0, EPOCHS, 11).record();
    let selection = Selection::new("GCE", Frequency::Dual).unwrap();
    let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection, None);
    let time = recording.epochs[0].time;
    let orbits = recording.ephemerides.iter().flat_map(|set| ubx::pages(set, time).unwrap()).collect();
    let epochs = recording.epochs.iter().map(|epoch| encoder.epoch(epoch).unwrap());
    [orbits].into_iter().chain(epochs).collect()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(bytes).unwrap();
    packed.finish().unwrap()
}

/// A folder with files of one test.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(test);
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn write(&self, name: &str, bytes: &[u8]) {
        fs::write(self.0.join(name), bytes).unwrap();
    }

    fn replay(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rig"));
        command.current_dir(&self.0).arg("replay").args(arguments).output().unwrap()
    }

    /// Returns standard error of a replay that succeeds or fails, as `succeeds` says.
    #[track_caller]
    fn reported(&self, arguments: &[&str], succeeds: bool) -> String {
        let output = self.replay(arguments);
        let reported = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.success(), succeeds, "{arguments:?}: {reported}");
        reported
    }

    /// Returns the sentences of a replay.
    fn sentences(&self, captures: &[&str]) -> String {
        self.reported(&[captures, &["--nmea", "said.nmea"]].concat(), true);
        fs::read_to_string(self.0.join("said.nmea")).unwrap()
    }
}

#[test]
fn settings_and_faults_that_cannot_be_meant_are_answered_with_what_may_be() {
    let folder = Folder::new("first-settings");
    folder.write("day.ubx", &pieces().concat());
    for (arguments, want) in [
        (["--set", "MAKS=5"], "unknown key; is MASK meant?"),
        (["--set", "MASK=95"], "out of range; it takes 0 to 60 °"),
        (["--set", "PHASE=CRUISE"], "unknown value; it takes ENROUTE, TERMINAL"),
        (["--inject", "R03:+50@5.."], "--inject R03: GLONASS does not take part"),
        (["--ramp", "J01:1@5.."], "J01: QZSS does not take part"),
    ] {
        let reported = folder.reported(&[&["day.ubx"][..], &arguments].concat(), false);
        assert!(reported.contains(want), "{arguments:?}: {reported}");
    }
    let reported = folder.reported(&["day.ubx", "--inject", "R03:+50@5..", "--systems", "gcer"], false);
    assert!(reported.contains("R03 is never received"), "{reported}");
    let reported = folder.reported(&["ntrip://caster:2101/MOUNT"], false);
    assert!(reported.contains("rai run --input RECEIVER --caster ntrip://caster:2101/MOUNT"), "{reported}");
}

/// The sky is that of 34.125 N, 108.57 E.
#[test]
fn truth_whose_numbers_are_in_another_order_is_asked_about() {
    let folder = Folder::new("first-truth");
    folder.write("day.ubx", &pieces().concat());
    for (wrong, right) in [
        ("34.17,-108.57,400", "34.17,108.57,400"),
        ("5007000,-1683000,3563000", "-1683000,5007000,3563000"),
        ("1683000,5007000,3563000", "-1683000,5007000,3563000"),
    ] {
        let reported = folder.reported(&["day.ubx", "--truth", wrong], true);
        let is_asked = reported.contains(&format!("in another order? {right} is "));
        assert!(is_asked && reported.contains("km or more from every position"), "{reported}");
    }
    for wrong in ["108.57,34.17,400", "400,34.17,108.57"] {
        let reported = folder.reported(&["day.ubx", "--truth", wrong], false);
        assert!(reported.contains("of angles the latitude stands first"), "{reported}");
    }
    let reported = folder.reported(&["day.ubx", "--truth", "34.17,108.57,400"], true);
    assert!(!reported.contains("order"), "{reported}");
}

#[test]
fn gzip_file_that_is_cut_off_is_read_as_far_as_it_goes() {
    let folder = Folder::new("first-cut");
    let packed = gzip(&pieces().concat());
    folder.write("cut.ubx.gz", &packed[..packed.len() * 3 / 4]);
    folder.write("whole.ubx.gz", &packed);
    let reported = folder.reported(&["cut.ubx.gz"], true);
    assert!(reported.contains("cut.ubx.gz is cut off, and read as far as the gzip data goes"), "{reported}");
    let (cut, whole) = (folder.sentences(&["cut.ubx.gz"]), folder.sentences(&["whole.ubx.gz"]));
    let epochs = [&cut, &whole].map(|text| text.matches("$PRAIS").count());
    assert!(epochs[0] >= 5 && epochs[0] < epochs[1], "{epochs:?}");
    // The last epoch may be that which the end cuts.
    let common = cut.rfind("$GNRMC").unwrap();
    assert_eq!(cut[..common], whole[..common]);
    assert!(!folder.reported(&["whole.ubx.gz"], true).contains("cut off"));
    // Bytes that changed are another matter.
    let mut spoilt = packed.clone();
    let last = spoilt.len() - 5;
    spoilt[last] ^= 1;
    folder.write("spoilt.ubx.gz", &spoilt);
    assert!(folder.reported(&["spoilt.ubx.gz"], false).contains("damaged gzip"));
}

/// A logger begins a new file after so many bytes, inside a frame.
#[test]
fn several_captures_of_one_logger_are_read_in_the_order_of_time() {
    let folder = Folder::new("first-series");
    let (pieces, bytes) = (pieces(), pieces().concat());
    let (first, rest) = bytes.split_at(pieces[..8].concat().len() + 100);
    let (second, third) = rest.split_at(rest.len() / 2 + 3);
    folder.write("whole.ubx", &bytes);
    folder.write("b.ubx", first);
    folder.write("c.ubx.gz", &gzip(second));
    folder.write("a.ubx", third);
    let want = folder.sentences(&["whole.ubx"]);
    for captures in [["a.ubx", "b.ubx", "c.ubx.gz"], ["c.ubx.gz", "b.ubx", "a.ubx"]] {
        assert_eq!(folder.sentences(&captures), want, "{captures:?}");
    }
    let reported = folder.reported(&["a.ubx", "b.ubx", "c.ubx.gz"], true);
    assert!(reported.contains("reading b.ubx, c.ubx.gz, a.ubx in the order of their time"), "{reported}");
    for (captures, want) in [
        (["b.ubx", "b.ubx"], "begin with the same epoch"),
        (["b.ubx", "-"], "several captures must be files, and - is none"),
        (["b.ubx", "no.ubx"], "several captures must be files, and no.ubx is none"),
    ] {
        assert!(folder.reported(&captures, false).contains(want));
    }
}
