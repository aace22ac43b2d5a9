//! The epoch loop: bytes in, sentences and pin out.
//!
//! ```text
//! GNSS bytes ─► input ─► navigator ─► report ─► nmea ─► host bytes
//!                                       └────► integrity pin
//! ```
//!
//! The pin is high while the position of the last epoch may be used. It is low in every other case:
//!
//! - from start-up until the first protected epoch
//! - after every verdict but `Protected`
//! - after a report of a second receiver or of spoofing, until the next protected epoch
//! - after a change of a setting that affects protection, until the next protected epoch
//! - after a failed self-test, until the next start
//! - after an ordered restart
//! - if the last judged epoch is older than the time to alert
//!
//! The age of an epoch counts from its due time. The due time is the arrival of its first byte
//! minus its lateness. The delay of an epoch is its arrival minus its tag. Its lateness is this
//! delay minus the shortest one of earlier epochs that agreed with the orbits ([`lateness`]). If a
//! complete epoch is already older than the time to alert, it is discarded, because its verdict
//! would describe the past.
//!
//! Each epoch is reported at once. If no epoch is judged within the time to alert, the module
//! raises `STALE`, or `SOURCE` if it receives epochs of another source. A series of unavailable
//! epochs does not raise them, because these epochs were judged. The pin is low anyway.
//!
//! An epoch whose last byte has waited for more than [`LAG_MS`] is skipped and counted. If epochs
//! come faster than they can be judged, the newest is therefore judged and not the oldest.
//!
//! Deadline: an epoch is judged within the call that completes it. This is the call of
//! [`Receiver::gnss`] that brings its last byte, or [`Receiver::tick`] after a silence. The pin is
//! set before a sentence is written. The worst-case epoch of a stream, found by a search over the
//! settings that affect the work, takes 1.6 million instructions. By a model of the processor's
//! cycles and its flash, these are 15 to 24 ms at 168 MHz (`cargo xtask bench`). The pin follows
//! within 30 ms at 168 MHz and within 350 ms at 16 MHz. Both figures include a margin for epochs
//! worse than the search found. [`Receiver::tick`], which must be called at least ten times a
//! second, detects a silent line.

mod boot;
mod epochs;
mod lateness;
mod meaning;
mod rivals;
mod statistics;
mod strengths;
#[cfg(feature = "osnma")]
mod trusted;
mod verdicts;
#[cfg(feature = "osnma")]
mod work;

use core::mem::MaybeUninit;

use embedded_hal::digital::OutputPin;
use embedded_io::Write;
use raim_core::epoch::Epoch;
use raim_core::internals::velocity::Velocity;
use raim_core::monitor::MonitorError;
use raim_core::report::{Report, Verdict};
use raim_single::ValidatedRequirements;

pub use self::boot::Boot;
use self::epochs::{EpochLoop, requirements_at_start};
#[cfg(feature = "osnma")]
use self::trusted::Trusted;
pub use self::verdicts::Verdicts;
use crate::board::{PortLosses, SEALED_BYTES};
use crate::correction::CAPACITY;
use crate::counters::count_many;
use crate::input::{Input, LeapSecond, Suspicion};
use crate::known_place::HostHeight;
use crate::observer::Observer;
#[cfg(feature = "osnma")]
use crate::osnma::Summary;
use crate::output::nmea::{write_answer, write_counters, write_refusal, write_version};
use crate::settings::{Action, CommandPort, Configuration, Heard, Order, Refusal, Unsealed};

/// Silence that ends a frame and an epoch, ms. If epochs are closer together, the next one
/// completes the one before.
const SILENCE_MS: u64 = 500;

/// Pause of the line that never occurs inside a burst, ms.
const PAUSE_MS: u64 = 100;

/// Longest time that the last byte of an epoch may wait, ms; otherwise the epoch is skipped.
/// Reading costs a tenth of judging, so that a module that is behind catches up by reading only.
pub const LAG_MS: u64 = 40;

/// The module: everything except the hardware. `O` observes its verdicts.
#[derive(Debug)]
pub struct Receiver<P, O = ()> {
    boot: Boot,
    input: Input,
    commands: CommandPort,
    epochs: EpochLoop<P, O>,
    last_byte_ms: Option<u64>,
    /// Latest time that a caller has passed, ms.
    now_ms: u64,
    has_paused: bool,
    /// Number of the counter with which a long answer continues.
    next_counter: Option<usize>,
    losses: PortLosses,
    /// True if the settings have changed since they were sealed.
    is_unsealed: bool,
    reset_requested: bool,
    #[cfg(feature = "osnma")]
    turns: work::Turns,
}

impl<P: OutputPin> Receiver<P> {
    /// Returns a module before the first byte, and sets the pin low.
    ///
    /// # Errors
    /// [`MonitorError`] if the thresholds of the requirements at start are not in the tables.
    pub fn new(mut pin: P, boot: Boot) -> Result<Self, MonitorError> {
        let pin_failures = u32::from(pin.set_low().is_err());
        Ok(Self::of(pin, (), pin_failures, requirements_at_start()?, boot))
    }

    /// Works like [`Self::new`], but builds the module in its final place, with less stack.
    ///
    /// # Errors
    /// As [`Self::new`]; the place is then as it was.
    pub fn place(place: &mut MaybeUninit<Self>, mut pin: P, boot: Boot) -> Result<&mut Self, MonitorError> {
        let pin_failures = u32::from(pin.set_low().is_err());
        let requirements = requirements_at_start()?;
        Ok(place.write(Self::of(pin, (), pin_failures, requirements, boot)))
    }
}

impl<P: OutputPin, O: Observer> Receiver<P, O> {
    /// Works like [`Receiver::new`], with an observer.
    ///
    /// # Errors
    /// As [`Receiver::new`].
    #[cfg(feature = "observer")]
    pub fn observed(mut pin: P, observer: O, boot: Boot) -> Result<Self, MonitorError> {
        let pin_failures = u32::from(pin.set_low().is_err());
        Ok(Self::of(pin, observer, pin_failures, requirements_at_start()?, boot))
    }

    /// Works like [`Receiver::place`], with an observer.
    ///
    /// # Errors
    /// As [`Receiver::place`].
    #[cfg(feature = "observer")]
    pub fn place_observed(
        place: &mut MaybeUninit<Self>,
        mut pin: P,
        observer: O,
        boot: Boot,
    ) -> Result<&mut Self, MonitorError> {
        let pin_failures = u32::from(pin.set_low().is_err());
        let requirements = requirements_at_start()?;
        Ok(place.write(Self::of(pin, observer, pin_failures, requirements, boot)))
    }

    /// Returns a module whose pin the caller has tried to set low. `pin_failures` is the number of
    /// failed attempts.
    #[allow(clippy::inline_always, reason = "large values are built in their final place")]
    #[inline(always)]
    fn of(pin: P, observer: O, pin_failures: u32, requirements: ValidatedRequirements, boot: Boot) -> Self {
        // Built in one expression, so that large parts are written directly to their final place.
        Self {
            input: Input::new(),
            commands: CommandPort::new(),
            epochs: EpochLoop::new(pin, observer, pin_failures, requirements, boot.clock_error_ppm),
            boot,
            last_byte_ms: None,
            now_ms: 0,
            has_paused: true,
            next_counter: None,
            losses: PortLosses::NONE,
            is_unsealed: true,
            reset_requested: false,
            #[cfg(feature = "osnma")]
            turns: work::Turns::NONE,
        }
    }

    // Not inlined, nor are the other entry points with a large stack frame, so that their stacks do
    // not add up.

    /// Sends version, reset cause and the result of the self-test.
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

    /// Applies the settings that the previous run has sealed. If they are damaged or missing, no
    /// position is protected until the host sends `CONFIRM`. After power-on the default settings
    /// need no confirmation.
    pub fn restore(&mut self, memory: &[u8; SEALED_BYTES], after_power_on: bool) {
        match Configuration::unseal(memory) {
            _ if after_power_on => {}
            Unsealed::Settings(settings) => {
                self.epochs.configuration = settings;
                #[cfg(feature = "osnma")]
                self.rekey();
                // At start there is no verdict to withdraw.
                let _ = self.epochs.reconfigure();
            }
            Unsealed::Damaged | Unsealed::Nothing => self.epochs.is_confirmed = false,
        }
    }

    /// Seals the settings for the next start, if they have changed since the last call. Unconfirmed
    /// settings are not sealed, because the next start would treat them as confirmed.
    pub fn seal(&mut self, memory: &mut [u8; SEALED_BYTES]) {
        if self.epochs.is_confirmed && core::mem::take(&mut self.is_unsealed) {
            self.epochs.configuration.seal(memory);
        }
    }

    /// Takes bytes of the GNSS port that have just come. Returns true if an epoch was judged.
    pub fn gnss<W: Write>(&mut self, bytes: &[u8], now_ms: u64, host: &mut W) -> bool {
        self.gnss_since(bytes, now_ms, now_ms, host)
    }

    /// Takes bytes of the GNSS port that came at `came_ms`. Returns true if an epoch was judged.
    #[inline(never)]
    pub fn gnss_since<W: Write>(&mut self, bytes: &[u8], came_ms: u64, now_ms: u64, host: &mut W) -> bool {
        (self.last_byte_ms, self.now_ms) = (Some(came_ms), now_ms);
        #[cfg(feature = "osnma")]
        {
            self.turns.heard_ms = now_ms;
        }
        self.has_paused = false;
        let is_behind = now_ms.saturating_sub(came_ms) > LAG_MS;
        let Self { input, epochs, .. } = self;
        let mut judged = false;
        input.feed(bytes, came_ms, |event| judged |= epochs.handle(&event, is_behind, now_ms, host));
        confirm(input, epochs);
        if let Some(leap) = input.leap_second().filter(|leap| leap.seconds != epochs.gps_minus_utc_s) {
            epochs.gps_minus_utc_s = leap.seconds;
            epochs.navigator.correct_utc();
        }
        judged
    }

    /// Discards incomplete input, because bytes of the GNSS port were lost.
    pub fn interrupt(&mut self) {
        self.input.interrupt();
    }

    /// Returns true if the bytes of the GNSS port so far end with a whole frame, or with bytes that are
    /// none: a frame from elsewhere may follow.
    pub fn is_between_frames(&self) -> bool {
        self.input.is_between_frames()
    }

    /// Returns the number of valid frames of the GNSS port since start.
    pub fn frames(&self) -> u32 {
        self.input.counters().frames
    }

    /// Takes the losses at the ports.
    pub fn note_losses(&mut self, losses: &PortLosses) {
        let before = core::mem::replace(&mut self.losses, *losses).sentences_lost;
        count_many(
            &mut self.epochs.verdicts.host_lost,
            losses.sentences_lost.saturating_sub(before) as usize,
        );
    }

    /// Returns the losses at the ports.
    pub fn losses(&self) -> &PortLosses {
        &self.losses
    }

    /// Takes the time. Returns true if an epoch was judged or an alert raised.
    ///
    /// - A silence ends an incomplete frame and completes an open epoch.
    /// - A pause completes an epoch whose stated end is doubtful.
    /// - An alert is raised if no epoch was judged for the time to alert.
    #[inline(never)]
    pub fn tick<W: Write>(&mut self, now_ms: u64, host: &mut W) -> bool {
        self.now_ms = now_ms;
        let Self { input, epochs, .. } = self;
        let mut judged = false;
        let silent_ms = self.last_byte_ms.map(|last_ms| now_ms.saturating_sub(last_ms));
        let is_silent = silent_ms.is_some_and(|silent_ms| silent_ms >= SILENCE_MS);
        if is_silent {
            self.last_byte_ms = None;
            input.silence(|event| judged |= epochs.handle(&event, false, now_ms, host));
        }
        if !self.has_paused && silent_ms.is_some_and(|silent_ms| silent_ms >= PAUSE_MS) {
            self.has_paused = true;
            input.pause(|event| judged |= epochs.handle(&event, false, now_ms, host));
        }
        if is_silent {
            input.end_epoch(|event| judged |= epochs.handle(&event, false, now_ms, host));
        }
        confirm(input, epochs);
        judged |= epochs.tick(now_ms, input.hears_others(), host);
        #[cfg(feature = "osnma")]
        self.authenticate(now_ms);
        let losses = self.losses_to_say();
        self.epochs.repeat(now_ms, &losses, host);
        judged
    }

    /// Takes bytes of the host port and writes each answer whole, for a caller that can wait.
    #[inline(never)]
    pub fn command<W: Write>(&mut self, bytes: &[u8], host: &mut W) {
        for &byte in bytes {
            self.command_byte(byte, host);
            while self.has_more_to_say() {
                self.go_on(host);
            }
        }
    }

    /// Takes one byte of the host port; returns true if it ended a command that was obeyed. Call it
    /// only while [`Self::has_more_to_say`] is false.
    pub fn command_byte<W: Write>(&mut self, byte: u8, host: &mut W) -> bool {
        let heard = self.commands.push(byte, &mut self.epochs.configuration, host);
        self.carry_out(&heard, host);
        heard.action.is_some()
    }

    /// Obeys a command that the calling program gives, not the host port, and writes the complete
    /// answer. `values` are separated by commas; `None` asks for the value in force.
    ///
    /// Key and values must be text that a sentence may contain: printable ASCII without `$` and
    /// `*`, at most [`MAX_LINE`](crate::settings::MAX_LINE) characters.
    ///
    /// # Errors
    /// [`Refusal`] names the reason; nothing has changed then.
    #[inline(never)]
    pub fn set<W: Write>(&mut self, key: &str, values: Option<&str>, host: &mut W) -> Result<(), Refusal> {
        let heard = self.commands.set(key, values, &mut self.epochs.configuration, host);
        self.carry_out(&heard, host);
        while self.has_more_to_say() {
            self.go_on(host);
        }
        heard.refusal.map_or(Ok(()), Err)
    }

    fn carry_out<E, W: Write>(&mut self, heard: &Heard<E>, host: &mut W) {
        self.epochs.sent(heard.answered.is_ok());
        if let Some(action) = heard.action {
            self.act(action, host);
        }
    }

    /// Returns true if the answer to the last command is incomplete.
    pub fn has_more_to_say(&self) -> bool {
        self.next_counter.is_some()
    }

    /// Writes the next sentence of a long answer.
    #[inline(never)]
    pub fn go_on<W: Write>(&mut self, host: &mut W) {
        let Some(next) = self.next_counter else { return };
        let reported = write_counters(self.statistics_from(next), host);
        self.next_counter = reported.as_ref().ok().filter(|&&many| many > 0).map(|many| next + many);
        self.epochs.sent(reported.is_ok());
    }

    fn act<W: Write>(&mut self, action: Action, host: &mut W) {
        let written = match action {
            Action::Reconfigured => {
                self.is_unsealed = true;
                #[cfg(feature = "osnma")]
                self.rekey();
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
            Action::Order(Order::Height(height_m, sigma_m)) => {
                self.epochs.host_height = Some(HostHeight { height_m, sigma_m, came_ms: self.now_ms });
                Ok(())
            }
            #[cfg(feature = "osnma")]
            Action::Order(Order::Trust(utc_s, bound_s)) => {
                self.epochs.trusted = Some(Trusted { utc_s, bound_s, came_ms: self.now_ms });
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

    /// Returns true after the host has ordered a restart.
    pub fn reset_requested(&self) -> bool {
        self.reset_requested
    }

    /// Returns the last verdict: of an epoch, of the absence of epochs, or of a change of settings.
    pub fn last_verdict(&self) -> Option<Verdict> {
        self.epochs.last_verdict
    }

    /// Returns the report of the last epoch; `None` after a verdict without an epoch.
    pub fn last_report(&self) -> Option<&Report<CAPACITY>> {
        self.epochs.has_report.then(|| self.epochs.navigator.report())
    }

    /// Returns the corrected ranges of the last epoch; `None` after a verdict without an epoch.
    pub fn last_epoch(&self) -> Option<&Epoch<CAPACITY>> {
        self.epochs.has_report.then(|| self.epochs.navigator.epoch())
    }

    /// Returns the velocity of the last epoch, if it passed its test.
    pub fn velocity(&self) -> Option<&Velocity> {
        self.epochs.navigator.velocity()
    }

    /// Returns the last reports of jamming and of spoofing.
    pub fn interference(&self) -> (Suspicion, Suspicion) {
        (self.epochs.interference.jamming, self.epochs.interference.spoofing)
    }

    /// Returns GPS time minus UTC as received, with its source and time.
    pub fn leap_second(&self) -> Option<LeapSecond> {
        self.input.leap_second()
    }

    /// Returns what is known of the navigation data of Galileo; `None` without a key.
    #[cfg(feature = "osnma")]
    pub fn authentication(&self) -> Option<&Summary> {
        self.epochs.authentication.as_ref()
    }

    /// Returns the settings in force.
    pub fn configuration(&self) -> &Configuration {
        &self.epochs.configuration
    }

    /// Returns the pin.
    pub fn pin(&self) -> &P {
        &self.epochs.pin
    }

    /// Returns the observer.
    #[cfg(feature = "observer")]
    pub fn observer(&self) -> &O {
        &self.epochs.observer
    }

    /// Returns the observer, for example to take what it has stored.
    #[cfg(feature = "observer")]
    pub fn observer_mut(&mut self) -> &mut O {
        &mut self.epochs.observer
    }
}

/// Confirms the last epoch whose ranges agreed with orbits.
fn confirm<P, O>(input: &mut Input, epochs: &mut EpochLoop<P, O>) {
    if let Some((time, came_ms)) = epochs.agreed.take() {
        input.confirm(time, came_ms);
    }
}

#[cfg(test)]
mod tests;
