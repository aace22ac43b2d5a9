//! Choice of the kind of ranges; restarts the monitor's learning if learned residuals no longer
//! apply.

use raim_core::frame::Ecef;

use super::{Navigator, Room};
use crate::correction::{Located, Ranges};
use crate::settings::{Configuration, Frequencies, Systems};
use crate::time::GpsTime;

impl Navigator {
    /// Restarts learning if the kind of ranges or the set of systems changes, because earlier
    /// residuals then no longer apply.
    pub(super) fn learn_anew_of(&mut self, learned: (Ranges, Systems)) {
        if self.learned.replace(learned).is_some_and(|before| before != learned) {
            self.monitor.forget_residuals();
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
        let (mut preference, before) = (self.preference, self.tally.mark());
        preference.weigh(self.monitor.noise(time.to_s()), |ranges, noise| {
            self.correct_about(point, time, ranges, configuration);
            let Room { epoch, memory, .. } = &mut self.room;
            let levels = raim_single::levels(&self.monitor, epoch, point, noise, memory)?;
            let vertical = configuration.val_m.map_or(0.0, |val_m| levels.vpl_m / val_m);
            // A NaN is no cost. An infinite level is worse than any other.
            Some((levels.hpl_m / configuration.hal_m).max(vertical) as f32)
        });
        // Refusals of a set that is not used do not count.
        self.preference = preference;
        self.tally.restore(before);
    }
}
