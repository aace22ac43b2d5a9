//! From one raw epoch to one report: satellites located, ranges corrected, integrity judged.
//!
//! Corrections depend on where the receiver is, and that is what they are for. The last position is the first
//! guess; without one, a coarse fix without atmosphere finds it. An epoch whose position turns out to be far from
//! the guess is corrected once more about what was found.

use core::cell::Cell;

use heapless::Vec;
use nalgebra::Vector3;
use rai_core::epoch::Epoch;
use rai_core::frame::Ecef;
#[cfg(feature = "araim")]
use rai_core::monitor::Method;
use rai_core::monitor::{MonitorError, Search};
use rai_core::numeric::real::Real;
use rai_core::report::{Alert, MAX_EXCLUDED, Report, Unavailable, Verdict};
use rai_core::requirements::Requirements;
use rai_core::satellite::{Constellation, SatelliteId};
use rai_core::single::{self, Monitor, MonitorWorkspace, Workspace};
use rai_core::velocity::Velocity;
use rai_core::weighting::Ism;

use crate::config::{Configuration, Frequencies, Systems};
use crate::correction::horizon::coordinates_m;
use crate::correction::{
    CAPACITY, Klobuchar, Located, Preference, Ranges, Site, Sky, Tally, View, coarse, locate_within,
};
use crate::ephemeris::{Ephemeris, Insertion, Store};
use crate::rates::{RateTally, Rates};
use crate::raw::RawEpoch;
use crate::time::GpsTime;

/// Within this distance corrections hold: 1 km changes an elevation by 0.003° and the zenith delay by at most 0.25 m.
const GUESS_HOLDS_M: f64 = 1e3;

/// Closer to the centre of the earth than this is no receiver: the position is unknown.
const UNKNOWN_RADIUS_M: f64 = 6e6;

/// How long broadcast coefficients are used, ms: they are renewed at least every six days.
const IONOSPHERE_HOLDS_MS: u64 = 6 * 86_400_000;

/// Guess, better guess, and one more after a gross fault bent the first.
const MAX_PASSES: usize = 3;

/// Searches for faulty satellites in one epoch: the expensive part.
const MAX_SEARCHES: usize = 2;

/// Orbits, monitor and counters: everything between a raw epoch and its report.
#[derive(Debug)]
pub struct Navigator {
    store: Store,
    monitor: Monitor,
    room: Room,
    tally: Tally,
    preference: Preference,
    /// The ranges whose residuals the monitor learns from, and the systems that they are of.
    learned: Option<(Ranges, Systems)>,
    rates: Rates,
    velocity: Option<Velocity>,
    /// Why no position is to be used, however well ranges agree with each other.
    distrusted: Option<Alert>,
    /// The models of the ionosphere that GPS and `BeiDou` satellites broadcast, and when they came; none before the first epoch,
    /// which then dates them.
    ionosphere: [Option<(Klobuchar, Option<GpsTime>)>; 2],
}

/// What one epoch needs of memory while it is judged, and leaves behind: here, so that it is not the stack's.
#[derive(Debug)]
struct Room {
    sky: Sky,
    epoch: Epoch<CAPACITY>,
    memory: MonitorWorkspace,
}

impl Navigator {
    /// A navigator without ephemerides.
    ///
    /// # Errors
    /// [`MonitorError`] names the requirement that cannot be met.
    pub fn new(requirements: Requirements) -> Result<Self, MonitorError> {
        Ok(Self::of(single::ValidatedRequirements::new(requirements)?))
    }

    /// As [`Self::new`], of requirements that are known to be met.
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
            ionosphere: [None; 2],
        }
    }

    /// Takes an ephemeris that was received at `now`.
    pub fn learn(&mut self, ephemeris: Ephemeris, now: Option<GpsTime>) -> Insertion {
        self.store.insert(ephemeris, now)
    }

    /// UTC is another than it was taken for: the orbits of GLONASS, which are dated in it, are not what they were taken for.
    pub fn correct_utc(&mut self) {
        self.store.forget(Constellation::Glonass);
    }

    /// Takes coefficients of the ionosphere that satellites of a constellation have broadcast, of the model that is theirs.
    /// What says nothing of it changes nothing, and those of a command outrank them.
    #[inline(never)]
    pub fn hear_ionosphere(
        &mut self,
        constellation: Constellation,
        coefficients: [f64; 8],
        now: Option<GpsTime>,
    ) {
        let [of_gps, of_beidou] = &mut self.ionosphere;
        let (known, heard) = match constellation {
            Constellation::Beidou => (of_beidou, Klobuchar::of_beidou(coefficients)),
            _ => (of_gps, Klobuchar::new(coefficients)),
        };
        *known = heard.map(|klobuchar| (klobuchar, now)).or(*known);
    }

    /// The model in force: that of a command, else what GPS has broadcast not too long ago, else what `BeiDou` has.
    fn klobuchar(&self, time: GpsTime, configuration: &Configuration) -> Option<Klobuchar> {
        let is_fresh = |came: GpsTime| time.since_ms(came).unsigned_abs() <= IONOSPHERE_HOLDS_MS;
        let mut heard = self.ionosphere.iter().flatten();
        let fresh = || heard.find(|(_, came)| came.is_none_or(is_fresh)).map(|(klobuchar, _)| *klobuchar);
        configuration.klobuchar.and_then(Klobuchar::new).or_else(fresh)
    }

    /// From now on ranges are distrusted for this reason, however well they agree with each other, or for none.
    pub fn distrust(&mut self, reason: Option<Alert>) {
        self.distrusted = reason;
    }

    /// Takes a first guess of the position. It counts for nothing once there is a fix.
    pub fn guess(&mut self, point: Ecef) {
        if is_unknown(self.monitor.start()) {
            self.monitor.start_from(point);
        }
    }

    /// Takes the requirements and the strategy of a configuration.
    ///
    /// # Errors
    /// As [`Self::new`]; nothing has changed then.
    pub fn configure(&mut self, configuration: &Configuration) -> Result<(), MonitorError> {
        self.monitor.set_requirements(configuration.requirements)?;
        self.monitor.set_strategy(configuration.strategy());
        // Every value within the ranges of the commands is one that the core takes.
        let _ = self.monitor.set_continuity(configuration.continuity());
        self.monitor.set_ism(configuration.promises.ism());
        Ok(())
    }

    /// The last position counts for nothing.
    pub fn forget_position(&mut self) {
        self.monitor.forget_position();
    }

    /// No epoch came within the time to alert.
    pub fn interrupt(&mut self) {
        self.monitor.interrupt();
    }

    /// What was said of the epoch that was judged last.
    pub fn report(&self) -> &Report<CAPACITY> {
        &self.room.memory.outcome().report
    }

    /// The room for equations, while nothing is judged.
    pub(crate) fn workspace(&mut self) -> &mut Workspace {
        self.room.memory.workspace()
    }

    /// What is judged by.
    pub fn requirements(&self) -> &Requirements {
        self.monitor.requirements()
    }

    /// The velocity of the last epoch, where there is one that passed its test.
    pub fn velocity(&self) -> Option<&Velocity> {
        self.velocity.as_ref()
    }

    /// What became of the range rates so far.
    pub fn rate_tally(&self) -> &RateTally {
        self.rates.tally()
    }

    /// What became of the satellites so far.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Judges one epoch, about better and better points, and learns from the last judgement.
    ///
    /// A set of faulty satellites that was found is not searched for again about a better point, and a search that found
    /// none is repeated once: about a point far off the corrections may have been what did not fit. About the first point of all,
    /// which no epoch before vouches for, a set is found and nothing more is asked: that is asked about the next.
    ///
    /// `came_ms` is when the epoch came, by the module's own clock.
    // What comes before and after is not inlined: the searches are below this frame.
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
        let before = self.tally.ranges;
        let mut known = Vec::<SatelliteId, MAX_EXCLUDED>::new();
        let mut searches = 0;
        // About every point the same but for a metre a second.
        let rates = [const { Cell::new(f32::NAN) }; CAPACITY];
        let search = if is_rough { Search::Rough } else { Search::Anew };
        self.judge_about(guess, raw.time, ranges, configuration, search, &rates);
        for _ in 1..MAX_PASSES {
            let assessment = self.room.memory.outcome();
            let found = found(&assessment.report);
            let is_believed = is_rough && assessment.searched && is_excluded(&assessment.report);
            if !is_believed && found.is_some_and(|found| found.distance_m(guess) <= GUESS_HOLDS_M) {
                break;
            }
            is_rough = false;
            searches += usize::from(assessment.searched);
            let settled = is_excluded(&assessment.report) || searches >= MAX_SEARCHES;
            if assessment.searched && settled {
                known = assessment.report.excluded.iter().fold(Vec::new(), |mut known, suspect| {
                    // As many as may be excluded: never full here.
                    let _ = known.push(suspect.satellite);
                    known
                });
            }
            let search = if settled { Search::Known(&known) } else { Search::Anew };
            guess = found.unwrap_or_else(|| self.coarse_position(raw.time));
            // What was refused about the poorer point does not count.
            self.tally.ranges = before;
            self.judge_about(guess, raw.time, ranges, configuration, search, &rates);
        }
        let refused_a_range = self.tally.ranges.range_implausible != before.range_implausible;
        self.conclude(raw, came_ms, refused_a_range, without_orbit)
    }

    /// Residuals say nothing of the sigmas of other ranges, nor of other systems.
    fn learn_anew_of(&mut self, learned: (Ranges, Systems)) {
        if self.learned.replace(learned).is_some_and(|before| before != learned) {
            self.monitor.forget_residuals();
        }
    }

    /// Finds where the satellites of an epoch were; says how many of them have no orbit.
    #[inline(never)]
    fn look_up(&mut self, raw: &RawEpoch, configuration: &Configuration) -> u32 {
        self.store.observe(raw.satellites.iter().map(|satellite| satellite.satellite));
        if configuration.systems.contains('R') {
            self.store.advance(raw.time);
        }
        for (_, came) in self.ionosphere.iter_mut().flatten() {
            came.get_or_insert(raw.time);
        }
        let before = self.tally.ephemerides.without_orbit();
        let mask_dbhz = configuration.signal_mask_db_hz as f32;
        // What the mask leaves out of a crowd is to leave room for what it does not.
        let start = self.monitor.start();
        let is_crowd = raw.satellites.len() > CAPACITY && !is_unknown(start);
        let view = is_crowd.then(|| View::from(start, configuration.mask_rad));
        let Self { store, tally, room: Room { sky, .. }, .. } = self;
        locate_within(raw, store, mask_dbhz, configuration.systems, view.as_ref(), tally, sky);
        self.tally.ephemerides.without_orbit().saturating_sub(before)
    }

    /// Learns from the last judgement, and says what more is known of the epoch than its ranges tell.
    #[inline(never)]
    fn conclude(
        &mut self,
        raw: &RawEpoch,
        came_ms: u64,
        refused_a_range: bool,
        without_orbit: u32,
    ) -> &mut Report<CAPACITY> {
        let Room { sky, memory, .. } = &mut self.room;
        if let Some(reason) = self.distrusted {
            memory.outcome_mut().override_alert(reason);
        }
        self.monitor.learn(memory.outcome_mut(), Some(came_ms as f64 * 1e-3));
        // Under an alert nobody is told a velocity, and one about a wrong place would only be dear.
        let report = &memory.outcome().report;
        let place = found(report).filter(|_| !matches!(report.verdict, Verdict::Alert(_)));
        self.velocity = self.rates.velocity(raw, sky, place, &self.monitor, memory.workspace());
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

    /// Which ranges are used: as commanded, or those that give the smaller levels.
    ///
    /// With clock aiding the set stays: another one moves the clock by the delay between carriers.
    #[inline(never)]
    fn ranges(&mut self, point: Ecef, time: GpsTime, configuration: &Configuration) -> Ranges {
        let sky = &self.room.sky;
        match configuration.frequencies {
            Frequencies::Dual => return Ranges::Pairs,
            Frequencies::Single => return Ranges::Singles,
            Frequencies::Auto if configuration.clock_aid || !sky.iter().any(Located::has_pair) => {}
            Frequencies::Auto => {
                let site =
                    Site::new(point, time, configuration.mask_rad, self.klobuchar(time, configuration));
                let hal_m = configuration.requirements.hal_m as f32;
                let val_m = configuration.requirements.val_m.map_or(f32::INFINITY, |val_m| val_m as f32);
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
        let rates = |satellite| {
            let index = sky.iter().position(|located| located.satellite() == satellite)?;
            let slot = known.get(index)?;
            if slot.get().is_nan() {
                slot.set(range_rate(sky.get(index)?, last, store, point, time)?);
            }
            Some(slot.get())
        };
        single::judge(&self.monitor, epoch, point, search, Some(&rates), memory);
    }

    /// Makes the epoch that is judged of the sky as seen from a point.
    ///
    /// Not inlined: the models of a site need the stack no longer when the epoch is judged.
    #[inline(never)]
    fn correct_about(&mut self, point: Ecef, time: GpsTime, ranges: Ranges, configuration: &Configuration) {
        let ism = self.promise(configuration);
        let klobuchar = self.klobuchar(time, configuration);
        let site =
            Site::new(point, time, configuration.mask_rad, klobuchar).with_ranges(ranges).weighted_by(ism);
        let Room { sky, epoch, .. } = &mut self.room;
        site.correct(sky, &mut self.tally.ranges, epoch);
    }

    /// What the ranges are weighed by: ARAIM by what is promised, the other methods by what is expected.
    fn promise(&self, configuration: &Configuration) -> Option<Ism> {
        #[cfg(feature = "araim")]
        if configuration.method == Method::Araim {
            return Some(*self.monitor.ism());
        }
        let _ = configuration;
        None
    }

    /// Roughly where a receiver is that sees this sky; the centre of the earth if that cannot be told.
    #[inline(never)]
    fn coarse_position(&mut self, time: GpsTime) -> Ecef {
        let Room { sky, epoch, memory } = &mut self.room;
        coarse(sky, time, epoch);
        single::position(memory.workspace(), epoch, Ecef::CENTRE).unwrap_or(Ecef::CENTRE)
    }
}

/// Range rates of the satellites of a sky, m/s, as far as they have been asked for: the others are NaN.
type KnownRates = [Cell<f32>; CAPACITY];

/// Between two places of a satellite whose difference is its velocity, ms.
const APART_MS: u32 = 128;

/// How fast the range of a receiver at rest to a satellite of the sky grows, m/s. Where the last epoch does not say, a second place on
/// the orbit does, which is dear.
#[inline(never)]
fn range_rate(located: &Located, last: &Rates, store: &Store, point: Ecef, time: GpsTime) -> Option<f32> {
    let velocity_m_s = last.of_satellite(located, time).or_else(|| velocity_m_s(located, store, time))?;
    let way_m = Vector3::from(coordinates_m(located.state().position - point));
    Some(way_m.dot(&velocity_m_s) * way_m.dot(&way_m).inverse_sqrt_approx())
}

/// How fast a satellite moves in the earth-fixed frame, m/s, by two places on its orbit.
fn velocity_m_s(located: &Located, store: &Store, time: GpsTime) -> Option<Vector3<f32>> {
    let ephemeris = store.get(located.satellite(), time).ok()?;
    let later = ephemeris.at(time.later_by_ms(APART_MS), located.measured_m()?).ok()?;
    let moved_m = coordinates_m(later.position - located.state().position);
    Some(Vector3::from(moved_m) * (1e3 / APART_MS as f32))
}

fn found(report: &Report<CAPACITY>) -> Option<Ecef> {
    report.solution.as_ref().map(|solution| solution.position)
}

fn is_excluded(report: &Report<CAPACITY>) -> bool {
    !report.excluded.is_empty() && !matches!(report.verdict, Verdict::Alert(_))
}

fn is_unknown(point: Ecef) -> bool {
    point.radius_m() < UNKNOWN_RADIUS_M
}
