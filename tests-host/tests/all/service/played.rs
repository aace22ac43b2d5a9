//! A file on standard input: the service prints what `replay` prints for it.

use std::fs::File;
use std::process::Command;

use raim::replay::command;

use super::endurance::ARGUMENTS;
use super::*;

/// The command line of `replay`.
#[derive(clap::Parser)]
struct Line {
    #[command(flatten)]
    arguments: command::Arguments,
}

#[test]
fn file_on_standard_input_gives_the_sentences_of_its_replay() {
    let folder = tempfile::tempdir().unwrap();
    let [capture, want] = ["capture.ubx", "sentences"].map(|name| folder.path().join(name));
    // More bytes than the queue between the threads holds.
    fs::write(&capture, pieces(300).concat()).unwrap();
    assert!(fs::metadata(&capture).unwrap().len() > 1 << 18);
    let words = ["replay".as_ref(), capture.as_os_str(), "--nmea".as_ref(), want.as_os_str()];
    let Line { arguments } = clap::Parser::parse_from(words);
    command::run(&arguments, None).unwrap();
    let run = || {
        let mut service = Command::new(std::env::current_exe().unwrap());
        service.args(["service::endurance::service_of_its_own", "--exact", "--nocapture"]);
        service.env(ARGUMENTS, "--input=-").env("RUST_TEST_THREADS", "1");
        let output = service.stdin(File::open(&capture).unwrap()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        // The test program prints lines of its own around the sentences.
        let text = String::from_utf8(output.stdout).unwrap();
        let start = text.find('$').expect("a sentence");
        let lines = text[start..].lines().take_while(|line| line.starts_with('$'));
        lines.flat_map(|line| [line, "\r\n"]).collect::<String>()
    };
    let want = fs::read_to_string(&want).unwrap();
    assert_eq!(want.matches("$PRAIS").count(), 300);
    assert_eq!(run(), want);
    assert_eq!(run(), want, "each time");
}
