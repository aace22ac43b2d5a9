//! The time of the service: that of the computer, or one that a test moves.
//!
//! ```text
//! computer:  now = time since the start of the program, in which the computer may have slept
//! led:       now = sum of what `advance` was given; each step ends once the epoch loop has judged it
//! ```
//!
//! A led clock passes in steps of at most [`STEP`]. A step is over once the loop has come round
//! twice and found nothing to do, so that one of the two rounds began after the step. A test
//! therefore sees the same states as in real time, and needs no sleep.
//!
//! On Linux the time of the computer is that of its oscillator, `CLOCK_MONOTONIC_RAW`, and of its
//! sleep, `CLOCK_BOOTTIME − CLOCK_MONOTONIC`. A step of the date does not move it. Nor does a program that
//! sets the date by and by (chrony lets the other clocks run 8 % faster): every epoch would seem
//! late. It goes on while the machine sleeps, so that a verdict of before is old when it wakes;
//! `Instant` would stand still meanwhile.
//!
//! The time of the computer stands still while it is held, because a consumer of a pipe's sentences
//! does not read: the bytes of the pipe wait meanwhile, and are taken as new. How old they are in truth
//! shows by the time that was not held ([`Clock::unheld`], [`super::backlog`]).

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Longest step of a led clock: the loop looks at the clock as often in real time.
const STEP: Duration = Duration::from_millis(50);
/// Longest real time in which the service must do what a test waits for.
const PATIENCE: Duration = Duration::from_secs(20);
/// Real time after which a resting loop comes round even if nothing has happened.
const ROUND: Duration = Duration::from_millis(100);

/// Returns the time since some instant, which no step of the date moves.
#[cfg(any(target_os = "linux", target_os = "android"))]
fn steady() -> Duration {
    use std::sync::atomic::AtomicU64;
    /// Time in which the machine has slept since it was started, ns.
    static SLEPT_NS: AtomicU64 = AtomicU64::new(0);
    // What goes by between the two calls makes the sleep too short, so that the longest one counts.
    let with_sleep = read(nix::time::ClockId::CLOCK_BOOTTIME);
    let slept = with_sleep.saturating_sub(read(nix::time::ClockId::CLOCK_MONOTONIC));
    let slept_ns = u64::try_from(slept.as_nanos()).unwrap_or(u64::MAX);
    let slept_ns = SLEPT_NS.fetch_max(slept_ns, Ordering::Relaxed).max(slept_ns);
    read(nix::time::ClockId::CLOCK_MONOTONIC_RAW) + Duration::from_nanos(slept_ns)
}

/// macOS counts the time of sleep in its monotonic clock.
#[cfg(all(unix, not(any(target_os = "linux", target_os = "android"))))]
fn steady() -> Duration {
    read(nix::time::ClockId::CLOCK_MONOTONIC)
}

/// It is an error to ask for a clock that the system does not have, and every one has these.
#[cfg(unix)]
fn read(clock: nix::time::ClockId) -> Duration {
    nix::time::clock_gettime(clock).map(Duration::from).unwrap_or_default()
}

#[cfg(not(unix))]
fn steady() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}

/// The clock.
#[derive(Debug)]
pub struct Clock {
    start: Duration,
    held: Mutex<Held>,
    led: Option<Led>,
}

/// The time that does not count.
#[derive(Debug, Default)]
struct Held {
    past: Duration,
    since: Option<Duration>,
}

/// A clock that a test moves.
#[derive(Debug, Default)]
struct Led {
    state: Mutex<State>,
    change: Condvar,
}

#[derive(Debug, Default)]
struct State {
    now: Duration,
    /// Number of changes that the loop must look at.
    events: u64,
    /// Rounds in which the loop found nothing to do, and those that a step waits for.
    rests: u64,
    wanted: u64,
    /// Bytes of the receiver and frames of the caster that have reached the loop's queue.
    heard: [u64; 2],
    has_ended: bool,
}

impl Clock {
    /// Returns the clock of the computer.
    pub fn of_the_computer() -> Arc<Self> {
        Arc::new(Self { start: steady(), held: Mutex::default(), led: None })
    }

    /// Returns a clock that stands still until it is [advanced](Self::advance).
    pub fn led() -> Arc<Self> {
        Arc::new(Self { start: steady(), held: Mutex::default(), led: Some(Led::default()) })
    }

    /// Returns the time since the start.
    pub(super) fn now(&self) -> Duration {
        if let Some(led) = &self.led {
            return led.state().now;
        }
        let held = self.held();
        let now = held.since.unwrap_or_else(steady);
        now.saturating_sub(self.start).saturating_sub(held.past)
    }

    fn held(&self) -> MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets the time of the computer stand still.
    pub(super) fn hold(&self) {
        self.held().since.get_or_insert_with(steady);
    }

    /// Lets the time of the computer go on from where it stands.
    pub(super) fn go_on(&self) {
        let mut held = self.held();
        if let Some(since) = held.since.take() {
            held.past += steady().saturating_sub(since);
        }
    }

    /// Returns the time since the start, with that which was held.
    pub(super) fn unheld(&self) -> Duration {
        self.led.as_ref().map_or_else(|| steady().saturating_sub(self.start), |led| led.state().now)
    }

    /// Sleeps, in pieces, so that a stop is noticed.
    pub(super) fn sleep(&self, pause: Duration, stop: &AtomicBool) {
        let until = self.now() + pause;
        while self.now() < until && !stop.load(Ordering::Relaxed) {
            match &self.led {
                Some(led) => drop(led.change.wait_timeout(led.state(), ROUND)),
                None => thread::sleep(ROUND.min(until.saturating_sub(self.now()))),
            }
        }
    }

    /// Moves a led clock on, and returns once the service has judged every step.
    ///
    /// # Panics
    /// If the clock is that of the computer, or if the service does not come round.
    pub fn advance(&self, by: Duration) {
        let led = self.led.as_ref().expect("a led clock");
        let mut rest = by;
        while !rest.is_zero() {
            let step = rest.min(STEP);
            rest -= step;
            let mut state = led.state();
            state.now += step;
            state.events += 1;
            led.come_round(state);
        }
    }

    /// Sets a led clock that no service follows.
    #[cfg(test)]
    pub(super) fn set(&self, now: Duration) {
        self.led.as_ref().expect("a led clock").state().now = now;
    }

    /// Waits in real time until this number of bytes of the receiver have come since the start.
    ///
    /// # Panics
    /// As [`Self::advance`].
    pub fn await_bytes(&self, count: u64) {
        let led = self.led.as_ref().expect("a led clock");
        led.wait_until(led.state(), "bytes are missing", |state| state.heard[0] >= count);
        // Bytes that a step overtook would have waited for as long as the step.
        led.come_round(led.state());
    }

    /// Waits in real time until this number of frames of the caster have come since the start.
    ///
    /// # Panics
    /// As [`Self::advance`].
    pub fn await_orbits(&self, count: u64) {
        let led = self.led.as_ref().expect("a led clock");
        led.wait_until(led.state(), "orbits are missing", |state| state.heard[1] >= count);
    }

    /// Notes bytes of the receiver and frames of the caster in the loop's queue.
    pub(super) fn receive(&self, bytes: usize, frames: usize) {
        if let Some(led) = &self.led {
            let mut state = led.state();
            state.heard[0] += bytes as u64;
            state.heard[1] += frames as u64;
            state.events += 1;
            led.change.notify_all();
        }
    }

    /// Returns the number of changes so far; `None` if the clock is that of the computer.
    pub(super) fn events(&self) -> Option<u64> {
        self.led.as_ref().map(|led| led.state().events)
    }

    /// Rests the loop, which has found nothing to do since it saw this number of changes.
    pub(super) fn rest(&self, seen: u64) {
        let Some(led) = &self.led else { return };
        let mut state = led.state();
        state.rests += 1;
        led.change.notify_all();
        let is_idle = |state: &mut State| state.events == seen && state.rests >= state.wanted;
        drop(led.change.wait_timeout_while(state, ROUND, is_idle));
    }

    /// Notes that the service has ended, so that nobody waits for it.
    pub(super) fn end(&self) {
        if let Some(led) = &self.led {
            led.state().has_ended = true;
            led.change.notify_all();
        }
    }
}

impl Led {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until the loop has come round and found nothing to do.
    fn come_round(&self, mut state: MutexGuard<'_, State>) {
        state.wanted = state.rests + 2;
        self.change.notify_all();
        self.wait_until(state, "it does not come round", |state| state.rests >= state.wanted);
    }

    fn wait_until(&self, state: MutexGuard<'_, State>, what: &str, is_met: impl Fn(&State) -> bool) {
        let waited =
            self.change.wait_timeout_while(state, PATIENCE, |state| !state.has_ended && !is_met(state));
        let has_failed = waited.unwrap_or_else(PoisonError::into_inner).1.timed_out();
        assert!(!has_failed, "the service: {what}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn held_time_does_not_count_and_goes_on_from_where_it_stood() {
        let clock = Clock::of_the_computer();
        clock.hold();
        let before = clock.now();
        thread::sleep(Duration::from_millis(30));
        clock.hold();
        assert_eq!(clock.now(), before);
        assert!(clock.unheld() >= before + Duration::from_millis(30));
        clock.go_on();
        clock.go_on();
        assert!(clock.now() >= before && clock.now() < before + Duration::from_millis(30));
    }
}
