//! The inputs of the service: a serial port that is pulled and plugged in again, and a caster of
//! orbits for a receiver that sends ranges alone.

use std::io::{BufRead as _, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use raim::replay::{self, Window};
use raim::signal::sky::Site;
use rig::skip;

use super::*;

/// A pair of pseudo-terminals: the second is the serial port.
struct Cable(Child);

impl Drop for Cable {
    fn drop(&mut self) {
        // It does not matter if it has already ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Cable {
    /// Returns `None` and reports a skip if `socat` is missing.
    fn plug(ends: &[PathBuf; 2]) -> Option<Self> {
        let end = |path: &PathBuf| format!("pty,raw,echo=0,link={}", path.display());
        let socat = Command::new("socat").args(ends.each_ref().map(end)).stderr(Stdio::null()).spawn();
        let Ok(socat) = socat else {
            skip::say("socat (apt-get install socat)");
            return None;
        };
        let cable = Self(socat);
        let start = Instant::now();
        while !ends.iter().all(|end| end.exists()) {
            assert!(start.elapsed() < Duration::from_secs(10), "socat makes no terminals");
            thread::sleep(Duration::from_millis(20));
        }
        Some(cable)
    }
}

#[test]
fn serial_port_is_read_and_opened_again_after_it_was_gone() {
    let folder = tempfile::tempdir().unwrap();
    let ends = ["receiver", "port"].map(|name| folder.path().join(name));
    let Some(cable) = Cable::plug(&ends) else { return };
    let input = Some(format!("serial:{}@115200", ends[1].display()));
    let output = vec!["udp://127.0.0.1:9".to_owned()];
    let mut service = Service::start(folder.path(), Arguments { input, output, ..Arguments::default() });
    // The service opens the port in real time.
    thread::sleep(Duration::from_millis(300));
    let pieces = pieces(100);
    let open = || fs::OpenOptions::new().write(true).open(&ends[0]).unwrap();
    service.send(&mut open(), &pieces[..20]);
    assert!(is_high(folder.path()), "the sky is good");
    drop(cable);
    service.wait_for(folder.path(), false, Duration::from_secs(5));
    let Some(_cable) = Cable::plug(&ends) else { return };
    // The service tries again after a pause of at most a second, and opens the port in real time.
    let gone = Duration::from_secs(4);
    for _ in 0..8 {
        service.clock.advance(gone / 8);
        thread::sleep(Duration::from_millis(60));
    }
    // As much time has passed as until the pin fell, and these four seconds; a second more is a gap.
    let next = 20 + ((TIME_TO_ALERT_S + gone.as_secs_f64() + 1.0) * f64::from(RATE_HZ)).ceil() as usize;
    service.send(&mut open(), &pieces[next..next + 25]);
    assert!(is_high(folder.path()), "the port is back");
}

/// Prints the input rate of a terminal by the call of Linux that has any rate (`TCGETS2`; `struct
/// termios2` in asm-generic/termbits.h).
const RATE: &str = r"
import fcntl, os, struct, sys
port = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
print(struct.unpack('4I20s2I', fcntl.ioctl(port, 0x802C542A, bytes(44)))[5])
";

/// Returns the rate of a terminal, as the kernel has it.
fn rate_of(port: &Path) -> u32 {
    let output = Command::new("python3").args(["-c", RATE]).arg(port).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    text.trim().parse().unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&output.stderr)))
}

/// A receiver at the second rate that is tried. At every other rate its bytes are noise.
#[test]
fn receiver_at_another_rate_is_found_as_the_board_finds_it() {
    let folder = tempfile::tempdir().unwrap();
    let ends = ["receiver", "port"].map(|name| folder.path().join(name));
    let Some(_cable) = Cable::plug(&ends) else { return };
    let input = Some(format!("serial:{}@115200", ends[1].display()));
    let output = vec!["udp://127.0.0.1:9".to_owned()];
    let mut service = Service::start(folder.path(), Arguments { input, output, ..Arguments::default() });
    // The service opens the port in real time.
    thread::sleep(Duration::from_millis(300));
    let mut line = fs::OpenOptions::new().write(true).open(&ends[0]).unwrap();
    let noise = vec![0x80, 0xFF, 0x3F];
    let (mut rates, mut is_found) = (Vec::new(), false);
    // A piece comes every 0.2 s, and each rate has five seconds; the kernel is asked every second.
    for five in pieces(60).chunks(5) {
        rates.push(rate_of(&ends[1]));
        if rates.last() == Some(&38_400) {
            if !std::mem::replace(&mut is_found, true) {
                service.send(&mut line, &pieces(1)[..1]);
            }
            service.send(&mut line, five);
        } else {
            service.send(&mut line, &vec![noise.clone(); 5]);
        }
    }
    rates.dedup();
    assert_eq!(rates, [115_200, 38_400]);
    assert!(is_high(folder.path()), "the sky is good");
}

/// A receiver that sends only sentences: the service says what `replay` says, and says it once.
#[test]
fn receiver_of_sentences_is_told_once_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let ends = ["receiver", "port"].map(|name| folder.path().join(name));
    let Some(_cable) = Cable::plug(&ends) else { return };
    let arguments = format!("--input=serial:{}\n--output=udp://127.0.0.1:9", ends[1].display());
    let mut service = service(&arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut line = fs::OpenOptions::new().write(true).open(&ends[0]).unwrap();
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(12) {
        line.write_all(b"$GPGLL,4916.45,N,12311.12,W,225444,A,*1D\r\n").unwrap();
        thread::sleep(Duration::from_millis(100));
    }
    let _ = Command::new("kill").arg(service.id().to_string()).status();
    let mut reported = String::new();
    service.stderr.take().unwrap().read_to_string(&mut reported).unwrap();
    service.wait().unwrap();
    assert_eq!(reported.matches("lines of NMEA. missing: ranges").count(), 1, "{reported}");
    assert!(reported.contains("RXM-RAWX and RXM-SFRBX"), "{reported}");
}

/// Returns the range messages of a piece, RXM-RAWX, without its navigation bits.
pub(super) fn ranges_of(piece: &[u8]) -> Vec<u8> {
    let (mut ranges, mut rest) = (Vec::new(), piece);
    while let [0xB5, 0x62, class, number, low, high, ..] = *rest {
        let (frame, next) = rest.split_at(8 + usize::from(u16::from_le_bytes([low, high])));
        if [class, number] == [0x02, 0x15] {
            ranges.extend_from_slice(frame);
        }
        rest = next;
    }
    ranges
}

/// Serves one stream of a caster; returns the request and the connection, which stays open.
fn serve_caster(listener: &TcpListener, stream: &[u8]) -> (Vec<String>, TcpStream) {
    let (mut connection, _) = listener.accept().unwrap();
    let lines = BufReader::new(connection.try_clone().unwrap()).lines();
    let request = lines.map(Result::unwrap).take_while(|line| !line.is_empty()).collect();
    connection.write_all(b"ICY 200 OK\r\n\r\n").unwrap();
    connection.write_all(stream).unwrap();
    (request, connection)
}

#[test]
fn caster_brings_orbits_and_its_ranges_are_never_used() {
    let folder = tempfile::tempdir().unwrap();
    let caster = TcpListener::bind("127.0.0.1:0").unwrap();
    let ((receiver, input), clients) = (receiver(), free_address());
    let arguments = Arguments {
        input,
        caster: Some(format!("ntrip://me:secret@{}/MOUNT", caster.local_addr().unwrap())),
        output: vec![format!("tcp://{clients}")],
        ..Arguments::default()
    };
    let mut service = Service::start(folder.path(), arguments);
    // The caster's station is 100 km away. Its ranges would contradict those of the receiver.
    let mut station = Simulation::above_xian(3600.0, 30, 5);
    station.site = Site::geodetic(33.27, 108.57, 400.0);
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    let lumps = replay::encode(&station.record(), &selection, &[], &Window::ALL).unwrap();
    let stream: Vec<u8> = lumps.into_iter().flat_map(|lump| lump.bytes).collect();
    let mut reader = client(clients);
    let (mut line, _) = receiver.accept().unwrap();
    let pieces: Vec<_> = pieces(100).iter().map(|piece| ranges_of(piece)).collect();
    // Without orbits nothing is promised.
    service.send(&mut line, &pieces[1..10]);
    assert!(!is_high(folder.path()), "no orbits");
    let (request, _connection) = serve_caster(&caster, &stream);
    assert!(request[0].starts_with("GET /MOUNT HTTP/1."), "{request:?}");
    // RFC 7617: `me:secret` in Base64.
    assert!(request.contains(&"Authorization: Basic bWU6c2VjcmV0".to_owned()), "{request:?}");
    // A frame of the caster goes in between two of the receiver.
    service.clock.await_orbits(10);
    service.send(&mut line, &pieces[10..80]);
    assert!(is_high(folder.path()), "the orbits of the caster");
    let sentences = read_until(&mut reader, &[",U,EPHEMERIS,", ",P,OK,"]);
    let protected = sentences.lines().filter(|line| line.contains("GNGNS") && line.contains(",A,"));
    for place in protected {
        assert!(place.contains(",3410."), "the receiver's own place, 34.17 degrees north: {place}");
    }
}
