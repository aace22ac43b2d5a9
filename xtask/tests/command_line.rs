//! The list of commands, and wrong command lines: exit code 1, and one line that names the error.

use std::process::{Command, Output};

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_xtask")).args(arguments).output().unwrap()
}

#[test]
fn help_is_no_error_and_no_command_shows_it() {
    for help in ["help", "--help", "-h"] {
        let output = run(&[help]);
        let reported = String::from_utf8(output.stdout).unwrap();
        assert!(
            output.status.success() && reported.contains("\n  demo ") && reported.contains("\n  test "),
            "{reported}"
        );
    }
    let bare = run(&[]);
    assert_eq!(bare.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&bare.stderr).contains("\n  replay "));
    let output = run(&["test", "--help"]);
    assert!(output.status.success() && String::from_utf8_lossy(&output.stdout).contains("--quick"));
}

#[test]
fn wrong_command_line_is_one_line_that_names_the_error() {
    for (arguments, want) in [
        (&["fly"][..], "`fly`"),
        (&["setup", "--wings"], "--wings"),
        (&["setup", "--check", "--consumers"], "--check"),
        (&["coverage", "--wings"], "--wings"),
    ] {
        let output = run(arguments);
        let reported = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {reported}");
        assert!(
            reported.starts_with("error: ") && reported.lines().count() == 1,
            "{arguments:?}: {reported}"
        );
        assert!(reported.contains(want), "{arguments:?}: {reported}");
    }
}
