//! Messages of one instant become one epoch.
//!
//! An epoch is complete when a message says that none follows, or when a message of another instant arrives. It is
//! dropped as a whole when its time is refused ([`super::calendar`]).

use heapless::Vec;
use rai_core::satellite::SatelliteId;

use super::Counters;
use super::calendar::{Calendar, TimeError};
use crate::counters::count;
use crate::signal::Signal;
use crate::time::GpsTime;

/// How many satellites an epoch holds.
pub const EPOCH_CAPACITY: usize = 64;

/// How many signals are kept of one satellite, the first in the order of the wire.
pub const SIGNAL_CAPACITY: usize = 3;

/// What a pseudorange can be, m.
///
/// No satellite is nearer than 19,000 km or farther than 43,000 km; a receiver clock may add or take 30 ms.
const RANGE_M: core::ops::RangeInclusive<f64> = 1.0e7..=5.2e7;

/// The signals of one satellite.
#[derive(Clone, Debug, PartialEq)]
pub struct RawSatellite {
    /// Which satellite.
    pub satellite: SatelliteId,
    /// At most one per band.
    pub signals: Vec<Signal, SIGNAL_CAPACITY>,
}

/// All ranges of one instant, as measured.
#[derive(Clone, Debug, PartialEq)]
pub struct RawEpoch {
    /// The receiver's time tag.
    pub time: GpsTime,
    /// The satellites, in the order of arrival, none twice.
    pub satellites: Vec<RawSatellite, EPOCH_CAPACITY>,
}

impl RawEpoch {
    /// An epoch without satellites.
    pub const fn new(time: GpsTime) -> Self {
        Self { time, satellites: Vec::new() }
    }

    /// Adds a signal of a message that began when the epoch held `earlier` satellites.
    ///
    /// A satellite that an earlier message of the epoch has brought is a duplicate and keeps its first ranges.
    pub(super) fn add(
        &mut self,
        satellite: SatelliteId,
        signal: Signal,
        is_reference: bool,
        earlier: usize,
        counters: &mut Counters,
    ) {
        if !RANGE_M.contains(&signal.range_m) {
            return count(&mut counters.ranges_out_of_bounds);
        }
        let known = self.satellites.iter_mut().enumerate().find(|(_, known)| known.satellite == satellite);
        match known {
            Some((index, _)) if index < earlier => count(&mut counters.satellites_duplicate),
            Some((_, known)) => add_signal(known, signal, is_reference, counters),
            None => self.open(satellite, signal, counters),
        }
    }

    fn open(&mut self, satellite: SatelliteId, signal: Signal, counters: &mut Counters) {
        let mut raw = RawSatellite { satellite, signals: Vec::new() };
        add_signal(&mut raw, signal, false, counters);
        if self.satellites.push(raw).is_err() {
            count(&mut counters.satellites_surplus);
        }
    }
}

/// Keeps one code of each band: the one that the broadcast clock is of, else the first on the wire.
fn add_signal(raw: &mut RawSatellite, signal: Signal, is_reference: bool, counters: &mut Counters) {
    if let Some(known) = raw.signals.iter_mut().find(|known| known.band == signal.band) {
        if is_reference {
            *known = signal;
        }
        count(&mut counters.signals_surplus);
    } else if raw.signals.push(signal).is_err() {
        count(&mut counters.signals_surplus);
    }
}

/// What to do with a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Admission {
    /// It belongs to the open epoch.
    Open,
    /// Its epoch is refused.
    Dropped,
    /// Another epoch is open and has to be handed on before.
    OtherEpochFirst,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Idle,
    Open,
    /// Messages at this time of week are passed over.
    Dropping(u32),
    /// Handed out; forgotten with the next byte.
    Complete,
}

/// The epoch under way.
#[derive(Debug)]
pub(super) struct Assembly {
    epoch: RawEpoch,
    phase: Phase,
}

impl Assembly {
    pub(super) const fn new() -> Self {
        Self { epoch: RawEpoch::new(GpsTime { week: 0, tow_ms: 0 }), phase: Phase::Idle }
    }

    /// Judges a message by its time, and opens an epoch where none is open.
    pub(super) fn admit(
        &mut self,
        tow_ms: u32,
        calendar: &mut Calendar,
        counters: &mut Counters,
    ) -> Admission {
        match self.phase {
            Phase::Open if tow_ms == self.epoch.time.tow_ms => Admission::Open,
            Phase::Open => Admission::OtherEpochFirst,
            Phase::Dropping(dropped_ms) if tow_ms == dropped_ms => Admission::Dropped,
            Phase::Dropping(_) | Phase::Idle | Phase::Complete => self.open(tow_ms, calendar, counters),
        }
    }

    fn open(&mut self, tow_ms: u32, calendar: &mut Calendar, counters: &mut Counters) -> Admission {
        match calendar.advance(tow_ms, counters) {
            Ok(time) => {
                self.epoch.time = time;
                self.epoch.satellites.clear();
                self.phase = Phase::Open;
                return Admission::Open;
            }
            Err(TimeError::WeekUnknown) => count(&mut counters.epochs_without_week),
            Err(TimeError::Backwards) => count(&mut counters.epochs_backwards),
        }
        self.phase = Phase::Dropping(tow_ms);
        Admission::Dropped
    }

    /// Whether an epoch is under way.
    pub(super) fn is_open(&self) -> bool {
        self.phase == Phase::Open
    }

    /// The epoch to which an admitted message adds.
    pub(super) fn epoch_mut(&mut self) -> &mut RawEpoch {
        &mut self.epoch
    }

    /// No message follows; true when that completes an epoch.
    pub(super) fn close(&mut self) -> bool {
        let was_open = self.phase == Phase::Open;
        self.phase = if was_open { Phase::Complete } else { Phase::Idle };
        was_open
    }

    /// Hands the epoch out.
    pub(super) fn complete(&mut self) -> &RawEpoch {
        self.phase = Phase::Complete;
        &self.epoch
    }

    /// Forgets an epoch that has been handed out.
    pub(super) fn retire(&mut self) {
        if self.phase == Phase::Complete {
            self.phase = Phase::Idle;
        }
    }
}
