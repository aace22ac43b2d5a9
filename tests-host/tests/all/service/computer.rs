//! The pin against what a computer does beside its work: its date steps, it sleeps, whoever reads
//! stops, its disk is full, somebody types Ctrl-Z.
//!
//! The service is a process of its own, in real time. Its clocks are shifted by a library that
//! stands before that of the system, because a test must not set the clock of the computer.

use std::ffi::OsString;
use std::fs::{File, OpenOptions};
use std::io::{BufRead as _, BufReader};
use std::os::unix::fs::FileExt as _;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use rig::skip;

use super::*;

/// Longest time from the last epoch to a low pin: the time to alert and a second more.
const LONGEST: Duration = Duration::from_secs(TIME_TO_ALERT_S as u64 + 1);

/// A library whose `clock_gettime` adds the seconds in a file to the date, others to the clock that
/// counts sleep, and others to both clocks that follow a program which sets the date by and by.
const SHIFTED_CLOCKS: &str = r#"
#define _GNU_SOURCE
#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static volatile long long *shifts;

__attribute__((constructor)) static void start(void)
{
    int file = open(getenv("RAI_SHIFTS"), O_RDONLY);
    if (file < 0) abort();
    shifts = mmap(0, 24, PROT_READ, MAP_SHARED, file, 0);
    if (shifts == MAP_FAILED) abort();
    close(file);
}

int clock_gettime(clockid_t clock, struct timespec *time)
{
    int result = (int)syscall(SYS_clock_gettime, clock, time);
    if (result == 0 && shifts) {
        if (clock == CLOCK_REALTIME) time->tv_sec += shifts[0];
        if (clock == CLOCK_BOOTTIME) time->tv_sec += shifts[1];
        if (clock == CLOCK_BOOTTIME || clock == CLOCK_MONOTONIC) time->tv_sec += shifts[2];
    }
    return result;
}
"#;

/// The clocks of a service.
struct Clocks {
    library: PathBuf,
    path: PathBuf,
    file: File,
}

impl Clocks {
    /// Returns clocks that are right; `None` and a skip without a C compiler.
    fn of(folder: &Path) -> Option<Self> {
        let (source, library, path) =
            (folder.join("clocks.c"), folder.join("clocks.so"), folder.join("shifts"));
        fs::write(&source, SHIFTED_CLOCKS).unwrap();
        fs::write(&path, [0; 24]).unwrap();
        let compiled =
            Command::new("cc").args(["-shared", "-fPIC", "-o"]).arg(&library).arg(&source).status();
        if !compiled.is_ok_and(|status| status.success()) {
            skip::say("a C compiler, cc (apt-get install gcc)");
            return None;
        }
        let file = OpenOptions::new().write(true).open(&path).unwrap();
        Some(Self { library, path, file })
    }

    /// Shifts the date, and the clock that counts sleep, s.
    fn shift(&self, date_s: i64, sleep_s: i64) {
        self.file.write_at(&[date_s.to_ne_bytes(), sleep_s.to_ne_bytes()].concat(), 0).unwrap();
    }

    /// Shifts the clocks that follow a program which sets the date by and by, s.
    fn slew(&self, slew_s: i64) {
        self.file.write_at(&slew_s.to_ne_bytes(), 16).unwrap();
    }

    /// Returns the variables of the service's environment.
    fn variables(&self) -> [(&'static str, OsString); 2] {
        [("LD_PRELOAD", self.library.clone().into()), ("RAI_SHIFTS", self.path.clone().into())]
    }
}

/// A service as a process, killed when dropped, and its receiver's line.
struct Process {
    child: Child,
    line: TcpStream,
    pieces: Vec<Vec<u8>>,
    sent: usize,
    folder: PathBuf,
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Returns the command of a service of its own.
fn command(arguments: &[String]) -> Command {
    let mut service = service(&arguments.join("\n"));
    service.stdin(Stdio::null()).stdout(Stdio::null());
    service
}

impl Process {
    /// Starts a service with its pin in this folder.
    fn start(folder: &Path, more: &[String], change: impl FnOnce(&mut Command)) -> Self {
        let (receiver, input) = receiver();
        let own = [
            format!("--input={}", input.unwrap()),
            format!("--set=TTA={TIME_TO_ALERT_S}"),
            format!("--pin=file:{}", folder.join("pin").display()),
        ];
        let mut service = command(&[&own[..], more].concat());
        change(&mut service);
        let child = service.spawn().unwrap();
        let line = accept(&receiver);
        Self { child, line, pieces: pieces(200), sent: 0, folder: folder.to_owned() }
    }

    /// Sends this many pieces in real time.
    fn send(&mut self, count: usize) {
        for piece in &self.pieces[self.sent..self.sent + count] {
            self.line.write_all(piece).unwrap();
            thread::sleep(Duration::from_secs(1) / RATE_HZ);
        }
        self.sent += count;
    }

    /// Lets this many epochs pass without sending them.
    fn miss(&mut self, count: usize) {
        self.sent += count;
    }

    /// Sends epochs until the pin is high, at most so many.
    #[track_caller]
    fn rise(&mut self, most: usize) {
        for _ in 0..most {
            self.send(1);
            if is_high(&self.folder) {
                return;
            }
        }
        panic!("the pin is low after {most} epochs");
    }

    /// Waits until the pin is low; the last epoch came an interval ago.
    #[track_caller]
    fn fall(&mut self, longest: Duration) -> Duration {
        let silent = Instant::now();
        while is_high(&self.folder) {
            assert!(silent.elapsed() < 4 * longest, "the pin is still high");
            thread::sleep(Duration::from_millis(5));
        }
        let taken = silent.elapsed() + Duration::from_secs(1) / RATE_HZ;
        assert!(taken < longest, "{taken:?} of {longest:?}");
        taken
    }

    /// Lets the intervals of a silence pass, so that the next epoch comes in its time.
    fn end_silence(&mut self, silent: Duration) {
        let interval = Duration::from_secs(1) / RATE_HZ;
        let missed = silent.as_secs_f64() / interval.as_secs_f64();
        let whole = missed.ceil();
        thread::sleep(interval.mul_f64(whole - missed));
        self.miss(whole as usize - 1);
    }
}

/// Returns the connection of a service, which would otherwise be waited for without an end.
#[track_caller]
fn accept(receiver: &TcpListener) -> TcpStream {
    receiver.set_nonblocking(true).unwrap();
    let start = Instant::now();
    loop {
        if let Ok((line, _)) = receiver.accept() {
            line.set_nonblocking(false).unwrap();
            return line;
        }
        assert!(start.elapsed() < Duration::from_secs(20), "the service does not connect");
        thread::sleep(Duration::from_millis(5));
    }
}

/// Returns the arguments of a service whose sentences nobody reads.
fn nowhere() -> Vec<String> {
    ["--output=udp://127.0.0.1:9", "--quiet"].map(str::to_owned).into()
}

#[test]
fn step_of_the_date_neither_holds_the_pin_nor_lowers_it() {
    let folder = tempfile::tempdir().unwrap();
    let Some(clocks) = Clocks::of(folder.path()) else { return };
    let mut service = Process::start(folder.path(), &nowhere(), |service| {
        service.envs(clocks.variables());
    });
    service.rise(30);
    for date_s in [3600, -3600, 0] {
        clocks.shift(date_s, 0);
        for _ in 0..5 {
            service.send(1);
            assert!(is_high(folder.path()), "after a step to {date_s} s");
        }
    }
    // The receiver falls silent, and the date goes back by a day.
    clocks.shift(-86_400, 0);
    service.fall(LONGEST);
}

/// chrony makes the clocks 8 % faster until the date is right. All that they have gained comes at once
/// here, and is more than the time to alert. (No silence follows: the system's own waits go by the clock
/// that is not shifted.)
#[test]
fn date_that_is_set_by_and_by_makes_no_epoch_late() {
    let folder = tempfile::tempdir().unwrap();
    let Some(clocks) = Clocks::of(folder.path()) else { return };
    let mut service = Process::start(folder.path(), &nowhere(), |service| {
        service.envs(clocks.variables());
    });
    service.rise(30);
    clocks.slew(60);
    for _ in 0..5 {
        service.send(1);
        assert!(is_high(folder.path()));
    }
}

/// A machine that sleeps for ten minutes stops `CLOCK_MONOTONIC`, and with it every `Instant`.
#[test]
fn verdict_of_before_a_sleep_does_not_stand_after_it() {
    let folder = tempfile::tempdir().unwrap();
    let Some(clocks) = Clocks::of(folder.path()) else { return };
    // The last time to alert counts: that of the monotonic clock would be long.
    let mut service =
        Process::start(folder.path(), &[nowhere(), vec!["--set=TTA=10".to_owned()]].concat(), |service| {
            service.envs(clocks.variables());
        });
    service.rise(30);
    let last = Instant::now();
    // The receiver goes on while the machine sleeps. The first of the pieces is not that of an epoch,
    // and a line that is silent for longer than two seconds is connected anew.
    let (asleep_s, awake_s) = (600, 1.6);
    let mut later = sky(100);
    later.start_s += (service.sent - 1) as f64 / f64::from(RATE_HZ) + asleep_s as f64 + awake_s;
    service.pieces = pieces_of(&later);
    service.sent = 1;
    assert!(is_high(folder.path()), "the time to alert has not passed");
    clocks.shift(asleep_s, asleep_s);
    service.fall(Duration::from_secs(1));
    let due = Duration::from_secs_f64(awake_s - 1.0 / f64::from(RATE_HZ));
    thread::sleep(due.saturating_sub(last.elapsed()));
    service.rise(90);
}

/// A pipe that nobody reads. A test program prints lines of its own at first, so that it is filled
/// later.
struct Unread {
    writer: std::io::PipeWriter,
    _reader: std::io::PipeReader,
}

impl Unread {
    fn new() -> Self {
        let (reader, writer) = std::io::pipe().unwrap();
        Self { writer, _reader: reader }
    }

    fn end(&self) -> std::io::PipeWriter {
        self.writer.try_clone().unwrap()
    }

    /// Fills the pipe, and keeps it full until it is dropped.
    fn fill(&self) {
        let mut filling = self.end();
        thread::spawn(move || filling.write_all(&vec![b'x'; 1 << 20]));
    }
}

/// Standard output and standard error are pipes that become full, as those of a pager that has
/// stopped. The sentences also go to a client and a terminal that are open and not read.
#[test]
fn readers_that_have_stopped_hold_neither_the_pin_nor_the_service() {
    let folder = tempfile::tempdir().unwrap();
    let (terminal, clients) = (folder.path().join("nmea"), free_address());
    let (out, log) = (Unread::new(), Unread::new());
    let more = [
        "--output=-".to_owned(),
        format!("--output=tcp://{clients}"),
        format!("--output=pty:{}", terminal.display()),
    ];
    let mut service = Process::start(folder.path(), &more, |service| {
        service.stdout(out.end()).stderr(log.end());
    });
    let _client = client(clients);
    let _terminal = File::open(&terminal).unwrap();
    service.rise(30);
    out.fill();
    log.fill();
    for _ in 0..3 {
        let silent = service.fall(LONGEST);
        service.end_silence(silent);
        service.rise(30);
    }
    assert!(service.child.try_wait().unwrap().is_none(), "the service goes on");
}

/// A file system of its own, which is full; unmounted when dropped.
struct FullDisk(PathBuf);

impl FullDisk {
    fn mount(folder: &Path) -> Option<Self> {
        let place = folder.join("disk");
        fs::create_dir(&place).unwrap();
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", "size=32k", "none"]).arg(&place).stderr(Stdio::null());
        if !mount.status().is_ok_and(|status| status.success()) {
            skip::say("the rights of the superuser, to mount a small disk");
            return None;
        }
        Some(Self(place))
    }

    fn fill(&self) {
        let mut filling = File::create(self.0.join("filling")).unwrap();
        while filling.write(&[0; 4096]).is_ok_and(|count| count > 0) {}
    }
}

impl Drop for FullDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(&self.0).status();
    }
}

/// The pin, the log and the sentences are files of a disk that becomes full while the pin is high.
#[test]
fn pin_on_a_full_disk_falls_and_the_service_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let Some(disk) = FullDisk::mount(folder.path()) else { return };
    let file = |name: &str| File::create(disk.0.join(name)).unwrap();
    let mut service = Process::start(&disk.0, &["--output=-".to_owned()], |service| {
        service.stdout(file("sentences")).stderr(file("log"));
    });
    service.rise(30);
    disk.fill();
    service.send(5);
    let silent = service.fall(LONGEST);
    // With room again, the pin rises again.
    fs::remove_file(disk.0.join("filling")).unwrap();
    File::options().write(true).open(disk.0.join("sentences")).unwrap().set_len(0).unwrap();
    service.end_silence(silent);
    service.rise(30);
    assert!(service.child.try_wait().unwrap().is_none(), "the service goes on");
}

#[test]
fn pin_that_cannot_be_set_is_said_once_and_ends_the_service() {
    let folder = tempfile::tempdir().unwrap();
    let pin = format!("--pin=file:{}", folder.path().join("missing/pin").display());
    let mut service = command(&["--input=tcp://127.0.0.1:1".to_owned(), pin]);
    let output = service.stderr(Stdio::piped()).output().unwrap();
    let reported = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && reported.contains("missing/pin"), "{reported}");
    assert_eq!(reported.matches("the pin cannot be set").count(), 1, "{reported}");
}

#[test]
fn stop_by_the_terminal_lowers_the_pin_and_epochs_after_it_raise_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut service = Process::start(folder.path(), &nowhere(), |_| ());
    service.rise(30);
    let signal = |name: &str| {
        let status =
            Command::new("kill").arg(format!("-{name}")).arg(service.child.id().to_string()).status();
        assert!(status.unwrap().success());
    };
    signal("TSTP");
    let start = Instant::now();
    let state = || {
        let status = File::open(format!("/proc/{}/status", service.child.id())).unwrap();
        let mut lines = BufReader::new(status).lines().map_while(Result::ok);
        lines.find_map(|line| line.strip_prefix("State:\t").map(str::to_owned)).unwrap()
    };
    while is_high(folder.path()) || !state().starts_with('T') {
        assert!(start.elapsed() < Duration::from_secs(1), "{}", state());
        thread::sleep(Duration::from_millis(5));
    }
    thread::sleep(Duration::from_secs(2));
    assert!(!is_high(folder.path()), "nothing drives it while the service is stopped");
    signal("CONT");
    let silent = start.elapsed() + Duration::from_secs(1) / RATE_HZ;
    service.end_silence(silent);
    service.rise(40);
}
