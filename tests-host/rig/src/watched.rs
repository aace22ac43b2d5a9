//! The sky of a demonstration on the emulated board, as a source of the live view.

use std::sync::mpsc::SyncSender;
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result};
use raim::monitor::source::{self, Message, News, Source};
use raim::replay::Module;
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::fault::{Injector, satellite};

use crate::board::EmulatedBoard;
use crate::demo::Plan;
use crate::image;

/// Interval between two epochs of the emulated board: ten epochs a second.
const PACE: Duration = Duration::from_millis(100);

/// Longest time that the emulated board may take for an epoch.
const PATIENCE: Duration = Duration::from_secs(20);

/// Starts a demonstration in which C08 drifts off by 80 m.
///
/// # Errors
/// Never, as C08 is the name of a satellite.
pub fn watched() -> Result<Source> {
    let satellite = satellite("C08").context("a satellite")?;
    let plan = Plan { satellite, bias_m: 80.0, seed: 1 };
    let name = format!("{satellite} of a simulated sky drifts off on the emulated board");
    Ok(source::run(name, move |sender| play(&plan, sender).map(|()| "the demonstration is over")))
}

/// Plays the sky of the demonstration on the emulated board.
fn play(plan: &Plan, sender: &SyncSender<News>) -> Result<()> {
    let simulation = plan.simulation()?;
    let recording = simulation.record();
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new("GC", Frequency::Dual)?);
    let mut board = EmulatedBoard::start(&image::build()?)?;
    // The same firmware in process: the board's sentences have no residuals and no directions.
    let mut twin = Module::start(&[])?;
    twin.watch();
    let start = board.read_through("$PRAIV", PATIENCE)?.concat();
    sender.send(News::Reported(Message::of(&start, Some(board.pin_is_high()), None)))?;
    for (index, epoch) in (0_u64..).zip(Injector::new(recording.epochs.into_iter(), vec![plan.fault()])) {
        let bytes = encoder.epoch(&epoch)?;
        board.feed(&bytes)?;
        let reported = board.read_through("$PRAIN", PATIENCE)?.concat();
        let (_, seen) = twin.receive(&bytes, index * 1000)?;
        let satellites = seen.into_iter().last().and_then(|seen| seen.view).map(|view| view.satellites);
        // The pin's level is in the log, whose last line of an epoch is the time it took.
        board.log_with(&format!("epoch {} took", index + 1), 0, PATIENCE)?;
        sender.send(News::Reported(Message::of(&reported, Some(board.pin_is_high()), satellites)))?;
        thread::sleep(PACE);
    }
    board.stop()
}
