//! Inputs of all commands: one grammar, one way to open each, one policy to come back.
//!
//! | input | source |
//! |---|---|
//! | `-` | standard input |
//! | `tcp://HOST:PORT` | a server |
//! | `serial:PORT`, `serial:PORT@BAUD` | a serial port, at 115,200 bit/s unless given (`configure`: 38,400) |
//! | the path of a serial port, with or without `@BAUD` | the same |
//! | any other name | a file |
//!
//! | command | words | a line that ends or fails |
//! |---|---|---|
//! | `run --input` | all | is opened again after 0.25 s, then twice as long each time, up to 8 s |
//! | `run --caster` | a caster | is opened again after 10 s, then twice as long each time, up to 5 min |
//! | `replay` | all | ends the recording |
//! | `monitor --port`, `--tcp`, `--file` | a line, an address, a file | ends the view |
//! | `configure --port` | a line | is an error |

#[cfg(feature = "commands")]
mod line;
#[cfg(feature = "commands")]
mod pause;
#[cfg(feature = "commands")]
mod serial;
#[cfg(feature = "commands")]
mod standard_input;

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::{Result, bail, ensure};

#[cfg(feature = "commands")]
pub(crate) use line::{Line, connect, is_timeout, listen};
#[cfg(feature = "commands")]
pub(crate) use pause::Pause;
#[cfg(feature = "commands")]
pub(crate) use serial::open as open_serial;
#[cfg(feature = "commands")]
pub(crate) use standard_input::in_place_of;

/// Rate of a serial port if none is named: the module's own first guess.
pub(crate) const BAUD: u32 = 115_200;

/// Form of an input, for errors.
const FORM: &str = "an input is serial:PORT@BAUD, tcp://HOST:PORT, - or a file";

/// An input, as the user names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// Standard input.
    Standard,
    /// A server: `host:port`.
    Tcp(String),
    /// A serial port, and its rate, bit/s.
    Serial(String, u32),
    /// A file.
    File(PathBuf),
}

impl FromStr for Source {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::named(text, BAUD)
    }
}

impl Source {
    /// Reads the name of an input. A serial port without a rate has `baud`.
    fn named(text: &str, baud: u32) -> Result<Self> {
        if text == "-" {
            return Ok(Self::Standard);
        }
        if let Some(address) = text.strip_prefix("tcp://") {
            return Ok(Self::Tcp(address.to_owned()));
        }
        ensure!(
            !["ntrip://", "ntrips://"].iter().any(|scheme| text.starts_with(scheme)),
            "a caster sends ephemerides beside a receiver: rai run --input RECEIVER --caster {text}"
        );
        if let Some(port) = text.strip_prefix("serial:") {
            return Self::serial(port, baud);
        }
        if is_port(Path::new(text.rsplit_once('@').map_or(text, |(path, _)| path))) {
            return Self::serial(text, baud);
        }
        ensure!(!text.is_empty() && !text.contains("://"), "{FORM}, and `{text}` is none");
        Ok(Self::File(text.into()))
    }

    /// Reads the name of a line: a server, or else a serial port, with `baud` unless the name has a
    /// rate.
    ///
    /// # Errors
    /// It is standard input, or the rate is not a number.
    pub fn line(text: &str, baud: u32) -> Result<Self> {
        match Self::named(text, baud)? {
            Self::File(_) => Self::serial(text, baud),
            Self::Standard => bail!("must be a serial port or tcp://HOST:PORT"),
            source => Ok(source),
        }
    }

    /// Reads `PORT` or `PORT@BAUD`.
    fn serial(text: &str, baud: u32) -> Result<Self> {
        let (port, baud) =
            text.rsplit_once('@').map_or((text, Ok(baud)), |(port, baud)| (port, baud.parse()));
        let Ok(baud) = baud else { bail!("the rate behind @ must be a number: `{text}`") };
        Ok(Self::Serial(port.to_owned(), baud))
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Standard => f.write_str("standard input"),
            Self::Tcp(address) => write!(f, "tcp://{address}"),
            Self::Serial(port, baud) => write!(f, "serial:{port}@{baud}"),
            Self::File(path) => path.display().fmt(f),
        }
    }
}

/// Returns true for the path of a character device, in which no bytes end by themselves.
#[cfg(unix)]
fn is_port(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt as _;

    let is_null = path == Path::new("/dev/null");
    !is_null && path.metadata().is_ok_and(|metadata| metadata.file_type().is_char_device())
}

/// Returns true for the name of a serial port, such as `COM3`.
#[cfg(not(unix))]
fn is_port(path: &Path) -> bool {
    path.to_string_lossy().strip_prefix("COM").is_some_and(|number| number.parse::<u8>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::{BAUD, Source};

    #[test]
    fn sources_are_read_or_refused_with_their_form() {
        let source = |text: &str| text.parse::<Source>();
        let serial = |port: &str, baud| Source::Serial(port.into(), baud);
        assert_eq!(source("-").unwrap(), Source::Standard);
        assert_eq!(source("serial:/dev/ttyUSB0").unwrap(), serial("/dev/ttyUSB0", 115_200));
        assert_eq!(source("serial:COM3@9600").unwrap(), serial("COM3", 9_600));
        assert_eq!(source("tcp://[::1]:2000").unwrap(), Source::Tcp("[::1]:2000".into()));
        for file in ["drive.ubx", "/dev/null", "a@b.ubx", "/nowhere/at/all"] {
            assert_eq!(source(file).unwrap(), Source::File(file.into()));
        }
        for wrong in ["", "serial:/dev/ttyUSB0@fast", "udp://x:1", "ntrip://me:secret@caster.org/M"] {
            assert!(source(wrong).is_err(), "{wrong}");
        }
        assert!(source("ntrips://caster.org/M").unwrap_err().to_string().contains("--caster ntrips://"));
    }

    #[test]
    fn a_line_is_a_server_or_a_port() {
        let line = |text: &str| Source::line(text, 38_400).unwrap().to_string();
        assert_eq!(line("/dev/no-such-port"), "serial:/dev/no-such-port@38400");
        assert_eq!(line("COM3@9600"), "serial:COM3@9600");
        assert_eq!(line("tcp://a:1"), "tcp://a:1");
        assert!(Source::line("-", BAUD).is_err());
    }
}
