//! The epoch loop: bytes in, sentences and pin out.
//!
//! ```text
//! GNSS bytes ─► input ─► navigator ─► report ─► nmea ─► host bytes
//!                                       └────► integrity pin
//! ```
//!
//! The pin is high while the position of the last epoch may be used, and low in every other case: from reset on,
//! on every verdict but `Protected`, and when the time to alert has passed since the last epoch came. A change of a setting that a
//! promise rests on takes it back until the next epoch, a missed known answer until the next start. An epoch that is complete
//! only after the time to alert is not judged at all: it would promise what was. Nor is one that was so much longer on its way
//! than others before it, by its tag and the module's own clock ([`lateness`]): something holds back what it passes on.
//!
//! What is said of an epoch is said at once; the time to alert bounds the silence after it. Epochs that come and are
//! unavailable are therefore never stale, however long it lasts: the pin went low with the first of them.
//!
//! An epoch whose end has waited for more than [`LAG_MS`] is skipped, and counted: where epochs come faster than they can
//! be judged, the newest is judged and not the oldest.
//!
//! Deadline: an epoch is judged within the call of [`Receiver::gnss`] that brings its last byte; the pin is set before
//! a sentence is written. The worst-case epoch of a stream that a search over all settings has found (40 satellites,
//! twenty faulty) takes 2.4 million instructions: 14 ms at 168 MHz and one instruction a cycle (`cargo xtask bench`).
//! A silent line is noticed by [`Receiver::tick`], to be called at least ten times a second.

mod epochs;
mod lateness;

use embedded_hal::digital::OutputPin;
use embedded_io::Write;
use raim_core::monitor::MonitorError;
use raim_core::report::{Report, Verdict};
use raim_core::velocity::Velocity;

use self::epochs::EpochLoop;
pub use self::epochs::Verdicts;
use crate::board::{PortLosses, SEALED_BYTES};
use crate::correction::CAPACITY;
use crate::counters::{at, count_many};
use crate::input::{Input, LeapSecond, Suspicion};
use crate::output::nmea::{Losses, write_answer, write_counters, write_refusal, write_version};
use crate::settings::{Action, CommandPort, Configuration, Order, Unsealed};

/// What the board knows when it starts.
#[derive(Clone, Debug)]
pub struct Boot {
    /// Commit that the image was built from.
    pub git: &'static str,
    /// Why it started, in the words of `PRAIV`.
    pub reset_cause: heapless::String<16>,
    /// By how much the module's own clock may gain on the right time, parts per million: how old an epoch may be without being
    /// found late.
    pub clock_error_ppm: u32,
}

impl Boot {
    /// Of a clock with a crystal: some 50 ppm when new and through its temperatures, and as much again for its years.
    pub const CRYSTAL_PPM: u32 = 250;
    /// Of one without: within 1 % at room temperature. Whose clock is farther off than this reads no byte of a receiver.
    pub const WITHOUT_CRYSTAL_PPM: u32 = 40_000;

    /// As a program on a computer starts: for no reason of its own, and with a crystal.
    pub const fn on_host(git: &'static str) -> Self {
        Self { git, reset_cause: heapless::String::new(), clock_error_ppm: Self::CRYSTAL_PPM }
    }
}

/// A pause of the line that no frame has inside, ms; shorter than the second between two epochs.
const SILENCE_MS: u64 = 500;

/// A pause of the line that no burst has inside, ms.
const PAUSE_MS: u64 = 100;

/// How long the end of an epoch may have waited to be read, ms. Reading costs a tenth of what judging costs, so whoever is
/// behind catches up by reading alone.
pub const LAG_MS: u64 = 40;

/// The module: everything but the hardware.
#[derive(Debug)]
pub struct Receiver<P> {
    boot: Boot,
    input: Input,
    commands: CommandPort,
    epochs: EpochLoop<P>,
    last_byte_ms: Option<u64>,
    has_paused: bool,
    /// The counter that a long answer goes on with.
    next_counter: Option<usize>,
    losses: PortLosses,
    /// Whether the settings have changed since they were sealed.
    is_unsealed: bool,
    reset_requested: bool,
}

impl<P: OutputPin> Receiver<P> {
    /// A module that has heard nothing; the pin goes low.
    ///
    /// # Errors
    /// [`MonitorError`] if the thresholds of the requirements at start are not in the tables.
    pub fn new(pin: P, boot: Boot) -> Result<Self, MonitorError> {
        // In one piece: what is large is written where it is to stay.
        Ok(Self {
            input: Input::new(),
            commands: CommandPort::new(),
            epochs: EpochLoop::new(pin, boot.clock_error_ppm)?,
            boot,
            last_byte_ms: None,
            has_paused: true,
            next_counter: None,
            losses: PortLosses::NONE,
            is_unsealed: true,
            reset_requested: false,
        })
    }

    // Not inlined, nor are the other ways in: what one needs of the stack the others need not have beside theirs.

    /// Says what runs here, why it started, and whether its arithmetic is right.
    #[inline(never)]
    pub fn greet<W: Write>(&mut self, host: &mut W) {
        let selftest = match self.epochs.test_self() {
            Ok(()) => "PASS",
            Err(failure) => failure.name(),
        };
        let version = env!("CARGO_PKG_VERSION");
        let cause = &self.boot.reset_cause;
        self.epochs.sent(write_version(version, self.boot.git, cause, selftest, host).is_ok());
    }

    /// Takes over the settings that the program before has sealed. Where a restart has damaged them, nothing is promised
    /// until the host confirms those at start; after power-on they are what is meant.
    pub fn restore(&mut self, memory: &[u8; SEALED_BYTES], after_power_on: bool) {
        match Configuration::unseal(memory) {
            _ if after_power_on => {}
            Unsealed::Settings(settings) => {
                self.epochs.configuration = settings;
                // At start there is no promise to take back.
                let _ = self.epochs.reconfigure();
            }
            Unsealed::Damaged | Unsealed::Nothing => self.epochs.is_confirmed = false,
        }
    }

    /// Seals the settings for the next start, if they have changed since the last call. Not those that nobody has confirmed: a
    /// second restart would find them, and take them for what is meant.
    pub fn seal(&mut self, memory: &mut [u8; SEALED_BYTES]) {
        if self.epochs.is_confirmed && core::mem::take(&mut self.is_unsealed) {
            self.epochs.configuration.seal(memory);
        }
    }

    /// Takes bytes of the GNSS port that have come just now. Says whether an epoch was judged.
    pub fn gnss<W: Write>(&mut self, bytes: &[u8], now_ms: u64, host: &mut W) -> bool {
        self.gnss_since(bytes, now_ms, now_ms, host)
    }

    /// Takes bytes of the GNSS port that came at `came_ms`. Says whether an epoch was judged.
    #[inline(never)]
    pub fn gnss_since<W: Write>(&mut self, bytes: &[u8], came_ms: u64, now_ms: u64, host: &mut W) -> bool {
        self.last_byte_ms = Some(came_ms);
        self.has_paused = false;
        let is_behind = now_ms.saturating_sub(came_ms) > LAG_MS;
        let Self { input, epochs, .. } = self;
        let mut judged = false;
        input.feed(bytes, came_ms, |event| judged |= epochs.handle(&event, is_behind, now_ms, host));
        if let Some((time, came_ms)) = epochs.agreed.take() {
            input.confirm(time, came_ms);
        }
        if let Some(leap) = input.leap_second().filter(|leap| leap.seconds != epochs.gps_minus_utc_s) {
            epochs.gps_minus_utc_s = leap.seconds;
            epochs.navigator.correct_utc();
        }
        judged
    }

    /// Bytes of the GNSS port were lost: what is under way is a part of something.
    pub fn interrupt(&mut self) {
        self.input.interrupt();
    }

    /// Frames of the GNSS port with a right check, since start.
    pub fn frames(&self) -> u32 {
        self.input.counters().frames
    }

    /// Takes over what was lost at the ports.
    pub fn note_losses(&mut self, losses: &PortLosses) {
        let before = core::mem::replace(&mut self.losses, *losses).sentences_lost;
        count_many(
            &mut self.epochs.verdicts.host_lost,
            losses.sentences_lost.saturating_sub(before) as usize,
        );
    }

    /// What was lost at the ports.
    pub fn losses(&self) -> &PortLosses {
        &self.losses
    }

    /// Looks at the clock: a cut frame holds nothing back any more after a pause, and a line that is silent for the
    /// time to alert is an alert. Says whether something was said.
    #[inline(never)]
    pub fn tick<W: Write>(&mut self, now_ms: u64, host: &mut W) -> bool {
        let Self { input, epochs, .. } = self;
        let mut judged = false;
        let silent_ms = self.last_byte_ms.map(|last_ms| now_ms.saturating_sub(last_ms));
        if silent_ms.is_some_and(|silent_ms| silent_ms >= SILENCE_MS) {
            self.last_byte_ms = None;
            input.silence(|event| judged |= epochs.handle(&event, false, now_ms, host));
        }
        if !self.has_paused && silent_ms.is_some_and(|silent_ms| silent_ms >= PAUSE_MS) {
            self.has_paused = true;
            input.pause(|event| judged |= epochs.handle(&event, false, now_ms, host));
        }
        judged |= epochs.tick(now_ms, input.hears_others(), host);
        let losses = self.losses_to_say();
        self.epochs.repeat(now_ms, &losses, host);
        judged
    }

    fn losses_to_say(&self) -> Losses {
        let wire = self.input.counters();
        let PortLosses { gnss_bytes_lost, gnss_bytes_dropped, command_bytes_lost, .. } = self.losses;
        Losses {
            gnss_bytes: gnss_bytes_lost.saturating_add(gnss_bytes_dropped),
            host_bytes: command_bytes_lost,
            frames_refused: wire.crc_failures.saturating_add(wire.messages_malformed),
            epochs_late: self.epochs.verdicts.epochs_late,
        }
    }

    /// Takes bytes of the host port, and says all there is to say to them: for a host that waits for nothing else.
    #[inline(never)]
    pub fn command<W: Write>(&mut self, bytes: &[u8], host: &mut W) {
        for &byte in bytes {
            self.command_byte(byte, host);
            while self.has_more_to_say() {
                self.go_on(host);
            }
        }
    }

    /// Takes one byte of the host port; says whether it ended a command that was obeyed. None is to be taken while there is
    /// more to say to the last one.
    pub fn command_byte<W: Write>(&mut self, byte: u8, host: &mut W) -> bool {
        let heard = self.commands.push(byte, &mut self.epochs.configuration, host);
        self.epochs.sent(heard.answered.is_ok());
        if let Some(action) = heard.action {
            self.act(action, host);
        }
        heard.action.is_some()
    }

    /// Whether the answer to the last command is not complete.
    pub fn has_more_to_say(&self) -> bool {
        self.next_counter.is_some()
    }

    /// Says the next sentence of a long answer.
    #[inline(never)]
    pub fn go_on<W: Write>(&mut self, host: &mut W) {
        let Some(next) = self.next_counter else { return };
        let said = write_counters(self.statistics_from(next), host);
        self.next_counter = said.as_ref().ok().filter(|&&many| many > 0).map(|many| next + many);
        self.epochs.sent(said.is_ok());
    }

    fn act<W: Write>(&mut self, action: Action, host: &mut W) {
        let written = match action {
            Action::Reconfigured => {
                self.is_unsealed = true;
                if self.epochs.reconfigure() { self.epochs.take_back(host) } else { Ok(()) }
            }
            Action::Order(Order::Confirm) => {
                self.epochs.is_confirmed = true;
                Ok(())
            }
            Action::Order(Order::Statistics) => {
                self.next_counter = Some(0);
                Ok(())
            }
            Action::Order(Order::SelfTest) => match self.epochs.test_self() {
                Ok(()) => write_answer("SELFTEST", core::iter::once("PASS"), None, host),
                Err(failure) => write_refusal("SELFTEST", failure.name(), host),
            },
            Action::Order(Order::Forget) => {
                self.epochs.forget();
                self.input.forget();
                Ok(())
            }
            Action::Order(Order::Week(week)) => {
                self.input.assume(week);
                self.epochs.forget_lateness();
                Ok(())
            }
            Action::Order(Order::Reset) => {
                self.reset_requested = true;
                self.epochs.drive_pin(false);
                Ok(())
            }
        };
        self.epochs.sent(written.is_ok());
    }

    /// True once the host has asked for a restart.
    pub fn reset_requested(&self) -> bool {
        self.reset_requested
    }

    /// What was said of the last epoch, or that there was none for too long.
    pub fn last_verdict(&self) -> Option<Verdict> {
        self.epochs.last_verdict
    }

    /// The report of the last epoch, unless a silence has been said since.
    pub fn last_report(&self) -> Option<&Report<CAPACITY>> {
        self.epochs.has_report.then(|| self.epochs.navigator.report())
    }

    /// The velocity of the last epoch, where there is one that passed its test.
    pub fn velocity(&self) -> Option<&Velocity> {
        self.epochs.navigator.velocity()
    }

    /// What the receiver said last of jamming and of spoofing.
    pub fn interference(&self) -> (Suspicion, Suspicion) {
        (self.epochs.interference.jamming, self.epochs.interference.spoofing)
    }

    /// GPS time minus UTC as it came in, who said so and when.
    pub fn leap_second(&self) -> Option<LeapSecond> {
        self.input.leap_second()
    }

    /// The configuration in force.
    pub fn configuration(&self) -> &Configuration {
        &self.epochs.configuration
    }

    /// The pin, for whoever watches it.
    pub fn pin(&self) -> &P {
        &self.epochs.pin
    }

    /// Every counter by name: verdicts, ports, wire, satellites, range rates, commands; and the mean of SSE/dof in percent, which is
    /// about 100 where the sigmas are right.
    pub fn statistics(&self) -> impl Iterator<Item = (&'static str, u32)> {
        self.statistics_from(0)
    }

    fn statistics_from(&self, first: usize) -> impl Iterator<Item = (&'static str, u32)> {
        (first..).map_while(|number| self.statistic(number))
    }

    /// The counter of a number.
    #[inline(never)]
    fn statistic(&self, mut number: usize) -> Option<(&'static str, u32)> {
        let number = &mut number;
        let sigma_check =
            self.epochs.sigma_check.map(|mean| ("sigma_check_pct", libm::round(mean * 100.0) as u32));
        let tally = self.epochs.navigator.tally();
        let verdict = self.epochs.verdicts.at(number);
        verdict
            .or_else(|| match sigma_check {
                Some((name, percent)) => at(&[name], &[percent], number),
                None => None,
            })
            .or_else(|| self.losses.at(number))
            .or_else(|| self.input.counters().at(number))
            .or_else(|| tally.ephemerides.at(number))
            .or_else(|| at(&["ephemerides_displaced"], &[self.epochs.navigator.displaced()], number))
            .or_else(|| tally.ranges.at(number))
            .or_else(|| self.epochs.navigator.rate_tally().at(number))
            .or_else(|| self.commands.counter(*number))
    }
}

#[cfg(test)]
mod tests;
