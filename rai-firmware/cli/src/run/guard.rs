//! The guard: a second thread that drops the pin and ends the program if the epoch loop hangs.
//!
//! Under systemd it also keeps the service's watchdog: only a loop that comes round feeds it. If
//! the whole process hangs, systemd ends it, and the unit's `ExecStopPost` drops the pin.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::pin::Wire;

/// Longest time that the loop may take to come round, ms.
const PATIENCE_MS: u64 = 2000;
/// Interval between two checks of the guard.
const LOOK: Duration = Duration::from_millis(100);

/// The loop's side of the guard.
#[derive(Debug)]
pub(super) struct Guard {
    start: Instant,
    fed_ms: Arc<AtomicU64>,
}

impl Guard {
    /// Starts the guard's thread.
    pub(super) fn start(wire: &Arc<Wire>, stop: &Arc<AtomicBool>) -> Self {
        let (start, fed_ms) = (Instant::now(), Arc::new(AtomicU64::new(0)));
        let (wire, stop, fed) = (Arc::clone(wire), Arc::clone(stop), Arc::clone(&fed_ms));
        std::thread::spawn(move || watch(&wire, &stop, &fed, start));
        Self { start, fed_ms }
    }

    /// Notes that the loop came round.
    pub(super) fn feed(&self) {
        self.fed_ms.store(milliseconds(self.start), Ordering::Relaxed);
    }
}

fn milliseconds(since: Instant) -> u64 {
    u64::try_from(since.elapsed().as_millis()).unwrap_or(u64::MAX)
}

fn watch(wire: &Wire, stop: &AtomicBool, fed_ms: &AtomicU64, start: Instant) {
    while !stop.load(Ordering::Relaxed) {
        std::thread::sleep(LOOK);
        let silent_ms = milliseconds(start).saturating_sub(fed_ms.load(Ordering::Relaxed));
        if silent_ms > PATIENCE_MS && fed_ms.load(Ordering::Relaxed) > 0 {
            // The program ends either way; a pin that cannot be set is systemd's to drop.
            let _ = wire.drive(false);
            eprintln!("error: the epoch loop has not come round for {silent_ms} ms; the pin is low");
            std::process::abort();
        }
        if silent_ms <= PATIENCE_MS {
            keep_alive();
        }
    }
}

/// Tells systemd that the service is ready.
pub(super) fn ready() {
    #[cfg(target_os = "linux")]
    let _ = sd_notify::notify(&[sd_notify::NotifyState::Ready]);
}

fn keep_alive() {
    #[cfg(target_os = "linux")]
    let _ = sd_notify::notify(&[sd_notify::NotifyState::Watchdog]);
}
