//! Command `configure`: gives a receiver its commands, and reports its answers.

use std::time::Duration;

use anyhow::{Context as _, Result, ensure};

use super::dialogue::{Answer, ask, identify};
use super::receivers::{Need, Receiver, Step};
use crate::source::{Line, Source};

/// Rate of a serial port if none is named: that of u-blox generation 9 and later at start.
const BAUD: u32 = 38_400;

/// A read returns after this time even if nothing comes.
const READ_TIMEOUT: Duration = Duration::from_millis(50);

/// Arguments of the command.
#[derive(clap::Args)]
pub struct Arguments {
    /// Port of the receiver: PORT or PORT@BAUD, such as /dev/ttyUSB0@38400 or COM3, or <tcp://HOST:PORT>
    #[arg(long, required_unless_present = "dry_run")]
    port: Option<String>,
    /// Kind of receiver; a u-blox is asked for it
    #[arg(long, value_enum, required_if_eq("dry_run", "true"))]
    receiver: Option<Receiver>,
    /// Port of the receiver that sends, by its own name: uart1, uart2, usb; a mosaic's COM1 to USB2
    #[arg(long)]
    wire: Option<String>,
    /// Keep the settings when the receiver loses its power
    #[arg(long)]
    keep: bool,
    /// Print the commands and send none
    #[arg(long)]
    dry_run: bool,
}

/// Runs the command.
///
/// # Errors
/// If the port fails, or the receiver refuses a message without which the module has no ranges.
pub fn run(arguments: &Arguments) -> Result<()> {
    let wire = wire(arguments);
    if arguments.dry_run {
        let receiver = arguments.receiver.context("--receiver must name the receiver")?;
        println!("{}", typed(receiver, &receiver.steps(&wire, arguments.keep)?));
        return Ok(());
    }
    let name = arguments.port.as_deref().context("--port must name the receiver's port")?;
    let open = || Line::open(&Source::line(name, BAUD)?, READ_TIMEOUT);
    let mut port = open().with_context(|| name.to_owned())?;
    let receiver = match arguments.receiver {
        Some(receiver) => receiver,
        None => identify(&mut port)?,
    };
    let steps = receiver.steps(&wire, arguments.keep)?;
    println!("{receiver}, {} commands for its port {wire}", steps.len());
    let answers = steps.iter().map(|step| ask(&mut port, step)).collect::<Result<Vec<_>>>()?;
    let (report, is_enough) = report(receiver, &steps, &answers);
    println!("{report}");
    ensure!(is_enough, "{}", advice(receiver, &answers));
    Ok(())
}

/// Returns the receiver's name of the port, as the user gives it or as the system's name of the
/// port suggests.
fn wire(arguments: &Arguments) -> String {
    if let Some(wire) = &arguments.wire {
        return wire.to_uppercase();
    }
    let port = arguments.port.as_deref().unwrap_or_default();
    let is_usb = ["ttyACM", "usbmodem"].iter().any(|part| port.contains(part));
    match (arguments.receiver, is_usb) {
        (Some(Receiver::Mosaic | Receiver::MosaicSbf), true) => "USB1",
        (Some(Receiver::Mosaic | Receiver::MosaicSbf), false) => "COM1",
        (_, true) => "USB",
        (_, false) => "UART1",
    }
    .to_owned()
}

/// Returns the commands as a person types or pastes them.
fn typed(receiver: Receiver, steps: &[Step]) -> String {
    let line = |step: &Step| format!("\n  {:<48} {}", step.typed(), step.purpose);
    let lines: Vec<_> = steps.iter().map(line).collect();
    format!("{receiver}:{}", lines.concat())
}

/// Returns a line for each step, and true if the module can work with the accepted ones.
fn report(receiver: Receiver, steps: &[Step], answers: &[Answer]) -> (String, bool) {
    let line =
        |(step, answer): (&Step, &Answer)| format!("  {:<10} {}: {}", answer.word(), step.name, step.purpose);
    let mut lines: Vec<_> = steps.iter().zip(answers).map(line).collect();
    let lacks = |need| {
        steps.iter().zip(answers).any(|(step, answer)| step.need == need && *answer != Answer::Accepted)
    };
    let is_enough = !lacks(Need::Ranges);
    if is_enough && lacks(Need::Extra) {
        lines.push("  the module works without what was refused".into());
    }
    if is_enough && !matches!(receiver, Receiver::Mosaic | Receiver::MosaicSbf) {
        lines.push("  30 satellites on two bands take 3 kB/s: a slower line needs a higher rate".into());
    }
    (lines.join("\n"), is_enough)
}

/// Returns the advice after a necessary command has failed.
fn advice(receiver: Receiver, answers: &[Answer]) -> String {
    if answers.iter().all(|answer| *answer == Answer::Missing) {
        return "the receiver answers nothing: check the port, its rate and --receiver".into();
    }
    match receiver {
        Receiver::Ublox9 | Receiver::Ublox10 => {
            "the receiver refuses raw ranges, without which there is nothing to check: M9 and M10 have no \
             RXM-RAWX; F9, X20 and M8T have it"
        }
        Receiver::Ublox8 => {
            "the receiver refuses raw ranges, without which there is nothing to check: of generation 8, M8T has \
             RXM-RAWX, M8N and M8Q have not"
        }
        Receiver::X20 | Receiver::Mosaic | Receiver::MosaicSbf => "the receiver refuses a message without which the module has no ranges",
    }
    .into()
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
