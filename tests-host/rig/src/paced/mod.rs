//! The module on a model of its ports: bytes at the rates of the lines, in simulated time.
//!
//! The emulator's ports are not paced. A burst arrives at once, and a host that floods the module
//! does so at the rate of a socket. Here the epoch loop of the firmware, the same that runs on the
//! chip, runs on a board of which every call costs time:
//!
//! ```text
//! t += cycles / f_core                a byte comes 10/baud after the one before it
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `f_core` | [`Costs::core_hz`] | Hz |
//! | cycles | the other fields of [`Costs`] | 1 |
//! | baud | [`Lines`] | bit/s, 10 bits a byte |
//!
//! The cost of an epoch is charged when the pin is driven, so that the pin is as late as on the
//! chip.
//!
//! The GNSS port uses the sender's rate ([`run`]), or must find it ([`search`]). Until then it
//! reads the bytes that a port of the wrong rate reads on such a line (`wire`).

mod wire;

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::digital::{ErrorType, OutputPin};
use raim::sentence::command;
use raim_firmware::bit_rate::RATES;
use raim_firmware::board::reset::ResetCause;
use raim_firmware::board::{Board, HOST_OUT_BYTES, Note, PortLosses, SEALED_BYTES};
use raim_firmware::epoch_loop::{EpochLoop, WORTH_A_PASS_BYTES};
use raim_firmware::outlet::Outlet;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::ring::Ring;
use raim_firmware::timed_ring::{Taken, TimedRing};

use wire::{Sent, Wire, byte_ns};

/// Costs of the module's work, in cycles.
#[derive(Clone, Copy, Debug)]
pub struct Costs {
    /// Frequency of the core, Hz.
    pub core_hz: u64,
    /// Reading a byte of the GNSS port, with its share of decoding.
    pub gnss_byte: u64,
    /// Judging an epoch.
    pub epoch: u64,
    /// Writing a byte of a sentence.
    pub sentence_byte: u64,
    /// Reading a byte of a command.
    pub command_byte: u64,
    /// One pass of the loop without work.
    pub pass: u64,
    /// One slice of the authentication.
    pub slice: u64,
}

impl Costs {
    /// Returns the costs beside an epoch of so many cycles, rounded up from the instructions that
    /// `bench` counts: 39 k for an epoch's 900 bytes of RTCM, 41 k for its 600 bytes of sentences, at
    /// most 60 k for a slice. Each instruction takes two cycles, which is above the upper bound of a
    /// whole epoch.
    pub const fn measured(core_hz: u64, epoch: u64) -> Self {
        Self {
            core_hz,
            gnss_byte: 100,
            epoch,
            sentence_byte: 150,
            command_byte: 800,
            pass: 2000,
            slice: 120_000,
        }
    }

    const fn nanoseconds(&self, cycles: u64) -> u64 {
        cycles * 1_000_000_000 / self.core_hz
    }
}

/// The lines to and from the module.
#[derive(Clone, Copy, Debug)]
pub struct Lines<'l> {
    /// Rate of the GNSS port, bit/s.
    pub gnss_baud: u64,
    /// Rate of the host port in both directions, bit/s.
    pub host_baud: u64,
    /// Time between epochs, ns.
    pub period_ns: u64,
    /// Bytes that the host repeats without a pause.
    pub flood: &'l [u8],
    /// True if the host reads its port.
    pub host_reads: bool,
}

/// Result of a run.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Time from the last byte of each judged epoch to the pin, ns.
    pub lateness_ns: Vec<u64>,
    /// Number of passes of the loop.
    pub passes: u64,
    /// Longest time between two passes, ns.
    pub longest_pass_ns: u64,
    /// Number of slices of the authentication.
    pub slices: u32,
    /// The module's counters at the end.
    pub counters: Vec<(&'static str, u32)>,
    /// Bytes that the host read.
    pub heard: Vec<u8>,
    /// Times, ns, at which the GNSS port changed its rate, and the rates.
    pub rates: Vec<(u64, u32)>,
}

impl Outcome {
    /// Returns a counter at the end.
    ///
    /// # Panics
    /// If there is no counter of this name.
    pub fn counter(&self, name: &str) -> u32 {
        self.counters.iter().find(|(known, _)| *known == name).expect(name).1
    }

    /// Returns the longest time from a last byte to the pin, ms.
    pub fn latest_ms(&self) -> f64 {
        self.lateness_ns.iter().max().map_or(0.0, |latest| *latest as f64 * 1e-6)
    }
}

/// Simulated time, and the epoch in progress.
#[allow(clippy::struct_field_names)] // Nanoseconds all of them.
#[derive(Debug, Default)]
struct Instant {
    now_ns: u64,
    /// Cost of driving the pin, ns.
    epoch_ns: u64,
    /// Time of the last byte of the last complete epoch, ns; `None` once the pin has been driven
    /// for it.
    complete_ns: Option<u64>,
    lateness_ns: Vec<u64>,
}

type Clock = Rc<RefCell<Instant>>;

/// A pin that takes as long as the judgement before it.
struct Pin {
    clock: Clock,
}

impl Pin {
    fn drive(&self) {
        let mut clock = self.clock.borrow_mut();
        clock.now_ns += clock.epoch_ns;
        if let Some(complete_ns) = clock.complete_ns.take() {
            let late_ns = clock.now_ns - complete_ns;
            clock.lateness_ns.push(late_ns);
        }
    }
}

impl ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.drive();
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.drive();
        Ok(())
    }
}

/// An output of which every byte takes time.
struct Metered<'r> {
    outlet: Outlet<'r, HOST_OUT_BYTES, fn()>,
    clock: Clock,
    byte_ns: u64,
}

impl embedded_io::ErrorType for Metered<'_> {
    type Error = Infallible;
}

impl embedded_io::Write for Metered<'_> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.clock.borrow_mut().now_ns += bytes.len() as u64 * self.byte_ns;
        self.outlet.write(bytes)
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        self.outlet.flush()
    }
}

/// The model of the board.
struct Model<'l> {
    clock: Clock,
    costs: Costs,
    lines: Lines<'l>,
    wire: Wire,
    /// Rate of the GNSS port, bit/s.
    port_baud: u64,
    /// Times of the last bytes that the ring holds, with the number of bytes before each.
    ends: VecDeque<(usize, u64)>,
    pushed: usize,
    read: usize,
    gnss: &'l TimedRing<4096, 64>,
    commands: &'l Ring<256>,
    out: &'l Ring<HOST_OUT_BYTES>,
    host: Metered<'l>,
    flooded: u64,
    sent_ns: u64,
    last_pass_ns: u64,
    outcome: Outcome,
    sealed: [u8; SEALED_BYTES],
}

impl Model<'_> {
    fn spend(&mut self, cycles: u64) {
        self.clock.borrow_mut().now_ns += self.costs.nanoseconds(cycles);
        self.catch_up();
    }

    fn now_ns(&self) -> u64 {
        self.clock.borrow().now_ns
    }

    fn has_work(&self) -> bool {
        self.gnss.len() >= WORTH_A_PASS_BYTES || !self.commands.is_empty()
    }

    /// Advances the lines to the present, as the interrupts would.
    fn catch_up(&mut self) {
        let now_ns = self.now_ns();
        while let Some((at_ns, byte, is_end)) = self.wire.next(self.port_baud)
            && at_ns <= now_ns
        {
            self.wire.pass(self.port_baud);
            let lost = self.gnss.lost();
            self.gnss.push(byte, (at_ns / 1_000_000) as u32);
            if self.gnss.lost() == lost {
                self.pushed += 1;
                if is_end {
                    self.ends.push_back((self.pushed, at_ns));
                }
            }
        }
        if !self.lines.flood.is_empty() {
            let due = now_ns / byte_ns(self.lines.host_baud);
            for number in self.flooded..due {
                let at = (number % self.lines.flood.len() as u64) as usize;
                self.commands.push(self.lines.flood[at]);
            }
            self.flooded = self.flooded.max(due);
        }
        let byte_ns = byte_ns(self.lines.host_baud);
        while self.lines.host_reads && self.sent_ns + byte_ns <= now_ns {
            let Some(byte) = self.out.pop() else {
                self.sent_ns = now_ns;
                break;
            };
            self.outcome.heard.push(byte);
            self.sent_ns += byte_ns;
        }
    }
}

impl<'l> Board for Model<'l> {
    type Pin = Pin;
    type Host = Metered<'l>;

    fn gnss(&mut self, chunk: &mut [u8]) -> Taken {
        self.spend(self.costs.pass);
        let now_ns = self.now_ns();
        self.outcome.longest_pass_ns = self.outcome.longest_pass_ns.max(now_ns - self.last_pass_ns);
        self.last_pass_ns = now_ns;
        let given_up = self.gnss.given_up();
        let taken = self.gnss.take(chunk, now_ns / 1_000_000);
        self.read += (self.gnss.given_up() - given_up) as usize;
        if let Taken::Bytes { count, .. } = taken {
            self.read += count;
            self.spend(count as u64 * self.costs.gnss_byte);
        }
        while let Some(&(position, at_ns)) = self.ends.front()
            && position <= self.read
        {
            self.ends.pop_front();
            self.clock.borrow_mut().complete_ns = Some(at_ns);
        }
        taken
    }

    fn command(&mut self) -> Option<u8> {
        let byte = self.commands.pop()?;
        self.spend(self.costs.command_byte);
        Some(byte)
    }

    fn host(&mut self) -> &mut Metered<'l> {
        self.catch_up();
        &mut self.host
    }

    fn host_room(&self) -> usize {
        self.out.room()
    }

    fn now_ms(&self) -> u64 {
        self.now_ns() / 1_000_000
    }

    fn clock_error_ppm(&self) -> u32 {
        Boot::CRYSTAL_PPM
    }

    fn now_ticks(&self) -> u64 {
        self.now_ns()
    }

    fn driven_ticks(&self, _: &Pin) -> u64 {
        self.now_ns()
    }

    fn losses(&self) -> PortLosses {
        let mut losses = PortLosses::NONE;
        losses.gnss_bytes_lost = self.gnss.lost();
        losses.gnss_bytes_dropped = self.gnss.given_up();
        losses.command_bytes_lost = self.commands.dropped();
        losses.sentences_lost = self.host.outlet.lost();
        losses.log_bytes_lost = 0;
        losses
    }

    fn feed_watchdog(&mut self) {}

    /// Sleeps until the next millisecond, or until there is enough work; each byte interrupts the
    /// sleep briefly.
    fn sleep(&mut self) -> Option<u64> {
        self.catch_up();
        let next_ms = (self.now_ns() / 1_000_000 + 1) * 1_000_000;
        let mut woken_ns = None;
        while self.now_ns() < next_ms && !self.has_work() {
            let next_byte = self.wire.next(self.port_baud).map_or(next_ms, |(at_ns, ..)| at_ns);
            let now_ns = self.now_ns();
            self.clock.borrow_mut().now_ns = now_ns.max(next_ms.min(next_byte));
            self.catch_up();
            woken_ns = woken_ns.or(Some(self.now_ns()));
        }
        woken_ns
    }

    fn reset_cause(&self) -> ResetCause {
        ResetCause::PowerOn
    }

    fn sealed(&mut self) -> &mut [u8; SEALED_BYTES] {
        &mut self.sealed
    }

    fn set_gnss_rate(&mut self, baud: u32) {
        self.port_baud = u64::from(baud);
        self.outcome.rates.push((self.now_ns(), baud));
    }

    fn note(&mut self, _: Note) {}
}

/// Sends lumps to a module that has already processed the first `quiet` of them; the lines are
/// silent for a second afterwards.
///
/// # Panics
/// If the module does not start.
pub fn run(lumps: &[Vec<u8>], quiet: usize, lines: Lines<'_>, costs: Costs) -> Outcome {
    play(lumps, quiet, &[], lines, costs, lines.gnss_baud)
}

/// Works like [`run`], with a module that has obeyed commands, each without `$PRAIC,` and checksum.
///
/// # Panics
/// If the module does not start, or refuses a command.
pub fn run_with(lumps: &[Vec<u8>], quiet: usize, setup: &[&str], lines: Lines<'_>, costs: Costs) -> Outcome {
    play(lumps, quiet, setup, lines, costs, lines.gnss_baud)
}

/// Sends lumps to a module that has just started, with its port at the rate at start; the lines are
/// silent for a second afterwards.
///
/// # Panics
/// If the module does not start.
pub fn search(lumps: &[Vec<u8>], lines: Lines<'_>, costs: Costs) -> Outcome {
    play(lumps, 0, &[], lines, costs, u64::from(RATES[0]))
}

fn play(
    lumps: &[Vec<u8>],
    quiet: usize,
    setup: &[&str],
    lines: Lines<'_>,
    costs: Costs,
    port_baud: u64,
) -> Outcome {
    let clock = Clock::default();
    let boot = Boot::on_host("paced");
    let pin = Pin { clock: Rc::clone(&clock) };
    let mut receiver = Receiver::new(pin, boot).expect("the module starts");
    for text in setup {
        let mut answer = Vec::new();
        receiver.command(command(text).as_bytes(), &mut answer);
        assert!(answer.windows(3).any(|part| part == b",OK"), "{text} is refused");
    }
    // The first lumps contain all orbits and cause a search for the position. They are not
    // measured.
    let (before, timed) = lumps.split_at(quiet);
    for lump in before {
        receiver.gnss(lump, 0, &mut Vec::new());
    }
    let (gnss, commands, out) = (TimedRing::new(), Ring::new(), Ring::new());
    let host = Metered {
        outlet: Outlet::new(&out, || ()),
        clock: Rc::clone(&clock),
        byte_ns: costs.nanoseconds(costs.sentence_byte),
    };
    let mut model = Model {
        wire: wire(timed, lines),
        port_baud,
        clock: Rc::clone(&clock),
        costs,
        lines,
        ends: VecDeque::new(),
        pushed: 0,
        read: 0,
        gnss: &gnss,
        commands: &commands,
        out: &out,
        host,
        flooded: 0,
        sent_ns: 0,
        last_pass_ns: 0,
        outcome: Outcome::default(),
        sealed: [0; SEALED_BYTES],
    };
    *clock.borrow_mut() = Instant { epoch_ns: costs.nanoseconds(costs.epoch), ..Instant::default() };
    let end_ns = model.wire.end_ns() + 1_000_000_000;
    let mut epoch_loop = EpochLoop::new();
    while model.now_ns() < end_ns {
        let before = receiver.slices();
        epoch_loop.pass(&mut model, &mut receiver);
        model.outcome.passes += 1;
        // The loop sleeps behind the slices. Here they come behind the sleep, which is no earlier.
        let slices = receiver.slices() - before;
        model.outcome.slices += slices;
        model.spend(u64::from(slices) * costs.slice);
    }
    let mut outcome = model.outcome;
    outcome.lateness_ns = std::mem::take(&mut clock.borrow_mut().lateness_ns);
    outcome.counters = receiver.statistics().collect();
    outcome
}

/// Computes when the bytes of the lumps arrive: a lump each period, or after the one before if the
/// line is too slow.
fn wire(lumps: &[Vec<u8>], lines: Lines<'_>) -> Wire {
    let mut sent = Vec::new();
    let mut free_ns = 0;
    for (number, lump) in lumps.iter().enumerate() {
        free_ns = free_ns.max(number as u64 * lines.period_ns);
        for (index, &byte) in lump.iter().enumerate() {
            sent.push(Sent { start_ns: free_ns, byte, is_end: index + 1 == lump.len() });
            free_ns += byte_ns(lines.gnss_baud);
        }
    }
    Wire::new(sent, lines.gnss_baud)
}
