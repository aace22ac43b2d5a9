//! Choice of the kind of ranges; restarts the monitor's learning if learned residuals no longer
//! apply.

use raim_core::frame::Ecef;
use raim_core::report::ProtectionLevels;

use super::{Navigator, Room};
use crate::correction::{Cost, Located, Ranges};
use crate::settings::{Configuration, Frequencies, Systems};
use crate::time::GpsTime;

/// Largest noise of a pair of frequencies, relative to that of one: that of L1 and L2.
const NOISE_OF_PAIRS: f32 = 3.0;

impl Navigator {
    /// Restarts learning if the kind of ranges or the set of systems changes, because earlier
    /// residuals then no longer apply.
    pub(super) fn learn_anew_of(&mut self, learned: (Ranges, Systems)) {
        let before = self.learned.replace(learned);
        if before.is_some_and(|before| before != learned) {
            #[cfg(feature = "both-kinds")]
            let left = core::mem::take(self.monitor.adaptation_mut());
            self.monitor.forget_residuals();
            if before.map(|(ranges, _)| ranges) != Some(learned.0) {
                self.monitor.change_kind(if learned.0 == Ranges::Pairs { NOISE_OF_PAIRS } else { 1.0 });
            }
            #[cfg(feature = "both-kinds")]
            self.others.take_over(before, learned, left, self.monitor.adaptation_mut());
        }
    }

    /// Restarts learning if a new model of the ionosphere applies to ranges of one frequency.
    ///
    /// Residuals of the old model would hide an error of the new one, for example if a forged page
    /// brought its coefficients.
    pub(super) fn learn_anew_with_model(&mut self, ranges: Ranges) {
        let is_new = self.ionosphere.take_news();
        if is_new && (ranges == Ranges::Singles || !self.room.sky.iter().any(Located::has_pair)) {
            self.monitor.forget_residuals();
        }
    }

    /// Returns the kind of ranges to use: the commanded kind, or else the kind with the smaller
    /// levels.
    ///
    /// With clock aiding the kind never changes, because a change moves the receiver clock by the
    /// delay between the carriers.
    #[inline(never)]
    pub(super) fn ranges(&mut self, point: Ecef, time: GpsTime, configuration: &Configuration) -> Ranges {
        match configuration.frequencies {
            Frequencies::Dual => Ranges::Pairs,
            Frequencies::Single => Ranges::Singles,
            Frequencies::Auto => {
                if !configuration.clock_aid && self.room.sky.iter().any(Located::has_pair) {
                    self.compare(point, time, configuration);
                }
                self.preference.ranges()
            }
        }
    }

    /// Compares the levels of both kinds of ranges.
    fn compare(&mut self, point: Ecef, time: GpsTime, configuration: &Configuration) {
        if !self.preference.is_due(time.tow_ms) {
            return;
        }
        let before = self.tally.mark();
        let (noise, others) = (self.monitor.noise(time.to_s()), self.noise_of_others(time));
        let noises = self.preference.noises(noise, others);
        let pairs = self.cost(point, time, (Ranges::Pairs, noises[0]), configuration);
        let singles = self.cost(point, time, (Ranges::Singles, noises[1]), configuration);
        // Refusals of a set that is not used do not count.
        self.tally.restore(before);
        self.preference.compare([pairs, singles], noise < 1.0 || others.is_some());
    }

    /// Returns the cost of a kind of ranges with this noise.
    #[inline(never)]
    fn cost(
        &mut self,
        point: Ecef,
        time: GpsTime,
        (ranges, noise): (Ranges, f32),
        configuration: &Configuration,
    ) -> Option<Cost> {
        self.correct_about(point, time, ranges, configuration);
        let levels = self.fault_free_levels(point, time, ranges != self.preference.ranges(), noise)?;
        // A NaN is no cost. An infinite level is worse than any other.
        let horizontal = (levels.hpl_m / configuration.hal_m) as f32;
        let vertical = (levels.vpl_m / configuration.val_m.unwrap_or(configuration.hal_m)) as f32;
        let is_vertical = configuration.val_m.is_some() && vertical > horizontal;
        let (decisive, other) = if is_vertical { (vertical, horizontal) } else { (horizontal, vertical) };
        Some(Cost { decisive, other })
    }
}

/// Without the feature `both-kinds`, nothing is known of the kind that is not in use.
#[cfg(not(feature = "both-kinds"))]
impl Navigator {
    const fn noise_of_others(&self, _: GpsTime) -> Option<f32> {
        None
    }

    fn fault_free_levels(
        &mut self,
        point: Ecef,
        _: GpsTime,
        _: bool,
        noise: f32,
    ) -> Option<ProtectionLevels> {
        let Room { epoch, memory, .. } = &mut self.room;
        raim_single::levels(&self.monitor, epoch, point, noise, memory)
    }
}

#[cfg(feature = "both-kinds")]
impl Navigator {
    /// Returns the noise that the kind not in use has shown in quiet minutes, if there were enough.
    fn noise_of_others(&self, time: GpsTime) -> Option<f32> {
        Some(self.others.adaptation.noise(time.to_s())).filter(|noise| *noise < 1.0)
    }

    /// Returns the levels of the room's epoch, and learns from its residuals if it is of the kind
    /// that is not in use.
    fn fault_free_levels(
        &mut self,
        point: Ecef,
        time: GpsTime,
        is_other: bool,
        noise: f32,
    ) -> Option<ProtectionLevels> {
        let Self { monitor, others, room: Room { epoch, memory, .. }, .. } = self;
        let fault_free = raim_single::fault_free(monitor, epoch, point, noise, memory);
        if is_other {
            others.learn(
                time.to_s(),
                fault_free.and_then(|(_, residuals)| residuals),
                monitor.adaptation_mut(),
            );
        }
        fault_free.map(|(levels, _)| levels)
    }
}
