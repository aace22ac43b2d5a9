//! The pin while clients take all that there is: places, open files, patience.

use std::os::unix::fs::PermissionsExt as _;
use std::process::{Child, Command, Stdio};

use super::*;

#[test]
fn clients_beyond_the_limit_are_refused_until_one_leaves() {
    let folder = tempfile::tempdir().unwrap();
    let ((receiver, input), clients) = (receiver(), free_address());
    let output = vec![format!("tcp://{clients}")];
    let arguments = Arguments { input, output, clients: Some(2), ..Arguments::default() };
    let mut service = Service::start(folder.path(), arguments);
    let (mut line, _) = receiver.accept().unwrap();
    let [mut first, second, mut third] = [0; 3].map(|_| client(clients));
    third.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    assert_eq!(third.read(&mut [0; 64]).unwrap(), 0, "the third is closed at once");
    let pieces = pieces(40);
    service.send(&mut line, &pieces[..20]);
    read_until(&mut first, &[",P,OK,"]);
    drop(second);
    // The place is free once the service has noticed.
    thread::sleep(Duration::from_millis(200));
    let mut next = client(clients);
    thread::sleep(Duration::from_millis(200));
    service.send(&mut line, &pieces[20..]);
    read_until(&mut next, &[",P,OK,"]);
    assert!(is_high(folder.path()));
}

/// A process that ends with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The service may have 64 files open, and clients take all of them while the pin is high. The pin
/// is a program, which takes files to start.
#[test]
fn pin_falls_in_time_with_64_open_files_and_more_clients() {
    let folder = tempfile::tempdir().unwrap();
    let (program, level) = (folder.path().join("drive"), folder.path().join("pin"));
    fs::write(&program, format!("#!/bin/sh\n[ $1 = high ] && l=1 || l=0\necho $l > {}\n", level.display()))
        .unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    let ((receiver, input), clients) = (receiver(), free_address());
    let arguments = [
        format!("--input={}", input.unwrap()),
        format!("--output=tcp://{clients}"),
        "--clients=512".to_owned(),
        "--set=TTA=1".to_owned(),
        format!("--pin=exec:{}", program.display()),
    ];
    let mut service = Command::new("sh");
    service.args(["-c", "ulimit -n 64; exec \"$0\" \"$@\""]).arg(std::env::current_exe().unwrap());
    let mut service = started_by(service, &arguments.join("\n"));
    service.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let _service = Running(service.spawn().unwrap());
    let (mut line, _) = receiver.accept().unwrap();
    // The service listens to clients once it has its receiver.
    let patience = Instant::now() + Duration::from_secs(10);
    let first = std::iter::from_fn(|| Some(TcpStream::connect(clients)));
    let first = first.take_while(|_| Instant::now() < patience).find_map(Result::ok);
    let held: Vec<_> =
        first.into_iter().chain((0..100).filter_map(|_| TcpStream::connect(clients).ok())).collect();
    assert!(held.len() > 64, "{} clients", held.len());
    for piece in pieces(15) {
        line.write_all(&piece).unwrap();
        thread::sleep(Duration::from_secs(1) / RATE_HZ);
    }
    assert!(is_high(folder.path()), "the sky is good");
    // The last epoch came a fifth of a second ago.
    let silent = Instant::now();
    while is_high(folder.path()) {
        assert!(silent.elapsed() < Duration::from_secs(10), "the pin is still high");
        thread::sleep(Duration::from_millis(5));
    }
    let taken = silent.elapsed() + Duration::from_secs(1) / RATE_HZ;
    assert!(taken < Duration::from_secs(2), "the time to alert and a second more: {taken:?}");
    drop(held);
}
