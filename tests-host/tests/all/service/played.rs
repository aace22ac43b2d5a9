//! A file or a pipe on standard input: the service prints what `replay` prints for a file, no slow
//! reader loses a sentence of either, and no signal cuts one.

use std::fs::File;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use raim::replay::command;

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
        let output = service("--input=-").stdin(File::open(&capture).unwrap()).output().unwrap();
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

/// Starts the service as a process whose standard input and output are pipes.
fn piped(arguments: &str) -> (Child, ChildStdin, ChildStdout) {
    let mut service = service(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let (input, output) = (service.stdin.take().unwrap(), service.stdout.take().unwrap());
    (service, input, output)
}

/// Returns the lines of the service, without those of the test program.
fn sentences(text: &str) -> Vec<&str> {
    let start = text.find('$').expect("a sentence");
    text[start..].split_inclusive('\n').take_while(|line| line.starts_with('$')).collect()
}

/// A reader that takes nothing for longer than the time to alert, while far more sentences come
/// than its pipe and its queue hold.
#[test]
fn pipe_waits_for_its_reader_and_loses_nothing_and_its_pin_is_low_meanwhile() {
    let folder = tempfile::tempdir().unwrap();
    let pin = folder.path().join("pin");
    let (mut service, mut input, mut output) =
        piped(&format!("--input=-\n--set=TTA=1\n--pin=file:{}", pin.display()));
    let capture = pieces(300).concat();
    let feed = thread::spawn(move || input.write_all(&capture));
    let start = Instant::now();
    while !is_high(folder.path()) {
        assert!(start.elapsed() < Duration::from_secs(20), "no promise");
        thread::sleep(Duration::from_millis(1));
    }
    thread::sleep(Duration::from_secs(3));
    assert!(!is_high(folder.path()), "nothing is judged while the reader stops");
    let mut text = String::new();
    output.read_to_string(&mut text).unwrap();
    feed.join().unwrap().unwrap();
    assert!(service.wait().unwrap().success());
    let sentences = sentences(&text);
    let of = |name: &str| sentences.iter().filter(|line| line.starts_with(name)).count();
    assert_eq!((of("$PRAIS"), of("$GNRMC"), of("$PRAIN")), (300, 300, 300));
    assert_eq!(text.matches(",P,OK,").count(), 300);
}

/// A reader that takes less than there is: no wait for it is long, and every epoch is older than the one
/// before. Once it has caught up, the next epoch is new.
#[test]
fn pin_is_low_while_a_slow_reader_makes_epochs_old() {
    let folder = tempfile::tempdir().unwrap();
    let pin = folder.path().join("pin");
    let (mut service, mut input, mut output) =
        piped(&format!("--input=-\n--set=TTA=10\n--pin=file:{}", pin.display()));
    // More sentences at once than the pipe holds, and then as a receiver sends.
    let feed = thread::spawn(move || {
        let pieces = pieces(400);
        input.write_all(&pieces[..200].concat()).unwrap();
        // The service ends once its pin is high.
        for piece in &pieces[200..] {
            if input.write_all(piece).is_err() {
                break;
            }
            thread::sleep(Duration::from_secs(1) / RATE_HZ);
        }
        input
    });
    wait_for_pin(folder.path(), true);
    wait_for_pin(folder.path(), false);
    for _ in 0..50 {
        output.read_exact(&mut [0; 200]).unwrap();
        thread::sleep(Duration::from_millis(100));
        assert!(!is_high(folder.path()), "an epoch of before is promised");
    }
    let reader = thread::spawn(move || std::io::copy(&mut output, &mut std::io::sink()));
    wait_for_pin(folder.path(), true);
    service.kill().unwrap();
    service.wait().unwrap();
    reader.join().unwrap().unwrap();
    drop(feed.join().unwrap());
}

#[track_caller]
fn wait_for_pin(folder: &Path, high: bool) {
    let start = Instant::now();
    while is_high(folder) != high {
        assert!(
            start.elapsed() < Duration::from_secs(20),
            "the pin is not {}",
            if high { "high" } else { "low" }
        );
        thread::sleep(Duration::from_millis(1));
    }
}

/// Stops of the service while its reader lags, stops, and while its input is a file.
#[test]
fn termination_cuts_no_sentence_and_waits_for_no_reader() {
    let folder = tempfile::tempdir().unwrap();
    let capture = folder.path().join("capture.ubx");
    let bytes = pieces(300).concat();
    fs::write(&capture, &bytes).unwrap();
    for (is_file, lag_ms) in [(true, 0), (true, 5), (false, 0), (false, 5), (false, 50)] {
        let (mut service, mut input, mut output) = if is_file {
            let mut service = service("--input=-");
            service.stdin(File::open(&capture).unwrap()).stdout(Stdio::piped()).stderr(Stdio::null());
            let mut service = service.spawn().unwrap();
            let output = service.stdout.take().unwrap();
            (service, None, output)
        } else {
            let (service, input, output) = piped("--input=-");
            (service, Some(input), output)
        };
        let bytes = bytes.clone();
        // The pipe stays open behind the last byte.
        let feed = thread::spawn(move || input.as_mut().map(|input| input.write_all(&bytes)).map(|_| input));
        let mut text = vec![0; 20_000];
        output.read_exact(&mut text).unwrap();
        thread::sleep(Duration::from_millis(lag_ms));
        let status = Command::new("kill").arg(service.id().to_string()).status().unwrap();
        assert!(status.success());
        let start = Instant::now();
        // The reader has stopped: the service ends without it.
        let ended = loop {
            if service.try_wait().unwrap().is_some() {
                break true;
            }
            if start.elapsed() > Duration::from_secs(8) {
                break false;
            }
            thread::sleep(Duration::from_millis(10));
        };
        service.kill().unwrap();
        output.read_to_end(&mut text).unwrap();
        drop(feed.join());
        assert!(ended, "file {is_file}: the service waits for its reader");
        let text = String::from_utf8(text).unwrap();
        let sentences = sentences(&text);
        assert!(sentences.len() > 200, "{}", sentences.len());
        for line in sentences {
            let body = line.strip_prefix('$').and_then(|line| line.strip_suffix("\r\n"));
            let (body, sum) =
                body.and_then(|body| body.rsplit_once('*')).unwrap_or_else(|| panic!("{line:?}"));
            let have = body.bytes().fold(0, |sum, byte| sum ^ byte);
            assert_eq!(u8::from_str_radix(sum, 16), Ok(have), "{line:?}");
        }
    }
}

#[test]
fn time_of_a_recording_is_refused() {
    for kind in ["file", "pipe"] {
        let mut service = service("--output=chrony:/nowhere/x.sock");
        let input = if kind == "file" { File::open("Cargo.toml").unwrap().into() } else { Stdio::piped() };
        let output = service.stdin(input).output().unwrap();
        let reported = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && reported.contains("may be of the past"), "{reported}");
    }
}
