//! The program that drives the pin: one at a time, and the last level wins.
//!
//! ```text
//! level ─► order ─► thread: PROGRAM high │ PROGRAM low, until it exits with 0
//! ```
//!
//! Two programs at once would race, and a slow `high` could end after a quick `low`. A `high` that
//! still runs when the pin must fall gets [`GRACE`], and is then killed with the processes that it
//! started. Each is repeated until it exits with 0 or another level is ordered; a `low` that hangs
//! is killed after [`LONGEST_LOW`]. Each failure is reported once.

use std::io;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::reserve::Reserve;
use crate::run::words::say;

/// Time in which a program that drives the pin high may end once the pin must fall.
const GRACE: Duration = Duration::from_millis(200);
/// Longest time of a program that drives the pin low.
const LONGEST_LOW: Duration = Duration::from_secs(2);
/// Pause before a failed `low` is repeated, and before a failed `high`, which nobody's safety waits
/// for.
const PAUSE_LOW: Duration = Duration::from_millis(100);
const PAUSE_HIGH: Duration = Duration::from_secs(1);
/// Shortest and longest time between two looks at a running program.
const LOOK: [Duration; 2] = [Duration::from_millis(2), Duration::from_millis(200)];

/// The thread that runs the programs, seen from outside.
#[derive(Debug)]
pub(super) struct Actuator {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    words: Vec<String>,
    orders: Mutex<Orders>,
    change: Condvar,
}

#[derive(Debug, Default)]
struct Orders {
    /// The last level that was ordered, and not yet begun.
    wanted: Option<bool>,
    /// The last level that a program has set, exiting with 0.
    is_set: Option<bool>,
    has_ended: bool,
}

impl Actuator {
    /// Starts the thread.
    pub(super) fn start(program: &str) -> Self {
        let words = program.split_whitespace().map(str::to_owned).collect();
        let shared = Arc::new(Shared { words, orders: Mutex::default(), change: Condvar::new() });
        let own = Arc::clone(&shared);
        thread::spawn(move || own.run(&Reserve::new()));
        Self { shared }
    }

    /// Orders a level, and returns at once.
    pub(super) fn order(&self, high: bool) {
        let mut orders = self.shared.orders();
        orders.wanted = Some(high);
        orders.is_set = None;
        self.shared.change.notify_all();
    }

    /// Orders the low level, and waits until a program has set it.
    ///
    /// # Errors
    /// If none has within this time.
    pub(super) fn lower(&self, longest: Duration) -> io::Result<()> {
        self.order(false);
        let orders = self.shared.orders();
        let waited = self.shared.change.wait_timeout_while(orders, longest, |orders| {
            // Another order may only be low, too, because the wire is closed or at its start.
            orders.is_set != Some(false)
        });
        if waited.unwrap_or_else(PoisonError::into_inner).1.timed_out() {
            let program = self.shared.words.join(" ");
            return Err(io::Error::other(format!("`{program} low` must exit with 0")));
        }
        Ok(())
    }
}

impl Drop for Actuator {
    fn drop(&mut self) {
        self.shared.orders().has_ended = true;
        self.shared.change.notify_all();
    }
}

impl Shared {
    fn orders(&self) -> MutexGuard<'_, Orders> {
        self.orders.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn run(&self, reserve: &Reserve) {
        let mut is_reported = false;
        while let Some(high) = self.next() {
            let outcome = reserve.with(|| self.spawn(high)).and_then(|child| self.end(child, high));
            match outcome {
                Ok(status) if status.success() => {
                    is_reported = false;
                    let mut orders = self.orders();
                    if orders.wanted.is_none() {
                        orders.is_set = Some(high);
                    }
                    self.change.notify_all();
                }
                failed => {
                    let level = if high { "high" } else { "low" };
                    let reason = failed.map_or_else(|error| error.to_string(), |status| status.to_string());
                    if !std::mem::replace(&mut is_reported, true) {
                        say!("error: the pin: `{} {level}`: {reason}", self.words.join(" "));
                    }
                    self.repeat(high);
                }
            }
        }
    }

    /// Waits for the next order; returns `None` at the end.
    fn next(&self) -> Option<bool> {
        let waiting = |orders: &mut Orders| orders.wanted.is_none() && !orders.has_ended;
        let orders = self.change.wait_while(self.orders(), waiting);
        let mut orders = orders.unwrap_or_else(PoisonError::into_inner);
        orders.wanted.take()
    }

    /// Orders a level again after a pause, unless another order has come.
    fn repeat(&self, high: bool) {
        let waiting = |orders: &mut Orders| orders.wanted.is_none() && !orders.has_ended;
        let pause = if high { PAUSE_HIGH } else { PAUSE_LOW };
        let waited = self.change.wait_timeout_while(self.orders(), pause, waiting);
        let (mut orders, _) = waited.unwrap_or_else(PoisonError::into_inner);
        if !orders.has_ended {
            orders.wanted.get_or_insert(high);
        }
    }

    fn spawn(&self, high: bool) -> io::Result<Child> {
        let mut words = self.words.iter();
        let mut command = Command::new(words.next().map_or("", String::as_str));
        command.args(words).arg(if high { "high" } else { "low" }).stdin(Stdio::null());
        // A group of its own, so that all of it can be killed.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        command.spawn()
    }

    /// Waits for the end of a program, and kills one that takes too long.
    fn end(&self, mut child: Child, high: bool) -> io::Result<ExitStatus> {
        let (start, mut look, mut ordered) = (Instant::now(), LOOK[0], None);
        loop {
            if let Some(status) = child.try_wait()? {
                return Ok(status);
            }
            let wants_low = self.orders().wanted == Some(false);
            let since_order = wants_low.then(|| ordered.get_or_insert_with(Instant::now).elapsed());
            let is_late = if high {
                since_order.is_some_and(|time| time > GRACE)
            } else {
                start.elapsed() > LONGEST_LOW
            };
            if is_late {
                kill(&mut child)?;
                return child.wait();
            }
            look = if wants_low { LOOK[0] } else { LOOK[1].min(2 * look) };
            drop(self.change.wait_timeout(self.orders(), look));
        }
    }
}

/// Kills a program and the processes that it started.
#[cfg(unix)]
fn kill(child: &mut Child) -> io::Result<()> {
    use nix::sys::signal::{Signal, killpg};
    use nix::unistd::Pid;
    let group = i32::try_from(child.id()).map_err(io::Error::other)?;
    killpg(Pid::from_raw(group), Signal::SIGKILL).map_err(io::Error::from)
}

#[cfg(not(unix))]
fn kill(child: &mut Child) -> io::Result<()> {
    child.kill()
}

#[cfg(all(test, unix))]
mod tests {
    use std::fs;
    use std::path::{Path, PathBuf};

    use super::*;

    /// Writes a program that is given to `sh`, and the wire that it drives.
    fn program(folder: &Path, text: &str) -> (String, PathBuf) {
        let (script, wire) = (folder.join("drive"), folder.join("wire"));
        fs::write(&script, text.replace("WIRE", &wire.display().to_string())).unwrap();
        (format!("sh {}", script.display()), wire)
    }

    fn level(wire: &Path) -> String {
        fs::read_to_string(wire).unwrap_or_default().trim().to_owned()
    }

    #[track_caller]
    fn wait_for(wire: &Path, want: &str, longest: Duration) {
        let start = Instant::now();
        while level(wire) != want {
            assert!(start.elapsed() < longest, "{:?}, not {want}", level(wire));
            thread::sleep(Duration::from_millis(5));
        }
    }

    #[test]
    fn slow_high_does_not_outlast_a_low() {
        let folder = tempfile::tempdir().unwrap();
        let (words, wire) = program(
            folder.path(),
            "if [ $1 = high ]; then (sleep 1; echo high > WIRE) & wait; else echo low > WIRE; fi\n",
        );
        let actuator = Actuator::start(&words);
        actuator.order(true);
        thread::sleep(Duration::from_millis(100));
        actuator.order(false);
        wait_for(&wire, "low", Duration::from_millis(900));
        // The process that the slow program started would have raised the wire by now.
        thread::sleep(Duration::from_millis(1300));
        assert_eq!(level(&wire), "low");
    }

    #[test]
    fn low_is_repeated_until_it_exits_with_zero() {
        let folder = tempfile::tempdir().unwrap();
        let (words, wire) = program(
            folder.path(),
            "n=$(cat WIRE.n 2>/dev/null || echo 0); echo $((n+1)) > WIRE.n\n\
             [ $n -lt 3 ] && exit 1; echo $1 > WIRE\n",
        );
        let actuator = Actuator::start(&words);
        actuator.lower(Duration::from_secs(5)).unwrap();
        assert_eq!(level(&wire), "low");
        assert_eq!(fs::read_to_string(wire.with_extension("n")).unwrap(), "4\n");
    }

    #[test]
    fn high_is_repeated_until_it_exits_with_zero_or_low_is_ordered() {
        let folder = tempfile::tempdir().unwrap();
        let (words, wire) = program(
            folder.path(),
            "[ $1 = high ] && [ ! -e WIRE.once ] && touch WIRE.once && exit 1; echo $1 > WIRE\n",
        );
        let actuator = Actuator::start(&words);
        actuator.order(true);
        wait_for(&wire, "high", Duration::from_secs(5));
        fs::remove_file(wire.with_extension("once")).unwrap();
        actuator.order(true);
        let start = Instant::now();
        while !wire.with_extension("once").exists() {
            assert!(start.elapsed() < Duration::from_secs(5), "it is not called");
            thread::sleep(Duration::from_millis(5));
        }
        actuator.lower(Duration::from_secs(5)).unwrap();
        thread::sleep(2 * PAUSE_HIGH);
        assert_eq!(level(&wire), "low", "a high that failed before is not repeated after it");
    }

    #[test]
    fn last_of_many_levels_wins() {
        let folder = tempfile::tempdir().unwrap();
        let (words, wire) = program(folder.path(), "sleep 0.0$((RANDOM % 5)); echo $1 > WIRE\n");
        let actuator = Actuator::start(&words);
        for round in 0..20 {
            actuator.order(round % 2 == 0);
            thread::sleep(Duration::from_millis(7));
        }
        actuator.lower(Duration::from_secs(5)).unwrap();
        assert_eq!(level(&wire), "low");
        actuator.order(true);
        wait_for(&wire, "high", Duration::from_secs(5));
    }

    #[test]
    fn program_that_does_not_exist_is_an_error() {
        let actuator = Actuator::start("/no/such/program");
        assert!(actuator.lower(Duration::from_millis(300)).is_err());
    }
}
