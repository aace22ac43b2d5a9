//! Replay with the module in process.

use anyhow::{Context, Result, ensure};
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::settings::Configuration;

use super::ahead::Ahead;
use super::settings::advice;
use crate::satellites::{Seen, View, Views};
use crate::sentence::{self, command};
use crate::signal::lump::Lump;
use crate::signal::pieces;
use crate::verdict::EpochOutput;
use raim_firmware::pin::MemoryPin;

/// Bodies of the commands that configure the module before the first epoch, without `$PRAIC,` and
/// checksum.
pub type Setup = [String];

/// Checks that every answer is `OK`.
///
/// # Errors
/// The module refuses a command.
pub fn check_answers(setup: &Setup, answers: &str) -> Result<()> {
    for (body, answer) in setup.iter().zip(answers.lines()) {
        let answer = answer.split('*').next().unwrap_or("");
        let accepted = answer.ends_with(",OK") || answer.contains(",OK,WARN,");
        let why = answer.split_once(",ERR,").map_or(answer, |(_, why)| why);
        let advice = advice(body.split(',').next().unwrap_or(""), why);
        ensure!(accepted, "the module refuses {}: {why}{advice}", body.replacen(',', "=", 1));
    }
    Ok(())
}

/// Time that passes for the module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// Time passes as recorded. An interval of more than one and a half times the recording's usual
    /// one is a silence, during which the module only receives ticks. With a key of OSNMA it receives
    /// some after each epoch. A recording thinned to 30 s
    /// is therefore not one long alarm.
    Recorded,
    /// The next lump follows the verdict on the last one, without silence.
    LockStep,
}

/// Answer of the module to one lump.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reported {
    /// Sentences of the epoch.
    pub of_epoch: String,
    /// Sentences of the silence after it.
    pub of_silence: String,
    /// Verdicts of the lump: one, unless it has several epochs or none.
    pub seen: Vec<Seen>,
    /// Verdicts of the silence after it, with their times, s after the first epoch of the recording.
    pub silence: Vec<(f64, Seen)>,
}

impl Reported {
    /// Returns the verdict on the epoch that was judged last, if one was.
    pub fn output(&self) -> Option<&EpochOutput> {
        self.seen.last().map(|seen| &seen.output)
    }

    /// Returns the module's view of that epoch, if it is [watched](Playback::watch).
    pub fn view(&self) -> Option<&View> {
        self.seen.last()?.view.as_ref()
    }
}

/// Result of a run in process.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HostRun {
    /// Sentences, lump by lump.
    pub reported: Vec<Reported>,
    /// Counters of the module at the end, by name.
    pub counters: Vec<(String, u32)>,
}

impl HostRun {
    /// Returns all sentences in one text.
    pub fn sentences(&self) -> String {
        self.reported
            .iter()
            .flat_map(|reported| [reported.of_epoch.as_str(), reported.of_silence.as_str()])
            .collect()
    }
}

/// Time between two ticks on a silent line, ms, as the module requires.
const TICK_MS: u64 = 100;

/// Time after an epoch in which the module authenticates, ms. It is shorter than any time to alert.
const WORK_MS: u64 = 1000;

/// Pause after which the module no longer waits for the rest of a frame, ms.
const QUIET_MS: u64 = 500;

/// Runs the lumps in process.
///
/// # Errors
/// As for [`Playback`].
pub fn on_host(
    lumps: &[Lump],
    setup: &Setup,
    pace: Pace,
    mut progress: impl FnMut(usize),
) -> Result<HostRun> {
    let mut playback = Playback::start(lumps.iter().cloned().map(Ok), setup, pace)?;
    let mut run = HostRun::default();
    while let Some((_, reported)) = playback.advance()? {
        run.reported.push(reported);
        progress(run.reported.len());
    }
    run.counters = playback.counters()?;
    Ok(run)
}

/// Playback of lumps through the module in process. It holds no more lumps in memory than it reads
/// ahead.
pub struct Playback<I> {
    lumps: Ahead<I>,
    module: Module,
    pace: Pace,
    last_epoch_ms: u64,
}

impl<I: Iterator<Item = Result<Lump>>> Playback<I> {
    /// Starts and configures a module.
    ///
    /// # Errors
    /// The module refuses a setup command.
    pub fn start(lumps: I, setup: &Setup, pace: Pace) -> Result<Self> {
        let (lumps, module) = (Ahead::of(lumps), Module::start(setup)?);
        Ok(Self { lumps, module, pace, last_epoch_ms: 0 })
    }

    /// Plays the next lump, and the silence behind it; returns `None` at the end.
    ///
    /// # Errors
    /// The source of the lumps fails, or the pin is high although the verdict forbids it, or the
    /// reverse.
    pub fn advance(&mut self) -> Result<Option<(Lump, Reported)>> {
        let Some((lump, next_ms)) = self.lumps.next()? else { return Ok(None) };
        let now_ms = lump.elapsed_ms();
        let (of_epoch, seen) = self.module.receive(&lump.bytes, now_ms)?;
        let mut reported = Reported { of_epoch, seen, ..Reported::default() };
        if !reported.seen.is_empty() {
            self.last_epoch_ms = now_ms;
        }
        // A lump without an epoch is a silence, too.
        let usual_ms = self.lumps.usual_ms();
        let is_silence = |next_ms: &u64| 2 * next_ms.saturating_sub(self.last_epoch_ms) > 3 * usual_ms;
        if let Some(next_ms) = next_ms.filter(|_| self.pace == Pace::Recorded) {
            if is_silence(&next_ms) {
                self.module.wait(now_ms, next_ms, &mut reported)?;
            } else if self.module.has_key {
                self.module.wait(now_ms, next_ms.min(now_ms + WORK_MS), &mut reported)?;
            }
        }
        Ok(Some((lump, reported)))
    }

    /// Returns the module's counters, by name.
    ///
    /// # Errors
    /// An answer is not text.
    pub fn counters(&mut self) -> Result<Vec<(String, u32)>> {
        self.module.counters()
    }

    /// Gives the module bytes of its host port; returns its answer.
    ///
    /// # Errors
    /// The answer is not text.
    pub fn command(&mut self, bytes: &[u8]) -> Result<String> {
        let mut reported = Vec::new();
        self.module.receiver.command(bytes, &mut reported);
        sentence::sentences(&reported)
    }

    /// Lets [`Reported`] have the module's view of every epoch.
    pub fn watch(&mut self) {
        self.module.watch();
    }

    /// Returns the settings in force.
    pub fn configuration(&self) -> &Configuration {
        self.module.receiver.configuration()
    }

    /// Returns the level of the pin.
    pub fn pin_is_high(&self) -> bool {
        self.module.receiver.pin().high
    }

    /// Returns the sentences that the module sends at start: its version and its settings.
    ///
    /// # Errors
    /// The sentences are not text.
    pub fn greeting(&mut self) -> Result<String> {
        let mut reported = Vec::new();
        self.module.receiver.greet(&mut reported);
        self.module.receiver.tick(0, &mut reported);
        Ok(String::from_utf8(reported)?)
    }
}

/// Module in process.
pub struct Module {
    receiver: Receiver<MemoryPin, Views>,
    /// True if the setup has a key of OSNMA, whose work is done in ticks.
    has_key: bool,
}

impl Module {
    /// Starts and configures the module.
    ///
    /// # Errors
    /// The module refuses a setup command.
    pub fn start(setup: &Setup) -> Result<Self> {
        let boot = Boot::on_host("host");
        let mut receiver = Receiver::observed(MemoryPin::default(), Views::new(false), boot)
            .context("the module cannot start")?;
        let mut answers = Vec::new();
        for body in setup {
            receiver.command(command(body).as_bytes(), &mut answers);
        }
        check_answers(setup, &sentence::sentences(&answers)?)?;
        let has_key = setup.iter().any(|body| body.starts_with("KEY,") || body.starts_with("ROOT,"));
        Ok(Self { receiver, has_key })
    }

    /// Returns the settings in force.
    pub fn configuration(&self) -> &Configuration {
        self.receiver.configuration()
    }

    /// Lets the module's view of every epoch be part of its verdict.
    pub fn watch(&mut self) {
        self.receiver.observer_mut().watch();
    }

    /// Returns sentences and verdicts for an epoch that comes at `now_ms`. If there are none, because
    /// no range came, the last verdict stands until it is stale.
    ///
    /// # Errors
    /// The pin is high although the verdict forbids it, or the reverse.
    pub fn receive(&mut self, bytes: &[u8], now_ms: u64) -> Result<(String, Vec<Seen>)> {
        // An epoch has some 650 bytes of sentences.
        let mut reported = Vec::with_capacity(1024);
        let is_judged = self.receiver.gnss(bytes, now_ms, &mut reported);
        if !is_judged && pieces::have_ranges(bytes) {
            // Noise that looks like the beginning of a frame delays the epoch until the line falls
            // silent.
            self.receiver.tick(now_ms + QUIET_MS, &mut reported);
        }
        let seen = self.receiver.observer_mut().take();
        self.compare(&seen, now_ms)?;
        Ok((sentence::sentences(&reported)?, seen))
    }

    /// Compares the pin with the last verdict.
    fn compare(&self, seen: &[Seen], now_ms: u64) -> Result<()> {
        let agree =
            seen.last().is_none_or(|last| self.receiver.pin().high == last.output.state.is_protected());
        ensure!(agree, "pin and verdict disagree at {now_ms} ms");
        Ok(())
    }

    /// Lets time pass without a byte.
    fn wait(&mut self, from_ms: u64, to_ms: u64, reported: &mut Reported) -> Result<()> {
        for now_ms in (from_ms..to_ms).step_by(TICK_MS as usize).skip(1) {
            let mut alarm = Vec::new();
            self.receiver.tick(now_ms, &mut alarm);
            reported.of_silence.push_str(&sentence::sentences(&alarm)?);
            // Settings and losses are repeated at intervals, whatever the input.
            let seen = self.receiver.observer_mut().take();
            self.compare(&seen, now_ms)?;
            reported.silence.extend(seen.into_iter().map(|seen| (now_ms as f64 * 1e-3, seen)));
        }
        Ok(())
    }

    fn counters(&mut self) -> Result<Vec<(String, u32)>> {
        let mut answers = Vec::new();
        self.receiver.command(command("STATS").as_bytes(), &mut answers);
        Ok(sentence::sentences(&answers)?.lines().flat_map(counters_of).collect())
    }
}

/// Returns the names and values in one answer to `STATS`.
pub fn counters_of(answer: &str) -> Vec<(String, u32)> {
    let body = answer.split('*').next().unwrap_or("");
    let fields: Vec<&str> = body.split(',').skip(2).collect();
    fields
        .chunks_exact(2)
        .filter_map(|pair| Some((pair.first()?.to_string(), pair.get(1)?.parse().ok()?)))
        .collect()
}
