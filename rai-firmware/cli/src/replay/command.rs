//! Command `replay`: a recording, or a capture of a receiver, through the module.

use std::iter;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use super::arguments::{Place, commands};
use super::page::About;
use super::sink::{Sink, Wanted};
use super::source::{Source, of_capture, of_recording, question};
use super::{BoardRun, Pace, Playback, Setup, Summary};
use crate::signal::lump::Lump;

pub use super::arguments::Arguments;

/// Plays lumps on the emulated board, which has its own package, and returns the result.
pub type OnBoard<'a> = &'a dyn Fn(&mut dyn Iterator<Item = Result<Lump>>, &Setup) -> Result<BoardRun>;

/// Runs the command, with the emulated board if the caller has one.
///
/// # Errors
/// If an argument or an input is wrong, if an output cannot be written, or if no epoch gave a
/// position.
pub fn run(arguments: &Arguments, board: Option<OnBoard>) -> Result<()> {
    let board = match arguments.on {
        Place::Host => None,
        Place::Board => Some(board.context("--on board needs the emulated board: use cargo xtask replay")?),
    };
    let mut question = question(arguments)?;
    let name = arguments.capture_name();
    let mut source = match &name {
        Some(name) => of_capture(arguments, &question).with_context(|| name.clone())?,
        None => of_recording(arguments, &mut question)?,
    };
    let in_source = |error: anyhow::Error| match &name {
        Some(name) => error.context(name.clone()),
        None => error,
    };
    let first = source.next().context("no epoch")?.map_err(in_source)?;
    let commands = commands(arguments, source.week(), source.klobuchar())?;
    let wanted = Wanted {
        rows: arguments.csv.as_deref(),
        sentences: arguments.nmea.as_deref(),
        stream: arguments.rtcm.as_deref(),
        satellites: arguments.satellites.as_deref(),
        report: arguments.report.as_deref(),
    };
    let place = match arguments.on {
        Place::Host => "on the host",
        Place::Board => "on the board",
    };
    let mut sink = Sink::open(wanted, question.truth.as_ref(), &question.faults, place)?;

    let lumps = iter::once(Ok(first)).chain(source.by_ref().map(|lump| lump.map_err(in_source)));
    let mut playback = Playback::start(lumps, &commands, Pace::Recorded)?;
    if wanted.needs_view() || !question.faults.is_empty() {
        playback.watch();
    }
    let mut played = iter::from_fn(|| sink.take(playback.advance()).transpose());
    let board = match board {
        None => played.try_for_each(|lump| lump.map(drop)).map(|()| None)?,
        Some(on_board) => Some(on_board(&mut played, &commands)?),
    };
    let about =
        About { title: title(arguments), source: names(arguments), configuration: *playback.configuration() };
    let counters = playback.counters()?.into_iter().filter(|(_, count)| *count > 0).collect();
    let identical = board.as_ref().map(|board| board.difference.is_none());
    let refused = source.refused().into_iter();
    let summary = Summary {
        host_target_identical: identical,
        skipped: source.skipped(),
        refused_orbits: refused.map(|(satellite, count)| (satellite.to_string(), count)).collect(),
        counters,
        ..sink.summary()
    };
    let far = sink.far_from_truth();
    sink.end(&question.faults, &summary, &about)?;
    let notes = [source.cut(), far.map(|far| far.words(arguments.truth.as_deref()))];
    notes.iter().flatten().for_each(|words| eprintln!("note: {words}"));
    note(&source, arguments, summary.fixes > 0);
    print(arguments, &summary, board.as_ref(), source.advice().as_deref())?;
    if let Some((host, target)) = board.and_then(|board| board.difference) {
        bail!("the board's sentences differ from the host's: {target:?} is not {host:?}");
    }
    Ok(())
}

/// Returns the name of the recording, without its folder: the title of its report.
fn title(arguments: &Arguments) -> String {
    let first = arguments.capture.first().map(Path::new).or(arguments.obs.first().map(PathBuf::as_path));
    let name = first.and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    match name {
        Some(name) if name == "-" => "standard input".to_owned(),
        Some(name) => name,
        None => names(arguments),
    }
}

/// Returns the names of the files that are replayed.
fn names(arguments: &Arguments) -> String {
    let files = arguments.obs.iter().chain(&arguments.nav).map(|path| path.display().to_string());
    let sample = arguments.sample.then(|| "the sample: Kamakura, Japan".to_owned());
    arguments.capture.iter().cloned().chain(sample).chain(files).collect::<Vec<_>>().join(", ")
}

/// Prints the content of the input, with what of it is not read or missing.
fn note(source: &Source, arguments: &Arguments, has_fixes: bool) {
    if arguments.json {
        return;
    }
    // Without a position, the advice is the error at the end.
    let advice = source.advice().filter(|_| has_fixes);
    match (advice, arguments.capture_name()) {
        (Some(advice), _) => eprintln!("note: {} {advice}", names(arguments)),
        (None, Some(name)) => eprintln!("{name}: {}", source.content()),
        (None, None) => {}
    }
}

fn print(
    arguments: &Arguments,
    summary: &Summary,
    board: Option<&BoardRun>,
    advice: Option<&str>,
) -> Result<()> {
    #[cfg(feature = "commands")]
    if arguments.json {
        println!("{}", serde_json::to_string_pretty(summary)?);
    }
    if !arguments.json {
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
        bail!("no epoch gave a position: {}", why_none(arguments, summary, advice));
    }
    Ok(())
}

/// Returns the most likely reason for which no epoch gave a position.
fn why_none(arguments: &Arguments, summary: &Summary, advice: Option<&str>) -> String {
    let backwards = summary.counters.get("epochs_backwards").map_or(0, |count| *count as usize);
    if 2 * backwards > summary.epochs {
        return format!(
            "{backwards} times the ranges are older than those before them, and the module does not go back in time. Are \
             these two recordings in one, or does the receiver date one system differently from the others?"
        );
    }
    match (advice, arguments.capture_name()) {
        (Some(advice), _) => format!("{} {advice}", names(arguments)),
        (None, Some(_)) => {
            "is the capture long enough for ephemerides to come (30 s to a minute), or is --nav of its \
                            day there?"
                .to_owned()
        }
        (None, None) => "ranges and orbits came, but no epoch had enough of both".to_owned(),
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
