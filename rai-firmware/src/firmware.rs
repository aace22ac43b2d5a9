//! The epoch loop.
//!
//! bytes in → receiver → sentences out; then time, then the watchdog, then sleep. Nothing here waits longer than the
//! host port's patience, and only a loop that comes round feeds the watchdog.
//!
//! What an epoch costs is logged with it: ticks of the core clock that the receiver was busy since the last epoch, and
//! ticks from its last byte to the pin. That byte came no earlier than the loop last found the ring empty or was woken.

use core::fmt::Write as _;

use cortex_m::singleton;
use cortex_m_rt::entry;
use rai_firmware::receiver::{Boot, Receiver};
use rai_firmware::reset::{Fault, ResetCause, WORD_BYTES};

use crate::board::pins::IntegrityPin;
use crate::board::ports::{HostPort, Losses};
use crate::board::watchdog::Watchdog;
use crate::board::{Board, clock::Clock, fault, ports, sleep_unless, stack, time};

/// GNSS bytes handed to the receiver at once.
const CHUNK_BYTES: usize = 256;
/// Epochs between two looks at the stack, which take longer than an epoch's share.
const EPOCHS_PER_STACK_REPORT: u32 = 60;

#[entry]
fn main() -> ! {
    let Some(Board { clock, reset_cause, pin, mut host, mut watchdog }) = Board::take() else {
        fault::reset_on_request()
    };
    crate::log::start();
    log_start(clock, reset_cause);
    watchdog.feed();
    let Some(receiver) = settle(pin, boot(reset_cause)) else { fault::reset_on_request() };
    receiver.greet(&mut host);
    run(receiver, host, watchdog)
}

/// Makes the receiver and gives it its place among the statics.
///
/// Not inlined, so that the copy on the stack is gone before the first epoch needs the room.
#[inline(never)]
fn settle(pin: IntegrityPin, boot: Boot) -> Option<&'static mut Receiver<IntegrityPin>> {
    let Ok(receiver) = Receiver::new(pin, boot) else {
        defmt::error!("the requirements at start are not in the threshold tables");
        return None;
    };
    singleton!(: Receiver<IntegrityPin> = receiver)
}

/// Goes round until the host asks for a reset.
fn run(receiver: &mut Receiver<IntegrityPin>, mut host: HostPort, mut watchdog: Watchdog) -> ! {
    let mut epochs = Epochs::default();
    let mut losses = Losses::default();
    while !receiver.reset_requested() {
        epochs.take_gnss(receiver, &mut host);
        take_commands(receiver, &mut host);
        look_at_clock(receiver, &mut host);
        report_losses(&mut losses);
        watchdog.feed();
        if let Some(woken_ticks) = sleep_unless(ports::input_waits) {
            epochs.heard_nothing_until(woken_ticks);
        }
    }
    ports::drain();
    fault::reset_on_request()
}

/// The cost of epochs.
#[derive(Default)]
struct Epochs {
    busy_ticks: u64,
    count: u32,
    /// What waits in the ring came after this instant.
    silent_until_ticks: u64,
}

impl Epochs {
    /// Hands over one chunk. An epoch ends with sentences, so their coming out closes the account of its ticks.
    fn take_gnss(&mut self, receiver: &mut Receiver<IntegrityPin>, host: &mut HostPort) {
        let mut chunk = [0; CHUNK_BYTES];
        let (lines_before, start_ticks) = (host.lines(), time::now_ticks());
        let count = ports::read_gnss(&mut chunk);
        if let Some(bytes @ [_, ..]) = chunk.get(..count) {
            receiver.gnss(bytes, time::now_ms(), host);
            self.busy_ticks += time::now_ticks() - start_ticks;
            if host.lines() != lines_before {
                self.close(receiver);
            }
        }
        if count < CHUNK_BYTES {
            self.heard_nothing_until(start_ticks);
        }
    }

    /// Notes an instant at which the ring was empty.
    fn heard_nothing_until(&mut self, ticks: u64) {
        self.silent_until_ticks = ticks;
    }

    fn close(&mut self, receiver: &Receiver<IntegrityPin>) {
        if self.count.is_multiple_of(EPOCHS_PER_STACK_REPORT) {
            defmt::info!("stack high water {=u32} bytes", stack::high_water_bytes());
            defmt::info!("rings high water {}", ports::high_water());
        }
        defmt::info!(
            "judged {}: pin {=u64} ticks after the last byte",
            receiver.last_verdict(),
            receiver.pin().driven_ticks().saturating_sub(self.silent_until_ticks)
        );
        self.count = self.count.wrapping_add(1);
        defmt::info!("epoch {=u32} took {=u64} ticks", self.count, self.busy_ticks);
        self.busy_ticks = 0;
    }
}

/// Lets time pass for the receiver. What it says then it says without a byte having come: that the line is silent, or
/// what it makes of an epoch that a damaged frame had held back.
fn look_at_clock(receiver: &mut Receiver<IntegrityPin>, host: &mut HostPort) {
    let lines_before = host.lines();
    receiver.tick(time::now_ms(), host);
    if host.lines() != lines_before {
        defmt::info!("judged {}: no byte came", receiver.last_verdict());
    }
}

fn take_commands(receiver: &mut Receiver<IntegrityPin>, host: &mut HostPort) {
    let mut chunk = [0; CHUNK_BYTES];
    let count = ports::read_host(&mut chunk);
    if let Some(bytes @ [_, ..]) = chunk.get(..count) {
        receiver.command(bytes, host);
    }
}

fn report_losses(before: &mut Losses) {
    let now = ports::losses();
    if now != *before {
        defmt::warn!("bytes lost since start: {}", now);
        *before = now;
    }
}

fn boot(cause: ResetCause) -> Boot {
    let mut reset_cause = heapless::String::<WORD_BYTES>::new();
    // Every cause fits: the module of the causes promises it, and its tests hold it to that.
    let _ = write!(reset_cause, "{cause}");
    Boot { git: env!("RAI_GIT"), reset_cause }
}

fn log_start(clock: Clock, cause: ResetCause) {
    let (version, git) = (env!("CARGO_PKG_VERSION"), env!("RAI_GIT"));
    defmt::info!("start: {=str} {=str}, reset cause {}", version, git, defmt::Display2Format(&cause));
    defmt::info!("clock: {}, core at {=u32} Hz", clock.source, clock.core_hz);
    if let ResetCause::Fault(Fault::Panic { file, line }) = cause {
        defmt::error!("the program before panicked: file {=u32:08x}, line {=u32}", file, line);
    }
}
