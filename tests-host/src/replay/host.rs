//! The module in process.

use anyhow::{Context, Result, ensure};
use rai_firmware::receiver::{Boot, Receiver};

use super::lump::Lump;
use super::lumps::interval_s;
use super::pieces;
use crate::pin::Pin;
use crate::sentence;

/// Bodies of the commands that configure the module before the first epoch, without `$PRAIC,` and checksum.
pub type Setup = [String];

/// A command as it goes over the wire.
pub(super) fn command(body: &str) -> String {
    let body = format!("PRAIC,{body}");
    format!("${body}*{:02X}\r\n", body.bytes().fold(0u8, |sum, byte| sum ^ byte))
}

/// Fails unless every answer says OK.
pub(super) fn check_answers(setup: &Setup, answers: &str) -> Result<()> {
    for (body, answer) in setup.iter().zip(answers.lines()) {
        let answer = answer.split('*').next().unwrap_or("");
        let accepted = answer.ends_with(",OK") || answer.contains(",OK,WARN,");
        let why = answer.split_once(",ERR,").map_or(answer, |(_, why)| why);
        ensure!(accepted, "the module refuses {}: {why}", body.replacen(',', "=", 1));
    }
    Ok(())
}

/// How time runs for the module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// As recorded. An interval half as long again as the recording's own is a silence, which the module is left to
    /// notice; a recording thinned to 30 s is not one long alarm.
    Recorded,
    /// The next lump follows the verdict on the last, as on the emulated board: there is no silence.
    LockStep,
}

/// What the module said of one lump.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Said {
    /// The sentences of the epoch.
    pub of_epoch: String,
    /// The sentences of the silence after it.
    pub of_silence: String,
    /// When it complained of the silence, seconds after the first epoch of the recording.
    pub stale_s: Option<f64>,
}

/// What came of a run in process.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HostRun {
    /// Lump by lump.
    pub said: Vec<Said>,
    /// The module's counters at the end, by name.
    pub counters: Vec<(String, u32)>,
}

impl HostRun {
    /// All sentences in one piece.
    pub fn sentences(&self) -> String {
        self.said.iter().flat_map(|said| [said.of_epoch.as_str(), said.of_silence.as_str()]).collect()
    }
}

/// Least time between two looks at a silent line, ms: what the module asks for.
const TICK_MS: u64 = 100;

/// A pause after which the module waits for the rest of a frame no more, ms.
const QUIET_MS: u64 = 500;

/// How much longer than usual an interval is that counts as a silence.
const SILENCE: f64 = 1.5;

/// Runs the lumps in process.
///
/// # Errors
/// A setup command that the module refuses; a pin that is high when the verdict does not allow it, or the reverse.
pub fn on_host(
    lumps: &[Lump],
    setup: &Setup,
    pace: Pace,
    mut progress: impl FnMut(usize),
) -> Result<HostRun> {
    let mut module = Module::start(setup)?;
    let usual_s = interval_s(lumps);
    let (mut run, mut last_epoch_s) = (HostRun::default(), 0.0);
    for (index, lump) in lumps.iter().enumerate() {
        let mut said = Said { of_epoch: module.hear(lump)?, ..Said::default() };
        if said.of_epoch.contains("$PRAIS") {
            last_epoch_s = lump.elapsed_s;
        }
        // Bytes without an epoch are a silence, too.
        let silence = lumps
            .get(index + 1)
            .filter(|next| pace == Pace::Recorded && next.elapsed_s - last_epoch_s > SILENCE * usual_s);
        if let Some(next) = silence {
            module.wait(lump.elapsed_s, next.elapsed_s, &mut said)?;
        }
        run.said.push(said);
        progress(index + 1);
    }
    run.counters = module.counters()?;
    Ok(run)
}

/// The module in process.
struct Module(Receiver<Pin>);

impl Module {
    fn start(setup: &Setup) -> Result<Self> {
        let boot = Boot::on_host("host");
        let mut receiver = Receiver::new(Pin::default(), boot).context("the module cannot start")?;
        let mut answers = Vec::new();
        for body in setup {
            receiver.command(command(body).as_bytes(), &mut answers);
        }
        check_answers(setup, &sentence::sentences(&answers)?)?;
        Ok(Self(receiver))
    }

    /// What it says of an epoch. Where it says nothing, because no range came, the last verdict stands until it is stale.
    fn hear(&mut self, lump: &Lump) -> Result<String> {
        let mut said = Vec::new();
        let is_judged = self.0.gnss(&lump.bytes, ms(lump.elapsed_s), &mut said);
        if !is_judged && pieces::have_ranges(&lump.bytes) {
            // Noise that looks like the beginning of a frame holds the epoch back until the line falls silent.
            self.0.tick(ms(lump.elapsed_s) + QUIET_MS, &mut said);
        }
        let text = sentence::sentences(&said)?;
        if let Some(epoch) = sentence::epochs(&text)?.last() {
            let agree = self.0.pin().high == epoch.state.is_protected();
            ensure!(agree, "pin and verdict disagree at {} s", lump.elapsed_s);
        }
        Ok(text)
    }

    /// Lets time pass without a byte.
    fn wait(&mut self, from_s: f64, to_s: f64, said: &mut Said) -> Result<()> {
        for now_ms in (ms(from_s)..ms(to_s)).step_by(TICK_MS as usize).skip(1) {
            let mut alarm = Vec::new();
            self.0.tick(now_ms, &mut alarm);
            let text = sentence::sentences(&alarm)?;
            said.of_silence.push_str(&text);
            // Settings and losses are said from time to time, whatever comes.
            if !sentence::epochs(&text)?.is_empty() {
                said.stale_s.get_or_insert(now_ms as f64 * 1e-3);
                ensure!(!self.0.pin().high, "the pin is high on a silent line at {now_ms} ms");
            }
        }
        Ok(())
    }

    fn counters(&mut self) -> Result<Vec<(String, u32)>> {
        let mut answers = Vec::new();
        self.0.command(command("STATS").as_bytes(), &mut answers);
        Ok(sentence::sentences(&answers)?.lines().flat_map(counters_of).collect())
    }
}

/// Names and values of one answer to `STATS`.
pub(super) fn counters_of(answer: &str) -> Vec<(String, u32)> {
    let body = answer.split('*').next().unwrap_or("");
    let fields: Vec<&str> = body.split(',').skip(2).collect();
    fields
        .chunks_exact(2)
        .filter_map(|pair| Some((pair.first()?.to_string(), pair.get(1)?.parse().ok()?)))
        .collect()
}

fn ms(elapsed_s: f64) -> u64 {
    (elapsed_s * 1e3) as u64
}
