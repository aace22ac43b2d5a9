//! Checks the module's reports against the promises of the product.
//!
//! | finding | report |
//! |---|---|
//! | [`Finding::Misleading`] | the pin is high on a position whose error exceeds a level, with one wrong range at most |
//! | [`Finding::Unreachable`] | the pin is high at a place that no receiver can have reached from the last such place |
//! | [`Finding::Early`] | the pin is high after an alert before the epochs and seconds that `RECOVER` asks for |
//! | [`Finding::Lost`] | nothing is promised although the input has been healthy for long and nothing excuses it |
//!
//! An epoch is identified by its time of day. If several were sent with one time, the place of any
//! of them is accepted.

use raim_core::frame::{Geodetic, LocalFrame};

use crate::attack::prelude::*;

/// Kind of a wrong report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Finding {
    Misleading,
    Unreachable,
    Early,
    Lost,
}

impl Finding {
    /// All findings, with their descriptions.
    pub(super) const ALL: [(Self, &'static str); 4] = [
        (Self::Misleading, "beyond their level"),
        (Self::Unreachable, "out of reach"),
        (Self::Early, "promised before RECOVER"),
        (Self::Lost, "healthy and not promised"),
    ];
}

/// An epoch that was sent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sent {
    /// Time tag in UTC, seconds of the day.
    pub(super) time_of_day_s: f64,
    /// Arrival of the first byte by the module's own clock, s.
    pub(super) own_s: f64,
    /// Place of the antenna.
    pub(super) place: Ecef,
    /// Number of satellites with a wrong range.
    pub(super) wrong: usize,
}

/// The last promise.
#[derive(Clone, Copy, Debug)]
struct Promise {
    place: Ecef,
    own_s: f64,
    hpl_m: f64,
    vpl_m: f64,
    /// Number of consecutive promised epochs, and arrival of the first of them, s.
    epochs: u32,
    since_s: f64,
}

/// Consecutive epochs after an alert that may count as consistent.
#[derive(Clone, Copy, Debug, Default)]
struct Recovering {
    epochs: u32,
    /// Time of the first one, by the own clock and by its tag, s.
    first: Option<(f64, f64)>,
}

/// Observer of one run.
#[derive(Debug, Default)]
pub(super) struct Oracle {
    seed: u64,
    sent: Vec<Sent>,
    recover: (u32, f64),
    /// Largest speed of the receiver, from `VMAX`, m/s.
    pub(super) max_speed_m_s: f64,
    promise: Option<Promise>,
    /// Epochs since the last promise that may count as consistent with each other.
    since_promise: u32,
    lost: Option<Recovering>,
    last_tag_s: f64,
    findings: Vec<(Finding, String)>,
    /// Number of judged epochs.
    pub(super) epochs: usize,
    /// Number of epochs with the pin high.
    pub(super) promised: usize,
    /// Number of alerts.
    pub(super) alerts: usize,
    /// Reason of the last epoch of the scene, and true if that epoch was promised.
    pub(super) last_reason: String,
    pub(super) has_promised_last: bool,
}

/// Epochs and seconds of agreement after which a promised place no longer yields to a
/// contradiction.
const FIRM: (u32, f64) = (10, 10.0);

/// Largest delay of an epoch relative to another by the own clock, s.
const DELAY_S: f64 = 1.0;

impl Oracle {
    /// Returns an oracle for a module with the settings at start.
    pub(super) fn new(seed: u64) -> Self {
        Self { seed, recover: (3, 3.0), max_speed_m_s: 515.0, ..Self::default() }
    }

    /// Returns the findings of one kind.
    pub(super) fn found(&self, kind: Finding) -> impl Iterator<Item = &str> {
        self.findings.iter().filter(move |(finding, _)| *finding == kind).map(|(_, what)| what.as_str())
    }

    /// Starts a scene.
    pub(super) fn begin(&mut self) {
        (self.last_reason, self.has_promised_last) = ("nothing said".into(), false);
    }

    /// Records an epoch that is sent.
    pub(super) fn offer(&mut self, sent: Sent) {
        self.sent.push(sent);
    }

    /// Records a command that the module accepted.
    pub(super) fn command(&mut self, command: &str) {
        let fields: Vec<&str> = command.split(',').collect();
        let number =
            |index: usize| fields.get(index).and_then(|text| text.parse::<f64>().ok()).unwrap_or(0.0);
        match fields[0] {
            "RECOVER" => self.recover = (number(1) as u32, number(2)),
            "VMAX" => self.max_speed_m_s = number(1),
            "FORGET" => {
                self.promise = None;
                self.disagree();
            }
            _ => {}
        }
    }

    /// Checks a report that came at `said_s` by the module's own clock.
    pub(super) fn receive(&mut self, seen: &Seen, said_s: f64) {
        let state = &seen.reported.state;
        if !state.has_epoch() {
            // A silence does not undo earlier agreement.
            return;
        }
        self.last_reason.clone_from(&state.reason);
        self.has_promised_last = state.state == 'P';
        self.epochs += 1;
        let tag_s = state.time_s.unwrap_or(0.0);
        // The line may have kept the second half of the epoch.
        let own_s = self.of_tag(tag_s).last().map_or(said_s, |sent| sent.own_s);
        // No run passes midnight, so an earlier tag is a leap.
        if tag_s < self.last_tag_s {
            self.disagree();
        }
        self.last_tag_s = tag_s;
        self.alerts += usize::from(state.state == 'A');
        match (state.state, state.reason.as_str()) {
            ('P', _) => self.promise(seen, own_s, said_s, tag_s),
            ('A', "JUMP") => {
                self.lost.get_or_insert_default();
                self.agree(own_s, tag_s);
            }
            ('A', _) | (_, "PLACE") => {
                self.lost = Some(Recovering::default());
                self.since_promise = 0;
            }
            (_, "RECOVERING") => self.agree(own_s, tag_s),
            (_, "HPL" | "VPL" | "EMT" | "ACCURACY" | "RISK") => {}
            _ => self.disagree(),
        }
    }

    fn agree(&mut self, own_s: f64, tag_s: f64) {
        self.since_promise += 1;
        if let Some(lost) = &mut self.lost {
            lost.epochs += 1;
            lost.first.get_or_insert((own_s, tag_s));
        }
    }

    /// Restarts the count of consistent epochs.
    fn disagree(&mut self) {
        self.since_promise = 0;
        if let Some(lost) = &mut self.lost {
            *lost = Recovering::default();
        }
    }

    fn promise(&mut self, seen: &Seen, own_s: f64, said_s: f64, tag_s: f64) {
        self.promised += 1;
        self.agree(own_s, tag_s);
        self.hold_to_recover(own_s, tag_s);
        let state = &seen.reported.state;
        let Some(place) = seen.reported.position.map(Geodetic::to_ecef) else {
            return self.find(Finding::Misleading, own_s, "no position");
        };
        let (hpl_m, vpl_m) = (state.hpl_m.unwrap_or(0.0), state.vpl_m.unwrap_or(0.0));
        self.hold_to_levels(place, (hpl_m, vpl_m), own_s, tag_s);
        // The module may have read only the second half of a divided epoch.
        self.hold_to_reach(place, hpl_m + vpl_m, said_s);
        let before = self.promise.filter(|_| self.since_promise <= 1);
        let (epochs, since_s) = before.map_or((0, own_s), |before| (before.epochs, before.since_s));
        self.promise = Some(Promise { place, own_s, hpl_m, vpl_m, epochs: epochs + 1, since_s });
        self.since_promise = 0;
    }

    /// Checks that a promise after an alert comes no earlier than `RECOVER` allows.
    fn hold_to_recover(&mut self, own_s: f64, tag_s: f64) {
        let Some(Recovering { epochs, first }) = self.lost.take() else { return };
        let (first_own_s, first_tag_s) = first.unwrap_or((own_s, tag_s));
        let (want_epochs, want_s) = self.recover;
        let seconds = (own_s - first_own_s + DELAY_S).min(tag_s - first_tag_s);
        // A sentence has hundredths of a second.
        if epochs < want_epochs || seconds < want_s - 0.011 {
            let what = format!("{epochs} epochs, {seconds:.2} s after an alert");
            self.find(Finding::Early, own_s, &what);
        }
    }

    /// Returns the epochs sent with this tag.
    fn of_tag(&self, tag_s: f64) -> impl DoubleEndedIterator<Item = &Sent> {
        const SAME_S: f64 = 0.006;
        self.sent.iter().filter(move |sent| (sent.time_of_day_s - tag_s).abs() < SAME_S)
    }

    fn hold_to_levels(&mut self, place: Ecef, levels_m: (f64, f64), own_s: f64, tag_s: f64) {
        let candidates: Vec<Sent> = self.of_tag(tag_s).copied().collect();
        if candidates.iter().any(|sent| sent.wrong > 1) {
            return;
        }
        let errors_m = |sent: &Sent| {
            let error = LocalFrame::at(sent.place).rotate(place - sent.place);
            (Enu::horizontal(error), error.up.abs())
        };
        let is_within = |sent: &Sent| {
            let (horizontal_m, vertical_m) = errors_m(sent);
            horizontal_m <= levels_m.0 && vertical_m <= levels_m.1
        };
        if !candidates.iter().any(is_within) {
            let errors = candidates.iter().map(errors_m).collect::<Vec<_>>();
            self.find(Finding::Misleading, own_s, &format!("errors {errors:.1?}, levels {levels_m:.1?}"));
        }
    }

    /// Checks that the receiver moved no faster than `VMAX`, unless the last place was not firm and
    /// has been replaced.
    fn hold_to_reach(&mut self, place: Ecef, levels_m: f64, own_s: f64) {
        let Some(last) = self.promise else { return };
        let way_m = self.max_speed_m_s * (own_s - last.own_s + DELAY_S);
        // The limit applies horizontally and vertically, each on its own.
        let reach_m = std::f64::consts::SQRT_2 * way_m + levels_m + last.hpl_m + last.vpl_m;
        let was_firm = last.epochs >= FIRM.0 && last.own_s - last.since_s >= FIRM.1;
        let has_given_way = !was_firm && self.since_promise >= FIRM.0;
        let distance_m = place.distance_m(last.place);
        if distance_m > reach_m && !has_given_way {
            self.find(
                Finding::Unreachable,
                own_s,
                &format!("{distance_m:.0} m away, {reach_m:.0} m within reach"),
            );
        }
    }

    /// Records a finding.
    pub(super) fn find(&mut self, finding: Finding, own_s: f64, what: &str) {
        self.findings.push((finding, format!("seed {} at {own_s:.1} s: {what}", self.seed)));
    }
}
