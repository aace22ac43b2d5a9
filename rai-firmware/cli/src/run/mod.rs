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
//! | `contact` | finds the rate of a port, and says what the receiver's bytes lack |
//! | `ranges` | notices that the ranges of a receiver end while its line lives |
//! | `px4` | makes the message that PX4 reads |
//! | `played` | plays a file on standard input, in the time of its epochs |
//! | `outbox`, `output`, `clients` | send sentences to consumers, none of which another one waits for |
//! | `time_server` | tells chrony the time of protected epochs |
//! | [`pin`], `actuator`, `reserve` | drive the integrity pin, whatever the computer has run out of |
//! | `signals` | lowers the pin before a signal or a panic ends the program |
//! | [`clock`], `backlog` | have the time, which a test may move, and the age of a pipe's epochs |
//! | [`log`] | reports the start and each change of the state |
//! | `report` | takes notes of every epoch, for a page as `replay` writes it |
//! | `share`, `record` | pass the receiver's raw bytes to other programs, or into a file |
//! | `page` | serves a page of the running module |
//! | `words` | writes lines on standard error, for which nobody waits |
//! | `guard` | drops the pin and ends the program if the epoch loop hangs |
//!
//! The epoch loop runs in the calling thread. Every port has a thread of its own, with a bounded
//! queue between the two: a slow or dead consumer loses its own sentences only.

mod actuator;
mod backlog;
mod board;
mod caster;
mod clients;
pub mod clock;
mod contact;
mod guard;
mod inbox;
mod input;
pub mod log;
mod outbox;
mod output;
mod page;
pub mod pin;
pub mod plan;
mod played;
mod px4;
mod ranges;
mod record;
mod report;
mod reserve;
mod share;
mod signals;
#[cfg(unix)]
mod time_server;
mod words;

use std::cell::Cell;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use anyhow::{Context as _, Result, bail, ensure};
use raim_firmware::board::SEALED_BYTES;
use raim_firmware::epoch_loop::EpochLoop;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::settings::Configuration;

use backlog::Backlog;
use board::Computer;
use clients::Clients;
use clock::Clock;
use contact::Contact;
use guard::Guard;
use inbox::Inbox;
use input::{Line, Nature};
use log::Log;
use outbox::{Outbox, Wait};
use output::Sink;
use page::Page;
use pin::{Pin, Wire};
use record::Record;
use report::Recorder;
use share::Share;
use words::say;

use crate::replay::settings;
use crate::satellites::Views;

pub use plan::{Arguments, Plan};

/// The module of the service.
type Module = Receiver<Pin, Views>;

/// Messages of `MAVLink`.
const MESSAGES: [&str; 3] = ["HEARTBEAT", "GPS_INPUT", "GNSS_INTEGRITY"];
/// Wait for a consumer after which the pin falls, because nothing is judged meanwhile, and age of an
/// epoch of a pipe from which on it is low.
const LONGEST_HIGH: Duration = Duration::from_millis(500);

/// Runs the service as the command line asks, until the input ends or a signal stops it.
///
/// # Errors
/// If the configuration is wrong, if a port that was named does not exist, or if a finite input
/// lost bytes or sentences.
pub fn run(arguments: Arguments) -> Result<()> {
    if arguments.lower_pin {
        return Wire::open(&plan::pin_alone(arguments)?)?.lower().context("the pin");
    }
    let plan = Plan::read(arguments)?;
    let stop = Arc::new(AtomicBool::new(false));
    let wire = Arc::new(Wire::open(&plan.pin)?);
    signals::catch(&wire, &stop)?;
    signals::end_on_panic(&wire);
    serve_on(&plan, &wire, &stop, &Clock::of_the_computer())
}

/// Runs the service until `stop` is set or a finite input ends.
///
/// # Errors
/// As [`run`].
pub fn serve(plan: &Plan, stop: &Arc<AtomicBool>) -> Result<()> {
    serve_by(plan, stop, &Clock::of_the_computer())
}

/// Runs the service by a clock that the caller may move.
///
/// # Errors
/// As [`run`].
pub fn serve_by(plan: &Plan, stop: &Arc<AtomicBool>, clock: &Arc<Clock>) -> Result<()> {
    serve_on(plan, &Arc::new(Wire::open(&plan.pin)?), stop, clock)
}

fn serve_on(plan: &Plan, wire: &Arc<Wire>, stop: &Arc<AtomicBool>, clock: &Arc<Clock>) -> Result<()> {
    // Whatever ends this function, the pin is low and nobody waits for the service.
    let end = End { wire, clock, has_failed: Cell::new(false) };
    // The pin first: it is low before anything else can fail.
    end.lower()?;
    let nature = Nature::of(&plan.input);
    ensure!(
        nature != Nature::File || plan.page.is_none(),
        "--page shows a running module; `replay --report` shows a file"
    );
    ensure!(
        nature == Nature::Live || (plan.share.is_none() && plan.record.is_none()),
        "--share and --record take the bytes of a receiver on a serial port or TCP; a file is a recording, and `tee` \
         keeps the bytes of a pipe"
    );
    ensure!(
        nature == Nature::Live || !plan.outputs.iter().any(|output| matches!(output, Sink::Chrony(_))),
        "chrony: takes the time of a receiver on a serial port or over TCP; that of a file or a pipe may be of the past"
    );
    let (is_file, waits) = (nature == Nature::File, nature != Nature::Live);
    let inbox = Arc::new(Inbox::new(Arc::clone(clock), waits));
    let guard = (!is_file).then(|| Arc::new(Guard::start(wire, stop)));
    let mut outbox = Outbox::new(waits.then(|| wait(wire, clock, stop, guard.clone())));
    outbox.keep_log(Log::new(plan.log));
    let mut clients = Clients::new(plan.clients, waits)?;
    for output in &plan.outputs {
        output::open(output, &mut outbox, &inbox, &mut clients, is_file)
            .with_context(|| output.to_string())?;
    }
    if clients.has_listeners() {
        let (lost, done) = outbox.for_clients();
        outbox.add_clients(clients.start(lost, done)?);
    }
    let mut recorder = plan.report.clone().map(|folder| Recorder::new(folder, plan.named.clone()));
    let configuration = match &guard {
        None => Some(played::play(plan, wire, &mut outbox, recorder.as_mut(), stop)?),
        Some(guard) => live(plan, (wire, guard), &inbox, &mut outbox, recorder.as_mut(), stop)?,
    };
    end.lower()?;
    let is_finite = is_file || inbox.has_ended();
    let lost = (inbox.dropped(), Arc::clone(&outbox.for_clients().0));
    let errors = outbox.close();
    let lost = [lost.0, lost.1.load(Ordering::Relaxed)];
    if let Some((recorder, configuration)) = recorder.zip(configuration) {
        recorder.end(&configuration)?;
    }
    say_losses(lost, errors, is_finite)
}

/// Runs the module in real time; returns its settings at the end.
fn live(
    plan: &Plan,
    (wire, guard): (&Arc<Wire>, &Guard),
    inbox: &Arc<Inbox>,
    outbox: &mut Outbox,
    mut recorder: Option<&mut Recorder>,
    stop: &Arc<AtomicBool>,
) -> Result<Option<Configuration>> {
    let mut sealed = Box::new([0; SEALED_BYTES]);
    let (mut after_power_on, mut configuration) = (true, None);
    let share = |name: &String| Share::serve(name, plan.share_write, plan.clients).map(Arc::new);
    let share = plan.share.as_ref().map(share).transpose().context("--share")?;
    let record = |path: &PathBuf| Record::open(path).map(Arc::new);
    let record = plan.record.as_ref().map(record).transpose().context("--record")?;
    let line = Line::of(&plan.input, share, record);
    let serve = |address: &String| {
        let back = line.share.as_ref().map(|share| Arc::clone(share.back()));
        Page::serve(address, plan, back)
    };
    let mut page = plan.page.as_ref().map(serve).transpose().context("--page")?;
    #[cfg(unix)]
    let mut servers = time_servers(plan)?;
    let is_watched = recorder.is_some() || page.is_some();
    let mut backlog = outbox.waits().then(Backlog::default);
    let mut contact = Contact::new(&plan.input, &line.rate, plan.caster.is_some());
    while !stop.load(Ordering::Relaxed) && !inbox.has_ended() {
        let mut receiver = receiver(wire, Views::new(is_watched))?;
        let mut board = Computer::new(
            inbox,
            (&mut *outbox, &mut contact),
            &mut sealed,
            (guard, wire, backlog.as_mut()),
            (recorder.as_deref_mut(), page.as_mut()),
        );
        receiver.restore(board.sealed_memory(), after_power_on);
        apply(plan, &mut receiver)?;
        if after_power_on {
            // The settings are in force before the first byte.
            input::start(&plan.input, &line, inbox, stop)?;
            if let Some(caster) = &plan.caster {
                caster::start(caster.clone(), inbox, stop);
            }
            board.outbox().report_start(plan, receiver.configuration());
        }
        receiver.greet(board.outbox());
        guard::ready();
        let mut epochs = EpochLoop::new();
        while !receiver.reset_requested() && !stop.load(Ordering::Relaxed) && !board.has_ended() {
            epochs.pass(&mut board, &mut receiver);
            board.insert_orbits(&mut receiver);
            board.look(&receiver);
            let promised_ms = board.record(&mut receiver);
            #[cfg(unix)]
            if let Some(came_ms) = promised_ms {
                board.tell_time(&receiver, came_ms, &mut servers);
            }
        }
        board.drain(&mut receiver);
        board.look(&receiver);
        board.record(&mut receiver);
        configuration = Some(*receiver.configuration());
        after_power_on = false;
    }
    let refused = line.share.as_ref().map_or(0, |share| share.back().counts()[1]);
    if refused > 0 {
        say!("share: {refused} bytes towards the receiver were refused");
    }
    if let Some(record) = &line.record {
        record.end();
    }
    if inbox.has_ended() {
        contact.end()?;
    }
    Ok(configuration)
}

/// Returns the consumers of the time.
#[cfg(unix)]
fn time_servers(plan: &Plan) -> Result<Vec<time_server::TimeServer>> {
    let paths = plan.outputs.iter().filter_map(|output| match output {
        Sink::Chrony(path) => Some(path),
        _ => None,
    });
    paths.map(|path| time_server::TimeServer::at(path)).collect()
}

/// Returns how a file or a pipe waits for a consumer: time stands still, the guard is content, and
/// the pin falls. That of a pipe is low until an epoch is new again; without a guard it is a file, whose
/// epochs have no age.
fn wait(wire: &Arc<Wire>, clock: &Arc<Clock>, stop: &Arc<AtomicBool>, guard: Option<Arc<Guard>>) -> Wait {
    let (wire, held, after) = (Arc::clone(wire), Arc::clone(clock), Arc::clone(clock));
    let meanwhile = move |waited: Duration| {
        held.hold();
        if let Some(guard) = &guard {
            guard.feed();
        }
        if waited > LONGEST_HIGH {
            match guard {
                Some(_) => wire.withhold(),
                // If it fails, the next look tries again.
                None => drop(wire.is_high().then(|| wire.drive(false))),
            }
        }
    };
    Wait { stop: Arc::clone(stop), meanwhile: Arc::new(meanwhile), after: Arc::new(move || after.go_on()) }
}

/// Reports what was lost. A finite input could have waited, so that a loss of it is an error.
fn say_losses([bytes, sentences]: [u32; 2], errors: Vec<std::io::Error>, is_finite: bool) -> Result<()> {
    if bytes > 0 || sentences > 0 {
        let words = format!("{bytes} bytes of the receiver and {sentences} sentences found no room");
        if is_finite {
            bail!("{words}");
        }
        say!("{words}");
    }
    match errors.into_iter().next() {
        Some(error) if is_finite => Err(error).context("an output"),
        Some(error) => {
            say!("an output: {error}");
            Ok(())
        }
        None => Ok(()),
    }
}

/// Lowers the pin when the service ends, also by an error or a panic.
struct End<'w> {
    wire: &'w Wire,
    clock: &'w Clock,
    /// True once the service ends with the pin's own error, which is then said once.
    has_failed: Cell<bool>,
}

impl End<'_> {
    /// Lowers the pin before the end.
    fn lower(&self) -> Result<()> {
        self.wire.lower().inspect_err(|_| self.has_failed.set(true)).context("the pin cannot be set")
    }
}

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.clock.end();
        if let (Err(error), false) = (self.wire.close(), self.has_failed.get()) {
            say!("error: the pin cannot be set: {error}");
        }
        words::flush();
    }
}

/// Makes the module; its pin is low.
fn receiver(wire: &Arc<Wire>, observer: Views) -> Result<Module> {
    let boot = Boot::on_host("computer");
    let receiver = Receiver::observed(Pin::new(Arc::clone(wire)), observer, boot);
    let Ok(receiver) = receiver else { bail!("the thresholds at start are not in the tables") };
    Ok(receiver)
}

/// Gives the module the settings of the plan, by the parser of the commands that a host sends.
fn apply(plan: &Plan, receiver: &mut Module) -> Result<()> {
    for (key, value) in &plan.settings {
        let (mut answer, values) = (Vec::new(), (!value.is_empty()).then_some(value.as_str()));
        if receiver.set(key, values, &mut answer).is_ok() {
            continue;
        }
        let answer = String::from_utf8_lossy(&answer);
        let (_, why) = answer.split_once(",ERR,").unwrap_or_default();
        let why = why.split('*').next().unwrap_or_default();
        let advice = settings::advice(key, why);
        bail!("the module refuses {key} = \"{value}\": {why}{advice}");
    }
    let configuration = receiver.configuration();
    let is_silent =
        configuration.outputs.rates().all(|(name, every)| every == 0 || !MESSAGES.contains(&name));
    let is_mavlink = |output: &Sink| matches!(output, Sink::MavlinkUdp(_) | Sink::MavlinkSerial(..));
    ensure!(
        !is_silent || !plan.outputs.iter().any(is_mavlink),
        "a MAVLink output without a message: set OUTPUT=GPS_INPUT,1, OUTPUT=GNSS_INTEGRITY,1 or OUTPUT=HEARTBEAT,1"
    );
    Ok(())
}

#[cfg(test)]
mod tests;
