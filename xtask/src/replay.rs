//! `cargo xtask replay`: a recording, or a capture of a receiver, through the module.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use indicatif::{ProgressBar, ProgressStyle};
use tests_host::capture::{self, Capture, Orbits};
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

/// Systems that are used unless others are asked for.
const SYSTEMS: &str = "GCE";

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
    /// What a receiver sent, UBX or RTCM 3, with text in between or not: a file (.ubx, .rtcm3, any; gz too), - for
    /// standard input, tcp://HOST:PORT, or serial:PATH@BAUD. The last two need --to.
    #[arg(value_name = "CAPTURE", conflicts_with_all = ["obs", "sample"])]
    capture: Option<String>,
    /// Observation files instead of a capture: RINEX 2, 3 or 4; plain, gz, crx or crx.gz.
    #[arg(long, num_args = 1.., value_name = "FILE")]
    obs: Vec<PathBuf>,
    /// Navigation files of the same time. A capture needs none, and takes from them what it lacks.
    #[arg(long, num_args = 1.., value_name = "FILE")]
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
    /// Systems to use: G (GPS), C (`BeiDou`), E (Galileo), R (GLONASS); the first three unless given. Of a capture also J
    /// (QZSS).
    #[arg(long, value_name = "LETTERS")]
    systems: Option<String>,
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
    /// Phase of flight: sets the alert limits. CUSTOM needs --set HAL=METRES. Unless given, as the module starts: NPA.
    #[arg(long, ignore_case = true, value_parser = word("PHASE"))]
    phase: Option<String>,
    /// Threshold of the test: from the false alarms, from the missed detections, or least cost of both. Unless given, as
    /// the module starts: T1.
    #[arg(long, ignore_case = true, value_parser = word("POLICY"))]
    policy: Option<String>,
    /// How a faulty satellite is found. Unless given, as the module starts: AUTO.
    #[arg(long, ignore_case = true, value_parser = word("METHOD"))]
    method: Option<String>,
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
    /// Write the stream that the module heard: RTCM, or what is left of the capture, with the faults in it.
    #[arg(long, value_name = "FILE")]
    rtcm: Option<PathBuf>,
    /// Write an HTML report with plots into this folder.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
}

/// What to replay, read and checked.
struct Source {
    lumps: Vec<Lump>,
    /// Coefficients of the ionosphere that the module is told.
    klobuchar: Option<[f64; 8]>,
    /// Records that could not be read.
    malformed: u64,
    truth: Option<Truth>,
    faults: Vec<Fault>,
    /// What a capture lacks for a position.
    missing: Option<String>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let source = source(arguments)?;
    let Source { lumps, faults, .. } = &source;
    let commands = commands(arguments, source.klobuchar)?;

    let host = replay::on_host(lumps, &commands, Pace::Recorded, progress(lumps, "on the host"))?;
    let on_board = match arguments.on {
        Place::Host => None,
        Place::Board => Some(run_on_board(lumps, &commands)?),
    };
    let identical = on_board.as_ref().map(|(host, board)| board.sentences == host.sentences());
    let board = on_board.map(|(_, board)| board);
    let track = replay::track(lumps, &host, source.truth.as_ref())?;
    let counters = host.counters.iter().filter(|(_, count)| *count > 0).cloned().collect();
    let summary = Summary {
        host_target_identical: identical,
        malformed: source.malformed,
        counters,
        ..Summary::of(&track, faults, source.truth.is_some())
    };
    write_files(arguments, lumps, &host, &track)?;
    if let Some(folder) = &arguments.report {
        let path = replay::write_report(folder, &track, faults, &summary)?;
        eprintln!("report: {}", path.display());
    }
    print(arguments, &summary, board.as_ref(), source.missing.as_deref())?;
    ensure!(identical != Some(false), "the board's sentences differ from the host's");
    Ok(())
}

fn source(arguments: &Arguments) -> Result<Source> {
    let truth = match (&arguments.truth, &arguments.truth_csv) {
        (Some(text), _) => Some(Truth::parse(text).context("--truth")?),
        (None, Some(path)) => Some(Truth::from_csv(path).context("--truth-csv")?),
        (None, None) => None,
    };
    let steps = arguments.inject.iter().map(|text| Fault::parse_inject(text));
    let ramps = arguments.ramp.iter().map(|text| Fault::parse_ramp(text));
    let faults: Vec<Fault> = steps.chain(ramps).collect::<Result<_, _>>()?;
    let window = Window { from_s: arguments.from, to_s: arguments.to, every_s: arguments.every };
    let has_files = !arguments.obs.is_empty() && !arguments.nav.is_empty();
    ensure!(
        arguments.capture.is_some() || arguments.sample || has_files,
        "give a CAPTURE of a receiver, or both --obs FILE and --nav FILE, or --sample"
    );
    match &arguments.capture {
        Some(name) => of_capture(arguments, name, truth, faults, &window),
        None => of_recording(arguments, truth, faults, &window),
    }
}

/// RINEX, as RTCM.
fn of_recording(
    arguments: &Arguments,
    mut truth: Option<Truth>,
    faults: Vec<Fault>,
    window: &Window,
) -> Result<Source> {
    let selection = selection(arguments, &systems(arguments))?;
    let recording = if arguments.sample {
        let sample = sample::fetch(Path::new("target"))?;
        truth = truth.or(Some(Truth::Fixed(sample.truth)));
        Recording::load_of(&[sample.observations], &[sample.navigation], &selection.systems)?
    } else {
        let loaded = Recording::load_of(&arguments.obs, &arguments.nav, &selection.systems);
        match (loaded.as_ref().err().and_then(|_| capture_among(arguments)), loaded) {
            (Some(path), _) => {
                bail!(
                    "{path} is a capture of a receiver and no RINEX: give it alone, cargo xtask replay {path}"
                )
            }
            (None, loaded) => loaded?,
        }
    };
    let lumps = replay::encode(&recording, &selection, &faults, window)?;
    let (klobuchar, malformed) = (recording.klobuchar, recording.malformed);
    Ok(Source { lumps, klobuchar, malformed, truth, faults, missing: None })
}

/// The bytes of a receiver, as they came.
fn of_capture(
    arguments: &Arguments,
    name: &str,
    truth: Option<Truth>,
    faults: Vec<Fault>,
    window: &Window,
) -> Result<Source> {
    let is_here = Path::new(name).is_file();
    if !is_here && arguments.to.is_finite() {
        eprintln!("taking {} s from {name}", arguments.to);
    }
    let bytes = capture::read(name, arguments.to).with_context(|| name.to_owned())?;
    // What a navigation file may add: QZSS is not among it.
    let systems = systems(arguments).replace('J', "");
    let orbits = match arguments.nav.as_slice() {
        [] => None,
        files => Some(Orbits::load(files, &selection(arguments, &systems)?)?),
    };
    let capture = Capture::of(bytes, orbits).with_context(|| name.to_owned())?;
    let prepared = capture.lumps(&faults, window)?;
    let missing = capture.missing();
    if !arguments.json {
        eprintln!("{name}: {}", capture.content());
        if let Some(missing) = &missing {
            eprintln!("note: {missing}");
        }
    }
    Ok(Source { lumps: prepared.lumps, klobuchar: prepared.klobuchar, malformed: 0, truth, faults, missing })
}

/// Letters of the systems that take part: what the module is told in the end.
fn systems(arguments: &Arguments) -> String {
    let told = |setting: &String| setting.to_uppercase().strip_prefix("SYSTEMS=").map(str::to_owned);
    let set = arguments.set.iter().rev().find_map(told);
    set.or_else(|| arguments.systems.clone()).unwrap_or_else(|| SYSTEMS.to_owned())
}

fn selection(arguments: &Arguments, systems: &str) -> Result<Selection> {
    let frequency = match arguments.frequency {
        Frequencies::Dual => Frequency::Dual,
        Frequencies::Single => Frequency::Single,
    };
    Selection::new(systems, frequency).context("--systems")
}

/// The first of the files given as RINEX that is a capture.
fn capture_among(arguments: &Arguments) -> Option<String> {
    let mut files = arguments.obs.iter().chain(&arguments.nav);
    files.find(|path| capture::is_capture(path)).map(|path| path.display().to_string())
}

/// Reads a word of one of the module's settings, in any case.
fn word(key: &str) -> impl TypedValueParser<Value = String> {
    PossibleValuesParser::new(replay::words(key)).map(|word| word.to_uppercase())
}

/// A number of seconds that time can have.
fn not_negative(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| "is no number of seconds".to_owned())?;
    if seconds >= 0.0 { Ok(seconds) } else { Err("seconds are not negative".to_owned()) }
}

/// Commands that configure the module as asked; what is not asked for stays as the module starts.
fn commands(arguments: &Arguments, klobuchar: Option<[f64; 8]>) -> Result<Vec<String>> {
    let given = [("PHASE", &arguments.phase), ("POLICY", &arguments.policy), ("METHOD", &arguments.method)];
    let mut setup: Vec<String> = given
        .iter()
        .filter_map(|(key, value)| value.as_ref().map(|value| format!("{key},{value}")))
        .collect();
    // Of a recording only what is asked for is sent; a capture holds what it holds, and the module chooses. GLONASS takes
    // part in neither unless the module is told.
    let says_systems = |letters: &&String| arguments.capture.is_some() || letters.contains('R');
    setup.extend(arguments.systems.as_ref().filter(says_systems).map(|letters| format!("SYSTEMS,{letters}")));
    if arguments.capture.is_some() {
        setup.extend((arguments.frequency == Frequencies::Single).then(|| "FREQ,SINGLE".to_owned()));
    }
    if let Some(coefficients) = klobuchar {
        let numbers: Vec<String> = coefficients.iter().map(|value| format!("{value:e}")).collect();
        setup.push(format!("IONO,{}", numbers.join(",")));
    }
    for setting in &arguments.set {
        setup.push(replay::command_for(setting)?);
    }
    let has_limit = setup.iter().any(|command| command.starts_with("HAL,"));
    ensure!(
        arguments.phase.as_deref() != Some("CUSTOM") || has_limit,
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

fn print(
    arguments: &Arguments,
    summary: &Summary,
    board: Option<&BoardRun>,
    missing: Option<&str>,
) -> Result<()> {
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
    if let (0, Some(missing)) = (summary.fixes, missing) {
        bail!("no epoch gave a position: {missing}");
    }
    if summary.fixes == 0 && arguments.capture.is_some() {
        bail!(
            "no epoch gave a position: is the capture long enough for ephemerides to come (30 s to a minute), or is --nav of its day there?"
        );
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
