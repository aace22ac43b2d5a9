//! A file that `--input` names, and settings in every form.

use std::fs::File;
use std::process::{Output, Stdio};

use super::*;

/// Runs the service as a program of its own with these arguments.
fn run(arguments: &str, input: impl Into<Stdio>) -> Output {
    service(arguments).stdin(input).output().unwrap()
}

/// Returns the sentences in the output of a test program, which prints lines of its own around
/// them.
fn sentences(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout);
    let start = text.find('$').expect("a sentence");
    text[start..].lines().take_while(|line| line.starts_with('$')).collect::<Vec<_>>().join("\n")
}

#[test]
fn named_file_is_read_as_the_same_file_on_standard_input() {
    let folder = tempfile::tempdir().unwrap();
    let capture = folder.path().join("capture.ubx");
    fs::write(&capture, pieces(30).concat()).unwrap();
    let want = sentences(&run("--input=-", File::open(&capture).unwrap()));
    assert_eq!(want.matches("$PRAIS").count(), 30);
    let named = run(&format!("--input={}", capture.display()), Stdio::null());
    assert_eq!(sentences(&named), want);
    // The key in any case, and an order beside settings, as in `replay`.
    let set = |key: &str| {
        sentences(&run(&format!("--input=-\n--set={key}\n--set=confirm"), File::open(&capture).unwrap()))
    };
    assert_eq!(set("hal=40"), set("HAL=40"));
    assert_ne!(set("hal=40"), want);
}

#[test]
fn unknown_setting_is_refused_each_time() {
    for _ in 0..6 {
        let output = run("--input=-\n--set=FOO=40", Stdio::null());
        let error = String::from_utf8_lossy(&output.stderr) + String::from_utf8_lossy(&output.stdout);
        assert!(!output.status.success() && error.contains("unknown key"), "{error}");
    }
}
