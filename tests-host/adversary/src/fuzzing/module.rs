//! The module in process, with every output checked.

use std::collections::BTreeMap;

use raim::verdict::EpochOutput;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::settings::Configuration;

use super::overheard;

/// A module, its clock, and the number of bytes and epochs that it processed.
pub(super) struct Module {
    receiver: Receiver<MemoryPin>,
    now_ms: u64,
    bytes: usize,
    epochs: usize,
    stale: usize,
}

impl Module {
    pub(super) fn new() -> Self {
        let boot = Boot::on_host("fuzzing");
        let receiver =
            Receiver::new(MemoryPin::default(), boot).expect("thresholds of the requirements at start");
        Self { receiver, now_ms: 0, bytes: 0, epochs: 0, stale: 0 }
    }

    /// Sends bytes to the GNSS port, then lets time pass.
    pub(super) fn receive(&mut self, bytes: &[u8], pause_ms: u64) {
        let mut reported = Vec::new();
        self.receiver.gnss(bytes, self.now_ms, &mut reported);
        self.bytes += bytes.len();
        self.now_ms += pause_ms;
        self.receiver.tick(self.now_ms, &mut reported);
        let outputs = overheard::check(&reported);
        for output in &outputs {
            let counter = if output.state.has_epoch() { &mut self.epochs } else { &mut self.stale };
            *counter += 1;
        }
        if let Some(EpochOutput { state, .. }) = outputs.last() {
            assert_eq!(self.receiver.pin().high, state.is_protected(), "the pin against {state:?}");
        }
    }

    /// Sends bytes to the host port; returns the answers.
    pub(super) fn obey(&mut self, bytes: &[u8]) -> String {
        let mut reported = Vec::new();
        self.receiver.command(bytes, &mut reported);
        overheard::check(&reported);
        String::from_utf8(reported).expect("checked above")
    }

    pub(super) fn configuration(&self) -> Configuration {
        *self.receiver.configuration()
    }

    pub(super) fn counter(&self, name: &str) -> usize {
        self.counters().get(name).copied().unwrap_or_else(|| panic!("no counter {name}"))
    }

    fn counters(&self) -> BTreeMap<&'static str, usize> {
        self.receiver.statistics().map(|(name, count)| (name, count as usize)).collect()
    }

    /// Checks bytes, frames and epochs against the counters, because nothing may be lost uncounted.
    pub(super) fn adds_up(&self) {
        let counters = self.counters();
        let sum = |names: &[&str]| names.iter().map(|name| counters[name]).sum::<usize>();
        let verdicts = sum(&["epochs_protected", "epochs_alert", "epochs_unavailable"]);
        assert_eq!(verdicts, self.epochs, "verdicts said and counted");
        let judged_or_late = self.epochs + counters["epochs_late"];
        assert_eq!(counters["epochs"], judged_or_late, "epochs handed on, and judged or too late");
        assert_eq!(counters["line_stale"], self.stale, "silences said and counted");
        let outcomes = [
            "messages_other",
            "messages_malformed",
            "ephemerides",
            "ephemerides_invalid",
            "positions_invalid",
        ];
        assert!(sum(&outcomes) <= counters["frames"], "a frame has one outcome: {counters:?}");
        // The shortest frame is header and parity.
        assert!(
            counters["bytes_skipped"] + 6 * counters["frames"] <= self.bytes,
            "{counters:?} of {}",
            self.bytes
        );
        assert_eq!(sum(&["host_lost", "pin_failures"]), 0, "{counters:?}");
    }
}
