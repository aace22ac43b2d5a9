//! Memory of the shipped image: flash and statics from the file, the stack from a run.
//!
//! The stack is painted at start. The image logs how much paint is gone with its first epoch and
//! with every sixtieth after it. The run takes the most expensive paths through the program: 40
//! satellites, three faults, every method in turn.

use std::time::Duration;

use anyhow::{Context, Result};

use super::figure::Figure;
use super::stages::METHODS;
use super::workload::{Stream, Wrong};
use crate::board::EmulatedBoard;
use crate::image::{self, Image};

const PATIENCE: Duration = Duration::from_mins(1);
const POLICIES: [&str; 3] = ["TOP", "T2", "T1"];
/// Number of epochs until the image logs the stack again.
const EPOCHS: u32 = 61;

/// Measures flash, static RAM and stack of the shipped image, bytes.
///
/// # Errors
/// If the image does not build or the board does not answer.
pub fn measure() -> Result<Vec<Figure>> {
    let path = image::build()?;
    let image = Image::open(&path)?;
    let small = Image::open(&image::build_small()?)?;
    let figure = |name: &str, value, target| Figure { name: name.to_owned(), value, target: Some(target) };
    Ok(vec![
        figure("flash, bytes", image.flash_bytes, 160 * 1024),
        figure("static RAM, bytes", image.static_ram_bytes, 32 * 1024),
        figure("stack high water, bytes", stack_bytes(&path)?, 12 * 1024),
        figure("image of RTCM and classic RAIM alone: flash, bytes", small.flash_bytes, 96 * 1024),
        figure("image of RTCM and classic RAIM alone: static RAM, bytes", small.static_ram_bytes, 32 * 1024),
    ])
}

fn stack_bytes(image: &std::path::Path) -> Result<u64> {
    let stream = Stream::with(EPOCHS, 40, Wrong { faults: 3, scale: 1.0, from_s: 5.0 })?;
    let mut board = EmulatedBoard::start(image)?;
    board.read_through("$PRAIV", PATIENCE)?;
    board.command("CLOCKAID,ON")?;
    board.read_through("$PRAIA", PATIENCE)?;
    for (number, bytes) in stream.epochs.iter().enumerate() {
        if number % 3 == 0 {
            for command in [
                ("METHOD", METHODS[number / 3 % METHODS.len()]),
                ("POLICY", POLICIES[number % POLICIES.len()]),
            ] {
                board.command(&format!("{},{}", command.0, command.1))?;
                board.read_through("$PRAIA", PATIENCE)?;
            }
        }
        board.feed(bytes)?;
        board.read_through("$PRAIS", PATIENCE)?;
    }
    board.log_with(&format!("epoch {EPOCHS} took"), 0, PATIENCE)?;
    let reports = board
        .log()
        .iter()
        .filter_map(|line| line.text.strip_prefix("stack high water ")?.strip_suffix(" bytes")?.parse().ok());
    reports.max().context("the board did not log its stack")
}
