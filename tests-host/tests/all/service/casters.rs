//! Casters that answer as real ones do: in chunks, or with the table of their mountpoints.

use std::io::{BufRead as _, BufReader};

use raim::replay::{self, Window};

use super::ports::ranges_of;
use super::*;

/// Returns the arguments of a service with a caster.
fn with_caster(input: Option<String>, caster: &TcpListener) -> Arguments {
    let caster = Some(format!("ntrip://{}/MOUNT", caster.local_addr().unwrap()));
    Arguments { input, caster, output: vec!["udp://127.0.0.1:9".to_owned()], ..Arguments::default() }
}

/// Reads a request up to its empty line.
fn read_request(connection: &TcpStream) {
    let lines = BufReader::new(connection.try_clone().unwrap()).lines();
    let _ = lines.map_while(Result::ok).take_while(|line| !line.is_empty()).count();
}

#[test]
fn orbits_come_from_a_stream_in_chunks_that_cut_its_frames() {
    let folder = tempfile::tempdir().unwrap();
    let caster = TcpListener::bind("127.0.0.1:0").unwrap();
    let (receiver, input) = receiver();
    let mut service = Service::start(folder.path(), with_caster(input, &caster));
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    let lumps = replay::encode(&sky(30).record(), &selection, &[], &Window::ALL).unwrap();
    let stream: Vec<u8> = lumps.into_iter().flat_map(|lump| lump.bytes).collect();
    // No ephemeris is as short as a chunk.
    let chunk = |bytes: &[u8]| [format!("{:x}\r\n", bytes.len()).as_bytes(), bytes, b"\r\n"].concat();
    let chunks: Vec<u8> = stream.chunks(40).flat_map(chunk).collect();
    let (mut line, _) = receiver.accept().unwrap();
    let pieces: Vec<_> = pieces(100).iter().map(|piece| ranges_of(piece)).collect();
    service.send(&mut line, &pieces[1..10]);
    assert!(!is_high(folder.path()), "no orbits");
    let (mut connection, _) = caster.accept().unwrap();
    read_request(&connection);
    connection.write_all(b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n").unwrap();
    connection.write_all(&chunks).unwrap();
    service.clock.await_orbits(10);
    service.send(&mut line, &pieces[10..80]);
    assert!(is_high(folder.path()), "the orbits of the caster");
}

/// Casters ban those that come back fast.
#[test]
fn pauses_between_attempts_double_up_to_five_minutes() {
    let folder = tempfile::tempdir().unwrap();
    let caster = TcpListener::bind("127.0.0.1:0").unwrap();
    let (receiver, input) = receiver();
    let service = Service::start(folder.path(), with_caster(input, &caster));
    let _line = receiver.accept().unwrap();
    let refuse = |connection: TcpStream| {
        read_request(&connection);
        let mut connection = connection;
        connection.write_all(b"SOURCETABLE 200 OK\r\n\r\nSTR;OTHER;x\r\nENDSOURCETABLE\r\n").unwrap();
    };
    refuse(caster.accept().unwrap().0);
    caster.set_nonblocking(true).unwrap();
    let comes_within = |longest: Duration| {
        let start = Instant::now();
        loop {
            match caster.accept() {
                Ok((connection, _)) => {
                    connection.set_nonblocking(false).unwrap();
                    return Some(connection);
                }
                Err(_) if start.elapsed() < longest => thread::sleep(Duration::from_millis(10)),
                Err(_) => return None,
            }
        }
    };
    for pause_s in [10, 20, 40, 80, 160, 300, 300] {
        // The answer is read in real time, and only then does the pause begin.
        thread::sleep(Duration::from_millis(200));
        service.clock.advance(Duration::from_secs(pause_s - 2));
        assert!(comes_within(Duration::from_millis(200)).is_none(), "before {pause_s} s");
        service.clock.advance(Duration::from_secs(4));
        refuse(comes_within(Duration::from_secs(10)).unwrap_or_else(|| panic!("after {pause_s} s")));
    }
}
