//! The epochs and silences of a run, in bounded memory.

use raim_core::frame::{Ecef, Enu, Geodetic, LocalFrame};
use raim_core::satellite::SatelliteId;
use raim_firmware::time::GpsTime;

use super::epochs::{Epochs, Sample, severity};
use super::satellites::Satellites;
use crate::page::thinned::Thinned;
use crate::page::{Moment, Verdict};
use crate::satellites::View;
use crate::verdict::{EpochOutput, Excluded};

/// Largest number of events in the list; further ones are counted.
const MOST_EVENTS: usize = 400;

/// Milliseconds of a day.
const DAY_MS: i64 = 86_400_000;

/// One epoch or one silence.
#[derive(Clone, Copy, Debug)]
pub struct Happened<'h> {
    /// Seconds after the first epoch.
    pub time_s: f64,
    /// Output of the module.
    pub output: &'h EpochOutput,
    /// Error of the position, if the truth is known.
    pub error: Option<Enu>,
    /// Level of the pin.
    pub pin_is_high: bool,
    /// The module's view; `None` if only its sentences are known.
    pub view: Option<&'h View>,
}

/// A change of the verdict or of the exclusions.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Event {
    pub(super) time_s: f64,
    pub(super) verdict: Verdict,
    pub(super) reason: String,
    pub(super) excluded: String,
}

/// Number of epochs with a verdict and a reason.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Count {
    pub(super) verdict: Verdict,
    pub(super) reason: String,
    pub(super) epochs: u64,
    pub(super) first_s: f64,
    pub(super) last_s: f64,
}

/// All epochs so far.
#[derive(Clone, Debug, Default)]
pub struct Journal {
    pub(super) epochs: Epochs,
    pub(super) satellites: Satellites,
    pub(super) thinned: Thinned,
    pub(super) events: Vec<Event>,
    pub(super) more_events: u64,
    pub(super) counts: Vec<Count>,
    pub(super) last_s: f64,
    /// GPS time at second 0.
    pub(super) start: Option<GpsTime>,
    /// GPS time minus UTC, s.
    pub(super) leap_s: Option<i64>,
    /// Verdict, reason and exclusions of the last epoch.
    before: Option<(Verdict, String, Vec<SatelliteId>)>,
    frame: Option<(Ecef, LocalFrame)>,
    /// The first position that may be used.
    pub(super) place: Option<Geodetic>,
    /// The first and the last position, for the track.
    pub(super) track: Vec<(f64, Enu)>,
    /// Every how many positions one is part of the track.
    sparse: u64,
    positions: u64,
}

impl Journal {
    /// Takes the next epoch or silence.
    pub fn push(&mut self, happened: &Happened<'_>) {
        let Happened { time_s, output, error, pin_is_high, view } = *happened;
        let moment = Moment::of(time_s, output, error, pin_is_high);
        self.last_s = time_s;
        self.date(time_s, output, view);
        self.note_event(&moment, output);
        let reason = self.count(&moment);
        let offset = output.position.map(|position| self.offset(position, moment.verdict));
        if let Some(offset) = offset {
            self.walk(time_s, offset);
        }
        let state = &output.state;
        self.epochs.push(&Sample {
            time_s,
            curves: [
                state.hpl_m,
                state.vpl_m,
                state.hal_m,
                state.val_m,
                moment.horizontal_error_m,
                moment.vertical_error_m.map(f64::abs),
                state.statistic,
                state.threshold,
            ],
            values: [
                view.and_then(|view| view.clock_m),
                offset.map(|offset| offset.east),
                offset.map(|offset| offset.north),
                offset.map(|offset| offset.up),
            ],
            reason,
            severity: severity(moment.verdict),
            pin: u8::from(pin_is_high),
            used: u8::try_from(state.used).unwrap_or(u8::MAX),
            excluded: u8::try_from(output.excluded.len()).unwrap_or(u8::MAX),
        });
        if let Some(view) = view {
            self.satellites.push(time_s, &view.satellites);
        }
        self.thinned.push(moment);
    }

    /// Returns the number of epochs and silences.
    pub fn len(&self) -> u64 {
        self.epochs.all()
    }

    /// Returns true before the first epoch.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Derives GPS time and UTC of second 0 from the first epoch that has them.
    fn date(&mut self, time_s: f64, output: &EpochOutput, view: Option<&View>) {
        let Some(time) = view.and_then(|view| view.time) else { return };
        if self.start.is_none() {
            let start_ms = time.to_ms().saturating_sub((time_s * 1e3).round() as u64);
            self.start = Some(GpsTime::from_ms(start_ms));
        }
        if let (None, Some(utc_s)) = (self.leap_s, output.state.time_s) {
            let behind_ms = i64::from(time.tow_ms) - (utc_s * 1e3).round() as i64;
            // A half turn: GPS time may be rounded to just below UTC plus its leap seconds.
            let behind_ms = (behind_ms + DAY_MS / 2).rem_euclid(DAY_MS) - DAY_MS / 2;
            self.leap_s = Some((behind_ms as f64 * 1e-3).round() as i64);
        }
    }

    fn note_event(&mut self, moment: &Moment, output: &EpochOutput) {
        let named = |one: &Excluded| format!("{} ({:+.1} m)", one.satellite, one.bias_m);
        let satellites: Vec<SatelliteId> = output.excluded.iter().map(|one| one.satellite).collect();
        let now = (moment.verdict, moment.reason.clone(), satellites);
        if self.before.as_ref() == Some(&now) {
            return;
        }
        self.before = Some(now);
        if self.events.len() >= MOST_EVENTS {
            self.more_events += 1;
            return;
        }
        self.events.push(Event {
            time_s: moment.time_s,
            verdict: moment.verdict,
            reason: moment.reason.clone(),
            excluded: output.excluded.iter().map(named).collect::<Vec<_>>().join(", "),
        });
    }

    /// Counts the reason; returns its number.
    fn count(&mut self, moment: &Moment) -> u8 {
        let is_same = |count: &&mut Count| count.verdict == moment.verdict && count.reason == moment.reason;
        if let Some(count) = self.counts.iter_mut().find(is_same) {
            count.epochs += 1;
            count.last_s = moment.time_s;
        } else {
            self.counts.push(Count {
                verdict: moment.verdict,
                reason: moment.reason.clone(),
                epochs: 1,
                first_s: moment.time_s,
                last_s: moment.time_s,
            });
        }
        let number = self
            .counts
            .iter()
            .position(|count| count.verdict == moment.verdict && count.reason == moment.reason);
        number.and_then(|number| u8::try_from(number).ok()).unwrap_or(u8::MAX)
    }

    /// Returns a position relative to the first.
    fn offset(&mut self, position: Geodetic, verdict: Verdict) -> Enu {
        if self.place.is_none() && verdict == Verdict::Protected {
            self.place = Some(position);
        }
        let position = position.to_ecef();
        let (origin, frame) = self.frame.get_or_insert_with(|| (position, LocalFrame::at(position)));
        frame.rotate(position - *origin)
    }

    /// Takes a point of the static track, of which every second one goes if there are many.
    fn walk(&mut self, time_s: f64, offset: Enu) {
        const MOST: usize = 1024;
        if self.positions.is_multiple_of(1 << self.sparse) {
            self.track.push((time_s, offset));
        }
        self.positions += 1;
        if self.track.len() >= MOST {
            let mut index = 0;
            self.track.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.sparse += 1;
        }
    }
}
