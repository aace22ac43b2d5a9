//! Counts of the module's reports, compared with the epochs that it was sent.
//!
//! An epoch is identified by its time of day. The truth of the last [`MEMORY_EPOCHS`] epochs is
//! kept.

use std::collections::{BTreeMap, VecDeque};

use raim::page::Moment;
use raim::sentence::{self, Sentence};
use raim::signal::calendar::readable;
use raim::verdict::{EpochOutput, State};
use raim_core::frame::{Enu, Geodetic, LocalFrame};
use raim_core::satellite::SatelliteId;
use raim_firmware::output::nmea::{GPS_MINUS_UTC_S, TimeOfDay};

use super::scenario::Offer;

/// Number of epochs whose truth is kept: more than are ever read late.
const MEMORY_EPOCHS: usize = 120;

/// Number of epochs after which no report on an epoch is expected any more.
const PATIENCE_EPOCHS: usize = 30;

/// Kind of an output of the host port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// The module has started and wants its settings.
    Greeting,
    /// Anything else.
    Speech,
}

/// Number of epochs within which every ephemeris in use is repeated. After a restart an early
/// ephemeris may be the only known one for as long, and its satellite is rightly left out.
pub(super) const RENEWAL_EPOCHS: u32 = 30;

/// Largest variation of an epoch's delay on the way to the board, s.
const SLACK_S: f64 = 1.0;

/// Number of epochs whose bytes may still be on their way; a reset loses them.
const IN_FLIGHT_EPOCHS: usize = 6;

/// An epoch that was sent, and whether the module has reported on it.
#[derive(Clone, Copy, Debug)]
struct Open {
    offer: Offer,
    offered_s: f64,
    is_judged: bool,
}

/// Counts of a soak.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    time_to_alert_s: f64,
    open: VecDeque<Open>,
    position: Option<Geodetic>,
    resets_awaited: u64,
    is_catching_up: bool,
    /// Horizontal alert limit that the host set last, m.
    limit_m: Option<f64>,
    /// Horizontal alert limit at the last reset, m.
    limit_at_reset_m: Option<f64>,
    has_just_started: bool,
    /// Smallest difference since the start between board time and time tags, s.
    least_lag_s: Option<f64>,
    /// True if the last judged epoch was sent without a false range.
    is_sound: bool,
    /// Number of the last epoch with an early ephemeris, by satellite.
    early_at: BTreeMap<SatelliteId, u64>,
    /// Number of early ephemerides.
    pub early: u64,
    /// Satellites left out of epochs without a false range and without a recent early ephemeris of
    /// that satellite, as text.
    pub left_out_sound: Vec<String>,
    /// Number of epochs sent.
    pub offered: u64,
    /// Number of epochs sent whole, in time, and with a later tag than all before.
    pub due: u64,
    /// Number of judged epochs, by reported state and reason.
    pub verdicts: BTreeMap<(char, String), u64>,
    /// Number of judged epochs with a false range.
    pub falsified: u64,
    /// Number of judged epochs beyond the promise: more than one false satellite, or a false
    /// constellation.
    pub beyond_promise: u64,
    /// Number of epochs beyond the promise with the pin high and an error above the alert limit.
    pub hazardous_beyond_promise: u64,
    /// Number of epochs within the promise, and beyond it, whose position from all satellites
    /// exceeded the alert limit.
    pub accepted: [u64; 2],
    /// Number of epochs within the promise with the pin high and an error above the alert limit.
    pub hazardous: u64,
    /// Number of epochs within the promise, and beyond it, with the pin high and an error above the
    /// protection level.
    pub misleading: [u64; 2],
    /// Number of alerts in epochs without a false range.
    pub false_alerts: u64,
    /// Number of reports that the line is silent.
    pub silences: u64,
    /// Number of epochs with the pin high that were older than the time to alert when judged.
    pub stale: u64,
    /// Due epochs without a report, as text.
    pub unspoken: Vec<String>,
    /// Number of reports on epochs that were never sent.
    pub invented: u64,
    /// Number of sentences read.
    pub sentences: u64,
    /// Number of sentences cut off by an intended reset.
    pub cut_off: u64,
    /// Lines that are not valid sentences.
    pub damaged: Vec<String>,
    /// Commands that the module refused.
    pub refused: Vec<String>,
    /// Number of intended starts: the first, and the resets.
    pub starts_asked: u64,
    /// Greetings after an unintended start, or with a fault.
    pub starts_unasked: Vec<String>,
    /// Epochs after a restart that were judged with other settings than before it, as text.
    pub settings_lost: Vec<String>,
    /// Epochs with the pin high that should not have been, as text.
    pub wrongly_promised: Vec<String>,
    /// Every judged epoch, for pictures. The time is that of sending, s.
    pub moments: Vec<Moment>,
}

impl Tally {
    /// Returns empty counts for a module that is about to start.
    pub fn new(time_to_alert_s: f64) -> Self {
        let mut tally = Self { time_to_alert_s, ..Self::default() };
        tally.expect_start();
        tally
    }

    /// Records an intended start or reset.
    pub fn expect_start(&mut self) {
        self.starts_asked += 1;
        self.resets_awaited += 1;
        self.limit_at_reset_m = self.limit_m;
        self.least_lag_s = None;
        for open in self.open.iter_mut().rev().take(IN_FLIGHT_EPOCHS) {
            open.offer.is_due = false;
        }
    }

    /// Records a horizontal alert limit that the host sets.
    pub fn expect_limit(&mut self, limit_m: f64) {
        self.limit_m = Some(limit_m);
    }

    /// Records that the host has told the module to disregard the delay of epochs.
    pub fn expect_lateness(&mut self) {
        self.least_lag_s = None;
    }

    /// Records that the host port is not read for a while, so that the next sentences may be old.
    pub fn stop_listening(&mut self) {
        self.is_catching_up = true;
    }

    /// Records that all earlier output has been read.
    pub fn caught_up(&mut self) {
        self.is_catching_up = false;
    }

    /// Records an epoch sent at `board_s` of board time. `is_whole` means that nothing disturbs it
    /// on the way.
    pub fn offer(&mut self, offer: Offer, is_whole: bool, board_s: f64) {
        let is_new = self.lateness_s(&offer, board_s) < self.time_to_alert_s - SLACK_S;
        let offer = Offer { is_due: offer.is_due && is_whole && is_new, ..offer };
        self.offered += 1;
        self.due += u64::from(offer.is_due);
        if let Some(satellite) = offer.early {
            self.early += 1;
            self.early_at.insert(satellite, self.offered);
        }
        self.open.push_back(Open { offer, offered_s: board_s, is_judged: false });
        let old = self.open.len().checked_sub(PATIENCE_EPOCHS).and_then(|at| self.open.get(at));
        if let Some(old) = old.filter(|old| old.offer.is_due && !old.is_judged) {
            self.unspoken.push(format!("{} never judged", readable(old.offer.time)));
        }
        if self.open.len() > MEMORY_EPOCHS {
            self.open.pop_front();
        }
    }

    /// Returns the delay of an epoch relative to others of this start, s.
    fn lateness_s(&mut self, offer: &Offer, board_s: f64) -> f64 {
        let lag_s = board_s - offer.time.to_s();
        let least_s = self.least_lag_s.map_or(lag_s, |least_s| least_s.min(lag_s));
        self.least_lag_s = Some(least_s);
        lag_s - least_s
    }

    /// Reads one line of the host port.
    pub fn receive(&mut self, line: &[u8]) -> Heard {
        let line = String::from_utf8_lossy(line);
        let line = self.behind_a_reset(&line);
        self.sentences += 1;
        match sentence::parse(line) {
            Ok(Sentence::Position(position)) => self.position = position,
            Ok(Sentence::State(state)) => self.judged(state),
            Ok(Sentence::Excluded(excluded)) => {
                self.left_out(excluded.satellite);
                if let Some(moment) = self.moments.last_mut() {
                    moment.excluded.push(excluded.satellite);
                }
            }
            Ok(Sentence::Other) if line.starts_with("$PRAIV") => {
                self.greeted(line);
                return Heard::Greeting;
            }
            Ok(Sentence::Other) if line.contains(",ERR,") => self.refused.push(line.trim_end().to_owned()),
            Ok(Sentence::Authentication(_) | Sentence::Other) => {}
            Err(error) => self.damaged.push(format!("{error:#}")),
        }
        Heard::Speech
    }

    /// Removes a sentence that a reset has cut off; the greeting follows on the same line.
    fn behind_a_reset<'a>(&mut self, line: &'a str) -> &'a str {
        match line.rfind("$PRAIV") {
            Some(at @ 1..) if self.resets_awaited > 0 => {
                self.cut_off += 1;
                &line[at..]
            }
            _ => line,
        }
    }

    fn greeted(&mut self, line: &str) {
        let fields: Vec<&str> = line.split([',', '*']).collect();
        let [_, _, _, cause, selftest, ..] = fields[..] else { return };
        let is_fault = ["PANIC", "FAULT", "CLOCK", "WATCHDOG"].iter().any(|word| cause.starts_with(word));
        if self.resets_awaited == 0 || is_fault || selftest != "PASS" {
            self.starts_unasked.push(line.trim_end().to_owned());
        }
        self.resets_awaited = self.resets_awaited.saturating_sub(1);
        self.has_just_started = true;
    }

    /// Checks that the settings before a restart are in force after it.
    fn look_at_settings(&mut self, state: &State) {
        let is_first = std::mem::take(&mut self.has_just_started);
        // Before the first start there were no settings, and a new setting may cross the module's
        // first report.
        let is_other = is_first
            && self.limit_at_reset_m.is_some()
            && ![self.limit_at_reset_m, self.limit_m].contains(&state.hal_m);
        if is_other || state.reason == "SETTINGS" && state.has_epoch() {
            let (have, want) = (state.hal_m, self.limit_m);
            self.settings_lost.push(format!("{}: HAL {have:?}, set was {want:?}", state.reason));
        }
    }

    /// Records a satellite left out of the last judged epoch.
    fn left_out(&mut self, satellite: SatelliteId) {
        let is_misled =
            self.early_at.get(&satellite).is_some_and(|at| self.offered - at <= u64::from(RENEWAL_EPOCHS));
        if self.is_sound && !is_misled {
            let time = self.moments.last().map_or(0.0, |moment| moment.time_s);
            self.left_out_sound.push(format!("{satellite} left out at {time:.0} s, no range false"));
        }
    }

    fn judged(&mut self, state: State) {
        let position = self.position.take();
        self.is_sound = false;
        self.look_at_settings(&state);
        if matches!(state.reason.as_str(), "STALE" | "SOURCE") {
            self.silences += 1;
            return;
        }
        if !state.has_epoch() {
            return;
        }
        *self.verdicts.entry((state.state, state.reason.clone())).or_default() += 1;
        let now_s = self.open.back().map_or(0.0, |open| open.offered_s);
        // If time has gone back while the host port was unread, two epochs have this time; the
        // expected one is taken.
        let is_not_awaited = |open: &&mut Open| !open.offer.is_due || open.is_judged;
        let of_the_time = self.open.iter_mut().rev().filter(|open| is_of(&state, &open.offer));
        let found = of_the_time.min_by_key(is_not_awaited);
        let Some(open) = found else {
            self.invented += 1;
            return;
        };
        open.is_judged = true;
        self.is_sound = !open.offer.falsified.is_any();
        let (offer, age_s) = (open.offer, now_s - open.offered_s);
        let error = position.map(|position| error(position, &offer));
        let reported = EpochOutput { position, state, excluded: Vec::new(), authentication: None };
        self.count(&reported, error, &offer, age_s);
        self.moments.push(Moment::of(offer.time.to_s(), &reported, error, reported.state.is_protected()));
    }

    fn count(&mut self, reported: &EpochOutput, error: Option<Enu>, offer: &Offer, age_s: f64) {
        let state = &reported.state;
        let is_promised = offer.falsified.is_within_promise();
        self.falsified += u64::from(offer.falsified.is_any());
        self.beyond_promise += u64::from(!is_promised);
        self.false_alerts += u64::from(state.state == 'A' && !offer.falsified.is_any());
        let accepted =
            offer.accepted_error_m.zip(state.hal_m).is_some_and(|(error_m, hal_m)| error_m > hal_m);
        self.accepted[usize::from(!is_promised)] += u64::from(accepted);
        if !state.is_protected() {
            return;
        }
        let is_stale = age_s > self.time_to_alert_s && !self.is_catching_up;
        self.stale += u64::from(is_stale);
        // A protected epoch without a position has no error that a bound could hold.
        let error_m = error.map_or([f64::INFINITY; 2], |error| [error.horizontal(), error.up.abs()]);
        let is_hazardous = error.is_none() || state.is_hazardous(error_m);
        self.hazardous += u64::from(is_hazardous && is_promised);
        if is_stale || is_hazardous && is_promised {
            let time = readable(offer.time);
            self.wrongly_promised
                .push(format!("{time}, {age_s:.1} s old, error {error:?}, {offer:?}, {state:?}"));
        }
        self.hazardous_beyond_promise += u64::from(is_hazardous && !is_promised);
        self.misleading[usize::from(!is_promised)] += u64::from(state.is_misleading(error_m));
    }

    /// Returns the number of epochs judged to be in that state.
    pub fn in_state(&self, state: char) -> u64 {
        self.verdicts.iter().filter(|((of, _), _)| *of == state).map(|(_, count)| count).sum()
    }
}

fn error(position: Geodetic, offer: &Offer) -> Enu {
    LocalFrame::at(offer.truth).rotate(position.to_ecef() - offer.truth)
}

/// Returns true if a report belongs to an epoch, by the time of day.
fn is_of(state: &State, offer: &Offer) -> bool {
    let [hours, minutes, seconds, hundredths] = TimeOfDay::new(offer.time, GPS_MINUS_UTC_S).parts();
    let time_s = f64::from(hours * 3600 + minutes * 60 + seconds) + f64::from(hundredths) * 1e-2;
    state.time_s.is_some_and(|said_s| (said_s - time_s).abs() < 1e-3)
}

#[cfg(test)]
mod tests;
