//! The plan of the service: the command line over a configuration file.
//!
//! ```toml
//! input = "serial:/dev/ttyUSB0@115200"
//! caster = "ntrip://user:password@caster.example:2101/MOUNT"     # orbits only
//! outputs = ["pty:/run/rai/nmea", "tcp://127.0.0.1:2950"]
//! pin = "gpio:/dev/gpiochip0:17"
//! report = "/var/lib/rai"
//!
//! [settings]                                                     # keys of INTERFACES.md
//! PHASE = "LPV200"
//! MASK = 5
//! ```

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Context as _, Result, ensure};
use serde::Deserialize;

use super::caster::Caster;
use super::clients::MOST_CLIENTS;
use super::log::Form;
use super::output::Sink;
use super::pin::Place;
use crate::replay::setting;
use crate::source::{self, Source};

/// Largest number of TCP clients that a user may allow. A process has 1024 files by default.
const LARGEST_CLIENTS: usize = 512;

/// Arguments of `rai run`, and the entries of its configuration file.
#[derive(Clone, Debug, Default, clap::Args, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[allow(clippy::doc_markdown, reason = "these comments are the help, which is not Markdown")]
pub struct Arguments {
    /// Configuration file; the options below outrank it.
    #[arg(long, short, value_name = "FILE")]
    #[serde(skip)]
    pub config: Option<PathBuf>,
    /// Receiver: serial:PORT@BAUD, tcp://HOST:PORT, - for standard input, or a file that a receiver's
    /// bytes were written to.
    #[arg(long, short, value_name = "SOURCE")]
    pub input: Option<String>,
    /// Caster of orbits: ntrip://USER:PASSWORD@HOST:PORT/MOUNTPOINT, or ntrips:// for TLS. Its ranges
    /// are never used.
    #[arg(long, value_name = "CASTER")]
    pub caster: Option<String>,
    /// Consumer: -, pty:PATH, serial:PORT@BAUD, tcp://ADDRESS:PORT, udp://ADDRESS:PORT,
    /// mavlink-udp://ADDRESS:PORT, mavlink-serial:PORT@BAUD, px4-udp://ADDRESS:PORT,
    /// px4-serial:PORT@BAUD, chrony:PATH; repeatable. Standard output unless one is given.
    #[arg(long, short, value_name = "SINK")]
    #[serde(rename = "outputs")]
    pub output: Vec<String>,
    /// Integrity pin: gpio:CHIP:LINE, file:PATH, or exec:PROGRAM (called with high or low, until it exits with 0).
    #[arg(long, value_name = "PIN")]
    pub pin: Option<String>,
    /// Setting of the module, such as PHASE=LPV200, or CONFIRM; repeatable, in this order.
    #[arg(long, value_name = "KEY=VALUE")]
    #[serde(skip)]
    pub set: Vec<String>,
    /// Settings of the file.
    #[arg(skip)]
    pub settings: BTreeMap<String, Value>,
    /// Serve at most this many TCP clients at once; 16 unless given.
    #[arg(long, value_name = "N")]
    pub clients: Option<usize>,
    /// Write a report, one HTML page, into this folder or to this `.html` file, every ten minutes
    /// and at the end.
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Pass the receiver's raw bytes to the TCP clients of this address: tcp://ADDRESS:PORT.
    #[arg(long, value_name = "SHARE")]
    pub share: Option<String>,
    /// Pass bytes of these clients to the receiver; otherwise they are dropped and counted.
    #[arg(long, requires = "share")]
    pub share_write: bool,
    /// Append the receiver's raw bytes to this file, for `rai replay`. Its size has no limit;
    /// each epoch adds one to five kilobytes.
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Serve a page of the running module here, read only: ADDRESS:PORT, or a PORT of this computer.
    #[arg(long, value_name = "ADDRESS")]
    pub page: Option<String>,
    /// Only drive the pin low, and end: what a service manager calls after the service has died.
    #[arg(long)]
    #[serde(skip)]
    pub lower_pin: bool,
    /// Report neither the start nor changes of the state on standard error; errors remain.
    #[arg(long, short)]
    #[serde(skip)]
    pub quiet: bool,
    /// Form of the start and of the changes of the state on standard error.
    #[arg(long, value_enum, value_name = "FORM", default_value = "text")]
    #[serde(skip)]
    pub log: Form,
}

/// The value of a setting in the file: a text, or a number as it stands.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, expecting = "a setting is a text in quotes or a number")]
pub enum Value {
    /// A text in quotes.
    Text(String),
    /// An integer.
    Whole(i64),
    /// A number with decimals.
    Decimal(f64),
}

impl Value {
    fn text(self) -> String {
        match self {
            Self::Text(text) => text,
            Self::Whole(number) => number.to_string(),
            Self::Decimal(number) => number.to_string(),
        }
    }
}

/// The parts of the service, each valid in form.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Source of the receiver's bytes.
    pub input: Source,
    /// That source as it was named: a file then takes the place of standard input.
    pub named: String,
    /// Caster of orbits.
    pub caster: Option<Caster>,
    /// Consumers of sentences and messages.
    pub outputs: Vec<Sink>,
    /// The pin.
    pub pin: Place,
    /// Largest number of TCP clients at once.
    pub clients: usize,
    /// Form of the log; `None` if the service is quiet.
    pub log: Option<Form>,
    /// Folder of the report.
    pub report: Option<PathBuf>,
    /// Address of the page.
    pub page: Option<String>,
    /// Address of the clients that get the receiver's bytes.
    pub share: Option<String>,
    /// True if the bytes of these clients go to the receiver.
    pub share_write: bool,
    /// File that keeps the receiver's bytes.
    pub record: Option<PathBuf>,
    /// Settings of the module in the order in which they are given: key, value.
    pub settings: Vec<(String, String)>,
}

impl Plan {
    /// Reads the configuration file, and lays the command line over it.
    ///
    /// # Errors
    /// If the file cannot be read or has an unknown entry, or if a value has the wrong form.
    pub fn read(line: Arguments) -> Result<Self> {
        let file = line.config.map_or_else(|| Ok(Arguments::default()), |path| read_file(&path))?;
        let input: Source = line.input.or(file.input).unwrap_or_else(|| "-".into()).parse()?;
        let mut outputs = if line.output.is_empty() { file.output } else { line.output };
        if outputs.is_empty() {
            outputs.push("-".into());
        }
        // PHASE sets what other keys refine, so it comes first.
        let text = |(key, value): (String, Value)| match value.text().as_str() {
            "" => key,
            value => format!("{key}={value}"),
        };
        let stated = file.settings.into_iter().map(|entry| setting(&text(entry)));
        let stated = stated.collect::<Result<Vec<_>>>()?;
        let (phase, rest): (Vec<_>, Vec<_>) = stated.into_iter().partition(|(key, _)| key == "PHASE");
        let given = line.set.iter().map(|text| setting(text)).collect::<Result<Vec<_>>>()?;
        let outputs: Vec<Sink> = outputs.iter().map(|text| text.parse()).collect::<Result<_>>()?;
        // PX4 gets what is made of these; a setting of the user outranks them.
        let for_px4 = ["GPS_INPUT,1", "HEARTBEAT,1"].map(|value| ("OUTPUT".to_owned(), value.to_owned()));
        let for_px4 = if outputs.iter().any(Sink::is_px4) { for_px4.to_vec() } else { Vec::new() };
        let settings = [for_px4, phase, rest, given].concat();
        ensure!(
            settings.iter().all(|(key, _)| !key.eq_ignore_ascii_case("RESET")),
            "RESET is a command and no setting: it would start the module again without an end"
        );
        let clients = line.clients.or(file.clients).unwrap_or(MOST_CLIENTS);
        ensure!(
            (1..=LARGEST_CLIENTS).contains(&clients),
            "clients must be within 1 to {LARGEST_CLIENTS}, not {clients}"
        );
        Ok(Self {
            named: input.to_string(),
            input: source::in_place_of(input)?,
            caster: line.caster.or(file.caster).map(|text| text.parse()).transpose()?,
            outputs,
            pin: line.pin.or(file.pin).map_or(Ok(Place::Nowhere), |text| text.parse())?,
            report: line.report.or(file.report),
            page: line.page.or(file.page),
            share: line.share.or(file.share),
            share_write: line.share_write || file.share_write,
            record: line.record.or(file.record),
            clients,
            log: (!line.quiet).then_some(line.log),
            settings,
        })
    }
}

/// Returns the place of the pin alone, so that no other mistake in the file keeps it high.
///
/// # Errors
/// If there is no file, or its pin has the wrong form.
pub(super) fn pin_alone(arguments: Arguments) -> Result<Place> {
    let named = match (arguments.pin, arguments.config) {
        (None, Some(path)) => {
            // Bytes that are no text are another mistake.
            let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
            pin_line(&String::from_utf8_lossy(&bytes)).with_context(|| path.display().to_string())?
        }
        (pin, _) => pin,
    };
    named.map_or(Ok(Place::Nowhere), |text| text.parse())
}

/// The line of the pin.
#[derive(Deserialize)]
struct Pin {
    pin: String,
}

/// Returns the value of the line `pin = …` before the first table.
fn pin_line(text: &str) -> Result<Option<String>> {
    let is_table = |line: &&str| line.starts_with('[') && line.trim_end().ends_with(']');
    let lines = text.lines().map(str::trim_start).take_while(|line| !is_table(line));
    let mut pins =
        lines.filter(|line| line.strip_prefix("pin").is_some_and(|rest| rest.trim_start().starts_with('=')));
    let Some(line) = pins.next() else { return Ok(None) };
    let Pin { pin } = toml::from_str(line).context("the line of the pin")?;
    Ok(Some(pin))
}

fn read_file(path: &std::path::Path) -> Result<Arguments> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    toml::from_str(&text).with_context(|| path.display().to_string())
}
