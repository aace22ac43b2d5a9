//! The navigator: makes one report from one raw epoch, with satellite positions, corrected ranges
//! and the integrity verdict.
//!
//! Corrections depend on the receiver's position, which they help to find. The last position is the
//! first guess. Without one, a coarse fix without atmosphere gives it. If the position of an epoch
//! is far from the guess, the epoch is corrected again at that position.

mod ionosphere;
mod known_rates;

use core::cell::Cell;

use heapless::Vec;
use nalgebra::Vector3;
use raim_core::epoch::{Aiding, Epoch};
use raim_core::frame::Ecef;
#[cfg(feature = "araim")]
use raim_core::monitor::Method;
use raim_core::monitor::{MonitorError, Search};
use raim_core::report::{Alert, MAX_EXCLUDED, Report, Unavailable, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_core::single::{self, Monitor, MonitorWorkspace, Workspace};
use raim_core::velocity::{Velocity, VelocityError};
use raim_core::weighting::Ism;

use crate::correction::horizon::coordinates_m;
use crate::correction::{
    CAPACITY, Located, Preference, Ranges, Site, Sky, Tally, View, coarse, locate_within,
};
use crate::ephemeris::{Ephemeris, Insertion, Store};
use crate::known_place::is_elsewhere;
use crate::output::Places;
use crate::rates::{RateTally, Rates};
use crate::raw::RawEpoch;
use crate::settings::{Configuration, Frequencies, Place, Systems};
use crate::time::GpsTime;

use ionosphere::Broadcast;
use known_rates::{KnownRates, range_rate};

/// Largest distance over which corrections hold, m: 1 km changes an elevation by 0.003° and the
/// zenith delay by at most 0.25 m.
const GUESS_HOLDS_M: f32 = 1e3;

/// Least distance of a receiver from the centre of the earth, m; a position below it is unknown.
const UNKNOWN_RADIUS_M: f32 = 6e6;

/// Most passes of an epoch: a guess, a better guess, and one more if a gross fault bent the first.
const MAX_PASSES: usize = 3;

/// Most searches for faulty satellites in one epoch, which are the expensive part.
const MAX_SEARCHES: usize = 2;

/// Orbits, monitor and counters: everything between a raw epoch and its report.
#[derive(Debug)]
pub struct Navigator {
    store: Store,
    monitor: Monitor,
    room: Room,
    tally: Tally,
    preference: Preference,
    /// Kind of ranges and systems whose residuals the monitor learns from.
    learned: Option<(Ranges, Systems)>,
    rates: Rates,
    velocity: Option<Velocity>,
    /// Alert that overrides the verdict, however well ranges agree with each other.
    distrusted: Option<Alert>,
    /// Height of the next epoch that is known from outside.
    known_height: Option<Aiding>,
    ionosphere: Broadcast,
}

/// Memory of one epoch, with its result, kept here so that the stack does not need it.
#[derive(Debug)]
struct Room {
    sky: Sky,
    epoch: Epoch<CAPACITY>,
    memory: MonitorWorkspace,
}

impl Navigator {
    /// Returns a navigator without ephemerides.
    ///
    /// # Errors
    /// [`MonitorError`] names the requirement that cannot be met.
    pub fn new(requirements: Requirements) -> Result<Self, MonitorError> {
        Ok(Self::of(single::ValidatedRequirements::new(requirements)?))
    }

    /// Returns a navigator like [`Self::new`], for validated requirements.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(crate) fn of(requirements: single::ValidatedRequirements) -> Self {
        Self {
            store: Store::new(),
            monitor: Monitor::of(requirements),
            room: Room { sky: Sky::new(), epoch: Epoch::new(0.0), memory: MonitorWorkspace::new() },
            tally: Tally::default(),
            preference: Preference::new(),
            learned: None,
            rates: Rates::new(),
            velocity: None,
            distrusted: None,
            known_height: None,
            ionosphere: Broadcast::new(),
        }
    }

    /// Stores an ephemeris that was received at `now`.
    pub fn learn(&mut self, ephemeris: Ephemeris, now: Option<GpsTime>) -> Insertion {
        self.store.insert(ephemeris, now)
    }

    /// Moves sets that came before the week of the present was named or moved.
    pub fn redate(&mut self, present: GpsTime) {
        self.store.redate(present);
    }

    /// Forgets the orbits of GLONASS, because a corrected UTC makes their dates wrong.
    pub fn correct_utc(&mut self) {
        self.store.forget(Constellation::Glonass);
    }

    /// Stores broadcast coefficients of the ionosphere for the model of their constellation.
    /// Invalid coefficients change nothing, and those of a command take precedence.
    #[inline(never)]
    pub fn hear_ionosphere(
        &mut self,
        constellation: Constellation,
        coefficients: [f64; 8],
        now: Option<GpsTime>,
    ) {
        self.ionosphere.hear(constellation, coefficients, now);
    }

    /// Sets the alert that overrides all verdicts, or removes it.
    pub fn distrust(&mut self, reason: Option<Alert>) {
        self.distrusted = reason;
    }

    /// Sets the height of the next epoch that is known from outside, or that there is none.
    pub fn know_height(&mut self, height: Option<Aiding>) {
        self.known_height = height;
    }

    /// Takes a first guess of the position, which has no effect after a fix.
    pub fn guess(&mut self, point: Ecef) {
        if is_unknown(self.monitor.start()) {
            self.monitor.start_from(point);
        }
    }

    /// Applies the requirements and the strategy of a configuration.
    ///
    /// # Errors
    /// As for [`Self::new`]; on error nothing has changed.
    pub fn configure(&mut self, configuration: &Configuration) -> Result<(), MonitorError> {
        self.monitor.set_requirements(configuration.requirements())?;
        // The core accepts every value within the ranges of the commands, and no word sets a method
        // that this build lacks.
        let _ = self.monitor.set_strategy(configuration.strategy());
        let _ = self.monitor.set_continuity(configuration.continuity());
        if cfg!(feature = "araim") {
            self.monitor.set_ism(configuration.promises.ism());
        }
        Ok(())
    }

    /// Forgets the last position.
    pub fn forget_position(&mut self) {
        self.store.forget_position();
        self.monitor.forget_position();
    }

    /// Notes that no epoch came within the time to alert.
    pub fn interrupt(&mut self) {
        self.monitor.interrupt();
    }

    /// Returns the report of the last epoch.
    pub fn report(&self) -> &Report<CAPACITY> {
        &self.room.memory.outcome().report
    }

    /// Returns the last place that was not contradicted; `None` if there is none yet.
    pub(crate) fn place(&self) -> Option<Ecef> {
        Some(self.monitor.start()).filter(|start| !is_unknown(*start))
    }

    /// Returns the corrected ranges of the last epoch.
    pub fn epoch(&self) -> &Epoch<CAPACITY> {
        &self.room.epoch
    }

    /// Returns the scratch memory for equations, which is free between epochs.
    pub(crate) fn workspace(&mut self) -> &mut Workspace {
        self.room.memory.workspace()
    }

    /// Returns the requirements in force.
    pub fn requirements(&self) -> &Requirements {
        self.monitor.requirements()
    }

    /// Returns the velocity of the last epoch, if it passed its test.
    pub fn velocity(&self) -> Option<&Velocity> {
        self.velocity.as_ref()
    }

    /// Returns the counters of range rates.
    pub fn rate_tally(&self) -> &RateTally {
        self.rates.tally()
    }

    /// Returns how many ephemerides of satellites in sight gave way to others.
    pub(crate) fn displaced(&self) -> u32 {
        self.store.displaced()
    }

    /// Returns the counters of satellites.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Judges one epoch at successively better points, then learns from the last verdict.
    ///
    /// An exclusion set that was found is not searched for again at a better point. A search
    /// without result is repeated once, because corrections at a distant point may have caused the
    /// misfit. At the first point of all, which no earlier epoch confirms, a set is accepted
    /// provisionally and checked at the next point.
    ///
    /// `came_ms` is the arrival time of the epoch by the module's own clock.
    // The stages before and after are not inlined, so that the frame below the searches stays
    // small.
    #[inline(never)]
    pub fn judge(
        &mut self,
        raw: &RawEpoch,
        came_ms: u64,
        configuration: &Configuration,
    ) -> &mut Report<CAPACITY> {
        let without_orbit = self.look_up(raw, configuration);
        let mut guess = self.monitor.start();
        let mut is_rough = is_unknown(guess);
        if is_rough {
            guess = self.coarse_position(raw.time);
        }
        let ranges = self.ranges(guess, raw.time, configuration);
        self.learn_anew_of((ranges, configuration.systems));
        self.learn_anew_with_model(ranges);
        let before = self.tally.ranges;
        let mut known = Vec::<SatelliteId, MAX_EXCLUDED>::new();
        let mut searches = 0;
        // Range rates are the same at every point within a metre per second.
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
                    // Both have the same capacity, so that it is never full here.
                    let _ = known.push(suspect.satellite);
                    known
                });
            }
            let search = if settled { Search::Known(&known) } else { Search::Anew };
            guess = found.unwrap_or_else(|| self.coarse_position(raw.time));
            // Refusals at the less accurate point do not count.
            self.tally.ranges = before;
            self.judge_about(guess, raw.time, ranges, configuration, search, &rates);
        }
        let refused_a_range = self.tally.ranges.range_implausible != before.range_implausible;
        self.conclude(raw, came_ms, configuration.place.as_ref(), refused_a_range, without_orbit)
    }

    /// Restarts learning if ranges or systems change, because residuals of others do not apply.
    fn learn_anew_of(&mut self, learned: (Ranges, Systems)) {
        if self.learned.replace(learned).is_some_and(|before| before != learned) {
            self.monitor.forget_residuals();
        }
    }

    /// Restarts learning if another model of the ionosphere applies to ranges of one frequency.
    ///
    /// Its error, of a forged page too, is in all residuals from now on, and those of another model
    /// would hide it.
    fn learn_anew_with_model(&mut self, ranges: Ranges) {
        let is_new = self.ionosphere.take_news();
        if is_new && (ranges == Ranges::Singles || !self.room.sky.iter().any(Located::has_pair)) {
            self.monitor.forget_residuals();
        }
    }

    /// Computes the satellite positions of an epoch; returns the number of satellites without
    /// orbit.
    #[inline(never)]
    fn look_up(&mut self, raw: &RawEpoch, configuration: &Configuration) -> u32 {
        self.store.observe(raw.satellites.iter().map(|satellite| satellite.satellite));
        if configuration.systems.contains('R') {
            self.store.advance(raw.time);
        }
        let start = self.monitor.start();
        if !is_unknown(start) {
            self.store.look_from(start, configuration.mask_rad(), raw.time);
        }
        self.ionosphere.date(raw.time);
        let before = self.tally.ephemerides.without_orbit();
        let mask_dbhz = configuration.signal_mask_db_hz as f32;
        // What the mask leaves out of a crowd is to leave room for what it does not.
        let is_crowd = raw.satellites.len() > CAPACITY && !is_unknown(start);
        let view = is_crowd.then(|| View::from(start, configuration.mask_rad()));
        let Self { store, tally, room: Room { sky, .. }, .. } = self;
        locate_within(raw, store, mask_dbhz, configuration.systems, view.as_ref(), tally, sky);
        self.tally.ephemerides.without_orbit().saturating_sub(before)
    }

    /// Learns from the last verdict, and completes the report beyond the ranges.
    #[inline(never)]
    fn conclude(
        &mut self,
        raw: &RawEpoch,
        came_ms: u64,
        fixed: Option<&Place>,
        refused_a_range: bool,
        without_orbit: u32,
    ) -> &mut Report<CAPACITY> {
        let Room { sky, memory, .. } = &mut self.room;
        if let Some(reason) = self.distrusted {
            memory.outcome_mut().override_alert(reason);
        }
        if cfg!(feature = "aiding")
            && fixed.is_some_and(|place| is_elsewhere(place, &memory.outcome().report))
        {
            memory.outcome_mut().withdraw(Unavailable::Place);
        }
        // Under an alert no velocity is reported, and computing one at a wrong place would only
        // cost time.
        let report = &memory.outcome().report;
        let place = found(report).filter(|_| !matches!(report.verdict, Verdict::Alert(_)));
        let velocity = if cfg!(feature = "past") {
            self.rates.velocity(raw, sky, place, &self.monitor, memory.workspace())
        } else {
            Err(VelocityError::Redundancy)
        };
        let came_s = came_ms as f64 * 1e-3;
        self.monitor.learn(memory.outcome_mut(), Some(came_s), velocity.as_ref().map_err(|error| *error));
        let is_alert = matches!(memory.outcome().report.verdict, Verdict::Alert(_));
        self.velocity = velocity.ok().filter(|_| !is_alert);
        let report = &mut memory.outcome_mut().report;
        if report.solution.is_none() && refused_a_range {
            report.verdict = Verdict::Unavailable(Unavailable::Input);
        } else if report.verdict == Verdict::Unavailable(Unavailable::NoFix)
            && without_orbit as usize > sky.len()
        {
            report.verdict = Verdict::Unavailable(Unavailable::Ephemeris);
        }
        report.tracked = raw.satellites.len().min(255) as u8;
        report
    }

    /// Returns the kind of ranges to use: as commanded, or the kind with the smaller levels.
    ///
    /// With clock aiding the kind stays, because another one moves the clock by the delay between
    /// carriers.
    #[inline(never)]
    fn ranges(&mut self, point: Ecef, time: GpsTime, configuration: &Configuration) -> Ranges {
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

    /// Corrects and judges the sky as seen from a point.
    fn judge_about(
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
        // Satellites are asked for in the order of the sky, so that the next one is mostly the one
        // behind the last.
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
        single::judge(&self.monitor, epoch, point, search, Some(&rates), memory);
    }

    /// Builds the epoch from the sky as seen from a point.
    ///
    /// Not inlined, so that the models of a site leave the stack before the epoch is judged.
    #[inline(never)]
    fn correct_about(&mut self, point: Ecef, time: GpsTime, ranges: Ranges, configuration: &Configuration) {
        let ism = self.promise(configuration);
        let klobuchar = self.ionosphere.model(time, configuration);
        let site =
            Site::new(point, time, configuration.mask_rad(), klobuchar).with_ranges(ranges).weighted_by(ism);
        let Room { sky, epoch, .. } = &mut self.room;
        site.correct(sky, &mut self.tally.ranges, epoch);
        // The forecast of a clock may take the last row.
        let has_room = epoch.observations().len() + 1 < CAPACITY;
        if let Some(height) = self
            .known_height
            .filter(|_| cfg!(feature = "aiding") && has_room && configuration.method.allows_aiding())
        {
            // Its values were checked when they were read.
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
        single::position(memory.workspace(), epoch, Ecef::CENTRE).unwrap_or(Ecef::CENTRE)
    }
}

impl Places for Navigator {
    fn place_of(&self, satellite: SatelliteId) -> Option<Ecef> {
        let located = self.room.sky.iter().find(|located| located.satellite() == satellite);
        located.map(Located::position)
    }
}

fn found(report: &Report<CAPACITY>) -> Option<Ecef> {
    report.solution.as_ref().map(|solution| solution.position)
}

fn is_excluded(report: &Report<CAPACITY>) -> bool {
    !report.excluded.is_empty() && !matches!(report.verdict, Verdict::Alert(_))
}

fn is_unknown(point: Ecef) -> bool {
    is_shorter(point, UNKNOWN_RADIUS_M)
}

/// Returns true if a vector is shorter than a limit, m; single precision suffices.
fn is_shorter(vector: Ecef, limit_m: f32) -> bool {
    let vector_m = Vector3::from(coordinates_m(vector));
    vector_m.dot(&vector_m) < limit_m * limit_m
}
