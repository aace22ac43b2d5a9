//! `rai run`: the integrity module as a service on a computer.
//!
//! ```text
//! receiver ─► input ─► inbox ─┐                        ┌─► outbox ─► standard output, PTY, TCP, UDP
//!                             ├─► board ─► epoch loop ─┤
//! caster ───► orbits ─────────┘    (firmware's own)    └─► pin: GPIO, file, command
//! ```
//!
//! | module | task |
//! |---|---|
//! | [`plan`] | reads the command line and the configuration file |
//! | `input`, `caster`, `inbox` | read bytes with their time of arrival, and reconnect |
//! | `board` | implements the firmware's `Board` on a computer |
//! | `outbox`, `output` | send sentences to consumers, none of which another one waits for |
//! | [`pin`] | drives the integrity pin |
//! | `report` | takes notes of every epoch, for a page as `replay` writes it |
//! | `guard` | drops the pin and ends the program if the epoch loop hangs |
//!
//! The epoch loop runs in the calling thread. Every port has a thread of its own, with a bounded
//! queue between the two: a slow or dead consumer loses its own sentences only.

mod board;
mod caster;
mod guard;
mod inbox;
mod input;
mod outbox;
mod output;
pub mod pin;
pub mod plan;
mod report;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context as _, Result, bail};
use raim_firmware::board::SEALED_BYTES;
use raim_firmware::epoch_loop::EpochLoop;
use raim_firmware::receiver::{Boot, Receiver};

use board::Computer;
use guard::Guard;
use inbox::Inbox;
use outbox::Outbox;
use pin::{Pin, Wire};
use report::Recorder;

pub use plan::{Arguments, Plan};

/// Runs the service as the command line asks, until the input ends or a signal stops it.
///
/// # Errors
/// If the configuration is wrong, or if a port that was named does not exist.
pub fn run(arguments: Arguments) -> Result<()> {
    if arguments.lower_pin {
        return Wire::open(&Plan::read(arguments)?.pin)?.drive(false).context("the pin");
    }
    let plan = Plan::read(arguments)?;
    let stop = Arc::new(AtomicBool::new(false));
    #[cfg(unix)]
    for signal in [signal_hook::consts::SIGTERM, signal_hook::consts::SIGINT] {
        signal_hook::flag::register(signal, Arc::clone(&stop)).context("a signal cannot be caught")?;
    }
    serve(&plan, &stop)
}

/// Runs the service until `stop` is set or a finite input ends.
///
/// # Errors
/// As [`run`].
pub fn serve(plan: &Plan, stop: &Arc<AtomicBool>) -> Result<()> {
    // The pin first: it is low before anything else can fail.
    let wire = Arc::new(Wire::open(&plan.pin)?);
    wire.drive(false).context("the pin cannot be set")?;
    let mut outbox = Outbox::default();
    let inbox = Arc::new(Inbox::new());
    for output in &plan.outputs {
        output::open(output, &mut outbox, &inbox).with_context(|| output.to_string())?;
    }
    input::start(&plan.input, &inbox, stop)?;
    if let Some(caster) = &plan.caster {
        caster::start(caster.clone(), &inbox, stop);
    }
    let guard = Guard::start(&wire, stop);
    let mut sealed = Box::new([0; SEALED_BYTES]);
    let mut recorder = plan.report.clone().map(|folder| Recorder::new(folder, plan.input.to_string()));
    outbox.keep_tape(recorder.is_some());
    let (mut after_power_on, mut configuration) = (true, None);
    while !stop.load(Ordering::Relaxed) && !inbox.has_ended() {
        let mut receiver = receiver(&wire)?;
        let mut board = Computer::new(&inbox, &mut outbox, &mut sealed, &guard, recorder.as_mut());
        receiver.restore(board.sealed_memory(), after_power_on);
        apply(plan, &mut receiver)?;
        receiver.greet(board.outbox());
        guard::ready();
        let mut epochs = EpochLoop::new();
        while !receiver.reset_requested() && !stop.load(Ordering::Relaxed) && !board.has_ended() {
            epochs.pass(&mut board, &mut receiver);
            board.record(&receiver);
        }
        board.drain(&mut receiver);
        board.record(&receiver);
        configuration = Some(*receiver.configuration());
        after_power_on = false;
    }
    wire.drive(false).context("the pin cannot be set")?;
    outbox.close();
    if let Some((recorder, configuration)) = recorder.zip(configuration) {
        recorder.end(&configuration)?;
    }
    Ok(())
}

/// Makes the module; its pin is low.
fn receiver(wire: &Arc<Wire>) -> Result<Receiver<Pin>> {
    let boot = Boot::on_host("computer");
    let receiver = Receiver::new(Pin::new(Arc::clone(wire)), boot);
    let Ok(receiver) = receiver else { bail!("the thresholds at start are not in the tables") };
    Ok(receiver)
}

/// Gives the module the settings of the plan, by the parser of the commands that a host sends.
fn apply(plan: &Plan, receiver: &mut Receiver<Pin>) -> Result<()> {
    for (key, value) in &plan.settings {
        let (mut answer, values) = (Vec::new(), (!value.is_empty()).then_some(value.as_str()));
        if receiver.set(key, values, &mut answer).is_ok() {
            continue;
        }
        let answer = String::from_utf8_lossy(&answer);
        let (_, why) = answer.split_once(",ERR,").unwrap_or_default();
        let why = why.split('*').next().unwrap_or_default();
        bail!("the module refuses {key} = \"{value}\": {why} (INTERFACES.md lists every key and its values)");
    }
    Ok(())
}

#[cfg(test)]
mod tests;
