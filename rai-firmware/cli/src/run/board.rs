//! A computer as a board of the firmware.

use std::convert::Infallible;
use std::time::Duration;
#[cfg(unix)]
use std::time::SystemTime;

use embedded_io::{ErrorType, Write};
use raim_firmware::board::reset::ResetCause;
use raim_firmware::board::{Board, HOST_OUT_BYTES, Note, PortLosses, SEALED_BYTES};
#[cfg(unix)]
use raim_firmware::output::nmea::GPS_MINUS_UTC_S;
use raim_firmware::receiver::Boot;
use raim_firmware::timed_ring::Taken;

use super::backlog::Backlog;
use super::contact::{Contact, Progress};
use super::guard::Guard;
use super::inbox::Inbox;
use super::outbox::Outbox;
use super::page::Page;
use super::pin::{Pin, Wire};
use super::report::Recorder;
#[cfg(unix)]
use super::time_server::{Sample, TimeServer};
use super::{LONGEST_HIGH, Module};
use crate::run::words::say;
use crate::satellites::Seen;

/// Longest sleep of the loop while the pin is high or bytes have come lately.
const LONGEST_SLEEP: Duration = Duration::from_millis(50);
/// Longest sleep of the loop on a silent line with a low pin, when nothing can fall or be completed.
const IDLE_SLEEP: Duration = Duration::from_millis(300);
/// Silence after which the line counts as silent, ms: longer than the module waits for the rest of
/// an epoch.
const SILENT_MS: u64 = 2000;
/// Pause after which an epoch without an end is complete, ms: a little more than the module waits.
const QUIET_MS: u64 = 600;

/// The ports of the service, as the epoch loop sees them.
pub(super) struct Computer<'s> {
    inbox: &'s Inbox,
    outbox: &'s mut Outbox,
    contact: &'s mut Contact,
    sealed: &'s mut [u8; SEALED_BYTES],
    guard: &'s Guard,
    wire: &'s Wire,
    recorder: Option<&'s mut Recorder>,
    page: Option<&'s mut Page>,
    /// Frames with orbits that the caster has sent.
    orbits: u32,
    /// The age of the epochs; `None` on a live line, whose lateness the module knows.
    backlog: Option<&'s mut Backlog>,
}

impl<'s> Computer<'s> {
    pub(super) fn new(
        inbox: &'s Inbox,
        (outbox, contact): (&'s mut Outbox, &'s mut Contact),
        sealed: &'s mut [u8; SEALED_BYTES],
        (guard, wire, backlog): (&'s Guard, &'s Wire, Option<&'s mut Backlog>),
        (recorder, page): (Option<&'s mut Recorder>, Option<&'s mut Page>),
    ) -> Self {
        Self { inbox, outbox, contact, sealed, guard, wire, recorder, page, orbits: 0, backlog }
    }

    /// Looks at what the module has made of the receiver's bytes.
    pub(super) fn look(&mut self, receiver: &Module) {
        let report = receiver.last_report();
        let progress = Progress {
            frames: receiver.frames().wrapping_sub(self.orbits),
            has_epoch: report.is_some(),
            has_position: report.is_some_and(|report| report.solution.is_some()),
            fixed: receiver.configuration().bit_rate.rate(),
            tag_s: receiver.last_epoch().map(raim_core::epoch::Epoch::time_s),
        };
        if let Some(words) = self.contact.look(progress, self.inbox.now_ms()) {
            say!("{words}");
        }
        if let Some(page) = &mut self.page {
            page.note_ranges(!self.contact.lacks_ranges());
        }
    }

    /// Gives the module the orbits of the caster while it has no frame of the receiver in hand, which
    /// they would cut.
    pub(super) fn insert_orbits(&mut self, receiver: &mut Module) {
        while receiver.is_between_frames() {
            let Some(orbit) = self.inbox.take_orbit() else { break };
            let before = receiver.frames();
            receiver.gnss(&orbit, self.inbox.now_ms(), self.outbox);
            self.orbits = self.orbits.wrapping_add(receiver.frames().wrapping_sub(before));
        }
    }

    /// Passes the verdicts since the last call to the log, and to the recorder and the page, if there
    /// are such. Returns when the last one came, ms, if it is protected.
    pub(super) fn record(&mut self, receiver: &mut Module) -> Option<u64> {
        self.outbox.wake();
        let seen = receiver.observer_mut().take();
        for seen in &seen {
            self.outbox.note(seen);
        }
        self.withhold_if_old(receiver, &seen);
        if let Some(page) = &mut self.page {
            page.note(&seen, receiver);
        }
        if let Some(recorder) = &mut self.recorder {
            let (pin_is_high, now_ms) = (receiver.pin().is_high(), self.inbox.now_ms());
            recorder.note(&seen, receiver.configuration(), pin_is_high, now_ms);
        }
        seen.last().filter(|seen| seen.output.state.is_protected())?.came_ms
    }

    /// Lets the pin be low while the epochs of a pipe are old.
    fn withhold_if_old(&mut self, receiver: &Module, seen: &[Seen]) {
        let Some(backlog) = &mut self.backlog else { return };
        let is_epoch = seen.last().is_some_and(|seen| seen.came_ms.is_some());
        let Some(epoch) = receiver.last_epoch().filter(|_| is_epoch) else { return };
        if backlog.age(epoch.time_s(), self.inbox.clock().unheld()) > LONGEST_HIGH {
            self.wire.withhold();
        } else {
            self.wire.release();
        }
    }

    pub(super) fn sealed_memory(&self) -> &[u8; SEALED_BYTES] {
        self.sealed
    }

    pub(super) fn outbox(&mut self) -> &mut Outbox {
        self.outbox
    }

    /// Returns true once a finite input has ended and all of it was judged.
    pub(super) fn has_ended(&self) -> bool {
        self.inbox.has_ended()
    }

    /// Tells the time of an epoch that is protected, which came at `came_ms`.
    #[cfg(unix)]
    pub(super) fn tell_time(&mut self, receiver: &Module, came_ms: u64, servers: &mut [TimeServer]) {
        /// Speed of light, m/s.
        const C_M_S: f64 = 299_792_458.0;
        let clock_m =
            receiver.last_report().and_then(|report| report.solution.as_ref()).and_then(|solution| {
                // The systems differ by less than a microsecond.
                solution.clocks_m.iter().copied().flatten().next()
            });
        let (Some(epoch), Some(clock_m)) = (receiver.last_epoch(), clock_m) else { return };
        let age = Duration::from_millis(self.inbox.now_ms().saturating_sub(came_ms));
        let leap_s = receiver.leap_second().map_or(GPS_MINUS_UTC_S, |leap| leap.seconds);
        let came = SystemTime::now() - age;
        let sample = Sample { gps_s: epoch.time_s() - clock_m / C_M_S, leap_s, came, age };
        for server in servers {
            server.tell(&sample);
        }
    }

    /// Lets the module judge what a finite input has left incomplete.
    pub(super) fn drain(&mut self, receiver: &mut Module) {
        // A pause that no frame has inside completes what waits.
        receiver.tick(self.inbox.now_ms().saturating_add(QUIET_MS), self.outbox);
    }
}

impl Board for Computer<'_> {
    type Pin = Pin;
    type Host = Outbox;

    fn gnss(&mut self, chunk: &mut [u8]) -> Taken {
        let taken = self.inbox.take(chunk);
        if let Taken::Bytes { count, came_ms } = &taken {
            self.contact.receive(chunk.get(..*count).unwrap_or_default(), *came_ms);
        }
        taken
    }

    fn command(&mut self) -> Option<u8> {
        self.inbox.take_command()
    }

    fn host(&mut self) -> &mut Outbox {
        self.outbox
    }

    fn host_room(&self) -> usize {
        HOST_OUT_BYTES
    }

    fn now_ms(&self) -> u64 {
        self.inbox.now_ms()
    }

    fn clock_error_ppm(&self) -> u32 {
        Boot::CRYSTAL_PPM
    }

    fn now_ticks(&self) -> u64 {
        self.inbox.now_ns()
    }

    fn driven_ticks(&self, _: &Pin) -> u64 {
        self.inbox.now_ns()
    }

    fn losses(&self) -> PortLosses {
        let mut losses = PortLosses::NONE;
        losses.gnss_bytes_lost = self.inbox.dropped();
        losses.sentences_lost = self.outbox.lost();
        losses
    }

    fn feed_watchdog(&mut self) {
        self.guard.feed();
    }

    fn sleep(&mut self) -> Option<u64> {
        self.outbox.wake();
        let is_idle = !self.wire.is_high() && self.inbox.silent_ms() > SILENT_MS;
        self.inbox.wait(if is_idle { IDLE_SLEEP } else { LONGEST_SLEEP });
        Some(self.inbox.now_ns())
    }

    fn reset_cause(&self) -> ResetCause {
        ResetCause::Software
    }

    fn sealed(&mut self) -> &mut [u8; SEALED_BYTES] {
        self.sealed
    }

    // `Contact` has the rate of the port: its trial begins at the rate that the user has named.
    fn set_gnss_rate(&mut self, _: u32) {}

    fn note(&mut self, _: Note) {}
}

impl ErrorType for Outbox {
    type Error = Infallible;
}

impl Write for Outbox {
    /// Takes one sentence or message, whole.
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.send(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
