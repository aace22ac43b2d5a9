//! What the module says, held to what is promised of it.
//!
//! | finding | what was said |
//! |---|---|
//! | [`Finding::Misleading`] | the pin is high on a position farther than a level from where the antenna was, with one range wrong at most |
//! | [`Finding::Unreachable`] | the pin is high where no receiver can have come to from the last such place |
//! | [`Finding::Early`] | the pin is high after an alert before as many epochs and seconds as `RECOVER` asks for |
//! | [`Finding::Lost`] | nothing is promised of what has been healthy for long, and nothing excuses that |
//!
//! An epoch is known again by its time of day; where several were sent with one, any of their places will do.

use rai_core::frame::{Ecef, Enu, Geodetic, LocalFrame};

use super::super::victim::Seen;

/// What should not have been said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Finding {
    Misleading,
    Unreachable,
    Early,
    Lost,
}

impl Finding {
    /// All of them, and what they are.
    pub(super) const ALL: [(Self, &'static str); 4] = [
        (Self::Misleading, "beyond their level"),
        (Self::Unreachable, "out of reach"),
        (Self::Early, "promised before RECOVER"),
        (Self::Lost, "healthy and not promised"),
    ];
}

/// An epoch as it was sent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sent {
    /// Its tag in UTC, seconds of the day.
    pub(super) time_of_day_s: f64,
    /// When its first byte came, by the module's own clock, s.
    pub(super) own_s: f64,
    /// Where the antenna was.
    pub(super) place: Ecef,
    /// Satellites with a wrong range.
    pub(super) wrong: usize,
}

/// The last promise.
#[derive(Clone, Copy, Debug)]
struct Promise {
    place: Ecef,
    own_s: f64,
    hpl_m: f64,
    vpl_m: f64,
    /// Epochs that were promised on end, and when the first of them came.
    epochs: u32,
    since_s: f64,
}

/// Epochs in a row that may count as agreeing since an alert.
#[derive(Clone, Copy, Debug, Default)]
struct Recovering {
    epochs: u32,
    /// When the first came, by the own clock and by its tag.
    first: Option<(f64, f64)>,
}

/// Watches one run.
#[derive(Debug)]
pub(super) struct Oracle {
    seed: u64,
    sent: Vec<Sent>,
    recover: (u32, f64),
    max_speed_m_s: f64,
    promise: Option<Promise>,
    /// Epochs since the last promise that may count as agreeing with each other.
    since_promise: u32,
    lost: Option<Recovering>,
    last_tag_s: f64,
    findings: Vec<(Finding, String)>,
    /// Epochs judged.
    pub(super) epochs: usize,
    /// With the pin high.
    pub(super) promised: usize,
    /// Alerts.
    pub(super) alerts: usize,
    /// What was said of the last epoch of the scene, and whether it was promised.
    pub(super) last_reason: String,
    pub(super) has_promised_last: bool,
}

/// Agreement after which neither what led to a promise nor what contradicts it gives way.
const FIRM: (u32, f64) = (10, 10.0);

/// How much later than another an epoch may have come to the own clock, s.
const DELAY_S: f64 = 1.0;

impl Oracle {
    /// One that has heard nothing; what is in force is what is at start.
    pub(super) fn new(seed: u64) -> Self {
        Self {
            seed,
            sent: Vec::new(),
            recover: (3, 3.0),
            max_speed_m_s: 515.0,
            promise: None,
            since_promise: 0,
            lost: None,
            last_tag_s: 0.0,
            findings: Vec::new(),
            epochs: 0,
            promised: 0,
            alerts: 0,
            last_reason: String::new(),
            has_promised_last: false,
        }
    }

    /// Everything of a kind that was found.
    pub(super) fn found(&self, kind: Finding) -> impl Iterator<Item = &str> {
        self.findings.iter().filter(move |(finding, _)| *finding == kind).map(|(_, what)| what.as_str())
    }

    /// A scene begins.
    pub(super) fn begin(&mut self) {
        (self.last_reason, self.has_promised_last) = ("nothing said".into(), false);
    }

    /// An epoch is sent.
    pub(super) fn offer(&mut self, sent: Sent) {
        self.sent.push(sent);
    }

    /// The host has given a command that was obeyed.
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

    /// What was said, at `said_s` by the module's own clock.
    pub(super) fn hear(&mut self, seen: &Seen, said_s: f64) {
        let state = &seen.said.state;
        if state.reason == "STALE" {
            // Silence takes nothing from what has agreed before.
            return;
        }
        self.last_reason.clone_from(&state.reason);
        self.has_promised_last = state.state == 'P';
        self.epochs += 1;
        let tag_s = state.time_s.unwrap_or(0.0);
        // The line may have kept the second half of the epoch.
        let own_s = self.of_tag(tag_s).last().map_or(said_s, |sent| sent.own_s);
        // A day's end comes in no run.
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

    /// What agreed so far counts for nothing.
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
        let state = &seen.said.state;
        let Some(place) = seen.said.position.map(Geodetic::to_ecef) else {
            return self.find(Finding::Misleading, own_s, "no position");
        };
        let (hpl_m, vpl_m) = (state.hpl_m.unwrap_or(0.0), state.vpl_m.unwrap_or(0.0));
        self.hold_to_levels(place, (hpl_m, vpl_m), own_s, tag_s);
        // Of an epoch in two halves only the second may have been read.
        self.hold_to_reach(place, hpl_m + vpl_m, said_s);
        let before = self.promise.filter(|_| self.since_promise <= 1);
        let (epochs, since_s) = before.map_or((0, own_s), |before| (before.epochs, before.since_s));
        self.promise = Some(Promise { place, own_s, hpl_m, vpl_m, epochs: epochs + 1, since_s });
        self.since_promise = 0;
    }

    /// After an alert a promise has to be earned.
    fn hold_to_recover(&mut self, own_s: f64, tag_s: f64) {
        let Some(Recovering { epochs, first }) = self.lost.take() else { return };
        let (first_own_s, first_tag_s) = first.unwrap_or((own_s, tag_s));
        let (want_epochs, want_s) = self.recover;
        let seconds = (own_s - first_own_s + DELAY_S).min(tag_s - first_tag_s);
        // To the hundredth that a sentence says.
        if epochs < want_epochs || seconds < want_s - 0.011 {
            let what = format!("{epochs} epochs, {seconds:.2} s after an alert");
            self.find(Finding::Early, own_s, &what);
        }
    }

    /// The epochs that were sent with a tag.
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

    /// Nobody comes from one place to another faster than `VMAX`, unless what led to the first was not firm and gave way.
    fn hold_to_reach(&mut self, place: Ecef, levels_m: f64, own_s: f64) {
        let Some(last) = self.promise else { return };
        let way_m = self.max_speed_m_s * (own_s - last.own_s + DELAY_S);
        // Over the ground and upwards each has a way of its own.
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

    /// Notes something that should not have been said.
    pub(super) fn find(&mut self, finding: Finding, own_s: f64, what: &str) {
        self.findings.push((finding, format!("seed {} at {own_s:.1} s: {what}", self.seed)));
    }
}
