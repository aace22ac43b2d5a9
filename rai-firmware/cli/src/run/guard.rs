//! The guard: a second thread that drops the pin and ends the program if the epoch loop hangs.
//!
//! Under systemd it also keeps the service's watchdog: only a loop that comes round feeds it. If
//! the whole process hangs, systemd ends it, and the unit's `ExecStopPost` drops the pin.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::pin::Wire;
use crate::run::words::{self, say};

/// Longest time that the loop may take to come round.
const PATIENCE: Duration = Duration::from_secs(2);
/// Lateness of the guard itself that shows that the whole program was stopped.
const STOPPED: Duration = Duration::from_millis(500);
/// Longest time between two signs of life for systemd, whose limit is 3 s.
const SIGN_OF_LIFE: Duration = Duration::from_secs(1);

/// The loop's side of the guard.
#[derive(Debug)]
pub(super) struct Guard {
    start: Instant,
    /// Time at which the loop came round last, and at which systemd was told, ms.
    fed_ms: Arc<AtomicU64>,
    told_ms: AtomicU64,
}

impl Guard {
    /// Starts the guard's thread. It wakes only when the loop could be late.
    pub(super) fn start(wire: &Arc<Wire>, stop: &Arc<AtomicBool>) -> Self {
        let (start, fed_ms) = (Instant::now(), Arc::new(AtomicU64::new(0)));
        let (wire, stop, fed) = (Arc::clone(wire), Arc::clone(stop), Arc::clone(&fed_ms));
        std::thread::spawn(move || watch(&wire, &stop, &fed, start));
        Self { start, fed_ms, told_ms: AtomicU64::new(0) }
    }

    /// Notes that the loop came round.
    pub(super) fn feed(&self) {
        let now_ms = milliseconds(self.start.elapsed());
        self.fed_ms.store(now_ms, Ordering::Relaxed);
        if now_ms.saturating_sub(self.told_ms.load(Ordering::Relaxed)) >= milliseconds(SIGN_OF_LIFE) {
            self.told_ms.store(now_ms, Ordering::Relaxed);
            keep_alive();
        }
    }
}

fn milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

fn watch(wire: &Wire, stop: &AtomicBool, fed_ms: &AtomicU64, start: Instant) {
    let (mut pause, mut excused) = (PATIENCE, Duration::ZERO);
    loop {
        let before = start.elapsed();
        std::thread::sleep(pause);
        if stop.load(Ordering::Relaxed) {
            return;
        }
        let now = start.elapsed();
        let fed = Duration::from_millis(fed_ms.load(Ordering::Relaxed));
        if now.saturating_sub(before) > pause + STOPPED {
            // Nobody could come round, and the loop has its time from now on. Until it does, nothing
            // is judged.
            excused = now;
            if now.saturating_sub(fed) > PATIENCE {
                wire.try_low();
            }
        }
        let silent = now.saturating_sub(fed.max(excused));
        if silent > PATIENCE && !fed.is_zero() {
            // The program ends either way; a pin that cannot be set is systemd's to drop.
            let _ = wire.close();
            say!("error: the epoch loop has not come round for {} ms; the pin is low", silent.as_millis());
            words::flush();
            std::process::abort();
        }
        // A millisecond more, because the time is counted in whole ones.
        pause = PATIENCE.saturating_sub(silent).max(Duration::from_millis(50)) + Duration::from_millis(1);
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
