//! The pin, observed on the board's own clock.
//!
//! The log has each change of the pin and each verdict, in order and with the time. They show how
//! long the pin stays high after one epoch, and whether it ever contradicts the verdict.
//!
//! | quantity | field | unit |
//! |---|---|---|
//! | last byte of an epoch to the pin | `to_pin_ticks` | ticks of the core clock |
//! | last epoch to the pin's fall on a silent line | `to_alert_s` | s |
//! | longest time that the pin stayed high after an epoch | `longest_trust_s` | s |

use std::collections::BTreeMap;

use raim::page::Verdict;
use rig::board::{Judgement, LogLine};

/// Largest delay of the pin's fall on a silent line, s. The module checks its clock every
/// millisecond, and an epoch that comes just before the end is judged first.
pub const LATENESS_S: f64 = 0.01;

/// Record of the pin.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    limit_s: f64,
    pin: Option<f64>,
    last_epoch_s: Option<f64>,
    fell_after_s: Option<f64>,
    last_line_s: f64,
    earlier_lives_s: f64,
    /// Number of starts of the program.
    pub starts: u64,
    /// Ticks from the last byte of an epoch to the pin, of each epoch.
    pub to_pin_ticks: Vec<u64>,
    /// Time from the last epoch to the fall of the pin, s, of each silence.
    pub to_alert_s: Vec<f64>,
    /// Longest time that the pin stayed high after an epoch, s.
    pub longest_trust_s: f64,
    /// Number of times that the pin stayed high for longer than the time to alert.
    pub stale: u64,
    /// Number of verdicts that the pin contradicted.
    pub contradictions: u64,
    /// Log lines that report lost bytes or a failed program.
    pub complaints: Vec<String>,
    /// Deepest stack, bytes.
    pub stack_bytes: u64,
    /// Largest number of bytes in each ring of the ports.
    pub rings: BTreeMap<String, u64>,
}

impl Watch {
    /// Returns a watch for this time to alert.
    pub fn new(time_to_alert_s: f64) -> Self {
        Self { limit_s: time_to_alert_s + LATENESS_S, ..Self::default() }
    }

    /// Returns board time over all starts, s.
    pub fn board_s(&self) -> f64 {
        self.earlier_lives_s + self.last_line_s
    }

    /// Reads one line of the log.
    pub fn see(&mut self, line: &LogLine) {
        if line.text.starts_with("start:") {
            self.start();
        }
        self.last_line_s = line.time_s;
        if let Some(is_high) = line.pin_level() {
            self.pin_changes(is_high, line.time_s);
        }
        if let Some(judgement) = line.judgement() {
            self.judged(judgement, line.time_s);
        }
        if line.text.starts_with("bytes lost") || line.level == "error" {
            self.complaints.push(line.text.clone());
        }
        self.stack_bytes = self.stack_bytes.max(line.stack_bytes().unwrap_or(0));
        for (name, bytes) in line.rings().unwrap_or_default() {
            let most = self.rings.entry(name).or_default();
            *most = bytes.max(*most);
        }
    }

    fn start(&mut self) {
        self.starts += 1;
        self.earlier_lives_s += self.last_line_s;
        (self.pin, self.last_epoch_s, self.fell_after_s) = (None, None, None);
    }

    fn pin_changes(&mut self, is_high: bool, now_s: f64) {
        self.fell_after_s = None;
        if !is_high && self.pin.is_some() {
            self.fell_after_s = self.trusted_until(now_s);
        }
        self.pin = is_high.then_some(now_s);
    }

    fn judged(&mut self, judgement: Judgement, now_s: f64) {
        self.contradictions += u64::from((judgement.verdict == Verdict::Protected) != self.pin.is_some());
        self.to_pin_ticks.extend(judgement.ticks_to_pin);
        let fell_after_s = self.fell_after_s.take();
        if judgement.is_stale {
            self.to_alert_s.extend(fell_after_s);
            return;
        }
        // A pin that has just been raised was not high before.
        if self.pin.is_some_and(|since_s| self.last_epoch_s.is_some_and(|last_s| since_s <= last_s)) {
            self.trusted_until(now_s);
        }
        self.last_epoch_s = Some(now_s);
    }

    /// Records that the pin was high until now because of the last epoch; returns for how long, s.
    fn trusted_until(&mut self, now_s: f64) -> Option<f64> {
        let trust_s = now_s - self.last_epoch_s?;
        self.longest_trust_s = self.longest_trust_s.max(trust_s);
        self.stale += u64::from(trust_s > self.limit_s);
        Some(trust_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(lines: &[(f64, &str)]) -> Watch {
        let mut watch = Watch::new(10.0);
        for &(time_s, text) in lines {
            watch.see(&LogLine { time_s, level: "info".into(), text: text.into() });
        }
        watch
    }

    const OK: &str = "judged Some(Protected(Ok)): pin 1000 ticks after the last byte";
    const STALE: &str = "judged Some(Alert(Stale)): no byte came";
    const HIGH: &str = "integrity pin high";
    const LOW: &str = "integrity pin low";

    #[test]
    fn silence_is_timed_from_the_last_epoch() {
        let watch = seen(&[(1.0, HIGH), (1.0, OK), (2.0, OK), (12.001, LOW), (12.002, STALE)]);
        assert_eq!(watch.to_alert_s.len(), 1);
        assert!((watch.to_alert_s[0] - 10.001).abs() < 1e-9, "{:?}", watch.to_alert_s);
        assert_eq!((watch.stale, watch.contradictions, watch.to_pin_ticks.len()), (0, 0, 2));
    }

    #[test]
    fn pin_that_outlasts_the_time_to_alert_is_stale() {
        let late = seen(&[(1.0, HIGH), (1.0, OK), (11.2, LOW), (11.2, STALE)]);
        assert_eq!(late.stale, 1);
        let never = seen(&[(1.0, HIGH), (1.0, OK), (30.0, OK)]);
        assert_eq!(never.stale, 1);
        assert!((never.longest_trust_s - 29.0).abs() < 1e-9);
        let low_between =
            seen(&[(1.0, HIGH), (1.0, OK), (11.0, LOW), (11.0, STALE), (30.0, HIGH), (30.0, OK)]);
        assert_eq!(low_between.stale, 0);
    }

    #[test]
    fn pin_against_the_verdict_is_seen() {
        assert_eq!(seen(&[(1.0, OK)]).contradictions, 1, "protected and low");
        let fault = "judged Some(Alert(Fault)): pin 1000 ticks after the last byte";
        assert_eq!(seen(&[(1.0, HIGH), (1.0, OK), (2.0, fault)]).contradictions, 1, "alert and high");
    }

    #[test]
    fn a_start_takes_everything_back_but_the_time() {
        let watch = seen(&[(1.0, HIGH), (1.0, OK), (0.01, "start: 0.1.0"), (60.0, HIGH), (60.0, OK)]);
        assert_eq!((watch.starts, watch.stale, watch.contradictions), (1, 0, 0));
        assert!((watch.board_s() - 61.0).abs() < 1e-9);
    }
}
