//! The integrity pin of a computer: a GPIO line, a file, or a command.
//!
//! The pin is low from the start of the service to the first promise, and again after its end. A
//! file falls even on a full disk: if it cannot be replaced, it is overwritten where it is, or
//! removed.

mod file;
#[cfg(target_os = "linux")]
mod gpio;

use std::fmt;
use std::io;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError, TryLockError};
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, bail};
use embedded_hal::digital::{Error, ErrorKind, ErrorType, OutputPin};

use super::actuator::Actuator;
use super::reserve::Reserve;
use crate::run::words::say;

/// Longest time in which a program must drive the pin low at the start and at the end.
const LONGEST_LOW: Duration = Duration::from_secs(5);
/// Longest wait for another thread that drives the pin.
const LONGEST_TURN: Duration = Duration::from_millis(500);

/// The place of the pin, as the user names it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Place {
    /// There is no pin.
    #[default]
    Nowhere,
    /// `gpio:/dev/gpiochip0:17`: a line of a GPIO chip.
    Gpio(PathBuf, u32),
    /// `file:/run/rai/pin`: a file that holds `1` or `0`.
    File(PathBuf),
    /// `exec:PROGRAM`: a program that gets `high` or `low` as its last word, on each change.
    Program(String),
}

impl FromStr for Place {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let Some((kind, rest)) = text.split_once(':') else {
            bail!("a pin is gpio:CHIP:LINE, file:PATH or exec:PROGRAM, not `{text}`");
        };
        match kind {
            "gpio" => {
                let (chip, line) = rest.rsplit_once(':').context("gpio:CHIP:LINE needs a line")?;
                let line = line.parse().with_context(|| format!("line `{line}` must be a number"))?;
                Ok(Self::Gpio(chip.into(), line))
            }
            "file" => Ok(Self::File(rest.into())),
            "exec" => Ok(Self::Program(rest.to_owned())),
            _ => bail!("a pin is gpio:CHIP:LINE, file:PATH or exec:PROGRAM, not `{text}`"),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nowhere => f.write_str("none"),
            Self::Gpio(chip, line) => write!(f, "gpio:{}:{line}", chip.display()),
            Self::File(path) => write!(f, "file:{}", path.display()),
            Self::Program(program) => write!(f, "exec:{program}"),
        }
    }
}

/// The wire behind the pin, which every thread may drive.
#[derive(Debug)]
pub struct Wire {
    kind: Kind,
    /// Held while the wire is driven; true once it must stay low.
    is_closed: Mutex<bool>,
    is_high: AtomicBool,
    /// True while it must stay low, whatever the module drives.
    is_withheld: AtomicBool,
    reserve: Reserve,
}

#[derive(Debug)]
enum Kind {
    /// No wire.
    Nowhere,
    /// A requested GPIO line.
    #[cfg(target_os = "linux")]
    Gpio(gpio::Line<gpiocdev::Request>),
    /// A file, replaced as a whole so that no reader sees half of it.
    File(PathBuf),
    /// A program.
    Program(Actuator),
}

impl Wire {
    /// Opens the wire; a GPIO line is low from then on.
    ///
    /// # Errors
    /// If the line cannot be requested, or the folder of the file does not exist.
    pub fn open(place: &Place) -> Result<Self> {
        let kind = match place {
            Place::Nowhere => Kind::Nowhere,
            Place::File(path) => Kind::File(path.clone()),
            Place::Program(program) => Kind::Program(Actuator::start(program)),
            #[cfg(target_os = "linux")]
            Place::Gpio(chip, line) => Kind::Gpio(gpio::open(chip, *line)?),
            #[cfg(not(target_os = "linux"))]
            Place::Gpio(..) => bail!("GPIO lines are known on Linux only: use file:PATH or exec:PROGRAM"),
        };
        let [is_high, is_withheld] = [const { AtomicBool::new(false) }; 2];
        Ok(Self { kind, is_closed: Mutex::new(false), is_high, is_withheld, reserve: Reserve::new() })
    }

    /// Drives the wire. A program is started and not waited for.
    ///
    /// # Errors
    /// As the system reports them, or if the wire must rise and is [closed](Self::close).
    pub fn drive(&self, high: bool) -> io::Result<()> {
        let is_closed = self.is_closed.lock().unwrap_or_else(PoisonError::into_inner);
        if high && *is_closed {
            return Err(io::Error::other("the service is about to end"));
        }
        self.set(self.level(high))
    }

    /// Returns the level that is driven in the place of this one.
    fn level(&self, high: bool) -> bool {
        high && !self.is_withheld.load(Ordering::Relaxed)
    }

    /// Lets the wire be low until [`Self::release`], whatever the module drives.
    pub(super) fn withhold(&self) {
        if !self.is_withheld.swap(true, Ordering::Relaxed) {
            say!(
                "a consumer reads more slowly than sentences come: the pin is low until epochs are new again"
            );
        }
        if self.is_high() {
            // If it fails, the next epoch tries again.
            let _ = self.drive(false);
        }
    }

    /// Lets the next promise raise the wire.
    pub(super) fn release(&self) {
        self.is_withheld.store(false, Ordering::Relaxed);
    }

    fn set(&self, high: bool) -> io::Result<()> {
        let done = self.reserve.with(|| match &self.kind {
            Kind::Nowhere => Ok(()),
            #[cfg(target_os = "linux")]
            Kind::Gpio(line) => line.drive(high),
            Kind::File(path) => file::drive(path, high),
            Kind::Program(actuator) => {
                actuator.order(high);
                Ok(())
            }
        });
        if done.is_ok() {
            self.is_high.store(high, Ordering::Relaxed);
        }
        done
    }

    /// Returns true if the wire was driven high last.
    pub(super) fn is_high(&self) -> bool {
        self.is_high.load(Ordering::Relaxed)
    }

    /// Drives the wire low, and waits for a program to do so.
    ///
    /// # Errors
    /// As the system reports them, or if the program does not exit with 0 in time.
    pub fn lower(&self) -> io::Result<()> {
        self.drive(false)?;
        self.await_low()
    }

    fn await_low(&self) -> io::Result<()> {
        match &self.kind {
            Kind::Program(actuator) => actuator.lower(LONGEST_LOW),
            _ => Ok(()),
        }
    }

    /// Drives the wire low, unless another thread drives it at this moment.
    pub(super) fn try_low(&self) {
        if let Ok(is_closed) = self.is_closed.try_lock() {
            // If it fails, the next look tries again.
            let _ = self.set(false);
            drop(is_closed);
        }
    }

    /// Drives the wire low, and lets no thread drive it while something else is done.
    #[cfg(unix)]
    pub(super) fn hold_low(&self, meanwhile: impl FnOnce()) {
        let is_closed = self.is_closed.lock().unwrap_or_else(PoisonError::into_inner);
        // Whether or not it succeeds, nothing more can be done before the program stops.
        let _ = self.set(false).and_then(|()| self.await_low());
        meanwhile();
        drop(is_closed);
    }

    /// Drives the wire low for good: from now on no thread can raise it.
    ///
    /// # Errors
    /// As [`Self::lower`], or if another thread has hung while it drives the wire.
    pub fn close(&self) -> io::Result<()> {
        let start = Instant::now();
        let mut is_closed = loop {
            match self.is_closed.try_lock() {
                Ok(guard) => break guard,
                Err(TryLockError::Poisoned(poisoned)) => break poisoned.into_inner(),
                Err(TryLockError::WouldBlock) if start.elapsed() < LONGEST_TURN => {
                    std::thread::sleep(Duration::from_millis(1));
                }
                Err(TryLockError::WouldBlock) => {
                    return Err(io::Error::other("another thread drives the pin"));
                }
            }
        };
        *is_closed = true;
        let done = self.set(false);
        drop(is_closed);
        done.and_then(|()| self.await_low())
    }
}

/// The pin as the firmware drives it. A level that is there already is not set again.
#[derive(Debug)]
pub struct Pin {
    wire: Arc<Wire>,
    is_high: Option<bool>,
}

impl Pin {
    /// Makes a pin that has not been driven.
    pub fn new(wire: Arc<Wire>) -> Self {
        Self { wire, is_high: None }
    }

    /// Returns true if the pin was driven high, and is.
    pub(super) fn is_high(&self) -> bool {
        self.is_high == Some(true) && self.wire.is_high()
    }

    fn drive(&mut self, high: bool) -> Result<(), PinError> {
        // Another thread, or a wait for a consumer, may have lowered the wire.
        if self.is_high == Some(high) && self.wire.is_high() == self.wire.level(high) {
            return Ok(());
        }
        self.is_high = None;
        self.wire.drive(high).map_err(|_| PinError)?;
        self.is_high = Some(high);
        Ok(())
    }
}

/// The pin could not be driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PinError;

impl Error for PinError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl ErrorType for Pin {
    type Error = PinError;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), PinError> {
        self.drive(false)
    }

    fn set_high(&mut self) -> Result<(), PinError> {
        self.drive(true)
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::file::next_of;
    use super::*;

    #[test]
    fn places_are_read_or_refused_with_their_form() {
        let place = |text: &str| text.parse::<Place>();
        assert_eq!(place("gpio:/dev/gpiochip0:17").unwrap(), Place::Gpio("/dev/gpiochip0".into(), 17));
        assert_eq!(place("file:/run/rai/pin").unwrap(), Place::File("/run/rai/pin".into()));
        for wrong in ["", "17", "gpio:/dev/gpiochip0", "gpio:/dev/gpiochip0:x", "usb:1"] {
            assert!(place(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn file_holds_the_level() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pin");
        let mut pin = Pin::new(Arc::new(Wire::open(&Place::File(path.clone())).unwrap()));
        pin.set_low().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "0\n");
        pin.set_high().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "1\n");
        drop(folder);
        assert_eq!(pin.set_low(), Err(PinError));
    }

    /// Whatever another service does beside its own pin, whose name begins alike.
    #[test]
    fn next_file_is_that_of_no_other_pin() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pin.front");
        fs::create_dir(folder.path().join("pin.next")).unwrap();
        let wire = Wire::open(&Place::File(path.clone())).unwrap();
        wire.drive(true).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "1\n");
    }

    #[test]
    fn withheld_wire_falls_and_rises_once_it_is_released() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pin");
        let wire = Arc::new(Wire::open(&Place::File(path.clone())).unwrap());
        let mut pin = Pin::new(Arc::clone(&wire));
        pin.set_high().unwrap();
        wire.withhold();
        assert!(!pin.is_high());
        assert_eq!(fs::read_to_string(&path).unwrap(), "0\n");
        pin.set_high().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "0\n");
        wire.release();
        pin.set_high().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "1\n");
    }

    /// A folder in the place of the next file stands for a disk that takes no new file.
    #[test]
    fn file_falls_on_a_disk_that_takes_no_new_file_and_does_not_rise() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pin");
        let mut pin = Pin::new(Arc::new(Wire::open(&Place::File(path.clone())).unwrap()));
        pin.set_high().unwrap();
        fs::create_dir(next_of(&path)).unwrap();
        pin.set_low().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "0\n");
        assert_eq!(pin.set_high(), Err(PinError));
        assert_eq!(fs::read_to_string(&path).unwrap(), "0\n");
    }

    #[test]
    fn closed_wire_falls_and_does_not_rise_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pin");
        let wire = Arc::new(Wire::open(&Place::File(path.clone())).unwrap());
        let mut pin = Pin::new(Arc::clone(&wire));
        pin.set_high().unwrap();
        wire.close().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "0\n");
        pin.set_low().unwrap();
        assert_eq!(pin.set_high(), Err(PinError));
        assert_eq!(fs::read_to_string(&path).unwrap(), "0\n");
    }
}
