//! Choice of the kind of ranges; restarts the monitor's learning if learned residuals no longer
//! apply.

use raim_core::frame::Ecef;

use super::Navigator;
use crate::correction::{Located, Ranges, Site};
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
        let sky = &self.room.sky;
        match configuration.frequencies {
            Frequencies::Dual => return Ranges::Pairs,
            Frequencies::Single => return Ranges::Singles,
            Frequencies::Auto if configuration.clock_aid || !sky.iter().any(Located::has_pair) => {}
            Frequencies::Auto => {
                let site = Site::new(
                    point,
                    time,
                    configuration.mask_rad(),
                    self.ionosphere.model(time, configuration),
                );
                let hal_m = configuration.hal_m as f32;
                let val_m = configuration.val_m.map_or(f32::INFINITY, |val_m| val_m as f32);
                let cost = |ranges| site.spread(sky, ranges).map(|spread| spread.cost(hal_m, val_m));
                self.preference.weigh(cost);
            }
        }
        self.preference.ranges()
    }
}
