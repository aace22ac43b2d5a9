//! The sky of a demonstration on the emulated board, as a source of the live view.

use std::sync::mpsc::SyncSender;
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result};
use raim::monitor::heaven::Heaven;
use raim::monitor::source::{self, News, Source, tell};
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::fault::{Injector, satellite};

use super::Plan;
use crate::board::EmulatedBoard;
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
    let mut heaven = Heaven::new();
    let mut place = simulation.site.position;
    tell(&board.read_through("$PRAIV", PATIENCE)?.concat(), &mut place, sender)?;
    for (index, epoch) in (0_u64..).zip(Injector::new(recording.epochs.into_iter(), vec![plan.fault()])) {
        let bytes = encoder.epoch(&epoch)?;
        board.feed(&bytes)?;
        tell(&board.read_through("$PRAIN", PATIENCE)?.concat(), &mut place, sender)?;
        board.log_with(&format!("epoch {} took", index + 1), 0, PATIENCE)?;
        sender.send(News::PinLevel(board.pin_is_high()))?;
        if let Some(bodies) = heaven.hear(&bytes, index * 1000, place) {
            sender.send(News::Heaven(bodies))?;
        }
        thread::sleep(PACE);
    }
    board.stop()
}
