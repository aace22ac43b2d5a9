//! `cargo xtask replay`: a recording, or a capture of a receiver, through the module.

use std::iter;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail, ensure};
use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use tests_host::capture::{self, Bytes, Lumps, Orbits};
use tests_host::encode::{Frequency, Selection};
use tests_host::fault::Fault;
use tests_host::recording::{Epochs, Recording, Skipped};
use tests_host::replay::{self, BoardRun, Broadcast, Encoding, Lump, Pace, Playback, Summary, Truth, Window};
use tests_host::{image, sample, setup};

use crate::sink::{Sink, Wanted};

/// Place in which the module runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Place {
    /// In process.
    Host,
    /// On the emulated board, and in process for comparison.
    Board,
}

/// Systems that are used by default.
const SYSTEMS: &str = "GCE";

/// Number of frequencies that the module receives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Frequencies {
    /// Two, if they were received.
    Dual,
    /// Only the first.
    Single,
}

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Replay the bytes of a receiver, UBX or RTCM 3, with or without text: a file (.ubx, .rtcm3,
    /// any; gz too), - for standard input, tcp://HOST:PORT, or serial:PATH@BAUD. The last two need
    /// --to.
    #[arg(value_name = "CAPTURE", conflicts_with_all = ["obs", "sample"])]
    capture: Option<String>,
    /// Replay observation files instead of a capture: RINEX 2, 3 or 4; plain, gz, crx or crx.gz.
    #[arg(long, num_args = 1.., value_name = "FILE")]
    obs: Vec<PathBuf>,
    /// Read navigation files of the same time. A capture needs none, and takes missing ephemerides
    /// from them.
    #[arg(long, num_args = 1.., value_name = "FILE")]
    nav: Vec<PathBuf>,
    /// Fetch a small real recording (60 s, Kamakura, Japan) and use it.
    #[arg(long, conflicts_with_all = ["obs", "nav"])]
    sample: bool,
    /// Set the true position of the antenna: X,Y,Z in metres, earth-fixed, or
    /// latitude,longitude,height in degrees and metres.
    #[arg(long, value_name = "X,Y,Z", conflicts_with = "truth_csv", allow_hyphen_values = true)]
    truth: Option<String>,
    /// Read the true positions of the antenna over time from a table whose heading names week,tow
    /// and `x_m,y_m,z_m` or `lat_deg,lon_deg,height_m`.
    #[arg(long, value_name = "FILE")]
    truth_csv: Option<PathBuf>,
    /// Use these systems: G (GPS), C (`BeiDou`), E (Galileo), R (GLONASS), J (QZSS). The default is
    /// the first three.
    #[arg(long, value_name = "LETTERS")]
    systems: Option<String>,
    /// Set the GPS week of a capture's first epoch, not rolled over: 1709 is October 2012. The
    /// default is taken from the capture.
    #[arg(long, value_name = "N", requires = "capture", value_parser = clap::value_parser!(u16).range(0..=8191))]
    week: Option<u16>,
    /// Use these frequencies.
    #[arg(long, value_enum, default_value = "dual")]
    frequency: Frequencies,
    /// Run the module in process or on the emulated board.
    #[arg(long, value_enum, default_value = "host")]
    pub(crate) on: Place,
    /// Inject a step or an outage: G05:+80@600..1200, E31:lost@..60; repeatable.
    #[arg(long, value_name = "FAULT")]
    inject: Vec<String>,
    /// Inject a drift in m/s: G05:0.5@600..; repeatable.
    #[arg(long, value_name = "FAULT")]
    ramp: Vec<String>,
    /// Start this number of seconds after the first epoch.
    #[arg(long, default_value_t = 0.0, value_name = "S", value_parser = not_negative, allow_negative_numbers = true)]
    from: f64,
    /// End this number of seconds after the first epoch.
    #[arg(long, default_value_t = f64::INFINITY, hide_default_value = true, value_name = "S", value_parser = not_negative, allow_negative_numbers = true)]
    to: f64,
    /// Skip epochs that come sooner than this after the last used one, s.
    #[arg(long, default_value_t = 0.0, value_name = "S", value_parser = not_negative, allow_negative_numbers = true)]
    every: f64,
    /// Set the phase of flight, which sets the alert limits. CUSTOM needs --set HAL=METRES. The
    /// default is NPA.
    #[arg(long, ignore_case = true, value_parser = word("PHASE"))]
    phase: Option<String>,
    /// Set the threshold of the test: from the false alarms, from the missed detections, or least
    /// cost of both. The default is T1.
    #[arg(long, ignore_case = true, value_parser = word("POLICY"))]
    policy: Option<String>,
    /// Set the method that finds a faulty satellite. The default is AUTO.
    #[arg(long, ignore_case = true, value_parser = word("METHOD"))]
    method: Option<String>,
    /// Set any other setting of the module, such as HAL=40 or MASK=5; repeatable, in this order.
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
    /// Write the stream that the module received: RTCM, or the rest of the capture, with the
    /// faults.
    #[arg(long, value_name = "FILE")]
    rtcm: Option<PathBuf>,
    /// Write an HTML report with plots into this folder.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
}

/// Inputs beside the recording or the capture.
struct Question {
    truth: Option<Truth>,
    faults: Vec<Fault>,
    window: Window,
}

/// Lumps that are read on demand.
enum Source {
    Recording(Box<Observed>),
    Capture(Box<Lumps<Bytes>>),
}

/// A recording: its observations, read epoch by epoch, and its navigation files.
struct Observed {
    lumps: Encoding<Epochs>,
    navigation: Recording,
    files: Vec<PathBuf>,
}

impl Iterator for Source {
    type Item = Result<Lump>;

    fn next(&mut self) -> Option<Result<Lump>> {
        match self {
            Self::Recording(observed) => observed.lumps.next().or_else(|| observed.check().err().map(Err)),
            Self::Capture(lumps) => lumps.next(),
        }
    }
}

impl Observed {
    /// Checks at the end of the observations that some ephemeris is of their time.
    fn check(&self) -> Result<()> {
        let (first, last) = self.lumps.span().context("the observation files hold no epoch")?;
        self.navigation.check_time(&self.files, first, last)
    }
}

impl Source {
    /// Returns the coefficients of the ionosphere for the module.
    fn klobuchar(&self) -> Option<[f64; 8]> {
        match self {
            Self::Recording(observed) => observed.navigation.klobuchar,
            Self::Capture(lumps) => lumps.klobuchar(),
        }
    }

    /// Returns the GPS week of the first epoch if the module needs it from a command.
    fn week(&self) -> Option<u16> {
        match self {
            Self::Recording(_) => None,
            Self::Capture(lumps) => lumps.week(),
        }
    }

    /// Returns the records that were skipped.
    fn skipped(&self) -> Skipped {
        match self {
            Self::Recording(observed) => {
                let mut skipped = observed.lumps.epochs().skipped();
                skipped.add(&observed.navigation.skipped);
                skipped
            }
            Self::Capture(_) => Skipped::default(),
        }
    }

    /// Returns what a capture lacks for a position.
    fn missing(&self) -> Option<String> {
        match self {
            Self::Recording(_) => None,
            Self::Capture(lumps) => lumps.missing(),
        }
    }
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let mut question = question(arguments)?;
    let name = arguments.capture.as_deref();
    let mut source = match name {
        Some(name) => of_capture(arguments, name, &question).with_context(|| name.to_owned())?,
        None => of_recording(arguments, &mut question)?,
    };
    let in_source = |error: anyhow::Error| match name {
        Some(name) => error.context(name.to_owned()),
        None => error,
    };
    let first = source.next().context("no epoch")?.map_err(in_source)?;
    let commands = commands(arguments, source.week(), source.klobuchar())?;
    let wanted = Wanted {
        rows: arguments.csv.as_deref(),
        sentences: arguments.nmea.as_deref(),
        stream: arguments.rtcm.as_deref(),
        report: arguments.report.as_deref(),
    };
    let place = match arguments.on {
        Place::Host => "on the host",
        Place::Board => "on the board",
    };
    let mut sink = Sink::open(wanted, question.truth.as_ref(), &question.faults, place)?;

    let lumps = iter::once(Ok(first)).chain(source.by_ref().map(|lump| lump.map_err(in_source)));
    let mut playback = Playback::start(lumps, &commands, Pace::Recorded)?;
    let mut played = iter::from_fn(|| sink.take(playback.advance()).transpose());
    let board = match arguments.on {
        Place::Host => played.try_for_each(|lump| lump.map(drop)).map(|()| None)?,
        Place::Board => Some(run_on_board(played, &commands)?),
    };
    let counters = playback.counters()?.into_iter().filter(|(_, count)| *count > 0).collect();
    let identical = board.as_ref().map(|board| board.difference.is_none());
    let summary =
        Summary { host_target_identical: identical, skipped: source.skipped(), counters, ..sink.summary() };
    sink.end(&question.faults, &summary)?;
    note(&source, arguments);
    print(arguments, &summary, board.as_ref(), source.missing().as_deref())?;
    if let Some((host, target)) = board.and_then(|board| board.difference) {
        bail!("the board's sentences differ from the host's: {target:?} is not {host:?}");
    }
    Ok(())
}

/// Prints the content of a capture.
fn note(source: &Source, arguments: &Arguments) {
    let (Source::Capture(lumps), Some(name), false) = (source, &arguments.capture, arguments.json) else {
        return;
    };
    eprintln!("{name}: {}", lumps.content());
    if let Some(missing) = lumps.missing() {
        eprintln!("note: {missing}");
    }
}

fn question(arguments: &Arguments) -> Result<Question> {
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
    Ok(Question { truth, faults, window })
}

/// Opens RINEX files, which are encoded as RTCM.
fn of_recording(arguments: &Arguments, question: &mut Question) -> Result<Source> {
    if arguments.sample {
        let sample = sample::fetch(Path::new("target"))?;
        question.truth = question.truth.take().or(Some(Truth::Fixed(sample.truth)));
        return observed(arguments, &[sample.observations], vec![sample.navigation], question);
    }
    observed(arguments, &arguments.obs, arguments.nav.clone(), question).map_err(|error| match capture_among(
        arguments,
    ) {
        Some(path) => anyhow!(
            "{path} is a capture of a receiver and no RINEX: give it alone, cargo xtask replay {path}"
        ),
        None => error,
    })
}

fn observed(
    arguments: &Arguments,
    observations: &[PathBuf],
    files: Vec<PathBuf>,
    question: &Question,
) -> Result<Source> {
    let selection = selection(arguments, &systems(arguments))?;
    let epochs = Epochs::open(observations)?;
    let navigation = Recording::of_navigation(&files)?;
    let broadcast = Broadcast {
        ephemerides: &navigation.ephemerides,
        klobuchar: navigation.klobuchar,
        approximate_position: epochs.approximate_position(),
    };
    let lumps = Encoding::of(epochs, &broadcast, &selection, &question.faults, &question.window)?;
    Ok(Source::Recording(Box::new(Observed { lumps, navigation, files })))
}

/// Opens the bytes of a receiver, as they came.
fn of_capture(arguments: &Arguments, name: &str, question: &Question) -> Result<Source> {
    let is_here = Path::new(name).is_file();
    if !is_here && arguments.to.is_finite() {
        eprintln!("taking {} s from {name}", arguments.to);
    }
    let bytes = Bytes::open(name, arguments.to)?;
    let systems = systems(arguments);
    let orbits = match arguments.nav.as_slice() {
        [] => None,
        files => Some(Orbits::load(files, &selection(arguments, &systems)?)?),
    };
    let week = match arguments.week {
        Some(week) => Some(week),
        None => capture::week_of(name, orbits.as_ref())?,
    };
    let lumps = Lumps::of(bytes, orbits, &question.faults, &question.window)?;
    Ok(Source::Capture(Box::new(lumps.in_week(week))))
}

/// Returns the letters of the systems that take part, by the last setting.
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

/// Returns the first of the RINEX files that is a capture.
fn capture_among(arguments: &Arguments) -> Option<String> {
    let mut files = arguments.obs.iter().chain(&arguments.nav);
    files.find(|path| capture::is_capture(path)).map(|path| path.display().to_string())
}

/// Reads a word of one of the module's settings, in any case.
fn word(key: &str) -> impl TypedValueParser<Value = String> {
    PossibleValuesParser::new(replay::words(key)).map(|word| word.to_uppercase())
}

/// Reads a number of seconds that is not negative.
fn not_negative(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| "is no number of seconds".to_owned())?;
    if seconds >= 0.0 { Ok(seconds) } else { Err("seconds are not negative".to_owned()) }
}

/// Returns the commands that configure the module; other settings stay as they start.
fn commands(arguments: &Arguments, week: Option<u16>, klobuchar: Option<[f64; 8]>) -> Result<Vec<String>> {
    let given = [("PHASE", &arguments.phase), ("POLICY", &arguments.policy), ("METHOD", &arguments.method)];
    let mut setup: Vec<String> = given
        .iter()
        .filter_map(|(key, value)| value.as_ref().map(|value| format!("{key},{value}")))
        .collect();
    // GLONASS and QZSS take part only by a command. A recording is encoded with the selected
    // systems alone; from a capture the module selects them.
    let says_systems = |letters: &&String| arguments.capture.is_some() || letters.contains(['R', 'J']);
    setup.extend(arguments.systems.as_ref().filter(says_systems).map(|letters| format!("SYSTEMS,{letters}")));
    if arguments.capture.is_some() {
        setup.extend((arguments.frequency == Frequencies::Single).then(|| "FREQ,SINGLE".to_owned()));
    }
    setup.extend(week.map(|week| format!("WEEK,{week}")));
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

/// Plays the lumps on the board.
fn run_on_board(lumps: impl Iterator<Item = Result<Lump>>, commands: &[String]) -> Result<BoardRun> {
    setup::ensure()?;
    let image = image::build()?;
    replay::on_board(&image, lumps, commands, |_| ())
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
