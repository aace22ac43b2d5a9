//! `cargo xtask replay`: a recording through the module.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};
use tests_host::encode::{Frequency, Selection};
use tests_host::fault::Fault;
use tests_host::recording::Recording;

use tests_host::replay::{self, BoardRun, HostRun, Lump, Pace, Summary, Track, Truth, Window};
use tests_host::{image, sample, setup};

/// Where the module runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Place {
    /// In process.
    Host,
    /// On the emulated board, and in process for comparison.
    Board,
}

/// How many frequencies the module gets to see.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Frequencies {
    /// Two, where they were received.
    Dual,
    /// The first only.
    Single,
}

/// Phases of flight that the module knows.
const PHASES: [&str; 5] = ["ENROUTE", "TERMINAL", "NPA", "LPV200", "CUSTOM"];
/// Policies that the module knows.
const POLICIES: [&str; 3] = ["T1", "T2", "TOP"];
/// Methods that the module knows; one that is not built in it refuses by name.
const METHODS: [&str; 8] =
    ["AUTO", "BAARDA", "SIMULTANEOUS", "SEQUENTIAL", "HYBRID", "GROUPING", "RANSAC", "SEPARATION"];

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Observation files: RINEX 2, 3 or 4; plain, gz, crx or crx.gz.
    #[arg(long, num_args = 1.., value_name = "FILE", required_unless_present = "sample")]
    obs: Vec<PathBuf>,
    /// Navigation files of the same time.
    #[arg(long, num_args = 1.., value_name = "FILE", required_unless_present = "sample")]
    nav: Vec<PathBuf>,
    /// Fetch a small real recording (60 s, Kamakura, Japan) and use it.
    #[arg(long, conflicts_with_all = ["obs", "nav"])]
    sample: bool,
    /// Where the antenna was: X,Y,Z in metres, earth-fixed, or latitude,longitude,height in degrees and metres.
    #[arg(long, value_name = "X,Y,Z", conflicts_with = "truth_csv", allow_hyphen_values = true)]
    truth: Option<String>,
    /// Where the antenna was when: a table whose heading names week,tow and `x_m,y_m,z_m` or `lat_deg,lon_deg,height_m`.
    #[arg(long, value_name = "FILE")]
    truth_csv: Option<PathBuf>,
    /// Systems to use: G (GPS), C (`BeiDou`), E (Galileo).
    #[arg(long, default_value = "GCE", value_name = "LETTERS")]
    systems: String,
    /// Frequencies to use.
    #[arg(long, value_enum, default_value = "dual")]
    frequency: Frequencies,
    /// Where the module runs.
    #[arg(long, value_enum, default_value = "host")]
    on: Place,
    /// A step or an outage: G05:+80@600..1200, E31:lost@..60; repeatable.
    #[arg(long, value_name = "FAULT")]
    inject: Vec<String>,
    /// A drift in m/s: G05:0.5@600..; repeatable.
    #[arg(long, value_name = "FAULT")]
    ramp: Vec<String>,
    /// Seconds after the first epoch at which to start.
    #[arg(long, default_value_t = 0.0, value_name = "S", value_parser = not_negative, allow_negative_numbers = true)]
    from: f64,
    /// Seconds after the first epoch at which to end.
    #[arg(long, default_value_t = f64::INFINITY, hide_default_value = true, value_name = "S", value_parser = not_negative, allow_negative_numbers = true)]
    to: f64,
    /// Least time between epochs, s.
    #[arg(long, default_value_t = 0.0, value_name = "S", value_parser = not_negative, allow_negative_numbers = true)]
    every: f64,
    /// Phase of flight: sets the alert limits. CUSTOM needs --set HAL=METRES.
    #[arg(long, default_value = "NPA", ignore_case = true, value_parser = PHASES)]
    phase: String,
    /// Threshold of the test: from the false alarms, from the missed detections, or least cost of both.
    #[arg(long, default_value = "T1", ignore_case = true, value_parser = POLICIES)]
    policy: String,
    /// How a faulty satellite is found.
    #[arg(long, default_value = "BAARDA", ignore_case = true, value_parser = METHODS)]
    method: String,
    /// Any other setting of the module, such as HAL=40 or MASK=5; repeatable, in this order.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
    /// Write one row per epoch.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write the sentences.
    #[arg(long, value_name = "FILE")]
    nmea: Option<PathBuf>,
    /// Write the RTCM stream.
    #[arg(long, value_name = "FILE")]
    rtcm: Option<PathBuf>,
    /// Write an HTML report with plots into this folder.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
}

/// What to replay, read and checked.
struct Source {
    recording: Recording,
    truth: Option<Truth>,
    faults: Vec<Fault>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let window = Window { from_s: arguments.from, to_s: arguments.to, every_s: arguments.every };
    let frequency = match arguments.frequency {
        Frequencies::Dual => Frequency::Dual,
        Frequencies::Single => Frequency::Single,
    };
    let selection = Selection::new(&arguments.systems, frequency).context("--systems")?;
    let source = source(arguments, &selection)?;
    let lumps = replay::encode(&source.recording, &selection, &source.faults, &window)?;
    let commands = commands(arguments, &source.recording)?;

    let host = replay::on_host(&lumps, &commands, Pace::Recorded, progress(&lumps, "on the host"))?;
    let on_board = match arguments.on {
        Place::Host => None,
        Place::Board => Some(run_on_board(&lumps, &commands)?),
    };
    let identical = on_board.as_ref().map(|(host, board)| board.sentences == host.sentences());
    let board = on_board.map(|(_, board)| board);
    let track = replay::track(&lumps, &host, source.truth.as_ref())?;
    let counters = host.counters.iter().filter(|(_, count)| *count > 0).cloned().collect();
    let summary = Summary {
        host_target_identical: identical,
        malformed: source.recording.malformed,
        counters,
        ..Summary::of(&track, &source.faults, source.truth.is_some())
    };
    write_files(arguments, &lumps, &host, &track)?;
    if let Some(folder) = &arguments.report {
        let path = replay::write_report(folder, &track, &source.faults, &summary)?;
        eprintln!("report: {}", path.display());
    }
    print(arguments, &summary, board.as_ref())?;
    ensure!(identical != Some(false), "the board's sentences differ from the host's");
    Ok(())
}

fn source(arguments: &Arguments, selection: &Selection) -> Result<Source> {
    let mut truth = match (&arguments.truth, &arguments.truth_csv) {
        (Some(text), _) => Some(Truth::parse(text).context("--truth")?),
        (None, Some(path)) => Some(Truth::from_csv(path).context("--truth-csv")?),
        (None, None) => None,
    };
    let steps = arguments.inject.iter().map(|text| Fault::parse_inject(text));
    let ramps = arguments.ramp.iter().map(|text| Fault::parse_ramp(text));
    let faults = steps.chain(ramps).collect::<Result<_, _>>()?;
    let recording = if arguments.sample {
        let sample = sample::fetch(Path::new("target"))?;
        truth = truth.or(Some(Truth::Fixed(sample.truth)));
        Recording::load_of(&[sample.observations], &[sample.navigation], &selection.systems)?
    } else {
        Recording::load_of(&arguments.obs, &arguments.nav, &selection.systems)?
    };
    Ok(Source { recording, truth, faults })
}

/// A number of seconds that time can have.
fn not_negative(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| "is no number of seconds".to_owned())?;
    if seconds >= 0.0 { Ok(seconds) } else { Err("seconds are not negative".to_owned()) }
}

/// Commands that configure the module as asked.
fn commands(arguments: &Arguments, recording: &Recording) -> Result<Vec<String>> {
    let mut setup = vec![
        format!("PHASE,{}", arguments.phase),
        format!("POLICY,{}", arguments.policy),
        format!("METHOD,{}", arguments.method),
    ];
    if let Some(coefficients) = recording.klobuchar {
        let numbers: Vec<String> = coefficients.iter().map(|value| format!("{value:e}")).collect();
        setup.push(format!("IONO,{}", numbers.join(",")));
    }
    for setting in &arguments.set {
        let (key, value) =
            setting.split_once('=').with_context(|| format!("--set {setting}: write it like HAL=40"))?;
        setup.push(format!("{},{value}", key.to_uppercase()));
    }
    let has_limit = setup.iter().any(|command| command.starts_with("HAL,"));
    ensure!(
        arguments.phase != "CUSTOM" || has_limit,
        "--phase CUSTOM has no limits of its own: give --set HAL=METRES"
    );
    Ok(setup)
}

/// The board's run, and the host's in lock step with it, which the board is held against.
fn run_on_board(lumps: &[Lump], commands: &[String]) -> Result<(HostRun, BoardRun)> {
    setup::ensure()?;
    let image = image::build()?;
    let host = replay::on_host(lumps, commands, Pace::LockStep, |_| ())?;
    let board = replay::on_board(&image, lumps, &host, commands, progress(lumps, "on the board"))?;
    Ok((host, board))
}

/// A bar that shows on a terminal only.
fn progress(lumps: &[Lump], place: &'static str) -> impl FnMut(usize) {
    let style = ProgressStyle::with_template("{msg} {bar:40} {pos}/{len} epochs {per_sec} {eta}");
    let bar = ProgressBar::new(lumps.len() as u64).with_message(place);
    if let Ok(style) = style {
        bar.set_style(style);
    }
    move |done| {
        bar.set_position(done as u64);
        if done as u64 == bar.length().unwrap_or(0) {
            bar.finish_and_clear();
        }
    }
}

fn write_files(arguments: &Arguments, lumps: &[Lump], host: &HostRun, track: &Track) -> Result<()> {
    if let Some(path) = &arguments.csv {
        let file = File::create(path).with_context(|| format!("cannot write {}", path.display()))?;
        let written = replay::write_csv(track, &mut BufWriter::new(file));
        written.with_context(|| format!("cannot write {}", path.display()))?;
    }
    let rtcm = || lumps.iter().flat_map(|lump| lump.bytes.iter().copied()).collect::<Vec<u8>>();
    for (path, bytes) in [
        (&arguments.nmea, &(|| host.sentences().into_bytes()) as &dyn Fn() -> Vec<u8>),
        (&arguments.rtcm, &rtcm),
    ] {
        if let Some(path) = path {
            fs::write(path, bytes()).with_context(|| format!("cannot write {}", path.display()))?;
        }
    }
    Ok(())
}

fn print(arguments: &Arguments, summary: &Summary, board: Option<&BoardRun>) -> Result<()> {
    if arguments.json {
        println!("{}", serde_json::to_string_pretty(summary)?);
    } else {
        print!("{summary}");
        if let Some(identical) = summary.host_target_identical {
            let answer = if identical { "yes" } else { "NO" };
            println!("board and host say the same, byte for byte: {answer}");
        }
    }
    if let Some(board) = board.filter(|_| !arguments.json) {
        print_board(board);
    }
    if summary.fixes == 0 {
        bail!("no epoch gave a position: are --systems and the navigation file those of the recording?");
    }
    Ok(())
}

fn print_board(board: &BoardRun) {
    if let (Some(most), false) = (board.instructions.iter().max(), board.instructions.is_empty()) {
        let mean = board.instructions.iter().sum::<u64>() / board.instructions.len() as u64;
        println!("target instructions per epoch: mean {mean}, most {most}");
    }
    let dropped = ["epochs_backwards", "crc_failures", "host_lost"];
    let counted = board.counters.iter().filter(|(name, _)| dropped.contains(&name.as_str()));
    let counted: Vec<String> = counted.map(|(name, count)| format!("{name} {count}")).collect();
    println!("bytes lost on the board: {} times; {}", board.losses, counted.join(", "));
}
