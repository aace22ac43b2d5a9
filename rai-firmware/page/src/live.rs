//! The module on a receiver's port, as `rai run` has it: bytes with their times in, its state out.

use std::io::{Read as _, stdin};

use anyhow::{Context as _, Result};
use raim::page::live::{State, json};
use raim::replay::{check_answers, command_for};
use raim::satellites::{Seen, Views};
use raim::sentence::{self, command};
use raim_firmware::bit_rate::{BitRate, RATES};
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};

/// A running module.
pub(crate) struct Live {
    receiver: Receiver<MemoryPin, Views>,
    state: State,
    reported: Vec<u8>,
    rate: BitRate,
    /// Rate at which the port must be read, bit/s.
    baud: u32,
    /// The same if a person has fixed it.
    fixed: Option<u32>,
}

impl Live {
    /// Starts a module with settings, as `KEY=VALUE`, on a port of this name and rate, and prints its
    /// state. The rate `AUTO` is found as on the board.
    ///
    /// # Errors
    /// A setting is refused, or the rate is no number.
    pub(crate) fn start(name: &str, rate: &str, settings: &[&str]) -> Result<Self> {
        let fixed =
            (rate != "AUTO").then(|| rate.parse()).transpose().context("the rate must be a number")?;
        let boot = Boot::on_host("page");
        let mut receiver = Receiver::observed(MemoryPin::default(), Views::new(true), boot)
            .context("the module cannot start")?;
        let setup: Vec<String> = settings.iter().map(|text| command_for(text)).collect::<Result<_>>()?;
        let mut answers = Vec::new();
        for body in &setup {
            receiver.command(command(body).as_bytes(), &mut answers);
        }
        check_answers(&setup, &sentence::sentences(&answers)?)?;
        let state = State::new(name.to_owned(), settings.iter().map(|text| (*text).to_owned()).collect());
        println!("{}", json(&state));
        let baud = fixed.unwrap_or(RATES[0]);
        Ok(Self { receiver, state, reported: Vec::new(), rate: BitRate::new(), baud, fixed })
    }

    /// Takes the bytes on standard input; returns true after a verdict.
    pub(crate) fn receive(&mut self, came_ms: u64) -> bool {
        let mut bytes = Vec::new();
        if stdin().read_to_end(&mut bytes).is_err() {
            return false;
        }
        self.receiver.gnss(&bytes, came_ms, &mut self.reported);
        self.rate.receive(came_ms);
        self.baud = self.rate.next(self.receiver.frames(), self.fixed).unwrap_or(self.baud);
        self.note()
    }

    /// Takes the time; returns true after a verdict.
    pub(crate) fn tick(&mut self, now_ms: u64) -> bool {
        self.receiver.tick(now_ms, &mut self.reported);
        self.note()
    }

    /// Returns the rate at which the port must be read, bit/s.
    pub(crate) const fn baud(&self) -> u32 {
        self.baud
    }

    /// Returns the number of frames so far.
    pub(crate) fn frames(&self) -> u32 {
        self.receiver.frames()
    }

    /// Notes what the module said, and prints the state after a verdict.
    fn note(&mut self) -> bool {
        self.reported.clear();
        self.state.live(self.receiver.pin().high);
        let seen = self.receiver.observer_mut().take();
        let has_verdict = !seen.is_empty();
        for Seen { output, view, .. } in seen {
            self.state.take(output, view.map(|view| view.satellites));
        }
        if has_verdict {
            println!("{}", json(&self.state));
        }
        has_verdict
    }
}
