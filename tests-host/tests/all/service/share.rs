//! The receiver's raw bytes for other programs, and theirs for the receiver.

use super::*;

/// Reads this many bytes.
fn read(stream: &mut TcpStream, count: usize) -> Vec<u8> {
    stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    let mut bytes = vec![0; count];
    stream.read_exact(&mut bytes).unwrap();
    bytes
}

#[test]
fn other_programs_get_every_byte_and_write_only_if_that_is_allowed() {
    // UBX-MON-VER, a question to the receiver.
    const QUESTION: [u8; 8] = [0xB5, 0x62, 0x0A, 0x04, 0x00, 0x00, 0x0E, 0x34];
    for share_write in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let ((receiver, input), share, page) = (receiver(), free_address(), free_address());
        let arguments = Arguments {
            input,
            output: vec!["udp://127.0.0.1:9".to_owned()],
            share: Some(format!("tcp://{share}")),
            share_write,
            record: Some(folder.path().join("capture.ubx")),
            page: Some(page.to_string()),
            ..Arguments::default()
        };
        let mut service = Service::start(folder.path(), arguments);
        let (mut line, _) = receiver.accept().unwrap();
        let (mut program, _deaf, mut other) = (client(share), client(share), client(share));
        // The service takes the clients that have just connected.
        thread::sleep(Duration::from_millis(100));
        let pieces = pieces(20);
        service.send(&mut line, &pieces);
        let want = pieces.concat();
        assert!(read(&mut program, want.len()) == want, "every byte, in order");
        assert!(read(&mut other, want.len()) == want, "every byte, in order");
        assert!(is_high(folder.path()), "the module has them too");
        program.write_all(&QUESTION).unwrap();
        let mut question = [0; 8];
        line.set_read_timeout(Some(Duration::from_millis(500))).unwrap();
        let has_come = line.read_exact(&mut question).is_ok();
        assert_eq!(has_come.then_some(question), share_write.then_some(QUESTION));
        let (passed, refused) = if share_write { (8, 0) } else { (0, 8) };
        for (fate, count) in [("passed", passed), ("refused", refused)] {
            wait_for_metric(page, &format!("rai_share_bytes_total{{fate=\"{fate}\"}} {count}\n"));
        }
        drop(service);
        assert!(fs::read(folder.path().join("capture.ubx")).unwrap() == want, "and the file has them");
    }
}

/// Asks for the metrics until they have this line: the receiver has bytes before they are counted.
fn wait_for_metric(page: SocketAddr, line: &str) {
    let start = Instant::now();
    loop {
        let metrics = get(page, "/metrics");
        if metrics.contains(line) {
            return;
        }
        assert!(start.elapsed() < Duration::from_secs(5), "{line}: {metrics}");
        thread::sleep(Duration::from_millis(10));
    }
}

/// Returns what the page answers.
fn get(page: SocketAddr, path: &str) -> String {
    let (mut stream, mut text) = (client(page), String::new());
    write!(stream, "GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    stream.read_to_string(&mut text).unwrap();
    text
}

/// A program behind `--share-write` can switch the ranges off.
#[test]
fn receiver_that_sends_no_ranges_any_more_is_told_from_a_dead_line() {
    let folder = tempfile::tempdir().unwrap();
    let ((receiver, input), page) = (receiver(), free_address());
    let output = vec!["udp://127.0.0.1:9".to_owned()];
    let arguments = Arguments { input, output, page: Some(page.to_string()), ..Arguments::default() };
    let mut service = Service::start(folder.path(), arguments);
    let (mut line, _) = receiver.accept().unwrap();
    let pieces = pieces(90);
    service.send(&mut line, &pieces[..20]);
    assert!(is_high(folder.path()) && get(page, "/state.json").contains("\"has_ranges\":true"));
    // NAV-PVT alone: the receiver's own position.
    let own = vec![ubx::frame([0x01, 0x07], &[0; 92]); 50];
    service.send(&mut line, &own);
    assert!(!is_high(folder.path()));
    let state = get(page, "/state.json");
    for part in ["\"has_ranges\":false", "STALE", "sends no ranges any more"] {
        assert!(state.contains(part), "{part}: {state}");
    }
    assert!(get(page, "/metrics").contains("rai_receiver_ranges 0\n"));
    service.send(&mut line, &pieces[70..]);
    assert!(get(page, "/state.json").contains("\"has_ranges\":true"));
}
