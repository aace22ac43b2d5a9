//! The service from its input to its outputs, without a receiver: what must hold before any
//! satellite.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use super::clock::Clock;
use super::{Arguments, Plan, serve, serve_by};

fn plan(arguments: Arguments) -> anyhow::Result<Plan> {
    Plan::read(arguments)
}

#[test]
fn command_line_outranks_the_file_and_unknown_entries_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rai.toml");
    std::fs::write(
        &path,
        "input = \"tcp://a:1\"\npin = \"file:/x\"\n[settings]\nMASK = \"5\"\nPHASE = \"NPA\"\n",
    )
    .unwrap();
    let have = plan(Arguments {
        config: Some(path.clone()),
        input: Some("tcp://b:2".into()),
        set: vec!["HAL=40".into()],
        ..Arguments::default()
    })
    .unwrap();
    assert_eq!(have.input.to_string(), "tcp://b:2");
    let keys: Vec<_> = have.settings.iter().map(|(key, _)| key.as_str()).collect();
    assert_eq!(keys, ["PHASE", "MASK", "HAL"]);
    std::fs::write(&path, "inputs = \"-\"\n").unwrap();
    let error = plan(Arguments { config: Some(path), ..Arguments::default() }).unwrap_err();
    assert!(format!("{error:#}").contains("inputs"), "{error:#}");
}

#[test]
fn setting_that_the_module_refuses_stops_the_start() {
    let receiver = TcpListener::bind("127.0.0.1:0").unwrap();
    let arguments = Arguments {
        input: Some(format!("tcp://{}", receiver.local_addr().unwrap())),
        set: vec!["MASK=95".into()],
        ..Arguments::default()
    };
    let error = serve(&plan(arguments).unwrap(), &Arc::new(AtomicBool::new(false))).unwrap_err().to_string();
    assert!(error.contains("MASK") && error.contains("out of range"), "{error}");
}

#[test]
fn client_gets_the_first_sentences_and_the_receiver_may_come_late() {
    let folder = tempfile::tempdir().unwrap();
    let pin = folder.path().join("pin");
    let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let receiver = TcpListener::bind("127.0.0.1:0").unwrap();
    let arguments = Arguments {
        input: Some(format!("tcp://{}", receiver.local_addr().unwrap())),
        output: vec![format!("tcp://{free}")],
        pin: Some(format!("file:{}", pin.display())),
        ..Arguments::default()
    };
    let (plan, stop) = (plan(arguments).unwrap(), Arc::new(AtomicBool::new(false)));
    let clock = Clock::led();
    let service = {
        let (stop, clock) = (Arc::clone(&stop), Arc::clone(&clock));
        thread::spawn(move || serve_by(&plan, &stop, &clock))
    };
    let start = Instant::now();
    let mut client = loop {
        match TcpStream::connect(free) {
            Ok(client) => break client,
            Err(error) => assert!(start.elapsed() < Duration::from_secs(10), "{error}"),
        }
        thread::sleep(Duration::from_millis(20));
    };
    let (mut line, _) = receiver.accept().unwrap();
    line.write_all(b"no frame at all\r\n").unwrap();
    client.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    clock.await_bytes(17);
    // The service takes the client that has just connected.
    thread::sleep(Duration::from_millis(100));
    clock.advance(Duration::from_secs(70));
    let mut have = [0; 7];
    // The module repeats its settings once a minute, whatever comes.
    client.read_exact(&mut have).unwrap();
    assert_eq!(&have[..4], b"$PRA");
    assert_eq!(std::fs::read_to_string(&pin).unwrap(), "0\n");
    stop.store(true, Ordering::Relaxed);
    service.join().unwrap().unwrap();
}

/// Returns the refusal of a start with these settings and this output.
fn refusal(set: &[&str], output: &str) -> String {
    let receiver = TcpListener::bind("127.0.0.1:0").unwrap();
    let arguments = Arguments {
        input: Some(format!("tcp://{}", receiver.local_addr().unwrap())),
        output: vec![output.to_owned()],
        set: set.iter().map(|text| (*text).to_owned()).collect(),
        ..Arguments::default()
    };
    serve(&plan(arguments).unwrap(), &Arc::new(AtomicBool::new(false))).unwrap_err().to_string()
}

#[test]
fn wrong_inputs_of_a_new_user_are_answered_with_what_would_be_right() {
    let udp = "udp://127.0.0.1:9";
    assert!(refusal(&["MAKS=5"], udp).contains("is MASK meant?"));
    assert!(refusal(&["MASK=95"], udp).contains("it takes 0 to 60 °"));
    assert!(refusal(&["PHASE=CRUISE"], udp).contains("it takes ENROUTE, TERMINAL"));
    assert!(refusal(&[], "mavlink-udp://127.0.0.1:9").contains("without a message: set OUTPUT=GPS_INPUT,1"));
}

#[test]
fn number_in_the_file_needs_no_quotes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rai.toml");
    std::fs::write(&path, "[settings]\nMASK = 5\nPFA = 1e-7\nHAL = 40.5\nRECOVER = \"3,3\"\n").unwrap();
    let have = plan(Arguments { config: Some(path.clone()), ..Arguments::default() }).unwrap();
    let want = [("HAL", "40.5"), ("MASK", "5"), ("PFA", "0.0000001"), ("RECOVER", "3,3")];
    assert_eq!(have.settings, want.map(|(key, value)| (key.to_owned(), value.to_owned())));
    std::fs::write(&path, "[settings]\nMASK = [5]\n").unwrap();
    let error = plan(Arguments { config: Some(path), ..Arguments::default() }).unwrap_err();
    assert!(format!("{error:#}").contains("a setting is a text in quotes or a number"), "{error:#}");
}

#[test]
fn reset_is_no_setting() {
    let arguments = Arguments { set: vec!["RESET=".into()], ..Arguments::default() };
    let error = plan(arguments).unwrap_err().to_string();
    assert!(error.contains("RESET is a command"), "{error}");
}

#[test]
fn pin_is_lowered_whatever_else_is_wrong_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let (path, pin) = (folder.path().join("rai.toml"), folder.path().join("pin"));
    std::fs::write(&pin, "1\n").unwrap();
    let line = format!("pin = \"file:{}\"", pin.display());
    let text = format!("input = serial\noutputs = [\"\npins = 3\n{line}\n[settings\nMASK = 95\n");
    std::fs::write(&path, text).unwrap();
    let arguments = Arguments { config: Some(path.clone()), lower_pin: true, ..Arguments::default() };
    super::run(arguments.clone()).unwrap();
    assert_eq!(std::fs::read_to_string(&pin).unwrap(), "0\n");
    // A pin of a wrong form must not pass for one that was lowered.
    std::fs::write(&path, "pin = \"usb:1\"\n").unwrap();
    assert!(super::run(arguments).is_err());
}
