//! Arguments of the command `replay`.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::settings::{command_for, words};
use crate::signal::encode::{Frequency, Selection};

/// Place in which the module runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Place {
    /// In process.
    Host,
    /// On the emulated board, and in process for comparison.
    Board,
}

/// Systems that are used by default.
const SYSTEMS: &str = "GCE";

/// Number of frequencies that the module receives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Frequencies {
    /// Two, if they were received.
    Dual,
    /// Only the first.
    Single,
}

/// Arguments of the command.
#[derive(clap::Args)]
pub struct Arguments {
    /// Replay the bytes of a receiver, UBX, SBF or RTCM 3, with or without text: a file (.ubx, .sbf,
    /// .rtcm3, any; gz too), - for standard input, tcp://HOST:PORT, or serial:PATH@BAUD. The last two need
    /// --to. Several files of one logger are read in the order of time.
    #[arg(value_name = "CAPTURE", conflicts_with_all = ["obs", "sample"])]
    pub(super) capture: Vec<String>,
    /// Replay observation files instead of a capture: RINEX 2, 3 or 4; plain, gz, crx or crx.gz.
    #[arg(long, num_args = 1.., value_name = "FILE")]
    pub(super) obs: Vec<PathBuf>,
    /// Read navigation files of the same time. A capture needs none, and takes missing ephemerides
    /// from them.
    #[arg(long, num_args = 1.., value_name = "FILE")]
    pub(super) nav: Vec<PathBuf>,
    /// Fetch a small real recording (60 s, Kamakura, Japan) and use it.
    #[arg(long, conflicts_with_all = ["obs", "nav"])]
    pub(super) sample: bool,
    /// Set the true position of the antenna: X,Y,Z in metres, earth-fixed, or
    /// latitude,longitude,height in degrees and metres above the ellipsoid; or read the positions over
    /// time from a file: a table as for --truth-csv, NMEA, or a solution of RTKLIB (.pos).
    #[arg(long, value_name = "X,Y,Z|FILE", conflicts_with = "truth_csv", allow_hyphen_values = true)]
    pub(super) truth: Option<String>,
    /// Read the true positions of the antenna over time from a table whose heading names week,tow
    /// and `x_m,y_m,z_m` or `lat_deg,lon_deg,height_m`.
    #[arg(long, value_name = "FILE")]
    pub(super) truth_csv: Option<PathBuf>,
    /// Use these systems: G (GPS), C (`BeiDou`), E (Galileo), R (GLONASS), J (QZSS). The default is
    /// the first three.
    #[arg(long, value_name = "LETTERS", value_parser = |text: &str| Ok::<_, String>(text.to_uppercase()))]
    pub(super) systems: Option<String>,
    /// Set the GPS week of a capture's first epoch, not rolled over: 1709 is October 2012. The
    /// default is taken from the capture.
    #[arg(long, value_name = "N", requires = "capture", value_parser = clap::value_parser!(u16).range(0..=8191))]
    pub(super) week: Option<u16>,
    /// Use these frequencies.
    #[arg(long, value_enum, default_value = "dual")]
    pub(super) frequency: Frequencies,
    /// Run the module in process or on the emulated board.
    #[arg(long, value_enum, default_value = "host")]
    pub(super) on: Place,
    /// Inject a step or an outage: G05:+80@600..1200, E31:lost@..60; repeatable.
    #[arg(long, value_name = "FAULT")]
    pub(super) inject: Vec<String>,
    /// Inject a drift in m/s: G05:0.5@600..; repeatable.
    #[arg(long, value_name = "FAULT")]
    pub(super) ramp: Vec<String>,
    /// Start this number of seconds after the first epoch.
    #[arg(long, default_value_t = 0.0, value_name = "S", value_parser = not_negative, allow_negative_numbers = true)]
    pub(super) from: f64,
    /// End this number of seconds after the first epoch.
    #[arg(long, default_value_t = f64::INFINITY, hide_default_value = true, value_name = "S", value_parser = not_negative, allow_negative_numbers = true)]
    pub(super) to: f64,
    /// Skip epochs that come sooner than this after the last used one, s.
    #[arg(long, default_value_t = 0.0, value_name = "S", value_parser = not_negative, allow_negative_numbers = true)]
    pub(super) every: f64,
    /// Set the phase of flight, which sets the alert limits. CUSTOM needs --set HAL=METRES. The
    /// default is NPA.
    #[arg(long, ignore_case = true, value_parser = word("PHASE"))]
    pub(super) phase: Option<String>,
    /// Set the threshold of the test: from the false alarms, from the missed detections, or least
    /// cost of both. The default is T1.
    #[arg(long, ignore_case = true, value_parser = word("POLICY"))]
    pub(super) policy: Option<String>,
    /// Set the method that finds a faulty satellite. The default is AUTO.
    #[arg(long, ignore_case = true, value_parser = word("METHOD"))]
    pub(super) method: Option<String>,
    /// Set any other setting of the module, such as HAL=40 or MASK=5, or CONFIRM; repeatable, in this
    /// order.
    #[arg(long, value_name = "KEY=VALUE")]
    pub(super) set: Vec<String>,
    /// Print the summary as JSON.
    // A browser has its own form of it.
    #[cfg_attr(feature = "commands", arg(long))]
    #[cfg_attr(not(feature = "commands"), arg(skip))]
    pub(super) json: bool,
    /// Write one row per epoch.
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    /// Write one row per satellite and epoch: direction, C/N0, residual, sigma, w-test, reason.
    #[arg(long, value_name = "FILE")]
    pub(super) satellites: Option<PathBuf>,
    /// Write the sentences.
    #[arg(long, value_name = "FILE")]
    pub(super) nmea: Option<PathBuf>,
    /// Write the stream that the module received: RTCM, or the rest of the capture, with the
    /// faults.
    #[arg(long, value_name = "FILE")]
    pub(super) rtcm: Option<PathBuf>,
    /// Write a report, one HTML page with tables and plots, into this folder or to this `.html` file.
    #[arg(long, value_name = "DIR")]
    pub(super) report: Option<PathBuf>,
}

impl Arguments {
    /// Returns the name of the capture, or the names of several; `None` if there is none.
    pub(super) fn capture_name(&self) -> Option<String> {
        (!self.capture.is_empty()).then(|| self.capture.join(", "))
    }
}

/// Reads a word of one of the module's settings, in any case.
fn word(key: &str) -> impl TypedValueParser<Value = String> {
    PossibleValuesParser::new(words(key)).map(|word| word.to_uppercase())
}

/// Reads a number of seconds that is not negative.
fn not_negative(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| "is no number of seconds".to_owned())?;
    if seconds >= 0.0 { Ok(seconds) } else { Err("seconds are not negative".to_owned()) }
}

/// Returns the letters of the systems that take part, by the last setting.
pub(super) fn systems(arguments: &Arguments) -> String {
    let told = |setting: &String| setting.to_uppercase().strip_prefix("SYSTEMS=").map(str::to_owned);
    let set = arguments.set.iter().rev().find_map(told);
    set.or_else(|| arguments.systems.clone()).unwrap_or_else(|| SYSTEMS.to_owned())
}

pub(super) fn selection(arguments: &Arguments, systems: &str) -> Result<Selection> {
    let frequency = match arguments.frequency {
        Frequencies::Dual => Frequency::Dual,
        Frequencies::Single => Frequency::Single,
    };
    Selection::new(systems, frequency).context("--systems")
}

/// Returns the commands that configure the module; other settings stay as they start.
pub(super) fn commands(
    arguments: &Arguments,
    week: Option<u16>,
    klobuchar: Option<[f64; 8]>,
) -> Result<Vec<String>> {
    let given = [("PHASE", &arguments.phase), ("POLICY", &arguments.policy), ("METHOD", &arguments.method)];
    let mut setup: Vec<String> = given
        .iter()
        .filter_map(|(key, value)| value.as_ref().map(|value| format!("{key},{value}")))
        .collect();
    // GLONASS and QZSS take part only by a command. A recording is encoded with the selected
    // systems alone; from a capture the module selects them.
    let says_systems = |letters: &&String| !arguments.capture.is_empty() || letters.contains(['R', 'J']);
    setup.extend(arguments.systems.as_ref().filter(says_systems).map(|letters| format!("SYSTEMS,{letters}")));
    if !arguments.capture.is_empty() {
        setup.extend((arguments.frequency == Frequencies::Single).then(|| "FREQ,SINGLE".to_owned()));
    }
    setup.extend(week.map(|week| format!("WEEK,{week}")));
    if let Some(coefficients) = klobuchar {
        let numbers: Vec<String> = coefficients.iter().map(|value| format!("{value:e}")).collect();
        setup.push(format!("IONO,{}", numbers.join(",")));
    }
    for setting in &arguments.set {
        setup.push(command_for(setting)?);
    }
    let has_limit = setup.iter().any(|command| command.starts_with("HAL,"));
    ensure!(
        arguments.phase.as_deref() != Some("CUSTOM") || has_limit,
        "--phase CUSTOM has no limits of its own: give --set HAL=METRES"
    );
    Ok(setup)
}
