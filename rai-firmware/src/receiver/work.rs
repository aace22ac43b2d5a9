//! Authentication between epochs, and what follows from it.
//!
//! **Work.** A slice takes at most 60,000 instructions. [`Receiver::tick`] does one in a pass of the
//! loop, and four if its caller passes ten times a second. None is done while bytes of an epoch come.
//! A line that is never silent gets one every [`PATIENCE_MS`], or every [`LONG_MS`] while an epoch is
//! open.
//!
//! | `AUTH` | false | not proved | wrong on two satellites |
//! |---|---|---|---|
//! | `OFF` | – | – | – |
//! | `SAY` | reported | reported | reported |
//! | `PREFER` | left out | used | alert `AUTH` |
//! | `ONLY` | left out | left out, if of Galileo; a promise takes four proved | alert `AUTH` |

use embedded_hal::digital::OutputPin;
use embedded_io::Write;
use raim_core::report::{Alert, Report};
use raim_core::satellite::{Constellation, SatelliteId};

use super::Receiver;
use super::epochs::EpochLoop;
use crate::correction::CAPACITY;
use crate::ephemeris::Demand;
use crate::observer::Observer;
use crate::osnma::{Keys, Proof, Standing, Worked};
use crate::output::nmea::{AuthenticationReport, TimeOfDay, write_authentication};
use crate::settings::{Authentication, Configuration};
use crate::time::GpsTime;

/// Time without bytes to read after which a slice is done, ms. It counts from when they were read, not
/// from their arrival: a module that is behind has more of them waiting.
const SILENT_MS: u64 = 3;

/// Time without a slice after which one is done on a busy line, and while an epoch is open, ms.
const PATIENCE_MS: u64 = 20;
const LONG_MS: u64 = 200;

/// Time between two passes from which on the caller passes ten times a second, ms.
const SELDOM_MS: u64 = 50;

/// Slices of such a pass.
const SLICES: u32 = 4;

/// Number of proved satellites that a promise takes under `ONLY`.
const LEAST_PROVED: usize = 4;

/// Time between two looks at the summary if nothing was done, ms.
const SUMMARY_MS: u64 = 1000;

/// What decides whose turn it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turns {
    /// When bytes were read last, ms.
    pub(super) heard_ms: u64,
    /// When the authentication has worked last, ms.
    worked_ms: u64,
    /// Number of slices, for tests of when they are done.
    #[cfg(feature = "observer")]
    slices: u32,
}

impl Turns {
    pub(super) const NONE: Self = Self {
        heard_ms: 0,
        worked_ms: 0,
        #[cfg(feature = "observer")]
        slices: 0,
    };
}

impl<P: OutputPin, O: Observer> Receiver<P, O> {
    /// Does slices of the authentication if it is their turn.
    #[inline(never)]
    pub(super) fn authenticate(&mut self, now_ms: u64) {
        let Self { input, epochs, turns, .. } = self;
        let keys = epochs.keys;
        if epochs.configuration.authentication == Authentication::Off || keys == Keys::NONE {
            epochs.authentication = None;
            return;
        }
        let rested_ms = now_ms.saturating_sub(turns.worked_ms);
        let is_silent = now_ms.saturating_sub(turns.heard_ms) >= SILENT_MS;
        let is_due = match (input.has_open_epoch(), is_silent) {
            (false, true) => rested_ms > 0,
            (false, false) => rested_ms >= PATIENCE_MS,
            (true, _) => rested_ms >= LONG_MS,
        };
        if !is_due {
            return;
        }
        let slices = if rested_ms >= SELDOM_MS { SLICES } else { 1 };
        let mut has_worked = false;
        for _ in 0..slices {
            if !epochs.navigator.compare_systems() {
                match input.authentication_mut().work(&keys, now_ms) {
                    Worked::Nothing => break,
                    Worked::Something => {}
                    Worked::Judged(number, seal) => epochs.navigator.take_verdict(number, seal),
                }
            }
            has_worked = true;
            #[cfg(feature = "observer")]
            {
                turns.slices += 1;
            }
        }
        if has_worked || rested_ms >= SUMMARY_MS {
            turns.worked_ms = now_ms;
            epochs.authentication = Some(input.authentication().summary(&keys, now_ms));
        }
    }

    /// Returns what the authentication is worth now; `None` without a key.
    pub fn standing(&self) -> Option<Standing> {
        let proof = self.epochs.proof(self.now_ms);
        self.epochs.authentication.as_ref().map(|summary| Standing::of(summary, proof))
    }

    /// Returns the number of slices since start.
    #[cfg(feature = "observer")]
    #[doc(hidden)]
    pub const fn slices(&self) -> u32 {
        self.turns.slices
    }

    /// Takes the keys of changed settings. Another key discards all verdicts.
    pub(super) fn rekey(&mut self) {
        let Configuration { own_key, own_root, authentication, .. } = &self.epochs.configuration;
        let keys =
            Keys { key: own_key.map(|key| (key.number, key.point)), root: own_root.map(|root| root.0) };
        let is_on = *authentication != Authentication::Off && keys != Keys::NONE;
        let own = self.input.authentication_mut();
        let is_other = core::mem::replace(&mut self.epochs.keys, keys) != keys;
        if is_other {
            own.forget_keys();
        }
        own.switch(is_on);
        if is_other || !is_on {
            self.epochs.navigator.forget_verdicts();
            self.epochs.authentication = None;
        }
    }
}

impl<P: OutputPin, O: Observer> EpochLoop<P, O> {
    /// Returns the tags that are proof.
    fn proof(&self, now_ms: u64) -> Proof {
        self.trusted.map_or(Proof::None, |trusted| trusted.proof(now_ms))
    }

    /// Sets what is demanded of ephemerides.
    pub(super) fn demand(&mut self, now_ms: u64) {
        let proof = self.proof(now_ms);
        let demand = match self.configuration.authentication {
            Authentication::Off | Authentication::Say => Demand::Nothing,
            Authentication::Prefer => Demand::NotFalse,
            Authentication::Only => Demand::Proved(proof),
        };
        self.navigator.demand(demand);
        let decides = demand != Demand::Nothing && proof == Proof::All;
        let known = self.authentication.filter(|_| decides);
        self.navigator.believe(known.map_or(0, |summary| summary.witnesses));
    }

    /// Returns the alert that an epoch is not of the present, or that navigation data are forged.
    pub(super) fn forged(&self, time: GpsTime, came_ms: u64) -> Option<Alert> {
        let is_past =
            self.trusted.is_some_and(|trusted| trusted.contradicts(time, came_ms, self.gps_minus_utc_s));
        if is_past {
            return Some(Alert::Replayed);
        }
        let is_alarm = self.authentication.is_some_and(|summary| summary.is_alarm);
        (is_alarm && self.configuration.authentication >= Authentication::Prefer).then_some(Alert::Forged)
    }

    /// Returns what is known of the authentication, and what it is worth; `None` without a key.
    #[allow(clippy::inline_always, reason = "made where it is written")]
    #[inline(always)]
    pub(super) fn authentication_report(&self, now_ms: u64) -> Option<AuthenticationReport> {
        self.authentication.map(|summary| AuthenticationReport {
            summary,
            proof: self.proof(now_ms),
            bound_s: self.trusted.map(|trusted| trusted.bound_s(now_ms)),
            apart_m: self.navigator.systems_apart_m(),
        })
    }

    /// Writes `PRAIO`, and lets the messages for autopilots know.
    pub(super) fn tell_authentication<W: Write>(
        &mut self,
        time: TimeOfDay,
        now_ms: u64,
        host: &mut W,
    ) -> Result<(), W::Error> {
        let report = self.authentication_report(now_ms);
        let is_off = self.configuration.authentication == Authentication::Off;
        self.publisher.authenticated(report.as_ref(), is_off);
        report.map_or(Ok(()), |report| write_authentication(&report, time, host))
    }
}

/// Returns true unless the settings demand proved satellites and too few are used.
pub(super) fn enough_are_proved(configuration: &Configuration, report: &Report<CAPACITY>) -> bool {
    let is_of_galileo = |satellite: &&SatelliteId| satellite.constellation() == Constellation::Galileo;
    configuration.authentication != Authentication::Only
        || report.used.iter().filter(is_of_galileo).count() >= LEAST_PROVED
}
