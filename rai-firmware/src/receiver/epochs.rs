//! Handles each event of the input: judges an epoch, sets the pin, writes the report, and stores
//! everything else.

use embedded_hal::digital::OutputPin;
use embedded_io::Write;
use raim_core::epoch::Aiding;
use raim_core::monitor::MonitorError;
use raim_core::report::{Alert, Unavailable, Verdict};
use raim_single::ValidatedRequirements;

use super::lateness::Lateness;
use super::meaning::{agree, is_sign};
use super::rivals::Rivals;
use super::strengths::Strengths;
#[cfg(feature = "osnma")]
use super::trusted::Trusted;
use super::verdicts::Verdicts;
#[cfg(feature = "osnma")]
use super::work::enough_are_proved;
use crate::counters::count;
use crate::ephemeris::{Ephemeris, Insertion};
use crate::input::{Event, Suspicions};
use crate::known_place::{HostHeight, aiding_of};
use crate::navigator::Navigator;
use crate::observer::{Judged, Observer, WithoutEpoch};
#[cfg(feature = "osnma")]
use crate::osnma::{Keys, Summary};
#[cfg(feature = "osnma")]
use crate::output::nmea::TimeOfDay;
use crate::output::nmea::{GPS_MINUS_UTC_S, Losses};
use crate::output::{InView, Interference, Motion, Statement};
use crate::publisher::Publisher;
use crate::raw::RawEpoch;
use crate::selftest::{self, Failure};
use crate::settings::{Configuration, SpoofFlag};
use crate::time::GpsTime;

/// Settings at start, read where the program stores them, because a copy would be on the stack.
static AT_START: Configuration = Configuration::at_start();

/// Returns the requirements of the settings at start.
///
/// # Errors
/// [`MonitorError`] if their thresholds are not in the tables.
pub(super) fn requirements_at_start() -> Result<ValidatedRequirements, MonitorError> {
    ValidatedRequirements::new(AT_START.requirements())
}

/// State of the module behind the input, and the reaction to each event.
#[derive(Debug)]
pub(super) struct EpochLoop<P, O> {
    pub(super) pin: P,
    pub(super) observer: O,
    pub(super) navigator: Navigator,
    pub(super) configuration: Configuration,
    pub(super) publisher: Publisher,
    /// Hash of the settings that a promise depends on. If it changes, a standing promise is taken
    /// back.
    promise_hash: u32,
    pub(super) verdicts: Verdicts,
    pub(super) last_verdict: Option<Verdict>,
    /// True if the last verdict is of an epoch, and not of a silence or a change of settings.
    pub(super) has_report: bool,
    last_time: Option<GpsTime>,
    /// Reference time for `STALE` and `SOURCE`, ms: the arrival of the last judged epoch minus its
    /// lateness, or the time of the last such alert.
    last_epoch_ms: u64,
    lateness: Lateness,
    /// Arrival of the epoch that is being judged, ms.
    #[cfg(feature = "observer")]
    came_ms: u64,
    /// Last epoch whose ranges agreed with orbits that determine the week, and its arrival, ms.
    pub(super) agreed: Option<(GpsTime, u64)>,
    pub(super) sigma_check: Option<f64>,
    is_sound: bool,
    /// False after an unexpected restart that lost the settings, until the host confirms those in
    /// force. Otherwise true.
    pub(super) is_confirmed: bool,
    pub(super) interference: Suspicions,
    /// Time at which the module's own tests last indicated counterfeit signals, ms.
    sign_ms: Option<u64>,
    strengths: Strengths,
    /// Height from the host.
    pub(super) host_height: Option<HostHeight>,
    rivals: Rivals,
    /// GPS time minus UTC, s; the value of the image until the input states another.
    pub(super) gps_minus_utc_s: u8,
    /// Time that the host has given.
    #[cfg(feature = "osnma")]
    pub(super) trusted: Option<Trusted>,
    /// Keys in force, and what is known by them.
    #[cfg(feature = "osnma")]
    pub(super) keys: Keys,
    #[cfg(feature = "osnma")]
    pub(super) authentication: Option<Summary>,
}

impl<P: OutputPin, O: Observer> EpochLoop<P, O> {
    /// Returns the state before the first event. The caller has tried to set the pin
    /// low; `pin_failures` is the number of failed attempts.
    ///
    /// It returns `Self` and no `Result`, because a `Result` would be built on the stack first.
    #[allow(clippy::inline_always, reason = "large values are built in their final place")]
    #[inline(always)]
    pub(super) fn new(
        pin: P,
        observer: O,
        pin_failures: u32,
        requirements: ValidatedRequirements,
        clock_error_ppm: u32,
    ) -> Self {
        Self {
            pin,
            observer,
            navigator: Navigator::of(requirements),
            configuration: AT_START,
            publisher: Publisher::new(AT_START.hash()),
            promise_hash: AT_START.promise_hash(),
            verdicts: Verdicts { pin_failures, ..Verdicts::NONE },
            last_verdict: None,
            has_report: false,
            last_time: None,
            last_epoch_ms: 0,
            lateness: Lateness::by_clock_within(clock_error_ppm),
            #[cfg(feature = "observer")]
            came_ms: 0,
            agreed: None,
            sigma_check: None,
            is_sound: true,
            is_confirmed: true,
            interference: Suspicions::NONE,
            sign_ms: None,
            strengths: Strengths::NONE,
            host_height: None,
            rivals: Rivals::NONE,
            gps_minus_utc_s: GPS_MINUS_UTC_S,
            #[cfg(feature = "osnma")]
            trusted: None,
            #[cfg(feature = "osnma")]
            keys: Keys::NONE,
            #[cfg(feature = "osnma")]
            authentication: None,
        }
    }

    /// Discards the last position, the delays of epochs, and the reports of jamming and spoofing.
    pub(super) fn forget(&mut self) {
        self.navigator.forget_position();
        self.lateness.forget();
        (self.interference, self.sign_ms, self.host_height) = (Suspicions::NONE, None, None);
        self.strengths = Strengths::NONE;
        self.rivals = Rivals::NONE;
    }

    /// Discards the delays of epochs, because delays before and after a change of week are not
    /// comparable.
    pub(super) const fn forget_lateness(&mut self) {
        self.lateness.forget();
    }

    /// Returns the alert that forbids any position, however well the ranges agree.
    fn distrust(&self, now_ms: u64) -> Option<Alert> {
        if self.is_spoofed(now_ms) {
            return Some(Alert::Spoofed);
        }
        Some(Alert::Ambiguous).filter(|_| self.rivals.are_near())
    }

    /// Returns the height of an epoch that came at `came_ms`: that of the host, or else that of a
    /// fixed antenna. A height of the host that has expired is discarded and counted.
    fn known_height(&mut self, came_ms: u64) -> Option<Aiding> {
        if !cfg!(feature = "aiding") {
            return None;
        }
        let climb_m_s =
            self.navigator.velocity().map_or(0.0, |velocity| velocity.east_north_up_m_s[2] as f32);
        let of_host = self.host_height.and_then(|height| height.aiding(came_ms, climb_m_s));
        if of_host.is_none() && self.host_height.take().is_some() {
            count(&mut self.verdicts.heights_expired);
        }
        of_host.or_else(|| self.configuration.place.as_ref().map(aiding_of))
    }

    /// Returns true if the receiver reports counterfeit signals and the report withdraws
    /// protection.
    fn is_spoofed(&self, now_ms: u64) -> bool {
        if !cfg!(feature = "ubx") {
            return false;
        }
        let word = &self.interference;
        self.configuration.spoof_flag == SpoofFlag::Hold
            && (word.is_sure() || word.confirms(self.sign_ms, now_ms))
    }

    /// Handles an event; returns true if an epoch was judged.
    pub(super) fn handle<W: Write>(
        &mut self,
        event: &Event<'_>,
        is_behind: bool,
        now_ms: u64,
        host: &mut W,
    ) -> bool {
        match event {
            Event::Epoch(raw, came_ms) => {
                let due_ms = came_ms.saturating_sub(self.lateness.of(raw.time, *came_ms));
                if now_ms.saturating_sub(due_ms) >= self.time_to_alert_ms() {
                    count(&mut self.verdicts.epochs_late);
                    self.lateness.doubt(raw.time, *came_ms);
                    return false;
                }
                if is_behind {
                    count(&mut self.verdicts.epochs_skipped);
                    return false;
                }
                if cfg!(feature = "ubx") {
                    self.interference.age(now_ms);
                }
                if cfg!(feature = "signs") && self.strengths.take(raw, now_ms) {
                    count(&mut self.verdicts.strengths_alike);
                    self.sign_ms = Some(now_ms);
                }
                #[cfg(feature = "osnma")]
                self.demand(now_ms);
                #[cfg(feature = "osnma")]
                let reason = self.forged(raw.time, *came_ms).or_else(|| self.distrust(now_ms));
                #[cfg(not(feature = "osnma"))]
                let reason = self.distrust(now_ms);
                self.navigator.distrust(reason);
                let height = self.known_height(*came_ms);
                self.navigator.know_height(height);
                self.rivals.age();
                let report = self.navigator.judge(raw, *came_ms, &self.configuration);
                report.verdict = match report.verdict {
                    // An alert is not replaced, because it reports that the position is wrong.
                    Verdict::Alert(_) => report.verdict,
                    _ if !self.is_sound => Verdict::Unavailable(Unavailable::SelfTest),
                    _ if !self.is_confirmed => Verdict::Unavailable(Unavailable::Settings),
                    #[cfg(feature = "osnma")]
                    Verdict::Protected(_) if !enough_are_proved(&self.configuration, report) => {
                        Verdict::Unavailable(Unavailable::Unproved)
                    }
                    verdict => verdict,
                };
                if is_sign(report) {
                    self.sign_ms = Some(now_ms);
                }
                if agree(report) {
                    self.lateness.learn(raw.time, *came_ms);
                    self.agreed = Some((raw.time, *came_ms));
                }
                #[cfg(feature = "observer")]
                {
                    self.came_ms = *came_ms;
                }
                self.conclude(raw, due_ms, host);
                return true;
            }
            Event::Ephemeris(ephemeris) => self.learn(ephemeris),
            Event::Redated(present) => {
                self.navigator.redate(*present);
                self.forget_lateness();
            }
            Event::Position(point) => self.navigator.guess(*point),
            Event::Ionosphere(constellation, coefficients) => {
                self.navigator.hear_ionosphere(*constellation, *coefficients, self.last_time);
            }
            #[cfg(feature = "cnav")]
            Event::Cnav(frame) => self.navigator.hear_cnav(frame, now_ms),
            Event::Rivalry(rivalry) => {
                self.rivals.receive(*rivalry);
                self.drive_pin(false);
            }
            Event::SelfReport(_) if !cfg!(feature = "ubx") => {}
            Event::SelfReport(reported) => {
                self.interference.receive(reported, now_ms);
                if self.is_spoofed(now_ms) {
                    self.drive_pin(false);
                }
            }
        }
        false
    }

    // Not inlined, so that its copy of the ephemeris is not on the stack while an epoch is judged.
    #[inline(never)]
    fn learn(&mut self, ephemeris: &Ephemeris) {
        match self.navigator.learn(*ephemeris, self.last_time) {
            Insertion::Taken => {}
            Insertion::Kept => count(&mut self.verdicts.ephemerides_kept),
            Insertion::Disputed => count(&mut self.verdicts.ephemerides_disputed),
        }
    }

    /// Publishes the navigator's report: the pin first, then the sentences.
    ///
    /// Not inlined, so that the stack of the sentences is not needed while an epoch is judged.
    #[inline(never)]
    fn conclude<W: Write>(&mut self, raw: &RawEpoch, due_ms: u64, host: &mut W) {
        let time = raw.time;
        let verdict = self.navigator.report().verdict;
        self.drive_pin(matches!(verdict, Verdict::Protected(_)));
        #[cfg(feature = "osnma")]
        {
            let time = TimeOfDay::new(time, self.gps_minus_utc_s);
            let written = self.tell_authentication(time, due_ms, host);
            self.sent(written.is_ok());
        }
        let report = self.navigator.report();
        self.last_verdict = Some(verdict);
        self.has_report = true;
        self.last_time = Some(time);
        self.last_epoch_ms = due_ms;
        self.sigma_check = report.sigma_check;
        if report.height.is_some_and(|height| !height.is_used) {
            count(&mut self.verdicts.heights_excluded);
        }
        count(match verdict {
            Verdict::Protected(_) => &mut self.verdicts.epochs_protected,
            Verdict::Alert(_) => &mut self.verdicts.epochs_alert,
            Verdict::Unavailable(_) => &mut self.verdicts.epochs_unavailable,
        });
        if report.excluded_constellations != 0 {
            count(&mut self.verdicts.system_excluded);
        }
        let statement = Statement {
            report,
            time,
            gps_minus_utc_s: self.gps_minus_utc_s,
            requirements: &self.configuration.requirements(),
            motion: self.navigator.velocity().map(Motion::of),
            interference: Interference::of(&self.interference),
            settings_hash: self.publisher.settings_hash(),
            #[cfg(feature = "cnav")]
            unhealthy_l5: self.navigator.unhealthy_l5(),
            in_view: cfg!(feature = "gsv").then_some(InView {
                raw,
                satellites: &self.navigator,
                place: self.navigator.place(),
            }),
        };
        let written = self.publisher.tell(&statement, &self.configuration.outputs, host);
        self.observer.epoch(&Judged {
            raw,
            navigator: &self.navigator,
            statement: &statement,
            #[cfg(feature = "observer")]
            came_ms: self.came_ms,
            #[cfg(all(feature = "observer", feature = "osnma"))]
            authentication: self.authentication_report(due_ms),
        });
        self.sent(written.is_ok());
    }

    #[inline(never)]
    pub(super) fn tick<W: Write>(&mut self, now_ms: u64, hears_others: bool, host: &mut W) -> bool {
        // The difference is absolute, so that a caller's clock that wraps round raises the alert.
        if now_ms.abs_diff(self.last_epoch_ms) < self.time_to_alert_ms() {
            return false;
        }
        // The alert is repeated each time that the time to alert has passed again, for a host that
        // connects later.
        self.last_epoch_ms = now_ms;
        let reason = if hears_others { Alert::Source } else { Alert::Stale };
        self.last_verdict = Some(Verdict::Alert(reason));
        self.navigator.interrupt();
        self.has_report = false;
        self.drive_pin(false);
        count(&mut self.verdicts.line_stale);
        let written = self.tell_without_epoch(Verdict::Alert(reason), host);
        self.sent(written.is_ok());
        true
    }

    /// Sends settings and losses if they are due again.
    #[inline(never)]
    pub(super) fn repeat<W: Write>(&mut self, now_ms: u64, losses: &Losses, host: &mut W) {
        let written = self.publisher.tick(now_ms, &self.configuration, losses, host);
        self.sent(written.is_ok());
    }

    fn time_to_alert_ms(&self) -> u64 {
        // Rounds to the nearest without doubles, which are software here, because every tick
        // computes it. The value is at most an hour.
        u64::from((self.configuration.time_to_alert_s as f32 * 1e3 + 0.5) as u32)
    }

    /// Applies the settings that a command has changed. If a promise depends on them, the pin goes
    /// low, because the last verdict was reached under other settings. The result is then true if
    /// that verdict was a promise.
    #[must_use]
    pub(super) fn reconfigure(&mut self) -> bool {
        let hash = self.configuration.promise_hash();
        let bears_on_promise = core::mem::replace(&mut self.promise_hash, hash) != hash;
        if bears_on_promise {
            self.drive_pin(false);
        }
        // It cannot fail, because the command was validated against the same tables.
        let _ = self.navigator.configure(&self.configuration);
        self.publisher.reconfigured(self.configuration.hash());
        bears_on_promise && matches!(self.last_verdict, Some(Verdict::Protected(_)))
    }

    /// Reports that the last verdict depended on settings that are no longer in force.
    #[inline(never)]
    pub(super) fn take_back<W: Write>(&mut self, host: &mut W) -> Result<(), W::Error> {
        let verdict = Verdict::Unavailable(Unavailable::Settings);
        self.last_verdict = Some(verdict);
        self.has_report = false;
        self.tell_without_epoch(verdict, host)
    }

    fn tell_without_epoch<W: Write>(&mut self, verdict: Verdict, host: &mut W) -> Result<(), W::Error> {
        let (publisher, configuration) = (&mut self.publisher, &self.configuration);
        let (last, gps_minus_utc_s) = (self.last_time, self.gps_minus_utc_s);
        let written = publisher.tell_without_epoch(verdict, last, gps_minus_utc_s, configuration, host);
        self.observer.without_epoch(&WithoutEpoch { verdict, last, gps_minus_utc_s, configuration });
        written
    }

    /// Runs the known-answer tests.
    pub(super) fn test_self(&mut self) -> Result<(), Failure> {
        let outcome = selftest::run(self.navigator.workspace());
        self.record_self_test(outcome)
    }

    /// Stores the outcome of the known-answer tests. After a failure no position is protected.
    pub(super) fn record_self_test(&mut self, outcome: Result<(), Failure>) -> Result<(), Failure> {
        if outcome.is_err() {
            self.is_sound = false;
            self.drive_pin(false);
        }
        outcome
    }

    /// Sets the integrity pin.
    pub(super) fn drive_pin(&mut self, usable: bool) {
        let set = if usable && self.is_sound { self.pin.set_high() } else { self.pin.set_low() };
        if set.is_err() {
            count(&mut self.verdicts.pin_failures);
        }
    }

    pub(super) fn sent(&mut self, written: bool) {
        if !written {
            count(&mut self.verdicts.host_lost);
        }
    }
}
