//! The epoch loop: bytes in, sentences and pin out.
//!
//! ```text
//! GNSS bytes ─► rtcm ─► navigator ─► report ─► nmea ─► host bytes
//!                                       └────► integrity pin
//! ```
//!
//! The pin is high while the position of the last epoch may be used, and low in every other case: from reset on,
//! on every verdict but `Protected`, and when the time to alert has passed since the last epoch came. Other requirements
//! take the promise back until the next epoch, a missed known answer until the next start. An epoch that is complete
//! only after the time to alert is not judged at all: it would promise what was.
//!
//! What is said of an epoch is said at once; the time to alert bounds the silence after it. Epochs that come and are
//! unavailable are therefore never stale, however long it lasts: the pin went low with the first of them.
//!
//! Deadline: an epoch is judged within the call of [`Receiver::gnss`] that brings its last byte; the pin is set before
//! a sentence is written. The dearest epoch that is known takes 4.1 million instructions (40 satellites, two of them
//! faulty, a new selection of range consensus), the dearest first one, which brings all ephemerides, 5.3 million: 24 ms
//! and 31 ms at 168 MHz and one instruction a cycle (`cargo xtask bench`). A silent line is noticed by [`Receiver::tick`], to be called at least ten times a second.

use embedded_hal::digital::OutputPin;
use embedded_io::Write;
use rai_core::monitor::MonitorError;
use rai_core::report::{Alert, Report, Unavailable, Verdict};

use crate::arrival::Arrival;
use crate::config::{Action, CommandPort, Configuration};
use crate::correction::CAPACITY;
use crate::counters::{count, counters};
use crate::ephemeris::Insertion;
use crate::navigator::Navigator;
use crate::nmea::{
    GPS_MINUS_UTC_S, write_answer, write_counters, write_epoch, write_refusal, write_stale, write_version,
};
use crate::rtcm::{Decoder, Event};
use crate::selftest::{self, Failure};
use crate::time::GpsTime;

/// What the board knows when it starts.
#[derive(Clone, Debug)]
pub struct Boot {
    /// Commit that the image was built from.
    pub git: &'static str,
    /// Why it started, in the words of `PRAIV`.
    pub reset_cause: heapless::String<16>,
}

counters! {
    /// What the epochs came to.
    Verdicts {
        /// Position usable.
        epochs_protected,
        /// Position not to be used.
        epochs_alert,
        /// Nothing to be promised.
        epochs_unavailable,
        /// Epochs that were complete only after the time to alert.
        epochs_late,
        /// Times that the line was silent for the time to alert.
        line_stale,
        /// Ephemerides that told nothing new.
        ephemerides_kept,
        /// Sentences that the host port did not take.
        host_lost,
        /// Times that the pin could not be set.
        pin_failures,
    }
}

/// A pause of the line that no frame has inside, ms; shorter than the second between two epochs.
const SILENCE_MS: u64 = 500;

/// The module: everything but the hardware.
#[derive(Debug)]
pub struct Receiver<P> {
    boot: Boot,
    decoder: Decoder,
    arrival: Arrival,
    commands: CommandPort,
    epochs: EpochLoop<P>,
    last_byte_ms: Option<u64>,
    reset_requested: bool,
}

/// What happens to each thing that the decoder finds, and what is remembered of it.
#[derive(Debug)]
struct EpochLoop<P> {
    pin: P,
    navigator: Navigator,
    configuration: Configuration,
    verdicts: Verdicts,
    last_verdict: Option<Verdict>,
    last_time: Option<GpsTime>,
    /// When it came, or when its silence was last complained of.
    last_epoch_ms: u64,
    sigma_check: Option<f64>,
    is_sound: bool,
}

impl<P: OutputPin> Receiver<P> {
    /// A module that has heard nothing; the pin goes low.
    ///
    /// # Errors
    /// [`MonitorError`] if the thresholds of the requirements at start are not in the tables.
    pub fn new(pin: P, boot: Boot) -> Result<Self, MonitorError> {
        let configuration = Configuration::at_start();
        let mut epochs = EpochLoop {
            pin,
            navigator: Navigator::new(configuration.requirements)?,
            configuration,
            verdicts: Verdicts::default(),
            last_verdict: None,
            last_time: None,
            last_epoch_ms: 0,
            sigma_check: None,
            is_sound: true,
        };
        epochs.promise(false);
        let (decoder, arrival, commands) = (Decoder::new(), Arrival::default(), CommandPort::new());
        Ok(Self { boot, decoder, arrival, commands, epochs, last_byte_ms: None, reset_requested: false })
    }

    // Not inlined, nor are the other ways in: what one needs of the stack the others need not have beside theirs.

    /// Says what runs here, why it started, and whether its arithmetic is right.
    #[inline(never)]
    pub fn greet<W: Write>(&mut self, host: &mut W) {
        let selftest = match self.epochs.prove(selftest::run()) {
            Ok(()) => "PASS",
            Err(failure) => failure.name(),
        };
        let version = env!("CARGO_PKG_VERSION");
        let cause = &self.boot.reset_cause;
        self.epochs.sent(write_version(version, self.boot.git, cause, selftest, host).is_ok());
    }

    /// Takes bytes of the GNSS port.
    #[inline(never)]
    pub fn gnss<W: Write>(&mut self, bytes: &[u8], now_ms: u64, host: &mut W) {
        self.last_byte_ms = Some(now_ms);
        for &byte in bytes {
            self.arrival.before_byte(&self.decoder, now_ms);
            let mut event = self.decoder.push(byte);
            while let Some(found) = event {
                self.epochs.handle(&found, &mut self.arrival, now_ms, host);
                event = self.decoder.pending();
            }
            self.arrival.after_byte(&self.decoder);
        }
    }

    /// Looks at the clock: a cut frame holds nothing back any more after a pause, and a line that is silent for the
    /// time to alert is an alert.
    #[inline(never)]
    pub fn tick<W: Write>(&mut self, now_ms: u64, host: &mut W) {
        if self.last_byte_ms.is_some_and(|last_ms| now_ms.saturating_sub(last_ms) >= SILENCE_MS) {
            self.last_byte_ms = None;
            while let Some(found) = self.decoder.silence() {
                self.epochs.handle(&found, &mut self.arrival, now_ms, host);
            }
            self.arrival.after_byte(&self.decoder);
        }
        self.epochs.tick(now_ms, host);
    }

    /// Takes bytes of the host port.
    #[inline(never)]
    pub fn command<W: Write>(&mut self, bytes: &[u8], host: &mut W) {
        for &byte in bytes {
            let heard = self.commands.push(byte, &mut self.epochs.configuration, host);
            self.epochs.sent(heard.answered.is_ok());
            if let Some(action) = heard.action {
                self.act(action, host);
            }
        }
    }

    fn act<W: Write>(&mut self, action: Action, host: &mut W) {
        let written = match action {
            Action::Reconfigured => {
                self.epochs.reconfigure();
                Ok(())
            }
            Action::Statistics => write_counters(self.statistics(), host),
            Action::SelfTest => match self.epochs.prove(selftest::run()) {
                Ok(()) => write_answer("SELFTEST", core::iter::once("PASS"), host),
                Err(failure) => write_refusal("SELFTEST", failure.name(), host),
            },
            Action::Reset => {
                self.reset_requested = true;
                self.epochs.promise(false);
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

    /// The configuration in force.
    pub fn configuration(&self) -> &Configuration {
        &self.epochs.configuration
    }

    /// The pin, for whoever watches it.
    pub fn pin(&self) -> &P {
        &self.epochs.pin
    }

    /// Every counter by name: verdicts, wire, satellites, commands; and the mean of SSE/dof in percent, which is
    /// about 100 where the sigmas are right.
    pub fn statistics(&self) -> impl Iterator<Item = (&'static str, u32)> {
        let sigma_check =
            self.epochs.sigma_check.map(|mean| ("sigma_check_pct", libm::round(mean * 100.0) as u32));
        let tally = self.epochs.navigator.tally();
        self.epochs
            .verdicts
            .iter()
            .chain(sigma_check)
            .chain(self.decoder.counters().iter())
            .chain(tally.ephemerides.iter())
            .chain(tally.ranges.iter())
            .chain(self.commands.counters())
    }
}

impl<P: OutputPin> EpochLoop<P> {
    fn handle<W: Write>(&mut self, event: &Event<'_>, arrival: &mut Arrival, now_ms: u64, host: &mut W) {
        match event {
            Event::Epoch(raw) => {
                let came_ms = arrival.of_epoch();
                if now_ms.saturating_sub(came_ms) >= self.time_to_alert_ms() {
                    return count(&mut self.verdicts.epochs_late);
                }
                let mut report = self.navigator.judge(raw, &self.configuration);
                if !self.is_sound {
                    // What was computed by wrong arithmetic is no input for anybody.
                    report.verdict = Verdict::Unavailable(Unavailable::Input);
                }
                self.conclude(&report, raw.time, came_ms, host);
            }
            Event::Ephemeris(ephemeris) => {
                if matches!(self.navigator.learn(*ephemeris, self.last_time), Insertion::Older) {
                    count(&mut self.verdicts.ephemerides_kept);
                }
            }
            Event::ReferencePosition(point) => self.navigator.guess(*point),
        }
    }

    /// Acts on a report: the pin first, then the sentences.
    fn conclude<W: Write>(&mut self, report: &Report<CAPACITY>, time: GpsTime, came_ms: u64, host: &mut W) {
        self.promise(matches!(report.verdict, Verdict::Protected(_)));
        self.last_verdict = Some(report.verdict);
        self.last_time = Some(time);
        self.last_epoch_ms = came_ms;
        self.sigma_check = report.sigma_check;
        count(match report.verdict {
            Verdict::Protected(_) => &mut self.verdicts.epochs_protected,
            Verdict::Alert(_) => &mut self.verdicts.epochs_alert,
            Verdict::Unavailable(_) => &mut self.verdicts.epochs_unavailable,
        });
        let written = write_epoch(report, time, GPS_MINUS_UTC_S, &self.configuration.requirements, host);
        self.sent(written.is_ok());
    }

    fn tick<W: Write>(&mut self, now_ms: u64, host: &mut W) {
        if now_ms.saturating_sub(self.last_epoch_ms) < self.time_to_alert_ms() {
            return;
        }
        // Said again after each further time to alert: whoever listens later must hear it too.
        self.last_epoch_ms = now_ms;
        self.last_verdict = Some(Verdict::Alert(Alert::Stale));
        self.promise(false);
        count(&mut self.verdicts.line_stale);
        let written = write_stale(self.last_time, GPS_MINUS_UTC_S, &self.configuration.requirements, host);
        self.sent(written.is_ok());
    }

    fn time_to_alert_ms(&self) -> u64 {
        (self.configuration.requirements.time_to_alert_s * 1e3) as u64
    }

    /// Takes over what a command has changed. A promise under other requirements is none under these.
    fn reconfigure(&mut self) {
        let (judged_by, mut wanted) = (self.navigator.requirements(), self.configuration.requirements);
        // A promise says nothing about the time to alert, which holds at once.
        wanted.time_to_alert_s = judged_by.time_to_alert_s;
        if *judged_by != wanted {
            self.promise(false);
        }
        // Validated against the same tables by the command: it is met.
        let _ = self.navigator.configure(&self.configuration);
    }

    /// Notes how the known-answer tests ended: whoever fails one promises nothing any more.
    fn prove(&mut self, outcome: Result<(), Failure>) -> Result<(), Failure> {
        if outcome.is_err() {
            self.is_sound = false;
            self.promise(false);
        }
        outcome
    }

    /// Sets the integrity pin.
    fn promise(&mut self, usable: bool) {
        let set = if usable && self.is_sound { self.pin.set_high() } else { self.pin.set_low() };
        if set.is_err() {
            count(&mut self.verdicts.pin_failures);
        }
    }

    fn sent(&mut self, written: bool) {
        if !written {
            count(&mut self.verdicts.host_lost);
        }
    }
}

#[cfg(test)]
mod tests {
    use core::convert::Infallible;

    use embedded_hal::digital::ErrorType;
    use embedded_io::ErrorKind;
    use rai_core::requirements::Requirements;

    use super::*;

    #[derive(Debug)]
    struct Level {
        high: bool,
    }

    impl ErrorType for Level {
        type Error = Infallible;
    }

    impl OutputPin for Level {
        fn set_low(&mut self) -> Result<(), Infallible> {
            self.high = false;
            Ok(())
        }

        fn set_high(&mut self) -> Result<(), Infallible> {
            self.high = true;
            Ok(())
        }
    }

    /// A host that takes nothing.
    struct Deaf;

    impl embedded_io::ErrorType for Deaf {
        type Error = ErrorKind;
    }

    impl Write for Deaf {
        fn write(&mut self, _: &[u8]) -> Result<usize, ErrorKind> {
            Err(ErrorKind::TimedOut)
        }

        fn flush(&mut self) -> Result<(), ErrorKind> {
            Ok(())
        }
    }

    fn promising() -> Receiver<Level> {
        let boot = Boot { git: "test", reset_cause: heapless::String::new() };
        let mut receiver = Receiver::new(Level { high: true }, boot).expect("in the tables");
        receiver.epochs.promise(true);
        receiver
    }

    #[test]
    fn a_change_whose_answer_is_lost_is_judged_by_nevertheless() {
        let mut receiver = promising();
        receiver.command(b"$PRAIC,HAL,40*08\r\n", &mut Deaf);
        let want = Requirements { hal_m: 40.0, ..Requirements::non_precision_approach() };
        assert_eq!(receiver.configuration().requirements, want);
        assert_eq!(*receiver.epochs.navigator.requirements(), want);
    }

    #[test]
    fn a_reset_whose_answer_is_lost_is_made_nevertheless() {
        let mut receiver = promising();
        receiver.command(b"$PRAIC,RESET*30\r\n", &mut Deaf);
        assert!(receiver.reset_requested());
        assert!(!receiver.pin().high);
        assert_eq!(receiver.epochs.verdicts.host_lost, 1);
    }

    #[test]
    fn other_requirements_take_the_promise_back() {
        let mut receiver = promising();
        receiver.command(b"$PRAIC,MASK,5*68\r\n", &mut [0; 100].as_mut_slice());
        assert!(receiver.pin().high, "the mask is no requirement");
        receiver.command(b"$PRAIC,HAL,40*08\r\n", &mut [0; 100].as_mut_slice());
        assert!(!receiver.pin().high);
    }

    #[test]
    fn whoever_misses_a_known_answer_promises_nothing() {
        let mut receiver = promising();
        let _ = receiver.epochs.prove(Err(Failure::Table));
        assert!(!receiver.pin().high);
        receiver.epochs.promise(true);
        assert!(!receiver.pin().high);
    }
}
