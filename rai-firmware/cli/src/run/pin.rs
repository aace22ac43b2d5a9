//! The integrity pin of a computer: a GPIO line, a file, or a command.
//!
//! The pin is low from the start of the service to the first promise, and again after its end. A
//! file falls even on a full disk: if it cannot be replaced, it is overwritten where it is, or
//! removed.

use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::str::FromStr;
use std::sync::Arc;

use anyhow::{Context as _, Result, bail};
use embedded_hal::digital::{Error, ErrorKind, ErrorType, OutputPin};

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

/// The wire behind the pin, which every thread may drive.
#[derive(Debug)]
pub enum Wire {
    /// No wire.
    Nowhere,
    /// A requested GPIO line.
    #[cfg(target_os = "linux")]
    Gpio(Line<gpiocdev::Request>),
    /// A file, replaced as a whole so that no reader sees half of it.
    File(PathBuf),
    /// A program.
    Program(String),
}

impl Wire {
    /// Opens the wire; a GPIO line is low from then on.
    ///
    /// # Errors
    /// If the line cannot be requested, or the folder of the file does not exist.
    pub fn open(place: &Place) -> Result<Self> {
        Ok(match place {
            Place::Nowhere => Self::Nowhere,
            Place::File(path) => Self::File(path.clone()),
            Place::Program(program) => Self::Program(program.clone()),
            Place::Gpio(chip, line) => gpio(chip, *line)?,
        })
    }

    /// Drives the wire.
    ///
    /// # Errors
    /// As the system reports them.
    pub fn drive(&self, high: bool) -> io::Result<()> {
        match self {
            Self::Nowhere => Ok(()),
            #[cfg(target_os = "linux")]
            Self::Gpio(line) => line.drive(high),
            Self::File(path) => match replace(path, high) {
                // A level that stays low is safe, one that stays high is not.
                Err(error) if !high => overwrite(path).or_else(|_| fs::remove_file(path)).map_err(|_| error),
                replaced => replaced,
            },
            Self::Program(program) => {
                let mut words = program.split_whitespace();
                let mut command = Command::new(words.next().unwrap_or_default());
                command.args(words).arg(if high { "high" } else { "low" }).stdin(Stdio::null());
                let mut child = command.spawn()?;
                // The loop does not wait for it; a thread takes its end.
                std::thread::spawn(move || child.wait());
                Ok(())
            }
        }
    }
}

/// Replaces a file as a whole, so that no reader sees half of it.
fn replace(path: &Path, high: bool) -> io::Result<()> {
    let next = path.with_extension("next");
    fs::write(&next, if high { "1\n" } else { "0\n" })?;
    fs::rename(&next, path)
}

/// Overwrites the level in a file with low, which needs no room on the disk.
fn overwrite(path: &Path) -> io::Result<()> {
    fs::OpenOptions::new().write(true).open(path)?.write_all(b"0\n")
}

/// Lines of a GPIO chip that a process has requested.
#[cfg(target_os = "linux")]
pub trait Lines {
    /// Sets one line.
    ///
    /// # Errors
    /// As the system reports them.
    fn set(&self, line: u32, high: bool) -> io::Result<()>;
}

#[cfg(target_os = "linux")]
impl Lines for gpiocdev::Request {
    fn set(&self, line: u32, high: bool) -> io::Result<()> {
        use gpiocdev::line::Value;
        let value = if high { Value::Active } else { Value::Inactive };
        self.set_value(line, value).map(drop).map_err(io::Error::other)
    }
}

/// One requested line.
#[cfg(target_os = "linux")]
#[derive(Debug)]
pub struct Line<L> {
    lines: L,
    number: u32,
}

#[cfg(target_os = "linux")]
impl<L: Lines> Line<L> {
    fn drive(&self, high: bool) -> io::Result<()> {
        self.lines.set(self.number, high)
    }
}

#[cfg(target_os = "linux")]
fn gpio(chip: &Path, line: u32) -> Result<Wire> {
    let lines =
        request(chip, line).request().with_context(|| format!("line {line} of {}", chip.display()))?;
    Ok(Wire::Gpio(Line { lines, number: line }))
}

/// Returns the request for a line: an output, low from the beginning.
#[cfg(target_os = "linux")]
fn request(chip: &Path, line: u32) -> gpiocdev::request::Builder {
    use gpiocdev::line::Value;
    let mut request = gpiocdev::Request::builder();
    request.on_chip(chip).with_consumer("rai").with_line(line).as_output(Value::Inactive);
    request
}

#[cfg(not(target_os = "linux"))]
fn gpio(_: &Path, _: u32) -> Result<Wire> {
    bail!("GPIO lines are known on Linux only: use file:PATH or exec:PROGRAM")
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

    /// Returns true if the pin was driven high.
    pub(super) fn is_high(&self) -> bool {
        self.is_high == Some(true)
    }

    fn drive(&mut self, high: bool) -> Result<(), PinError> {
        if self.is_high == Some(high) {
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

    /// A folder in the place of the next file stands for a disk that takes no new file.
    #[test]
    fn file_falls_on_a_disk_that_takes_no_new_file_and_does_not_rise() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pin");
        let mut pin = Pin::new(Arc::new(Wire::open(&Place::File(path.clone())).unwrap()));
        pin.set_high().unwrap();
        fs::create_dir(path.with_extension("next")).unwrap();
        pin.set_low().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "0\n");
        assert_eq!(pin.set_high(), Err(PinError));
        assert_eq!(fs::read_to_string(&path).unwrap(), "0\n");
    }

    #[cfg(target_os = "linux")]
    mod gpio_line {
        use std::cell::RefCell;

        use gpiocdev::line::{Direction, Value};

        use super::super::*;

        /// A chip that remembers what was set.
        #[derive(Default)]
        struct Chip(RefCell<Vec<(u32, bool)>>);

        impl Lines for Chip {
            fn set(&self, line: u32, high: bool) -> io::Result<()> {
                self.0.borrow_mut().push((line, high));
                Ok(())
            }
        }

        #[test]
        fn request_asks_for_one_output_that_is_low_and_not_inverted() {
            let request = request(Path::new("/dev/gpiochip7"), 17);
            let config = request.config();
            let line = config.line_config(17).unwrap();
            assert_eq!((line.direction, line.value), (Some(Direction::Output), Some(Value::Inactive)));
            assert!(!line.active_low && config.num_lines() == 1);
            assert_eq!(config.chip(), Path::new("/dev/gpiochip7"));
        }

        #[test]
        fn level_goes_to_the_line_that_was_named() {
            let line = Line { lines: Chip::default(), number: 17 };
            line.drive(true).unwrap();
            line.drive(false).unwrap();
            assert_eq!(*line.lines.0.borrow(), [(17, true), (17, false)]);
        }

        #[test]
        fn chip_that_is_not_there_is_named() {
            let place = "gpio:/dev/gpiochip-of-nobody:3".parse().unwrap();
            let error = format!("{:#}", Wire::open(&place).unwrap_err());
            assert!(error.contains("line 3 of /dev/gpiochip-of-nobody"), "{error}");
        }
    }
}
