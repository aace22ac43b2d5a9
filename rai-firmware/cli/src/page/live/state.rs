//! The state of the module as the page shows it, and what it was before.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::page::Verdict;
use crate::page::report::explanation;
use crate::satellites::Account;
use crate::verdict::EpochOutput;

/// Verdicts of the past that a new page gets.
const PAST: usize = 600;
/// Changes of the state that a new page gets.
const CHANGES: usize = 100;
/// Time after which the epoch loop counts as hung.
const HUNG: Duration = Duration::from_secs(3);

/// The state of a module, with its past.
#[derive(Debug)]
pub struct State {
    /// Where the bytes come from.
    pub input: String,
    /// Settings, as `KEY=VALUE`.
    pub settings: Vec<String>,
    /// The last output.
    pub reported: Option<EpochOutput>,
    /// Level of the pin.
    pub pin_is_high: bool,
    /// Satellites of the last epoch; none during a silence.
    pub satellites: Vec<Account>,
    /// Counters of the module.
    pub counters: Vec<(&'static str, u32)>,
    /// Number of verdicts so far.
    pub verdicts: u64,
    /// True while the receiver sends messages and no ranges any more.
    pub lacks_ranges: bool,
    /// True once the service has ended.
    pub has_ended: bool,
    judged: Option<Instant>,
    alive: Instant,
    past: VecDeque<Value>,
    changes: VecDeque<Value>,
}

impl State {
    /// Returns the state before the first epoch.
    pub fn new(input: String, settings: Vec<String>) -> Self {
        Self {
            input,
            settings,
            reported: None,
            pin_is_high: false,
            satellites: Vec::new(),
            counters: Vec::new(),
            verdicts: 0,
            lacks_ranges: false,
            has_ended: false,
            judged: None,
            alive: Instant::now(),
            past: VecDeque::new(),
            changes: VecDeque::new(),
        }
    }

    /// Notes that the epoch loop comes round.
    pub fn live(&mut self, pin_is_high: bool) {
        self.alive = Instant::now();
        self.pin_is_high = pin_is_high;
    }

    /// Takes a verdict; returns true if it is another than that before.
    pub fn take(&mut self, reported: EpochOutput, satellites: Option<Vec<Account>>) -> bool {
        let (word, reason) = (self.word(), self.reason().to_owned());
        let is_first = self.reported.is_none();
        self.verdicts += 1;
        self.judged = Some(Instant::now());
        // After a silence the satellites are those of before.
        self.satellites = satellites.unwrap_or_default();
        let state = &reported.state;
        self.past.push_back(json!([
            self.verdicts,
            state.time_s,
            state.state.to_string(),
            state.hpl_m,
            state.vpl_m,
            state.statistic,
            state.threshold
        ]));
        self.reported = Some(reported);
        let has_changed = is_first || word != self.word() || reason != self.reason();
        if has_changed {
            let time_s = self.reported.as_ref().and_then(|reported| reported.state.time_s);
            self.changes.push_back(json!([time_s, self.word(), self.reason()]));
        }
        self.past.drain(..self.past.len().saturating_sub(PAST));
        self.changes.drain(..self.changes.len().saturating_sub(CHANGES));
        has_changed
    }

    /// Returns the state in a word. Before the first verdict, and if the loop hangs, the position is
    /// unavailable.
    pub fn word(&self) -> &'static str {
        match &self.reported {
            Some(reported) if self.alive.elapsed() < HUNG => {
                Verdict::from_letter(reported.state.state).word()
            }
            _ => "unavailable",
        }
    }

    /// Returns the reason, in the module's word.
    pub fn reason(&self) -> &str {
        self.reported.as_ref().map_or("", |reported| &reported.state.reason)
    }

    /// Returns the reason in words.
    pub fn explanation(&self) -> &'static str {
        match &self.reported {
            _ if self.alive.elapsed() >= HUNG => "the module does not come round",
            Some(reported) if self.lacks_ranges && reported.state.reason == "STALE" => {
                "the receiver sends no ranges any more, and other messages still"
            }
            Some(reported) => explanation(&reported.state.reason).unwrap_or_default(),
            None => "no epoch has been judged yet",
        }
    }

    /// Returns the time since the last verdict.
    pub fn age(&self) -> Option<Duration> {
        self.judged.map(|judged| judged.elapsed())
    }

    /// Returns true while the loop runs and the receiver is heard.
    pub fn is_healthy(&self) -> bool {
        self.alive.elapsed() < HUNG
            && self.reported.as_ref().is_some_and(|reported| {
                !matches!(reported.state.reason.as_str(), "STALE" | "SOURCE" | "SELFTEST")
            })
    }

    /// Returns the past for a new page: verdicts, and changes of the state.
    pub fn past(&self) -> Value {
        json!({"past": self.past, "changes": self.changes})
    }
}
