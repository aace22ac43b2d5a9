//! Memory of the named images: flash and statics from the file, the stack from a run.
//!
//! The stack is painted at start. The image logs how much paint is gone with its first epoch and
//! with every sixtieth after it. The run takes the most expensive paths through the program: 40
//! satellites, three faults, every method in turn. An image without a method refuses its command
//! and continues with the one before. An image without a log has one for this run, which takes
//! stack too.

use std::time::Duration;

use anyhow::{Context, Result, ensure};

use super::figure::Figure;
use super::stages::METHODS;
use super::workload::{Stream, Wrong};
use crate::board::EmulatedBoard;
use crate::image::{Image, NAMED, Named};

const PATIENCE: Duration = Duration::from_mins(1);
const POLICIES: [&str; 3] = ["TOP", "T2", "T1"];
/// Number of epochs until the image logs the stack again.
const EPOCHS: u32 = 61;
/// Bytes at the end of the stack that no access may reach.
const GUARD_BYTES: u64 = 512;

/// Measured memory of an image, bytes.
pub const QUANTITIES: [&str; 3] = ["flash", "static RAM", "stack high water"];

/// Returns the name of an image's figure.
pub fn figure_name(named: &Named, quantity: &str) -> String {
    format!("image `{}`: {quantity}, bytes", named.name)
}

/// Measures flash, static RAM and stack of the named images, bytes.
///
/// # Errors
/// If an image does not build, exceeds its limits, or does not answer.
pub fn measure() -> Result<Vec<Figure>> {
    let figures = NAMED.iter().map(measure_image).collect::<Result<Vec<_>>>()?;
    Ok(figures.concat())
}

fn measure_image(named: &Named) -> Result<Vec<Figure>> {
    let path = named.build()?;
    let image = Image::open(&path)?;
    let findings = named.findings(&image);
    ensure!(findings.is_empty(), "{}", findings.join("; "));
    let stack = stack_bytes(&named.build_with_log()?)?;
    let reserved = named.stack_bytes - GUARD_BYTES;
    ensure!(stack <= reserved, "image `{}` used {stack} bytes of stack, more than {reserved}", named.name);
    let values = [
        (image.flash_bytes, named.flash_kib * 1024),
        (image.static_ram_bytes, named.ram_kib * 1024 - named.stack_bytes),
        (stack, reserved),
    ];
    let figures = QUANTITIES.iter().zip(values);
    let figure = |(quantity, (value, most)): (&&str, (u64, u64))| Figure {
        name: figure_name(named, quantity),
        value,
        target: Some(most),
    };
    Ok(figures.map(figure).collect())
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
