//! The ways in of a capture: file, packed file, serial port, network, standard input.

use std::io::Write as _;
use std::net::TcpListener;
use std::path::Path;
use std::process::{Command, Stdio};

use flate2::Compression;
use flate2::write::GzEncoder;
use raim::signal::capture;

use super::epochs;

/// Reads standard input if [`every_way_in_gives_the_same_bytes`] has started it, and reports the
/// result.
#[test]
fn standard_input_of_a_child() {
    let Some(path) = std::env::var_os("RAI_CAPTURE_WANT") else { return };
    assert!(capture::read("-", f64::INFINITY).unwrap() == std::fs::read(path).unwrap(), "other bytes");
    println!("the same bytes");
}

#[test]
fn every_way_in_gives_the_same_bytes() {
    let Some(want) = epochs(6) else { return };
    let folder = tempfile::tempdir().unwrap();
    let (plain, packed) = (folder.path().join("plain"), folder.path().join("packed"));
    std::fs::write(&plain, &want).unwrap();
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(&want).unwrap();
    let gz = encoder.finish().unwrap();
    std::fs::write(&packed, &gz).unwrap();
    let read = |name: &str| capture::read(name, 1.0).unwrap();
    let name = |path: &Path| path.display().to_string();
    assert!(read(&name(&plain)) == want && read(&name(&packed)) == want);
    assert!(read(&format!("serial:{}", name(&plain))) == want);

    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let served = want.clone();
    let server = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        served.chunks(999).for_each(|chunk| stream.write_all(chunk).unwrap());
    });
    assert!(read(&format!("tcp://{address}")) == want);
    server.join().unwrap();

    for sent in [&want, &gz] {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "capture::ways_in::standard_input_of_a_child", "--nocapture"])
            .env("RAI_CAPTURE_WANT", &plain)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(sent).unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success());
        assert!(String::from_utf8_lossy(&output.stdout).contains("the same bytes"));
    }
}

#[test]
fn what_has_no_end_needs_one() {
    for name in ["tcp://127.0.0.1:9", "serial:/dev/ttyS0", "/dev/ptmx"] {
        let error = format!("{:#}", capture::read(name, f64::INFINITY).unwrap_err());
        assert!(error.contains("--to"), "{name}: {error}");
    }
}
