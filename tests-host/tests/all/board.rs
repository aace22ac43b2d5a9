//! The image on the emulated board: it starts, answers, measures, and fails safely with a reason.

use std::path::PathBuf;
use std::sync::OnceLock;
use std::time::Duration;

use raim::signal::osnma::Secret;
use rig::board::{EmulatedBoard, Pace, Settings, is_installed};
use rig::image::{self, Chip, Image};

/// Patience for a machine with other work.
const PATIENCE: Duration = Duration::from_secs(30);

fn built() -> PathBuf {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    IMAGE.get_or_init(|| image::build().expect("the image builds")).clone()
}

/// Returns a board that has greeted; `None` if the emulator is not installed.
fn started(settings: &Settings) -> Option<(EmulatedBoard, String)> {
    if !is_installed() {
        return None;
    }
    let mut board = EmulatedBoard::start_with(&built(), settings).expect("the board starts");
    let greeting = board.read_line(PATIENCE).expect("the board greets");
    Some((board, greeting))
}

#[test]
fn image_fits_the_chip_and_its_budgets() {
    let image = Image::open(&built()).expect("an image");
    let findings = image.check(&Chip::named("STM32F405RGTx").expect("a known chip"));
    assert_eq!(findings, Vec::<String>::new(), "{image}");
}

#[test]
fn start_says_version_cause_and_self_test() {
    let Some((board, greeting)) = started(&Settings::default()) else { return };
    let fields: Vec<&str> = greeting.trim_end().split([',', '*']).collect();
    assert_eq!(fields[0], "$PRAIV", "{greeting}");
    assert_eq!(fields[1], env!("CARGO_PKG_VERSION"), "{greeting}");
    assert_eq!(&fields[3..5], ["UNKNOWN", "PASS"], "the emulated reset flags read 0: {greeting}");
    board.stop().expect("the emulator ran until it was stopped");
}

#[test]
fn missing_oscillator_is_a_named_fallback() {
    let Some((mut board, _)) = started(&Settings::default()) else { return };
    let (_, line) = board.log_with("clock: ", 0, PATIENCE).expect("the clock is logged");
    assert_eq!(line.text, "clock: Unreported, core at 168000000 Hz");
    assert!(line.time_s < 0.1, "start-up waits are bounded: logged after {} s", line.time_s);
}

#[test]
fn command_is_answered_and_noise_on_both_ports_is_survived() {
    let Some((mut board, _)) = started(&Settings::default()) else { return };
    let noise: Vec<u8> =
        (0..20_000_u32).map(|number| (number.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    board.feed(&noise).expect("the board takes noise");
    board.send(b"$PRAIC,PHASE,NPA*00\r\nrubbish\r\n").expect("the board takes rubbish");
    board.command("SELFTEST").expect("the board takes a command");
    let lines = board.read_through("$PRAIA,SELFTEST", PATIENCE).expect("an answer");
    assert!(lines.last().expect("the answer").contains(",PASS,OK*"), "{lines:?}");
    assert!(!board.pin_is_high(), "nothing but a protected epoch may raise the pin");
    assert!(!board.log().iter().any(|line| line.text.starts_with("bytes lost")), "{:?}", board.log());
}

/// Anybody can read the secret of the key that the tests sign with.
#[test]
fn key_of_the_tests_is_refused_by_an_image() {
    let Some((mut board, _)) = started(&Settings::default()) else { return };
    let digits =
        |point: [u8; 33]| point.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().concat();
    for (secret, want) in [(Secret::test(), ",ERR,not in this build"), (Secret::of(b"another"), ",OK")] {
        let mut point = secret.public();
        board.command(&format!("KEY,1,{}", digits(point))).expect("the board takes a command");
        let lines = board.read_through("$PRAIA,KEY", PATIENCE).expect("an answer");
        assert!(lines.last().expect("the answer").contains(want), "{lines:?}");
        // The opposite point has the same secret but for its sign.
        point[0] ^= 1;
        board.command(&format!("KEY,1,{}", digits(point))).expect("the board takes a command");
        let lines = board.read_through("$PRAIA,KEY", PATIENCE).expect("an answer");
        assert!(lines.last().expect("the answer").contains(want), "{lines:?}");
    }
}

#[test]
fn silent_line_becomes_stale_with_the_pin_low() {
    let settings = Settings { pace: Pace::Leap, ..Settings::default() };
    let Some((mut board, _)) = started(&settings) else { return };
    let lines = board.read_through("$PRAIS", PATIENCE).expect("silence is reported");
    assert!(lines.last().expect("the report").contains(",A,STALE,"), "{lines:?}");
    assert!(!board.pin_is_high());
}

#[test]
fn reset_on_request_starts_again() {
    let Some((mut board, greeting)) = started(&Settings::default()) else { return };
    let (first, _) = board.log_with("start:", 0, PATIENCE).expect("the start is logged");
    board.command("RESET").expect("the board takes a command");
    let lines = board.read_through("$PRAIV", PATIENCE).expect("it greets again");
    assert_eq!(lines.last(), Some(&greeting), "a reset on request is no fault");
    board.log_with("start:", first + 1, PATIENCE).expect("the second start is logged");
}

#[test]
fn dropped_board_leaves_no_process() {
    let Some((board, _)) = started(&Settings::default()) else { return };
    let pid = board.process_id();
    let process = PathBuf::from(format!("/proc/{pid}"));
    if !process.parent().is_some_and(|folder| folder.join("self").exists()) {
        return rig::skip::say("/proc");
    }
    assert!(process.exists(), "the emulator runs");
    drop(board);
    assert!(!process.exists(), "the emulator {pid} outlived its board");
}

#[test]
fn file_that_is_no_image_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("image");
    std::fs::write(&path, b"not an image").expect("a file");
    let error = EmulatedBoard::start(&path).err().expect("no board starts from text");
    assert!(format!("{error:#}").contains("log table"), "{error:#}");
}

mod fault {
    //! Failures of the program, caused by a debugger; the reaction is the program's own.

    use std::io::{Read, Write};
    use std::net::{TcpListener, TcpStream};

    use super::*;

    /// The few commands of the debugger's protocol that are needed.
    struct Debugger(TcpStream);

    impl Debugger {
        fn ask(&mut self, words: &str) -> String {
            let checksum = words.bytes().fold(0_u8, u8::wrapping_add);
            write!(self.0, "${words}#{checksum:02x}").expect("the emulator listens");
            self.answer()
        }

        fn answer(&mut self) -> String {
            let mut text = String::new();
            while !text.contains('#') {
                let mut byte = [0];
                self.0.read_exact(&mut byte).expect("the emulator answers");
                text.push(char::from(byte[0]));
            }
            let mut checksum = [0; 2];
            self.0.read_exact(&mut checksum).expect("the emulator answers");
            self.0.write_all(b"+").expect("the emulator listens");
            text.trim_matches(['+', '$', '#']).to_owned()
        }

        fn go_on(&mut self) {
            self.0.write_all(b"$c#63").expect("the emulator listens");
        }

        fn stop(&mut self) {
            self.0.write_all(&[3]).expect("the emulator listens");
            self.answer();
            // After a request for its registers' names, the emulator also allows setting them.
            self.ask("qXfer:features:read:target.xml:0,ff");
        }

        fn jump(&mut self, address: u32) {
            let answer = self.ask(&format!("Pf={:08x}", address.swap_bytes()));
            assert_eq!(answer, "OK", "the program counter is set");
        }
    }

    fn debugged() -> Option<(EmulatedBoard, Debugger)> {
        if !is_installed() {
            return None;
        }
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("an address").port();
        let arguments =
            ["-chardev", &format!("socket,id=gdb,host=127.0.0.1,port={port}"), "-gdb", "chardev:gdb"]
                .map(str::to_owned)
                .to_vec();
        let settings = Settings { arguments, ..Settings::default() };
        let mut board = EmulatedBoard::start_with(&built(), &settings).expect("the board starts");
        let debugger = Debugger(listener.accept().expect("the emulator connects").0);
        debugger.0.set_read_timeout(Some(PATIENCE)).expect("a deadline");
        board.read_through("$PRAIV", PATIENCE).expect("the board greets");
        Some((board, debugger))
    }

    /// Number of attempts of a jump.
    const TRIES: u32 = 3;

    /// Continues the running program at `address`, and returns its greeting when it starts again.
    fn greeting_after_jump_to(address: u32) -> Option<String> {
        let (mut board, mut debugger) = debugged()?;
        // Rarely, on a busy machine, the emulator continues at its old place instead of the new
        // one.
        let lines = (0..TRIES).find_map(|_| {
            debugger.stop();
            debugger.jump(address);
            debugger.go_on();
            board.read_through("$PRAIV", PATIENCE / TRIES).ok()
        });
        assert!(!board.pin_is_high(), "the pin stays low through a fault");
        lines.expect("it starts again").last().cloned()
    }

    #[test]
    fn hard_fault_resets_and_names_the_address() {
        // Nothing is mapped there on this chip, so the fetch itself faults.
        let Some(greeting) = greeting_after_jump_to(0x6000_0000) else { return };
        assert!(greeting.contains(",FAULT-60000000,"), "{greeting}");
    }

    #[test]
    fn stack_that_reaches_its_guard_is_a_fault() {
        let Some((mut board, mut debugger)) = debugged() else { return };
        let statics_end = image::symbol(&built(), "_stack_end").expect("the end of the statics") as u32;
        let guard = statics_end.next_multiple_of(256) + 128;
        // Rarely, as above, the emulator continues with its old stack pointer.
        let lines = (0..TRIES).find_map(|_| {
            debugger.stop();
            let answer = debugger.ask(&format!("Pd={:08x}", guard.swap_bytes()));
            assert_eq!(answer, "OK", "the stack pointer is set");
            debugger.go_on();
            board.read_through("$PRAIV", PATIENCE / TRIES).ok()
        });
        let lines = lines.expect("it starts again");
        assert!(lines.last().expect("a greeting").contains(",FAULT-"), "{lines:?}");
    }
}
