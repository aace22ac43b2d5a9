//! Signals and panics: whatever would end the program lowers the pin first.
//!
//! A signal that the system delivers by ending the program is caught by a thread. It drives the pin
//! low for good, and lets the service end in order. A panic in any thread does the same and then
//! ends the program, because a service without one of its threads would be half a service.
//!
//! A signal that stops the program for a time, such as that of Ctrl-Z, lowers the pin before it does;
//! the epochs after the stop raise it again. Nobody can catch a `SIGKILL` or a `SIGSTOP`; the unit's
//! `ExecStopPost` lowers the pin after the first, and its watchdog kills the program after the
//! second.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Result;

use super::pin::Wire;
use crate::run::words::{self, say};

/// Exit code after a panic, as Rust has it.
const PANICKED: i32 = 101;

/// Catches the signals whose usual effect is the end of the program.
///
/// # Errors
/// If the system refuses.
#[cfg(unix)]
pub(super) fn catch(wire: &Arc<Wire>, stop: &Arc<AtomicBool>) -> Result<()> {
    use anyhow::Context as _;
    use signal_hook::consts::{
        SIGALRM, SIGHUP, SIGINT, SIGPROF, SIGQUIT, SIGTERM, SIGTSTP, SIGTTIN, SIGTTOU, SIGUSR1, SIGUSR2,
        SIGVTALRM, SIGXCPU, SIGXFSZ,
    };
    let ends =
        [SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGXCPU, SIGXFSZ];
    let stops = [SIGTSTP, SIGTTIN, SIGTTOU];
    let caught = ends.iter().chain(&stops);
    let mut signals = signal_hook::iterator::Signals::new(caught).context("a signal cannot be caught")?;
    let (wire, stop) = (Arc::clone(wire), Arc::clone(stop));
    std::thread::spawn(move || {
        for signal in signals.forever() {
            if stops.contains(&signal) {
                wire.hold_low(|| {
                    // It fails only for a signal that does not exist.
                    let _ = nix::sys::signal::raise(nix::sys::signal::Signal::SIGSTOP);
                });
                continue;
            }
            stop.store(true, Ordering::Relaxed);
            if let Err(error) = wire.close() {
                say!("error: the pin cannot be set: {error}");
            }
        }
    });
    Ok(())
}

#[cfg(not(unix))]
pub(super) fn catch(_: &Arc<Wire>, _: &Arc<AtomicBool>) -> Result<()> {
    Ok(())
}

/// Lets a panic of any thread lower the pin and end the program.
pub(super) fn end_on_panic(wire: &Arc<Wire>) {
    let (wire, usual) = (Arc::clone(wire), std::panic::take_hook());
    std::panic::set_hook(Box::new(move |panic| {
        // The pin first: whoever reads standard error may have stopped.
        let lowered = wire.close();
        usual(panic);
        if let Err(error) = lowered {
            say!("error: the pin cannot be set: {error}");
            words::flush();
        }
        std::process::exit(PANICKED);
    }));
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::super::pin::Place;
    use super::*;

    /// Variable with the path of the pin, in the process that panics.
    const PIN: &str = "RAI_PIN_OF_A_PANIC";

    /// In a process of its own: a thread panics while the pin is high.
    #[test]
    fn panic_of_any_thread_lowers_the_pin_and_ends_the_program() {
        if let Ok(path) = std::env::var(PIN) {
            let wire = Arc::new(Wire::open(&Place::File(path.into())).unwrap());
            end_on_panic(&wire);
            wire.drive(true).unwrap();
            let _ = std::thread::spawn(|| panic!("on purpose")).join();
            unreachable!("the panic has ended the program");
        }
        let folder = tempfile::tempdir().unwrap();
        let pin = folder.path().join("pin");
        let name = "run::signals::tests::panic_of_any_thread_lowers_the_pin_and_ends_the_program";
        let mut program = Command::new(std::env::current_exe().unwrap());
        let output = program.args([name, "--exact", "--nocapture"]).env(PIN, &pin).output().unwrap();
        let reported = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(PANICKED), "{reported}");
        assert!(reported.contains("on purpose"), "{reported}");
        assert_eq!(std::fs::read_to_string(&pin).unwrap(), "0\n");
    }
}
