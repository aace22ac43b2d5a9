//! Settings of the module, and the commands that change them.
//!
//! The module answers `$PRAIC,key,value…*CS` with `$PRAIA,key,value…,OK*CS` or with
//! `$PRAIA,key,ERR,why*CS`. A command produces a complete new [`Configuration`] or none, so that a
//! refused command changes nothing.
//!
//! The table in `table.rs` has one row for each setting. Key, field, start value, parsing,
//! reporting, hash, seal and the table of INTERFACES.md follow from the row. A new setting takes
//! one row; a type of value that no other setting has takes one more file.
//!
//! A key without a value returns the value in force, in the words that set it. `HAL`, `VAL`, `PFA`
//! and `PMD` make the phase `CUSTOM`; `TTA` does not. A known word that this build lacks is refused
//! with `not in this build`. The answer repeats the values as they came. If that would exceed 82
//! characters (eight long coefficients), the answer has only the key and `OK`. A command that is
//! obeyed but unwise is answered with `OK,WARN,why`. For example, the thresholds `T2` and `TOP`
//! limit only missed detections. At a limit of 556 m or more, no error that occurs then raises an
//! alarm.

use raim_core::internals::allocation::Allocation;
use raim_core::internals::continuity::{self, ContinuitySettings};
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::detection::threshold::policy::Policy;
use raim_core::monitor::Strategy;
use raim_core::requirements::Requirements;
use raim_single::CAPACITY;

mod fields;
mod ionosphere;
#[cfg(feature = "osnma")]
mod keys;
mod kinds;
#[cfg(feature = "cnav")]
mod l5;
mod line;
mod number;
mod order;
mod outputs;
mod phase;
mod place;
mod port;
mod promises;
mod read;
mod refusal;
mod reported;
mod row;
mod sealed;
mod table;
mod value;
mod word;
mod words;

#[cfg(feature = "osnma")]
pub use keys::{Authentication, PublicKey, TreeRoot};
pub use kinds::{Baud, Frequencies, Heights, Levels, Noise, Recovery, SpoofFlag, Systems};
#[cfg(feature = "cnav")]
pub use l5::L5;
pub use line::MAX_LINE;
pub(crate) use number::hexadecimal;
pub use number::{decimal, scientific};
pub use order::Order;
pub use phase::Phase;
pub use place::Place;
pub use port::{Action, CommandPort, Heard};
pub use promises::{Preset, Promises};
pub use refusal::Refusal;
pub use sealed::{SEALED_BYTES, Unsealed};
pub use table::{Configuration, Documentation, PhaseEffect, Row, Setting};

use read::{Values, none};

/// Horizontal limit, m, from which the thresholds that limit missed detections alone exceed any
/// error that occurs. At 556 m, `T2` and `TOP` alarmed in none of 986 real epochs with errors up to
/// 158 m.
const WIDE_LIMIT_M: f64 = 556.0;

/// Factor from degrees to radians.
const RAD: f64 = core::f64::consts::PI / 180.0;

impl Configuration {
    /// Returns the settings with one of them changed, or the reason for refusing the change.
    fn changed(mut self, setting: Setting, values: Values<'_, '_>) -> Result<Self, Refusal> {
        self.change(setting, values).map(|()| self)
    }

    /// Changes one setting in place. After a refusal the contents must not be used.
    #[inline(never)]
    fn change(&mut self, setting: Setting, values: Values<'_, '_>) -> Result<(), Refusal> {
        let row = setting.row();
        self.value_mut(setting).change(values, row.ranges)?;
        none(values)?;
        match row.phase {
            PhaseEffect::Apart => {}
            PhaseEffect::Enters => self.take_numbers_of_phase(),
            PhaseEffect::Leaves => {
                self.phase = Phase::Custom;
                self.check_requirements()?;
            }
            PhaseEffect::Bounded => {
                if self.time_to_alert_s > self.phase.longest_time_to_alert_s() {
                    return Err(Refusal::OutOfRange);
                }
            }
        }
        Ok(())
    }

    /// Sets the requirements to those of a named phase. `CUSTOM` leaves them unchanged.
    fn take_numbers_of_phase(&mut self) {
        if let Some(required) = self.phase.requirements() {
            self.hal_m = required.hal_m;
            self.val_m = required.val_m;
            self.false_alarm = required.false_alarm;
            self.missed_detection = required.missed_detection;
            self.fault_free_risk = required.fault_free_risk;
            self.time_to_alert_s = required.time_to_alert_s;
        }
    }

    fn check_requirements(&self) -> Result<(), Refusal> {
        self.requirements().validate().map_err(|_| Refusal::OutOfRange)?;
        Thresholds::up_to::<CAPACITY>(self.false_alarm, self.missed_detection)?;
        Ok(())
    }

    /// Returns the requirements for the core. Under `CUSTOM`, ARAIM's allocation of the risk
    /// follows from the present values, never from an earlier phase.
    pub const fn requirements(&self) -> Requirements {
        let mut required = match self.phase.requirements() {
            Some(required) => required,
            None => Requirements::non_precision_approach(),
        };
        if matches!(self.phase, Phase::Custom) && self.val_m.is_some() {
            required.allocation = Allocation::vertical();
        }
        required.hal_m = self.hal_m;
        required.val_m = self.val_m;
        required.false_alarm = self.false_alarm;
        required.missed_detection = self.missed_detection;
        required.fault_free_risk = self.fault_free_risk;
        required.time_to_alert_s = self.time_to_alert_s;
        required
    }

    /// Returns the elevation mask, rad.
    pub const fn mask_rad(&self) -> f64 {
        self.mask_deg * RAD
    }

    /// Returns a warning if the threshold hardly ever raises an alarm.
    pub fn warning(&self) -> Option<&'static str> {
        let warning = match self.policy {
            Policy::T2 => "T2 hardly ever alarms at this HAL",
            Policy::TOp => "TOP hardly ever alarms at this HAL",
            _ => return None,
        };
        (self.hal_m >= WIDE_LIMIT_M).then_some(warning)
    }

    /// Returns a warning if ARAIM does not monitor satellite faults.
    fn warning_of_promises(&self) -> Option<&'static str> {
        self.promises.leaves_faults_unwatched().then_some("faults so unlikely are not watched for")
    }

    /// Returns a warning if ephemerides are to be proved and nothing can prove them.
    #[cfg(feature = "osnma")]
    fn warning_of_keys(&self) -> Option<&'static str> {
        let is_keyless = self.own_key.is_none() && self.own_root.is_none();
        (is_keyless && self.authentication >= Authentication::Prefer)
            .then_some("nothing is proved or false without KEY or ROOT")
    }

    /// Returns true if L5 is used only where the satellite calls it healthy: by `L5,HEALTHY`, and
    /// for ARAIM by the presets of ICAO, whose probabilities are promised for healthy signals alone.
    #[cfg(feature = "cnav")]
    pub(crate) fn needs_healthy_l5(&self) -> bool {
        #[cfg(feature = "araim")]
        if self.method == raim_core::monitor::Method::Araim && self.promises.is_of_icao() {
            return true;
        }
        self.l5 == L5::Healthy
    }

    /// Returns the strategy of the core's monitor.
    pub const fn strategy(&self) -> Strategy {
        Strategy::DEFAULT
            .with_policy(self.policy)
            .with_method(self.method)
            .with_levels(self.levels)
            .with_clock_aid(self.clock_aid)
            .with_noise(self.noise)
    }

    /// Returns the limits of the antenna's motion, and the time for which satellites must agree
    /// after an alert.
    pub const fn continuity(&self) -> ContinuitySettings {
        ContinuitySettings::anywhere()
            .with_max_speed_m_s(self.greatest_speed_m_s)
            .with_min_height_m(self.heights.least_m)
            .with_max_height_m(self.heights.greatest_m)
            .with_recovery(continuity::Recovery {
                epochs: self.recovery.epochs as u16,
                seconds: self.recovery.seconds,
            })
    }
}

#[cfg(test)]
mod toy;
