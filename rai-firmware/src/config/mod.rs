//! Configuration of the module, and the commands that change it.
//!
//! `$PRAIC,key,value…*CS` is answered with `$PRAIA,key,value…,OK*CS` or with `$PRAIA,key,ERR,why*CS`. A command
//! makes a whole new [`Configuration`] or none: what is refused changes nothing.
//!
//! | key | values | at start | unit |
//! |---|---|---|---|
//! | `PHASE` | `ENROUTE`, `TERMINAL`, `NPA`, `LPV200`; `CUSTOM` keeps the present numbers | `NPA` | |
//! | `HAL` | 0.1 to 99999.9 | 556 | m |
//! | `VAL` | 0.1 to 99999.9, or `OFF` | `OFF` | m |
//! | `PFA`, `PMD` | a probability of the committed tables | 3.33e-7, 1e-3 | |
//! | `PFF` | 1e-12 to 0.01 | 1e-7 | |
//! | `TTA` | 0.1 to what the phase allows: 60, 30, 10, 6, 3600 in the order above | 10 | s |
//! | `POLICY` | `T1`, `T2`, `TOP` | `T1` | |
//! | `METHOD` | `AUTO`, `BAARDA`, `SIMULTANEOUS`, `SEQUENTIAL`, `HYBRID`, `GROUPING`, `RANSAC`, `SEPARATION` | `AUTO` | |
//! | `LEVELS` | `BOUND`, `SLOPE` | `BOUND` | |
//! | `SYSTEMS` | letters of `GRECJ`; GLONASS widens ARAIM levels, for it is the least sure of its own health | `GEC` | |
//! | `MASK` | 0 to 60 | 10 | ° |
//! | `CLOCKAID` | `ON`, `OFF` | `OFF` | |
//! | `CN0MASK` | 0 to 55 | 28 | dB-Hz |
//! | `VMAX` | 1 to 10000 | 515 | m/s |
//! | `HEIGHT` | least, greatest: −12000 to 2000000 | −500, 20000 | m |
//! | `RECOVER` | epochs 1 to 100, seconds 0 to 600 | 3, 3 | –, s |
//! | `FREQ` | `AUTO`, `DUAL`, `SINGLE` | `AUTO` | |
//! | `SIGMA` | `FIXED`, `ADAPT` | `FIXED` | |
//! | `BAUD` | `AUTO`, 9600, 38400, 115200, 230400, 460800, 921600 | `AUTO` | bit/s |
//! | `IONO` | 4 α, 4 β, not all zero; or `AUTO`: what satellites broadcast | `AUTO` | s, s/semicircle, … as broadcast |
//! | `ISM` | `ICAO`, `RESEARCH`: presets of [`rai_core::weighting::Ism`], for `SEPARATION`; with `-AIR` the noise is that of an antenna on an aircraft. Or one system: its letter (of `GREC`), URA, URE, `b_nom`, `P_sat`, `P_const`, until the next preset ([`Promises`]) | `ICAO` | m, –, as there |
//! | `OUTPUT` | an item of [`crate::output::schedule`], every how many epochs: 0 (never) to 255 | as there | |
//! | `STATS`, `SELFTEST`, `CONFIRM`, `FORGET`, `RESET` | none: an [`Action`] | | |
//!
//! A key without a value answers what is in force, in the words that set it. `HAL`, `VAL`, `PFA` and `PMD` make the
//! phase `CUSTOM`; `TTA` does not. What is known here but not built in is refused with `not in this build`
//! ([`Key::is_built`], and words of [`Command`]): nothing is accepted that is not done. The answer repeats the values as
//! they came; where that would make it longer than 82 characters (eight long coefficients), it carries the key and `OK`
//! alone. What is obeyed but hardly wise is answered with `OK,WARN,why`: the thresholds `T2` and `TOP` hold missed
//! detections down and nothing else, and at a limit of 556 m and more that is no alarm at any error that occurs.
//!
//! References: [IS-GPS-200] table 20-X for the range of the ionospheric coefficients.
//!
//! [IS-GPS-200]: crate#references

use rai_core::allocation::Allocation;
use rai_core::continuity::{self, ContinuitySettings};
use rai_core::integrity::raim::detection::threshold::Thresholds;
use rai_core::integrity::raim::detection::threshold::policy::Policy;
use rai_core::monitor::{Method, Strategy};
use rai_core::requirements::Requirements;
use rai_core::weighting::Ism;

use crate::output::schedule::Schedule;

mod command;
mod fields;
mod key;
mod line;
mod number;
mod phase;
mod port;
mod promises;
mod refusal;
mod said;
mod sealed;
mod setting;
mod value;
mod words;

pub use command::Command;
pub use key::Key;
pub use line::MAX_LINE;
pub(crate) use number::hexadecimal;
pub use number::{decimal, scientific};
pub use phase::Phase;
pub use port::{Action, CommandPort, Heard};
pub use promises::Promises;
pub use refusal::Refusal;
pub use sealed::{SEALED_BYTES, Unsealed};
pub use setting::{Frequencies, Heights, Levels, Recovery, Setting, Sigma, Systems};

/// Everything that a command can change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Configuration {
    /// Where the requirements come from.
    pub phase: Phase,
    /// What is required of the position.
    pub requirements: Requirements,
    /// Satellites below this elevation are left out, rad.
    pub mask_rad: f64,
    /// Threshold of the global test.
    pub policy: Policy,
    /// Identification of the faulty satellite.
    pub method: Method,
    /// Is the predicted receiver clock used as an aiding row?
    pub clock_aid: bool,
    /// Broadcast coefficients of the single-frequency ionospheric model, α0 to α3 and β0 to β3.
    pub klobuchar: Option<[f64; 8]>,
    /// What the protection levels hold.
    pub levels: Levels,
    /// Who takes part.
    pub systems: Systems,
    /// Signals weaker than this are left out, dB-Hz.
    pub signal_mask_db_hz: f64,
    /// The receiver moves no faster than this, m/s.
    pub greatest_speed_m_s: f64,
    /// Where the receiver can be.
    pub heights: Heights,
    /// How long satellites must agree after an alert.
    pub recovery: Recovery,
    /// One frequency or two.
    pub frequencies: Frequencies,
    /// Where the sigmas come from.
    pub sigma: Sigma,
    /// Bit rate of the GNSS port; `None` finds out.
    pub bit_rate: Option<u32>,
    /// What is promised of the satellites, for [`Method::Araim`].
    pub promises: Promises,
    /// What is sent, how often.
    pub outputs: Schedule,
}

/// From this horizontal limit on, the thresholds that only hold missed detections down lie above any error that
/// occurs: at 556 m, `T2` and `TOP` alarmed in none of 986 real epochs with errors up to 158 m.
const WIDE_LIMIT_M: f64 = 556.0;

/// Elevation mask at start: below 10° the atmosphere's error grows faster than the geometry gains, rad.
const MASK_RAD: f64 = 10.0 * core::f64::consts::PI / 180.0;

impl Configuration {
    /// As the module starts: non-precision approach, 10° mask, no ionospheric coefficients.
    pub const fn at_start() -> Self {
        Self {
            phase: Phase::NonPrecisionApproach,
            requirements: Requirements::non_precision_approach(),
            mask_rad: MASK_RAD,
            policy: Policy::T1,
            method: Method::Auto,
            clock_aid: false,
            klobuchar: None,
            levels: Levels::Bound,
            systems: Systems::AT_START,
            signal_mask_db_hz: 28.0,
            greatest_speed_m_s: 515.0,
            heights: Heights { least_m: -500.0, greatest_m: 20_000.0 },
            recovery: Recovery { epochs: 3, seconds: 3.0 },
            frequencies: Frequencies::Auto,
            sigma: Sigma::Fixed,
            bit_rate: None,
            promises: Promises::preset(Ism::ICAO),
            outputs: Schedule::AT_START,
        }
    }

    /// This configuration with one thing changed.
    ///
    /// # Errors
    /// [`Refusal`] where the result could not be used: a probability without thresholds, a limit out of its range.
    pub fn with(mut self, setting: Setting) -> Result<Self, Refusal> {
        self.change(setting).map(|()| self)
    }

    /// As [`Self::with`], in place: what is refused leaves settings that nobody may use.
    #[inline(never)]
    fn change(&mut self, setting: Setting) -> Result<(), Refusal> {
        match setting {
            Setting::Phase(phase) => {
                self.enter(phase);
                return Ok(());
            }
            Setting::TimeToAlert(time_s) => return self.alert_within(time_s),
            Setting::HorizontalAlertLimit(limit_m) => self.requirements.hal_m = limit_m,
            Setting::VerticalAlertLimit(limit_m) => self.requirements.val_m = limit_m,
            Setting::FalseAlarm(probability) => self.requirements.false_alarm = probability,
            Setting::MissedDetection(probability) => self.requirements.missed_detection = probability,
            other => {
                self.choose(other);
                return Ok(());
            }
        }
        self.enter(Phase::Custom);
        self.requirements.validate().map_err(|_| Refusal::OutOfRange)?;
        Thresholds::from_tables(self.requirements.false_alarm, self.requirements.missed_detection)?;
        Ok(())
    }

    /// Changes what is no requirement: any value within its range will do.
    fn choose(&mut self, setting: Setting) {
        match setting {
            Setting::Policy(policy) => self.policy = policy,
            Setting::Method(method) => self.method = method,
            Setting::Levels(levels) => self.levels = levels,
            Setting::FaultFree(probability) => self.requirements.fault_free_risk = probability,
            Setting::Systems(systems) => self.systems = systems,
            Setting::Mask(mask_rad) => self.mask_rad = mask_rad,
            Setting::ClockAid(clock_aid) => self.clock_aid = clock_aid,
            Setting::SignalMask(mask_db_hz) => self.signal_mask_db_hz = mask_db_hz,
            Setting::GreatestSpeed(speed_m_s) => self.greatest_speed_m_s = speed_m_s,
            Setting::Heights(heights) => self.heights = heights,
            Setting::Recovery(recovery) => self.recovery = recovery,
            Setting::Frequencies(frequencies) => self.frequencies = frequencies,
            Setting::Sigma(sigma) => self.sigma = sigma,
            Setting::BitRate(bit_rate) => self.bit_rate = bit_rate,
            Setting::Ionosphere(coefficients) => self.klobuchar = coefficients,
            Setting::Support(ism) => self.promises = Promises::preset(ism),
            Setting::SupportOf(constellation, support) => {
                self.promises = self.promises.with(constellation, support);
            }
            Setting::Output(item, every) => self.outputs = self.outputs.with(item, every),
            Setting::Phase(_)
            | Setting::TimeToAlert(_)
            | Setting::HorizontalAlertLimit(_)
            | Setting::VerticalAlertLimit(_)
            | Setting::FalseAlarm(_)
            | Setting::MissedDetection(_) => {}
        }
    }

    /// Takes another time to alert, which a phase bounds and which does not make it another phase.
    fn alert_within(&mut self, time_s: f64) -> Result<(), Refusal> {
        if time_s > self.phase.longest_time_to_alert_s() {
            return Err(Refusal::OutOfRange);
        }
        self.requirements.time_to_alert_s = time_s;
        Ok(())
    }

    /// What whoever chose this ought to know of it.
    pub fn warning(&self) -> Option<&'static str> {
        match self.policy {
            Policy::T2 if self.requirements.hal_m >= WIDE_LIMIT_M => {
                Some("T2 hardly ever alarms at this HAL")
            }
            Policy::TOp if self.requirements.hal_m >= WIDE_LIMIT_M => {
                Some("TOP hardly ever alarms at this HAL")
            }
            _ => None,
        }
    }

    /// The same of what is promised of the satellites.
    fn warning_of_promises(&self) -> Option<&'static str> {
        self.promises.leaves_faults_unwatched().then_some("faults so unlikely are not watched for")
    }

    /// How the core is to monitor.
    pub const fn strategy(&self) -> Strategy {
        Strategy {
            policy: self.policy,
            method: self.method,
            levels: self.levels,
            clock_aid: self.clock_aid,
            sigma_adapt: matches!(self.sigma, Sigma::Adapted),
        }
    }

    /// What the receiver can do, and how long its satellites must agree after an alert.
    pub const fn continuity(&self) -> ContinuitySettings {
        ContinuitySettings {
            max_speed_m_s: self.greatest_speed_m_s,
            min_height_m: self.heights.least_m,
            max_height_m: self.heights.greatest_m,
            recovery: continuity::Recovery {
                epochs: self.recovery.epochs as u16,
                seconds: self.recovery.seconds,
            },
        }
    }

    /// Takes the requirements of a phase. In nobody's phase the numbers stay, and how ARAIM spends the risk follows from them: of the
    /// phase before, nothing would be left to see.
    fn enter(&mut self, phase: Phase) {
        self.phase = phase;
        match phase.requirements() {
            Some(requirements) => self.requirements = requirements,
            None if self.requirements.val_m.is_some() => {
                self.requirements.allocation = Allocation::vertical();
            }
            None => self.requirements.allocation = Allocation::horizontal(),
        }
    }
}
