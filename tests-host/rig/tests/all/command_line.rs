//! Wrong command lines: exit code 1, and one line that names the error and its place.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

/// One epoch of two satellites.
const OBSERVATIONS: &str = "     3.04           OBSERVATION DATA    M                   RINEX VERSION / TYPE
G    1 C1C                                                  SYS / # / OBS TYPES
C    1 C2I                                                  SYS / # / OBS TYPES
                                                            END OF HEADER
> 2024 06 24 08 00  0.0000000  0  2
G02  24503597.381
C05  41654777.792
";

/// One ephemeris, two hours later.
const NAVIGATION: &str = include_str!("../../../vectors/one_ephemeris.nav");

/// Files of one test, in a separate folder.
struct Files(PathBuf);

impl Files {
    fn new(test: &str) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(test);
        fs::create_dir_all(&folder).unwrap();
        let files = Self(folder);
        files.write("day.obs", OBSERVATIONS);
        files.write("day.nav", NAVIGATION);
        files
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.0.join(name), text).unwrap();
    }

    /// Runs a command in the folder.
    fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_rig")).current_dir(&self.0).args(arguments).output().unwrap()
    }

    /// Runs a command that is refused; returns its one line.
    fn refusal(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let reported = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {reported}");
        assert!(output.stdout.is_empty(), "{arguments:?}: {:?}", output.stdout);
        let [line] = reported.lines().collect::<Vec<_>>()[..] else { panic!("{arguments:?}: {reported}") };
        assert!(line.starts_with("error: "), "{arguments:?}: {line}");
        line.to_owned()
    }

    /// Returns the refusal of a replay of the day with more arguments.
    fn replay(&self, more: &[&str]) -> String {
        self.refusal(&[&["replay", "--obs", "day.obs", "--nav", "day.nav"], more].concat())
    }
}

fn assert_says(line: &str, wanted: &[&str]) {
    for want in wanted {
        assert!(line.contains(want), "have {line}, want {want}");
    }
}

#[test]
fn a_missing_file_is_named() {
    let files = Files::new("missing");
    let line = files.refusal(&["replay", "--obs", "no.obs", "--nav", "day.nav"]);
    assert_says(&line, &["observation file no.obs", "cannot be read"]);
    let line = files.refusal(&["replay", "--obs", "day.obs", "--nav", "no.nav"]);
    assert_says(&line, &["navigation file no.nav", "cannot be read"]);
    assert_says(&files.replay(&["--truth-csv", "no.csv"]), &["truth file no.csv"]);
}

#[test]
fn an_empty_file_is_named() {
    let files = Files::new("empty");
    files.write("empty", "");
    let line = files.refusal(&["replay", "--obs", "empty", "--nav", "day.nav"]);
    assert_says(&line, &["observation file empty", "is empty"]);
    let line = files.refusal(&["replay", "--obs", "day.obs", "--nav", "empty"]);
    assert_says(&line, &["navigation file empty", "is empty"]);
    assert_says(&files.replay(&["--truth-csv", "empty"]), &["empty: holds no position"]);
}

#[test]
fn a_navigation_file_of_another_day_is_told_with_both_times() {
    let files = Files::new("another_day");
    let other = NAVIGATION.replace("2024 06 24", "2024 06 25").replace("1.2240000", "2.0880000");
    files.write("other.nav", &other);
    let line = files.refusal(&["replay", "--obs", "day.obs", "--nav", "other.nav"]);
    assert_says(&line, &["other.nav", "2024-06-24 08:00:00", "2024-06-25 10:00:00"]);
}

#[test]
fn observations_of_two_receivers_are_refused_with_both_names() {
    let files = Files::new("two_receivers");
    files.write("other.obs", &OBSERVATIONS.replace("24503597", "24503697"));
    let line = files.refusal(&["replay", "--obs", "day.obs", "--obs", "other.obs", "--nav", "day.nav"]);
    assert_says(&line, &["day.obs and other.obs are recordings of two receivers", "give one of the two"]);
    // A copy is the same receiver; what is refused then is that there are too few satellites.
    files.write("copy.obs", OBSERVATIONS);
    let output = files.run(&["replay", "--obs", "day.obs", "--obs", "copy.obs", "--nav", "day.nav"]);
    assert!(!String::from_utf8_lossy(&output.stderr).contains("two receivers"));
}

#[test]
fn an_unknown_satellite_is_told_with_those_that_there_are() {
    let files = Files::new("satellite");
    let line = files.replay(&["--inject", "G31:+80@0..10"]);
    assert_says(&line, &["G31 is never received", "G02", "C05"]);
    for name in ["X05", "G5x", "Q07", "G123"] {
        let line = files.replay(&["--inject", &format!("{name}:+80@0..10")]);
        assert_says(&line, &[&format!("`{name}`"), "at character 1"]);
    }
    assert_says(&files.replay(&["--ramp", "E99:0.5@0.."]), &["E99 is never received"]);
}

#[test]
fn a_truth_that_is_no_position_is_told_with_an_example() {
    let files = Files::new("truth");
    files.write("degrees.csv", "week,tow,lat,lon\n2320,115200,55,8\n");
    assert_says(
        &files.replay(&["--truth-csv", "degrees.csv"]),
        &["week,tow,lat,lon", "lat_deg,lon_deg,height_m"],
    );
    for truth in ["here", "1,2", "1,2,three", "0,0,0", "nan,0,6400000", "1e9,1e9,1e9", ""] {
        assert_says(&files.replay(&["--truth", truth]), &["truth", &format!("{truth:?}")]);
    }
    files.write("truth.csv", "week,tow,x_m,y_m,z_m\n2320,115200,6378137,2,3\n2320,115201,6378137,2\n");
    assert_says(&files.replay(&["--truth-csv", "truth.csv"]), &["truth.csv: line 3"]);
}

#[test]
fn usage_errors_are_one_line_that_names_the_argument() {
    let files = Files::new("usage");
    assert_says(&files.refusal(&["replay"]), &["--obs", "--nav"]);
    assert_says(&files.refusal(&["replay", "--obs"]), &["--obs"]);
    assert_says(&files.refusal(&["fly"]), &["fly"]);
    assert_says(&files.replay(&["--form", "3"]), &["--form"]);
    assert_says(&files.replay(&["--from", "noon"]), &["noon", "--from"]);
    assert_says(&files.replay(&["--on", "moon"]), &["moon", "host", "board"]);
    assert_says(&files.replay(&["--systems", "GX"]), &["system `X` of `GX`"]);
    assert_says(&files.replay(&["--phase", "LUNCH"]), &["LUNCH", "--phase", "LPV200"]);
    assert_says(&files.replay(&["--method", "GUESS"]), &["GUESS", "--method", "GROUPING"]);
    assert_says(&files.replay(&["--policy", "T3"]), &["T3", "--policy", "TOP"]);
    assert_says(&files.replay(&["--every", "-1"]), &["-1", "--every", "not negative"]);
    assert_says(&files.replay(&["--phase", "CUSTOM"]), &["--phase CUSTOM", "--set HAL="]);
    assert_says(&files.replay(&["--set", "HAL"]), &["--set HAL", "HAL=40"]);
    assert_says(&files.replay(&["--set", "HAL=wide"]), &["HAL=wide"]);
}

#[test]
fn help_is_no_error_and_no_command_shows_it() {
    let files = Files::new("help");
    let help = files.run(&["help"]);
    assert!(help.status.success() && String::from_utf8_lossy(&help.stdout).contains("replay"));
    let bare = files.run(&[]);
    assert_eq!(bare.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&bare.stderr).contains("replay"));
}

#[test]
fn a_full_disk_is_noticed() {
    let files = Files::new("full");
    for option in ["--csv", "--nmea", "--rtcm"] {
        assert_says(&files.replay(&[option, "/dev/full"]), &["cannot write /dev/full", "No space left"]);
    }
}

#[test]
fn a_line_that_cannot_be_read_is_counted_in_words_and_in_json() {
    let files = Files::new("skipped");
    let damaged = OBSERVATIONS.replace("C05  41654777.792", "C05  4165A777.792");
    files.write("day.obs", &damaged);
    assert_says(
        &files.replay(&[]),
        &["observation file day.obs: 1 of 7 lines cannot be read, at most a tenth may be lost", "line 7"],
    );
    let later = OBSERVATIONS.lines().skip(4).collect::<Vec<_>>().join("\n").replace("00  0.0", "00 30.0");
    files.write("day.obs", &format!("{damaged}{later}\n"));
    let arguments = ["replay", "--obs", "day.obs", "--nav", "day.nav", "--systems", "G"];
    let reported = String::from_utf8(files.run(&arguments).stdout).unwrap();
    assert!(reported.contains("records skipped    1 damaged; first flaw: day.obs, line 7\n"), "{reported}");
    let output = files.run(&[&arguments[..], &["--json"]].concat());
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&summary["epochs"], &summary["skipped"]["damaged"]), (&2.into(), &1.into()), "{summary}");
    let first = &summary["skipped"]["first"];
    assert_eq!((&first["file"], &first["line"]), (&"day.obs".into(), &7.into()), "{summary}");
}

#[test]
fn without_a_truth_nothing_is_said_of_misleading_epochs() {
    let files = Files::new("no_truth");
    let output = files.run(&["replay", "--obs", "day.obs", "--nav", "day.nav"]);
    let reported = String::from_utf8(output.stdout).unwrap();
    assert!(reported.contains("unknown: --truth") && !reported.contains("misleading"), "{reported}");
    let output = files.run(&["replay", "--obs", "day.obs", "--nav", "day.nav", "--json"]);
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(summary["misleading"].is_null() && summary["hazardous"].is_null(), "{summary}");
}

#[test]
fn help_lists_the_values_of_an_option() {
    let files = Files::new("values");
    let help = String::from_utf8(files.run(&["replay", "--help"]).stdout).unwrap();
    for value in ["ENROUTE", "CUSTOM", "TOP", "BAARDA", "RANSAC"] {
        assert!(help.contains(value), "{value}: {help}");
    }
}

#[test]
fn every_setting_and_every_word_of_the_module_is_obeyed() {
    let files = Files::new("settings");
    for setting in raim::replay::every() {
        let output = files.run(&["replay", "--obs", "day.obs", "--nav", "day.nav", "--set", &setting]);
        let errors = String::from_utf8(output.stderr).unwrap();
        // Two satellites have no position; the command finds nothing else wrong.
        let [line] = errors.lines().collect::<Vec<_>>()[..] else { panic!("{setting}: {errors}") };
        assert_says(line, &["no epoch gave a position"]);
    }
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let files = Files::new("pipe");
    for arguments in
        [&["help"][..], &["replay", "--help"], &["replay", "--obs", "day.obs", "--nav", "day.nav", "--json"]]
    {
        // The reader is closed before the command starts, because the command might otherwise
        // finish first.
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = Command::new(env!("CARGO_BIN_EXE_rig"))
            .current_dir(&files.0)
            .args(arguments)
            .stdout(writer)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
            .wait_with_output()
            .unwrap();
        let reported = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            output.status.success() && reported.is_empty(),
            "{arguments:?}: {:?} {reported}",
            output.status.code()
        );
    }
}
