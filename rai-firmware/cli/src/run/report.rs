//! The report of the service: what happened since it started, as `replay` reports a recording.
//!
//! The epoch loop only takes notes. A thread writes the page, every ten minutes and at the end, and
//! replaces the last one in one step. A page of a day has some 6 MB, so that a page a minute would
//! write up to 9 GB a day onto a card that wears out.

use std::path::PathBuf;
use std::thread::{self, JoinHandle};

use anyhow::{Context as _, Result};
use raim_firmware::settings::Configuration;

use crate::page::report::{self, Facts, Happened, Journal, command_line, settings_of};
use crate::run::words::say;
use crate::satellites::Seen;

/// Milliseconds between two pages.
const INTERVAL_MS: u64 = 600_000;

/// Notes of the service.
#[derive(Debug)]
pub(super) struct Recorder {
    folder: PathBuf,
    source: String,
    journal: Journal,
    first_ms: Option<u64>,
    written_ms: u64,
    writer: Option<JoinHandle<Result<PathBuf>>>,
}

impl Recorder {
    pub(super) fn new(folder: PathBuf, source: String) -> Self {
        Self { folder, source, journal: Journal::default(), first_ms: None, written_ms: 0, writer: None }
    }

    /// Takes the verdicts of a pass of the epoch loop.
    pub(super) fn note(
        &mut self,
        seen: &[Seen],
        configuration: &Configuration,
        pin_is_high: bool,
        now_ms: u64,
    ) {
        self.take(seen, pin_is_high, now_ms);
        if now_ms.saturating_sub(self.written_ms) >= INTERVAL_MS && !self.journal.is_empty() {
            self.written_ms = now_ms;
            self.write(configuration);
        }
    }

    /// Takes verdicts.
    pub(super) fn take<'s>(
        &mut self,
        seen: impl IntoIterator<Item = &'s Seen>,
        pin_is_high: bool,
        now_ms: u64,
    ) {
        for Seen { output, view, .. } in seen {
            let time_s = (now_ms - *self.first_ms.get_or_insert(now_ms)) as f64 * 1e-3;
            self.journal.push(&Happened { time_s, output, error: None, pin_is_high, view: view.as_ref() });
        }
    }

    /// Writes the page in a thread of its own, unless the last one is not yet complete.
    fn write(&mut self, configuration: &Configuration) {
        if self.writer.as_ref().is_some_and(|writer| !writer.is_finished()) {
            return;
        }
        let (journal, facts, folder) = (self.journal.clone(), self.facts(configuration), self.folder.clone());
        self.writer = Some(thread::spawn(move || report::write(&journal, &facts, &folder)));
    }

    /// Writes the last page.
    ///
    /// # Errors
    /// The page cannot be written.
    pub(super) fn end(mut self, configuration: &Configuration) -> Result<()> {
        // Two threads must not write the same page.
        if let Some(writer) = self.writer.take() {
            let _ = writer.join();
        }
        if self.journal.is_empty() {
            return Ok(());
        }
        let path =
            report::write(&self.journal, &self.facts(configuration), &self.folder).context("the report")?;
        say!("report: {}", path.display());
        Ok(())
    }

    fn facts(&self, configuration: &Configuration) -> Facts {
        let (settings_hash, settings) = settings_of(configuration);
        Facts {
            title: "The module as a service".to_owned(),
            summary: format!("{} epochs and silences since the start.", self.journal.len()),
            source: self.source.clone(),
            command: command_line(),
            settings_hash,
            settings,
            mask_deg: configuration.mask_rad().to_degrees(),
            ..Facts::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use raim_firmware::receiver::{Boot, Receiver};

    use super::*;
    use crate::satellites::Views;
    use crate::signal::encode::{Encoder, Frequency, Selection};
    use crate::signal::sky::raw::Simulation;
    use raim_firmware::pin::MemoryPin;

    type Module = Receiver<MemoryPin, Views>;

    fn module() -> Module {
        Receiver::observed(MemoryPin::default(), Views::new(true), Boot::on_host("test")).unwrap()
    }

    fn record(recorder: &mut Recorder, receiver: &mut Module, now_ms: u64) {
        let seen = receiver.observer_mut().take();
        recorder.note(&seen, receiver.configuration(), receiver.pin().high, now_ms);
    }

    /// Sends the epochs of a sky to a module and its recorder, a second apart by their clock.
    fn observe(recorder: &mut Recorder, receiver: &mut Module, epochs: u32) -> String {
        let recording = Simulation::above_xian(0.0, epochs, 1).record();
        let mut encoder =
            Encoder::new(&recording.ephemerides, Selection::new("GC", Frequency::Dual).unwrap());
        for (second, epoch) in (0_u64..).zip(&recording.epochs) {
            receiver.gnss(&encoder.epoch(epoch).unwrap(), second * 1000, &mut Vec::new());
            record(recorder, receiver, second * 1000);
        }
        recording.epochs[0].satellites[0].satellite.to_string()
    }

    #[test]
    fn page_is_replaced_every_ten_minutes_while_the_service_runs() {
        let folder = tempfile::tempdir().unwrap();
        let mut receiver = module();
        let mut recorder = Recorder::new(folder.path().to_owned(), "-".to_owned());
        observe(&mut recorder, &mut receiver, 60);
        assert!(recorder.writer.is_none() && !folder.path().join("report.html").exists());
        let mut epochs = [0; 2];
        for (now_ms, epochs) in [600_000, 1_200_000].into_iter().zip(&mut epochs) {
            receiver.tick(now_ms - 1000, &mut Vec::new());
            record(&mut recorder, &mut receiver, now_ms - 1000);
            assert!(recorder.writer.is_none(), "no page before its time");
            receiver.tick(now_ms, &mut Vec::new());
            record(&mut recorder, &mut receiver, now_ms);
            recorder.writer.take().expect("a page every ten minutes").join().unwrap().unwrap();
            let html = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
            assert!(html.ends_with("</html>\n"));
            let (before, _) = html.split_once(" epochs and silences").expect("a summary");
            *epochs = before.rsplit('>').next().unwrap().parse().unwrap();
        }
        // After a minute of epochs, the silence adds its alerts.
        assert!(epochs[0] >= 60 && epochs[1] > epochs[0], "{epochs:?}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing stays beside the page");
    }

    #[test]
    fn epochs_and_a_silence_reach_the_page() {
        let mut receiver = module();
        let folder = tempfile::tempdir().unwrap();
        let mut recorder = Recorder::new(folder.path().to_owned(), "tcp://receiver:1".to_owned());
        let known = observe(&mut recorder, &mut receiver, 20);
        for now_ms in (19_100..35_000).step_by(100) {
            receiver.tick(now_ms, &mut Vec::new());
            record(&mut recorder, &mut receiver, now_ms);
        }
        recorder.end(receiver.configuration()).unwrap();
        let html = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
        for part in [
            "tcp://receiver:1",
            "STALE",
            "<td>protected</td>",
            &known,
            "no epoch was judged within the time to alert",
        ] {
            assert!(html.contains(part), "{part}");
        }
    }
}
