//! The tie: where systems contradict each other, Galileo decides if its ephemerides are proved.
//!
//! ```text
//! |p_O − p₀| > L_O + 2 v Δt + a Δt²/2     the others have leapt from the last place
//! |p_E − p₀| < |p_O − p₀|                 and Galileo is nearer to it
//! ```
//!
//! | symbol | what | unit |
//! |---|---|---|
//! | `p_E` | place by the proved satellites of Galileo alone | m |
//! | `p_O`, `L_O` | place by all satellites of the other systems, and the sum of its levels | m |
//! | `p₀`, `Δt` | last place that nothing contradicted, and the time since | m, s |
//! | `v` | speed there; `VMAX` if it is unknown | m/s |
//! | `a` | [`ACCELERATION_M_S2`] | m/s² |
//!
//! It is asked if an epoch is an alert `FAULT` or `AMBIGUOUS`, or if a majority leaves out half of the proved
//! satellites: whoever forges two systems alike has the majority, but not the signature. Galileo wins if
//!
//! - the settings demand proof (`PREFER`, `ONLY`), and the time is known so well that all tags are
//!   proof; under tags with a later key alone it never wins
//! - at least [`LEAST`] of its satellites are proved, within 4 h, by a tag with the next key
//! - these pass the test for `P_fa` without an exclusion, with levels within the limits
//! - the others have leapt, and not Galileo
//!
//! The levels are then those of its proved satellites; nothing else is used. Proved data say nothing about
//! ranges, so that the last condition is what keeps true data with forged ranges from winning. Without an
//! earlier place, or without levels of the others, nothing shows which has moved. Then an alert stays, and a
//! majority against at least [`LEAST`] proved satellites becomes `AMBIGUOUS`.
//!
//! **Limits.** Others that are led away slowly stay an alert until they are beyond the first bound. Whoever
//! sends the true data of Galileo with forged ranges, and other counterfeit systems that leap, decides with
//! them; each alone does not.

use core::cell::Cell;

use raim_core::frame::Ecef;
use raim_core::internals::numeric::sqrt;
use raim_core::monitor::Search;
use raim_core::report::{Alert, Protected, ProtectionLevels, Report, Verdict};
use raim_core::satellite::{Constellation, SatelliteId};
use raim_single::{Monitor, MonitorMemory, Workspace};

use super::{Navigator, Room, found};
use crate::correction::horizon::coordinates_m;
use crate::correction::{CAPACITY, Ranges, Sky, remove};
use crate::settings::Configuration;
use crate::time::GpsTime;

type Epoch = raim_core::epoch::Epoch<CAPACITY>;

/// Least number of proved satellites that may decide.
const LEAST: usize = 4;

/// Largest acceleration of a receiver, m/s².
const ACCELERATION_M_S2: f32 = 10.0;

/// What is known of the last place that nothing contradicted, beside the place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    pub(super) time: GpsTime,
    /// Speed, m/s, if it was known.
    pub(super) speed_m_s: Option<f32>,
}

impl Held {
    pub(super) const NONE: Self = Self { time: GpsTime::from_ms(0), speed_m_s: None };

    /// Returns the way that a receiver may have gone since, twice what its speed explains, m.
    fn way_m(&self, time: GpsTime, highest_m_s: f64) -> f32 {
        let elapsed_s = (time.since_ms(self.time) as f32 * 1e-3).abs();
        let speed_m_s = self.speed_m_s.unwrap_or(highest_m_s as f32);
        (2.0 * speed_m_s + 0.5 * ACCELERATION_M_S2 * elapsed_s) * elapsed_s
    }
}

/// Returns the alert that stays if Galileo does not decide, for an epoch that is an alert, or promised by
/// a majority that leaves out half of the proved satellites or more; `None` if nothing contradicts these.
fn contradiction(report: &Report<CAPACITY>, witnesses: u64, count: usize) -> Option<Alert> {
    match report.verdict {
        Verdict::Alert(reason @ (Alert::Fault | Alert::Ambiguous)) => Some(reason),
        Verdict::Protected(_) => {
            let used = report.used.iter().filter(|its| is_in(witnesses, **its)).count();
            (2 * used <= count).then_some(Alert::Ambiguous)
        }
        _ => None,
    }
}

/// Returns true if a satellite is of a set of numbers of Galileo.
#[inline(never)]
fn is_in(witnesses: u64, satellite: SatelliteId) -> bool {
    satellite.constellation() == Constellation::Galileo && witnesses >> (satellite.number() & 63) & 1 != 0
}

/// Returns the distance of two places, m.
pub(super) fn distance_m(one: Ecef, other: Ecef) -> f32 {
    let [x_m, y_m, z_m] = coordinates_m(one - other);
    sqrt(x_m * x_m + y_m * y_m + z_m * z_m)
}

/// Returns some of the satellites of an epoch. All of a variance counts as the receiver's.
fn some_of(epoch: &Epoch, keeps: &dyn Fn(SatelliteId) -> bool) -> Epoch {
    let mut some = Epoch::new(epoch.time_s());
    for (seen, shared) in epoch.observations().iter().zip(epoch.shared()) {
        if keeps(seen.satellite) {
            // It was accepted before.
            let _ = some.push_sharing(*seen, *shared);
        }
    }
    some
}

/// Returns the place by some of the satellites of an epoch.
// Not inlined, so that the copy is not on the stack while an epoch is judged.
#[inline(never)]
pub(super) fn place_by(
    keeps: &dyn Fn(SatelliteId) -> bool,
    epoch: &Epoch,
    start: Ecef,
    workspace: &mut Workspace,
) -> Option<Ecef> {
    raim_single::position(workspace, &some_of(epoch, keeps), start)
}

/// Returns the levels of some of the satellites of an epoch, about their place.
#[inline(never)]
fn levels_by(
    keeps: &dyn Fn(SatelliteId) -> bool,
    monitor: &Monitor,
    epoch: &Epoch,
    (place, noise): (Ecef, f32),
    memory: &mut MonitorMemory,
) -> Option<ProtectionLevels> {
    raim_single::levels(monitor, &some_of(epoch, keeps), place, noise.max(1.0), memory)
}

/// Leaves out all satellites of a sky that are not of a set.
fn keep(sky: &mut Sky, witnesses: u64) {
    let others = sky.iter().enumerate().filter(|(_, located)| !is_in(witnesses, located.satellite()));
    let others = others.fold(0, |set, (index, _)| set | 1 << index);
    remove(sky, others, &mut 0);
}

impl Navigator {
    /// Sets the satellites of Galileo that may decide, a bit for each number; 0 if none may.
    pub(crate) const fn believe(&mut self, witnesses: u64) {
        self.witnesses = witnesses;
    }

    /// Notes the speed at a place that nothing has contradicted, and names the reason of a promise that
    /// Galileo has decided; before, the monitor has learned from it as from any other.
    pub(super) fn end_tie(&mut self, is_decided: bool, time: GpsTime) -> &mut Report<CAPACITY> {
        if found(self.report()) == Some(self.monitor.start()) {
            let speed_m_s = self.velocity.as_ref().map(|velocity| velocity.speed_m_s() as f32);
            self.held = Held { time, speed_m_s };
        }
        let report = &mut self.room.memory.outcome_mut().report;
        if is_decided && matches!(report.verdict, Verdict::Protected(_)) {
            report.verdict = Verdict::Protected(Protected::System);
        }
        report
    }

    /// Returns the place by satellites of Galileo if the others have leapt and not Galileo, and keeps the
    /// place of the others, whose ranges are then left out.
    fn unmoved(&mut self, witnesses: u64, time: GpsTime, highest_m_s: f64) -> Option<Ecef> {
        let before = self.place()?;
        let way_m = self.held.way_m(time, highest_m_s);
        let noise = self.monitor.noise(time.to_s());
        let Self { monitor, apart, room: Room { epoch, memory, .. }, .. } = self;
        let own = place_by(&|its| is_in(witnesses, its), epoch, before, memory.workspace())?;
        let is_other = |its: SatelliteId| its.constellation() != Constellation::Galileo;
        let others = place_by(&is_other, epoch, before, memory.workspace())?;
        let levels = levels_by(&is_other, monitor, epoch, (others, noise), memory)?;
        let leap_m = distance_m(others, before);
        // NaN fails these comparisons.
        let is_leap = leap_m > (levels.hpl_m + levels.vpl_m) as f32 + way_m;
        if is_leap && distance_m(own, before) < leap_m {
            apart.add(others);
            return Some(own);
        }
        None
    }

    /// Returns those satellites of the epoch whose set in use is the proved one, and their number. Others
    /// of the sky are below the mask or lack a range, which contradicts nothing.
    fn witnesses_in_epoch(&self, time: GpsTime) -> (u64, usize) {
        let seen = self.room.epoch.observations().iter().map(|seen| seen.satellite);
        let proved = seen.filter(|its| is_in(self.witnesses, *its) && self.store.is_proved(*its, time));
        proved.fold((0, 0), |(set, count), its| (set | 1 << (its.number() & 63), count + 1))
    }

    /// Lets Galileo decide where systems contradict each other; returns true if it has. If it has not,
    /// the epoch is an alert.
    #[inline]
    pub(super) fn break_tie(&mut self, time: GpsTime, ranges: Ranges, configuration: &Configuration) -> bool {
        self.witnesses != 0 && self.decide(time, ranges, configuration)
    }

    /// Works like [`Self::break_tie`], where the data of some satellites are proved.
    #[cold]
    #[inline(never)]
    fn decide(&mut self, time: GpsTime, ranges: Ranges, configuration: &Configuration) -> bool {
        let (witnesses, count) = self.witnesses_in_epoch(time);
        if count < LEAST {
            return false;
        }
        let Some(reason) = contradiction(self.report(), witnesses, count) else { return false };
        let highest_m_s = configuration.continuity().max_speed_m_s;
        if let Some(place) = self.unmoved(witnesses, time, highest_m_s) {
            // What follows from the epoch, such as its velocity, is of the same satellites.
            keep(&mut self.room.sky, witnesses);
            let before = self.tally.mark();
            let known = [const { Cell::new(f32::NAN) }; CAPACITY];
            self.judge_about(place, time, ranges, configuration, Search::Known(&[]), &known);
            self.tally.restore(before);
            if self.report().verdict == Verdict::Protected(Protected::Ok) {
                return true;
            }
        }
        let outcome = self.room.memory.outcome_mut();
        outcome.override_alert(reason);
        outcome.report.verdict = Verdict::Alert(reason);
        false
    }
}

#[cfg(test)]
mod tests;
