//! Passes of an epoch: corrections and judgement at successively better points.

use core::cell::Cell;

use heapless::Vec;
use raim_core::frame::Ecef;
use raim_core::internals::weighting::Ism;
#[cfg(feature = "araim")]
use raim_core::monitor::Method;
use raim_core::monitor::Search;
use raim_core::report::{MAX_EXCLUDED, Report, Verdict};
use raim_core::satellite::SatelliteId;

use super::known_rates::{KnownRates, range_rate};
use super::{Navigator, Room, found, is_shorter, is_unknown};
use crate::correction::{CAPACITY, Located, Ranges, Site, coarse};
use crate::raw::RawEpoch;
use crate::settings::Configuration;
use crate::time::GpsTime;

/// Largest distance over which corrections hold, m. Over 1 km an elevation changes by at most
/// 0.012°, mostly because the vertical tilts. 1 km of height changes the zenith delay by some 0.35
/// m.
const GUESS_HOLDS_M: f32 = 1e3;

/// Maximum number of passes of an epoch: at the guess, at a better guess, and once more if a gross
/// fault distorted the first result.
const MAX_PASSES: usize = 3;

/// Maximum number of searches for faulty satellites in one epoch. They are its most expensive part.
const MAX_SEARCHES: usize = 2;

impl Navigator {
    /// Judges one epoch at successively better points, then learns from the last verdict.
    ///
    /// If a search has found satellites to exclude, it is not repeated at a better point. A search
    /// without result is repeated once, because corrections at a distant point may have caused the
    /// misfit. If no earlier position exists, the set found at the first point is provisional, and
    /// is checked at the next.
    ///
    /// `came_ms` is the arrival time of the epoch by the module's own clock.
    // The stages before and after are not inlined, so that this stack frame stays small during the
    // searches.
    #[inline(never)]
    pub fn judge(
        &mut self,
        raw: &RawEpoch,
        came_ms: u64,
        configuration: &Configuration,
    ) -> &mut Report<CAPACITY> {
        #[cfg(feature = "cnav")]
        self.prepare(came_ms, configuration);
        #[cfg(feature = "osnma")]
        self.apart.begin();
        let without_orbit = self.look_up(raw, configuration);
        let mut guess = self.monitor.start();
        let mut is_rough = is_unknown(guess);
        if is_rough {
            guess = self.coarse_position(raw.time);
        }
        let ranges = self.ranges(guess, raw.time, configuration);
        self.learn_anew_of((ranges, configuration.systems));
        self.learn_anew_with_model(ranges);
        let before = self.tally.mark();
        let mut known = Vec::<SatelliteId, MAX_EXCLUDED>::new();
        let mut searches = 0;
        // All passes share the range rates, which differ by less than 1 m/s at points a few
        // kilometres apart.
        let rates = [const { Cell::new(f32::NAN) }; CAPACITY];
        let search = if is_rough { Search::Rough } else { Search::Anew };
        self.judge_about(guess, raw.time, ranges, configuration, search, &rates);
        for _ in 1..MAX_PASSES {
            let assessment = self.room.memory.outcome();
            let found = found(&assessment.report);
            let is_believed = is_rough && assessment.searched && is_excluded(&assessment.report);
            if !is_believed && found.is_some_and(|found| is_shorter(found - guess, GUESS_HOLDS_M)) {
                break;
            }
            is_rough = false;
            searches += usize::from(assessment.searched);
            let settled = is_excluded(&assessment.report) || searches >= MAX_SEARCHES;
            if assessment.searched && settled {
                known = assessment.report.excluded.iter().fold(Vec::new(), |mut known, suspect| {
                    // Both lists have the same capacity, so that this never fails.
                    let _ = known.push(suspect.satellite);
                    known
                });
            }
            let search = if settled { Search::Known(&known) } else { Search::Anew };
            guess = found.unwrap_or_else(|| self.coarse_position(raw.time));
            // Refusals at the less accurate point do not count.
            self.tally.restore(before);
            self.judge_about(guess, raw.time, ranges, configuration, search, &rates);
        }
        let is_decided = self.break_tie(raw.time, ranges, configuration);
        let refused_a_range = self.tally.ranges.range_implausible != before.0.range_implausible;
        self.conclude(raw, came_ms, configuration.place.as_ref(), refused_a_range, without_orbit);
        self.end_tie(is_decided, raw.time)
    }

    /// Corrects and judges the sky as seen from a point.
    pub(super) fn judge_about(
        &mut self,
        point: Ecef,
        time: GpsTime,
        ranges: Ranges,
        configuration: &Configuration,
        search: Search<'_>,
        known: &KnownRates,
    ) {
        self.correct_about(point, time, ranges, configuration);
        let Room { sky, epoch, memory } = &mut self.room;
        let (store, last) = (&self.store, &self.rates);
        // The core asks for satellites in the order of `sky`, so that the search begins behind the
        // satellite found last.
        let next = Cell::new(0);
        let rates = |satellite| {
            if !cfg!(feature = "hypotheses") {
                return None;
            }
            let is_it = |located: &Located| located.satellite() == satellite;
            let index = match sky.get(next.get()) {
                Some(located) if is_it(located) => next.get(),
                _ => sky.iter().position(is_it)?,
            };
            next.set(index + 1);
            let slot = known.get(index)?;
            if slot.get().is_nan() {
                slot.set(range_rate((sky.get(index)?, index), last, store, point, time)?);
            }
            Some(slot.get())
        };
        raim_single::judge(&self.monitor, epoch, point, search, Some(&rates), memory);
    }

    /// Builds the epoch from the sky as seen from a point.
    ///
    /// Not inlined, so that the models of a site leave the stack before the epoch is judged.
    #[inline(never)]
    pub(super) fn correct_about(
        &mut self,
        point: Ecef,
        time: GpsTime,
        ranges: Ranges,
        configuration: &Configuration,
    ) {
        let ism = self.promise(configuration);
        let klobuchar = self.ionosphere.model(time, configuration);
        let site =
            Site::new(point, time, configuration.mask_rad(), klobuchar).with_ranges(ranges).weighted_by(ism);
        let Room { sky, epoch, .. } = &mut self.room;
        site.correct(sky, &mut self.tally, epoch);
        // The forecast of a clock may need one more row.
        let has_room = epoch.observations().len() + 1 < CAPACITY;
        if let Some(height) = self
            .known_height
            .filter(|_| cfg!(feature = "aiding") && has_room && configuration.method.allows_aiding())
        {
            // This does not fail, because the values were checked when they were read.
            let _ = epoch.aid(height);
        }
    }

    /// Returns the parameters that weight the ranges: the ISM for ARAIM, otherwise none.
    fn promise(&self, configuration: &Configuration) -> Option<Ism> {
        #[cfg(feature = "araim")]
        if configuration.method == Method::Araim {
            return Some(*self.monitor.ism());
        }
        let _ = configuration;
        None
    }

    /// Returns a coarse position of a receiver that sees this sky, or the centre of the earth if
    /// there is none.
    #[inline(never)]
    fn coarse_position(&mut self, time: GpsTime) -> Ecef {
        let Room { sky, epoch, memory } = &mut self.room;
        coarse(sky, time, epoch);
        raim_single::position(memory.workspace(), epoch, Ecef::CENTRE).unwrap_or(Ecef::CENTRE)
    }
}

fn is_excluded(report: &Report<CAPACITY>) -> bool {
    !report.excluded.is_empty() && !matches!(report.verdict, Verdict::Alert(_))
}
