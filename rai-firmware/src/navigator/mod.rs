//! The navigator: makes one report from one raw epoch, with satellite positions, corrected ranges
//! and the integrity verdict.
//!
//! Corrections depend on the receiver's position. But the position is computed from the corrected
//! ranges. The first guess is the last position, or a coarse fix without atmosphere if there is
//! none. If the position of an epoch is far from the guess, the epoch is corrected again at that
//! position.

#[cfg(feature = "osnma")]
mod apart;
mod choice;
mod ionosphere;
mod known_rates;
#[cfg(feature = "both-kinds")]
mod others;
mod passes;
#[cfg(feature = "osnma")]
mod tie;

use nalgebra::Vector3;
use raim_core::epoch::{Aiding, Epoch};
use raim_core::frame::Ecef;
use raim_core::internals::velocity::{Velocity, VelocityError};
use raim_core::monitor::MonitorError;
use raim_core::report::{Alert, Report, Unavailable, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_single::{Monitor, MonitorMemory, Workspace};

#[cfg(feature = "observer")]
use crate::correction::Fate;
use crate::correction::horizon::coordinates_m;
use crate::correction::{CAPACITY, Located, Preference, Ranges, Sky, Tally, View, locate_within};
#[cfg(feature = "cnav")]
use crate::ephemeris::CnavFrame;
#[cfg(feature = "osnma")]
use crate::ephemeris::Demand;
use crate::ephemeris::{Ephemeris, Insertion, Store};
use crate::known_place::is_elsewhere;
#[cfg(feature = "osnma")]
use crate::osnma::Seal;
use crate::output::Places;
use crate::rates::{RateTally, Rates};
use crate::raw::RawEpoch;
#[cfg(feature = "observer")]
use crate::raw::RawSatellite;
use crate::settings::{Configuration, Place, Systems};
use crate::time::GpsTime;

#[cfg(feature = "osnma")]
use apart::Apart;
use ionosphere::Broadcast;
#[cfg(feature = "both-kinds")]
use others::Others;
#[cfg(feature = "osnma")]
use tie::Held;

/// Least distance of a receiver from the centre of the earth, m; a position below it is unknown.
const UNKNOWN_RADIUS_M: f32 = 6e6;

/// Orbits, monitor and counters: everything between a raw epoch and its report.
#[derive(Debug)]
pub struct Navigator {
    store: Store,
    monitor: Monitor,
    room: Room,
    tally: Tally,
    preference: Preference,
    #[cfg(feature = "both-kinds")]
    others: Others,
    /// Kind of ranges and set of systems behind the residuals that the monitor stores. If either
    /// changes, the residuals are discarded.
    learned: Option<(Ranges, Systems)>,
    rates: Rates,
    velocity: Option<Velocity>,
    /// Alert that overrides the verdict, however well the ranges agree.
    distrusted: Option<Alert>,
    /// Known height for the next epoch, from the host or the place of a fixed antenna.
    known_height: Option<Aiding>,
    ionosphere: Broadcast,
    /// Satellites of Galileo that may decide a tie, a bit for each number.
    #[cfg(feature = "osnma")]
    witnesses: u64,
    #[cfg(feature = "osnma")]
    held: Held,
    #[cfg(feature = "osnma")]
    apart: Apart,
}

/// Memory of one epoch, with its result. It is here and not on the stack.
#[derive(Debug)]
struct Room {
    sky: Sky,
    epoch: Epoch<CAPACITY>,
    memory: MonitorMemory,
}

impl Navigator {
    /// Returns a navigator without ephemerides.
    ///
    /// # Errors
    /// [`MonitorError`] names the requirement that cannot be met.
    pub fn new(requirements: Requirements) -> Result<Self, MonitorError> {
        Ok(Self::of(raim_single::ValidatedRequirements::new(requirements)?))
    }

    /// Returns a navigator like [`Self::new`], for validated requirements.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(crate) fn of(requirements: raim_single::ValidatedRequirements) -> Self {
        Self {
            store: Store::new(),
            monitor: Monitor::of(requirements),
            room: Room { sky: Sky::new(), epoch: Epoch::new(0.0), memory: MonitorMemory::new() },
            tally: Tally::default(),
            preference: Preference::new(),
            #[cfg(feature = "both-kinds")]
            others: Others::new(),
            learned: None,
            rates: Rates::new(),
            velocity: None,
            distrusted: None,
            known_height: None,
            ionosphere: Broadcast::new(),
            #[cfg(feature = "osnma")]
            witnesses: 0,
            #[cfg(feature = "osnma")]
            held: Held::NONE,
            #[cfg(feature = "osnma")]
            apart: Apart::NONE,
        }
    }

    /// Stores an ephemeris that was received at `now`.
    pub fn learn(&mut self, ephemeris: Ephemeris, now: Option<GpsTime>) -> Insertion {
        self.store.insert(ephemeris, now)
    }

    /// Sets what is demanded of the sets in use.
    #[cfg(feature = "osnma")]
    pub(crate) const fn demand(&mut self, demand: Demand) {
        self.store.demand(demand);
    }

    /// Takes the verdict on the words of a satellite of Galileo.
    #[cfg(feature = "osnma")]
    pub(crate) fn take_verdict(&mut self, number: u8, seal: Seal) {
        if let Some(satellite) = SatelliteId::new(Constellation::Galileo, number) {
            self.store.take_verdict(satellite, seal);
        }
    }

    /// Discards all verdicts.
    #[cfg(feature = "osnma")]
    pub(crate) fn forget_verdicts(&mut self) {
        self.store.forget_verdicts();
    }

    /// Corrects the week of ephemerides that were stored before the week of the present was known
    /// or changed.
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
        self.ionosphere.receive(constellation, coefficients, now);
    }

    /// Stores what a frame of CNAV says, which came at `now_ms` by the module's own clock.
    #[cfg(feature = "cnav")]
    #[inline(never)]
    pub fn hear_cnav(&mut self, frame: &CnavFrame, now_ms: u64) {
        self.store.hear_cnav(frame, now_ms);
    }

    /// Takes the time of an epoch by the module's own clock, and the use of L5. If the use has
    /// changed, learning begins anew, because other ranges are used.
    #[cfg(feature = "cnav")]
    fn prepare(&mut self, came_ms: u64, configuration: &Configuration) {
        if self.store.prepare(came_ms, configuration.needs_healthy_l5()) {
            self.monitor.forget_residuals();
        }
    }

    /// Returns the number of satellites of the last epoch whose L5 is in use although they call it
    /// out of service.
    #[cfg(feature = "cnav")]
    pub(crate) fn unhealthy_l5(&self) -> u8 {
        let Some((ranges, _)) = self.learned else { return 0 };
        let used = &self.report().used;
        let is_used =
            |located: &&Located| located.uses_unhealthy_l5(ranges) && used.contains(&located.satellite());
        self.room.sky.iter().filter(is_used).count() as u8
    }

    /// Sets the alert that overrides all verdicts, or removes it.
    pub fn distrust(&mut self, reason: Option<Alert>) {
        self.distrusted = reason;
    }

    /// Sets the known height for the next epoch; `None` if it is unknown.
    pub fn know_height(&mut self, height: Option<Aiding>) {
        self.known_height = height;
    }

    /// Takes a first guess of the position. After a fix it has no effect.
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
        // Neither call fails: the core accepts every value within the ranges of the commands, and
        // no command sets a method that this build lacks.
        let _ = self.monitor.set_strategy(configuration.strategy());
        let _ = self.monitor.set_continuity(configuration.continuity());
        if cfg!(feature = "araim") {
            self.monitor.set_ism(configuration.promises.ism());
        }
        Ok(())
    }

    /// Forgets what limits the next position, so that it may be anywhere.
    pub fn forget_position(&mut self) {
        self.store.forget_position();
        self.monitor.forget_position();
    }

    /// Notes that no epoch was judged within the time to alert.
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

    /// Returns the number of times that the ephemeris of one visible satellite displaced that of
    /// another.
    pub(crate) fn displaced(&self) -> u32 {
        self.store.displaced()
    }

    /// Returns the counters of satellites.
    pub fn tally(&self) -> &Tally {
        &self.tally
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
        // If the epoch has more satellites than fit, those below the mask are left out first.
        let is_crowd = raw.satellites.len() > CAPACITY && !is_unknown(start);
        let view = is_crowd.then(|| View::from(start, configuration.mask_rad()));
        let Self { store, tally, room: Room { sky, .. }, .. } = self;
        locate_within(raw, store, mask_dbhz, configuration.systems, view.as_ref(), tally, sky);
        self.tally.ephemerides.without_orbit().saturating_sub(before)
    }

    /// Learns from the last verdict, and completes the report with results that do not come from
    /// the corrected ranges.
    #[inline(never)]
    fn conclude(
        &mut self,
        raw: &RawEpoch,
        came_ms: u64,
        fixed: Option<&Place>,
        refused_a_range: bool,
        without_orbit: u32,
    ) -> &mut Report<CAPACITY> {
        let Room { sky, epoch, memory } = &mut self.room;
        // From here on the sigmas are those of the judgement.
        epoch.change_noise(memory.outcome().noise());
        self.tally.notes.measure(memory.workspace());
        if let Some(reason) = self.distrusted {
            memory.outcome_mut().override_alert(reason);
        }
        if cfg!(feature = "aiding")
            && fixed.is_some_and(|place| is_elsewhere(place, &memory.outcome().report))
        {
            memory.outcome_mut().withdraw(Unavailable::Place);
        }
        // In an alert no velocity is computed, because the place may be wrong.
        let report = &memory.outcome().report;
        let place = found(report).filter(|_| !matches!(report.verdict, Verdict::Alert(_)));
        let velocity = if cfg!(feature = "past") {
            self.rates.velocity(raw, sky, place, &self.monitor, memory.workspace())
        } else {
            Err(VelocityError::Redundancy)
        };
        let came_s = came_ms as f64 * 1e-3;
        let compared = match self.rates.refusal() {
            Some(refusal) => Err(refusal),
            None => velocity.as_ref().map_err(|error| *error),
        };
        self.monitor.learn(memory.outcome_mut(), Some(came_s), compared);
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
}

/// The parts of an account.
#[cfg(feature = "observer")]
impl Navigator {
    /// Returns the use of a satellite of the last epoch, or the reason why it is not used.
    pub(crate) fn fate_of(&self, satellite: SatelliteId) -> Fate {
        let report = self.report();
        match self.tally.notes.refusal(satellite) {
            // Without a position there is no elevation.
            Some(Fate::BelowMask) if report.solution.is_none() => Fate::NoPosition,
            Some(fate) => fate,
            None if report.used.contains(&satellite) => Fate::Used,
            None if report.solution.is_none() => Fate::NoPosition,
            None if report.excluded.iter().any(|suspect| suspect.satellite == satellite) => Fate::Excluded,
            None if report.excluded_constellations >> (satellite.constellation() as u8) & 1 != 0 => {
                Fate::SystemExcluded
            }
            None => Fate::Excluded,
        }
    }

    /// Returns the position of a satellite of the last epoch, whether or not it is used.
    pub(crate) fn position_of(&self, raw: &RawSatellite, time: GpsTime) -> Option<Ecef> {
        let of_orbit = || {
            let ephemeris = self.store.get(raw.satellite, time).ok()?;
            Some(ephemeris.at(time, raw.signals.first()?.range_m).ok()?.position)
        };
        self.place_of(raw.satellite).or_else(of_orbit)
    }

    /// Returns SSE/dof of the ranges used in the last epoch; `None` if they did not pass their test.
    pub(crate) fn variance_ratio(&self) -> Option<f64> {
        self.room.memory.outcome().variance_ratio().map(f64::from)
    }

    /// Returns the w-test of a range by its index in the last epoch, dimensionless.
    pub(crate) fn w_test(&self, index: usize) -> Option<f64> {
        self.tally.notes.w_test(index)
    }
}

/// Without OSNMA nothing decides where systems contradict each other.
#[cfg(not(feature = "osnma"))]
#[allow(clippy::inline_always, clippy::unused_self, reason = "nothing must remain of them")]
impl Navigator {
    #[inline(always)]
    const fn break_tie(&self, _: GpsTime, _: Ranges, _: &Configuration) -> bool {
        false
    }

    #[inline(always)]
    fn end_tie(&mut self, _: bool, _: GpsTime) -> &mut Report<CAPACITY> {
        &mut self.room.memory.outcome_mut().report
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

fn is_unknown(point: Ecef) -> bool {
    is_shorter(point, UNKNOWN_RADIUS_M)
}

/// Returns true if a vector is shorter than a limit, m; single precision suffices.
fn is_shorter(vector: Ecef, limit_m: f32) -> bool {
    let vector_m = Vector3::from(coordinates_m(vector));
    vector_m.dot(&vector_m) < limit_m * limit_m
}
