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
use tests_host::replay::{self, BoardRun, Lump, Summary, Track, Truth, Window};
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
    /// Where the antenna was: X,Y,Z in metres, earth-fixed.
    #[arg(long, value_name = "X,Y,Z", conflicts_with = "truth_csv", allow_hyphen_values = true)]
    truth: Option<String>,
    /// Where the antenna was when: rows of `week,tow,x_m,y_m,z_m` under a heading.
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
    #[arg(long, default_value_t = 0.0, value_name = "S")]
    from: f64,
    /// Seconds after the first epoch at which to end.
    #[arg(long, default_value_t = f64::INFINITY, value_name = "S")]
    to: f64,
    /// Least time between epochs, s.
    #[arg(long, default_value_t = 0.0, value_name = "S")]
    every: f64,
    /// Phase of flight: ENROUTE, TERMINAL, NPA, LPV200.
    #[arg(long, default_value = "NPA")]
    phase: String,
    /// Threshold policy.
    #[arg(long, default_value = "T1")]
    policy: String,
    /// Identification method.
    #[arg(long, default_value = "BAARDA")]
    method: String,
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
    let source = source(arguments)?;
    let window = Window { from_s: arguments.from, to_s: arguments.to, every_s: arguments.every };
    let frequency = match arguments.frequency {
        Frequencies::Dual => Frequency::Dual,
        Frequencies::Single => Frequency::Single,
    };
    let selection = Selection::new(&arguments.systems, frequency)?;
    let lumps = replay::encode(&source.recording, &selection, &source.faults, &window)?;
    let commands = commands(arguments, &source.recording);

    let host = replay::on_host(&lumps, &commands, progress(&lumps, "on the host"))?;
    let board = match arguments.on {
        Place::Host => None,
        Place::Board => Some(run_on_board(&lumps, &host, &commands)?),
    };
    let identical = board.as_ref().map(|board| board.sentences == host.concat());
    let track = replay::track(&lumps, &host, source.truth.as_ref())?;
    let summary = Summary { host_target_identical: identical, ..Summary::of(&track, &source.faults) };
    write_files(arguments, &lumps, &host, &track)?;
    if let Some(folder) = &arguments.report {
        let path = replay::write_report(folder, &track, &source.faults, &summary)?;
        eprintln!("report: {}", path.display());
    }
    print(arguments, &summary, board.as_ref())?;
    ensure!(identical != Some(false), "the board's sentences differ from the host's");
    Ok(())
}

fn source(arguments: &Arguments) -> Result<Source> {
    let mut truth = match (&arguments.truth, &arguments.truth_csv) {
        (Some(text), _) => Some(Truth::parse(text)?),
        (None, Some(path)) => Some(Truth::from_csv(path)?),
        (None, None) => None,
    };
    let steps = arguments.inject.iter().map(|text| Fault::parse_inject(text));
    let ramps = arguments.ramp.iter().map(|text| Fault::parse_ramp(text));
    let faults = steps.chain(ramps).collect::<Result<_, _>>()?;
    let recording = if arguments.sample {
        let sample = sample::fetch(Path::new("target"))?;
        truth = truth.or(Some(Truth::Fixed(sample.truth)));
        Recording::load(&[sample.observations], &[sample.navigation])?
    } else {
        Recording::load(&arguments.obs, &arguments.nav)?
    };
    Ok(Source { recording, truth, faults })
}

/// Commands that configure the module as asked.
fn commands(arguments: &Arguments, recording: &Recording) -> Vec<String> {
    let mut setup = vec![
        format!("PHASE,{}", arguments.phase),
        format!("POLICY,{}", arguments.policy),
        format!("METHOD,{}", arguments.method),
    ];
    if let Some(coefficients) = recording.klobuchar {
        let numbers: Vec<String> = coefficients.iter().map(|value| format!("{value:e}")).collect();
        setup.push(format!("IONO,{}", numbers.join(",")));
    }
    setup
}

fn run_on_board(lumps: &[Lump], host: &[String], commands: &[String]) -> Result<BoardRun> {
    setup::ensure()?;
    let image = image::build()?;
    replay::on_board(&image, lumps, host, commands, progress(lumps, "on the board"))
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

fn write_files(arguments: &Arguments, lumps: &[Lump], host: &[String], track: &Track) -> Result<()> {
    if let Some(path) = &arguments.csv {
        let file = File::create(path).with_context(|| format!("cannot write {}", path.display()))?;
        replay::write_csv(track, &mut BufWriter::new(file))?;
    }
    let rtcm = || lumps.iter().flat_map(|lump| lump.bytes.iter().copied()).collect::<Vec<u8>>();
    for (path, bytes) in [
        (&arguments.nmea, &(|| host.concat().into_bytes()) as &dyn Fn() -> Vec<u8>),
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
        print_words(summary);
    }
    if let Some(board) = board.filter(|_| !arguments.json) {
        print_board(board);
    }
    if summary.fixes == 0 {
        bail!("no epoch gave a position: are --systems and the navigation file those of the recording?");
    }
    Ok(())
}

fn print_words(summary: &Summary) {
    let metres = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.2} m"));
    println!(
        "epochs {}, fixes {}: protected {}, alerts {}, unavailable {}",
        summary.epochs, summary.fixes, summary.protected, summary.alerts, summary.unavailable
    );
    let reasons: Vec<String> =
        summary.by_reason.iter().map(|(reason, count)| format!("{reason} {count}")).collect();
    println!("reasons            {}", reasons.join(", "));
    println!(
        "error              horizontal {} rms, {} at 95 %; vertical {} rms, {} at 95 %",
        metres(summary.horizontal_rms_m),
        metres(summary.horizontal_p95_m),
        metres(summary.vertical_rms_m),
        metres(summary.vertical_p95_m)
    );
    println!(
        "protection levels  HPL {}, VPL {} (medians)",
        metres(summary.hpl_median_m),
        metres(summary.vpl_median_m)
    );
    println!("misleading {}, hazardous {}", summary.misleading, summary.hazardous);
    for fault in &summary.injected {
        let noticed = fault.first_alert_or_exclusion_s.map_or("never".to_owned(), |s| format!("after {s} s"));
        println!(
            "injected {} {:+.1} m from {} s: noticed {noticed}, excluded in {} epochs, wrong exclusions {}",
            fault.sat, fault.bias_m, fault.start, fault.excluded_epochs, fault.wrong_exclusions
        );
    }
    if let Some(identical) = summary.host_target_identical {
        println!("board and host say the same, byte for byte: {}", if identical { "yes" } else { "NO" });
    }
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
