//! Requirements on a position, and the strategy that monitors it.

use raim_core::internals::allocation::Allocation;
use raim_core::internals::continuity::{ContinuityError, ContinuitySettings, Recovery};
use raim_core::internals::integrity::Method;
use raim_core::internals::integrity::raim::detection::threshold::policy::Policy;
use raim_core::internals::integrity::raim::detection::threshold::{ThresholdError, Thresholds};
#[cfg(feature = "searches")]
use raim_core::internals::integrity::raim::isolation::parity::Isolation;
use raim_core::internals::integrity::raim::levels::Levels;
use raim_core::internals::numeric::probability::Probability;
use raim_core::monitor::{MonitorError, Noise, Strategy};
use raim_core::requirements::{Requirements, RequirementsError};
use raim_single::CAPACITY;

use crate::pointer::{Versioned, give, status_of};
#[allow(clippy::wildcard_imports)] // The statuses are all of the module.
use crate::status::*;

/// En route: HAL 3,704 m.
pub const RAI_PHASE_ENROUTE: u8 = 0;
/// Terminal area: HAL 1,852 m.
pub const RAI_PHASE_TERMINAL: u8 = 1;
/// Non-precision approach: HAL 556 m.
pub const RAI_PHASE_NPA: u8 = 2;
/// Localiser performance with vertical guidance: HAL 40 m, VAL 35 m.
pub const RAI_PHASE_LPV200: u8 = 3;

/// Policy: the threshold of the global test follows from the probability of false alarm.
pub const RAI_POLICY_T1: u8 = 0;
/// Policy: the threshold of the global test follows from the probability of missed detection.
pub const RAI_POLICY_T2: u8 = 1;
/// Policy: the threshold of the global test has the least cost of both errors.
pub const RAI_POLICY_TOP: u8 = 2;

/// Method: every group of satellites if their number allows, else the largest w-test.
pub const RAI_METHOD_AUTO: u8 = 0;
/// Method: the largest w-test, repeatedly.
pub const RAI_METHOD_BAARDA: u8 = 1;
/// Method in parity space, all satellites at once. This one and those up to RANSAC need the
/// library's feature `searches`.
pub const RAI_METHOD_SIMULTANEOUS: u8 = 2;
/// Method in parity space, one satellite after the other.
pub const RAI_METHOD_SEQUENTIAL: u8 = 3;
/// Method in parity space, the simultaneous search, else the sequential one.
pub const RAI_METHOD_HYBRID: u8 = 4;
/// Method in parity space, every group of satellites.
pub const RAI_METHOD_GROUPING: u8 = 5;
/// Method: consensus of disjoint subsets.
pub const RAI_METHOD_RANSAC: u8 = 6;
/// Method: ARAIM, which compares solutions with and without every plausible set of satellites. It
/// takes the probabilities of faults from the ICAO's standards, and needs the library's feature
/// `araim`.
pub const RAI_METHOD_SEPARATION: u8 = 7;

/// Protection levels bound the error of a protected position, fault and noise together.
pub const RAI_LEVELS_BOUND: u8 = 0;
/// Protection levels are the mean error under the worst missed fault, as in the papers.
pub const RAI_LEVELS_SLOPE: u8 = 1;

/// Requirements on a position, and the strategy that monitors it. Fill it with
/// `rai_settings_preset`, then change single fields.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rai_settings_t {
    /// `sizeof(rai_settings_t)`, set by the caller.
    pub size: u32,
    /// Threshold of the global test, `RAI_POLICY_…`.
    pub policy: u8,
    /// Method that finds faulty satellites, `RAI_METHOD_…`.
    pub method: u8,
    /// Clock aiding: if not 0, a forecast of the receiver clock adds a row to the equations.
    pub clock_aid: u8,
    /// Kind of protection levels, `RAI_LEVELS_…`.
    pub levels: u8,
    /// Horizontal alert limit, m.
    pub hal_m: f64,
    /// Vertical alert limit, m; 0 if only the horizontal position matters.
    pub val_m: f64,
    /// Probability of a false alarm per epoch, from the committed tables.
    pub false_alarm: f64,
    /// Probability of missing a significant fault, from the committed tables.
    pub missed_detection: f64,
    /// Highest speed of the receiver, m/s: a position farther from the last one is an alert,
    /// `RAI_REASON_JUMP`.
    pub max_speed_m_s: f64,
    /// Least height above the ellipsoid, m.
    pub min_height_m: f64,
    /// Greatest height above the ellipsoid, m.
    pub max_height_m: f64,
    /// Time for which satellites must agree after an alert, s.
    pub recovery_s: f64,
    /// Number of epochs for which satellites must agree after an alert.
    pub recovery_epochs: u16,
    /// Reserved for later use; must be 0.
    pub reserved: [u8; 6],
}

#[allow(unsafe_code)]
// SAFETY: `repr(C)`, its size first, and integers and doubles, of which every pattern of bits is a
// value.
unsafe impl Versioned for rai_settings_t {
    const FIRST_SIZE: usize = 80;
}

const _: () =
    assert!(size_of::<rai_settings_t>() == 80, "a field came or moved: raise RAI_ABI_VERSION if it moved");

/// Fills settings with those of a phase of flight, `RAI_PHASE_…`, and the default method of the
/// module.
///
/// Refuses a null or misaligned pointer, an unknown `size` and an unknown phase.
///
/// # Safety
/// `settings` is null or points to a struct whose `size` states how much of it may be written.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_settings_preset(settings: *mut rai_settings_t, phase: u8) -> rai_status_t {
    let requirements = match phase {
        RAI_PHASE_ENROUTE => Requirements::en_route(),
        RAI_PHASE_TERMINAL => Requirements::terminal(),
        RAI_PHASE_NPA => Requirements::non_precision_approach(),
        RAI_PHASE_LPV200 => Requirements::lpv200(),
        _ => return RAI_STATUS_PHASE,
    };
    // SAFETY: guaranteed by the caller.
    status_of(unsafe { give(settings, &rai_settings_t::of(&requirements)) })
}

impl rai_settings_t {
    /// Returns the settings at start, which fill the missing fields of an earlier version.
    pub(crate) fn at_start() -> Self {
        Self::of(&Requirements::non_precision_approach())
    }

    /// Returns the settings at start, with these requirements.
    pub(crate) fn of(requirements: &Requirements) -> Self {
        let continuity = ContinuitySettings::anywhere();
        Self {
            size: size_of::<Self>() as u32,
            policy: RAI_POLICY_T1,
            method: RAI_METHOD_AUTO,
            clock_aid: 0,
            levels: RAI_LEVELS_BOUND,
            hal_m: requirements.hal_m,
            val_m: requirements.val_m.unwrap_or(0.0),
            false_alarm: requirements.false_alarm.get(),
            missed_detection: requirements.missed_detection.get(),
            max_speed_m_s: continuity.max_speed_m_s,
            min_height_m: continuity.min_height_m,
            max_height_m: continuity.max_height_m,
            recovery_s: continuity.recovery.seconds,
            recovery_epochs: continuity.recovery.epochs,
            reserved: [0; 6],
        }
    }

    /// Returns the requirements for the core.
    pub(crate) fn requirements(&self) -> Result<Requirements, rai_status_t> {
        let base = Requirements::non_precision_approach();
        let val_m = (self.val_m != 0.0).then_some(self.val_m);
        Ok(base
            .with_hal_m(self.hal_m)
            .with_val_m(val_m)
            .with_allocation(val_m.map_or(base.allocation, |_| Allocation::vertical_guidance()))
            .with_false_alarm(Probability::new(self.false_alarm).ok_or(RAI_STATUS_FALSE_ALARM)?)
            .with_missed_detection(
                Probability::new(self.missed_detection).ok_or(RAI_STATUS_MISSED_DETECTION)?,
            ))
    }

    /// Returns the requirements for the core, if it accepts these settings as a whole.
    // Not inlined, so that its stack is not added to that of making the monitor.
    #[inline(never)]
    pub(crate) fn checked(&self) -> Result<Requirements, rai_status_t> {
        self.strategy()?;
        self.continuity()?;
        let requirements = self.requirements()?;
        let valid = requirements.validate().map_err(|error| refusal_of(MonitorError::Requirements(error)))?;
        Thresholds::up_to::<CAPACITY>(valid.false_alarm, valid.missed_detection)
            .map_err(|error| refusal_of(MonitorError::Threshold(error)))?;
        Ok(valid)
    }

    /// Returns the limits of the receiver's motion.
    pub(crate) fn continuity(&self) -> Result<ContinuitySettings, rai_status_t> {
        let recovery = Recovery { epochs: self.recovery_epochs, seconds: self.recovery_s };
        let settings = ContinuitySettings::anywhere()
            .with_max_speed_m_s(self.max_speed_m_s)
            .with_min_height_m(self.min_height_m)
            .with_max_height_m(self.max_height_m)
            .with_recovery(recovery);
        settings.validate().map_err(|error| match error {
            ContinuityError::Speed { .. } => RAI_STATUS_SPEED,
            ContinuityError::Height { .. } => RAI_STATUS_HEIGHT,
            ContinuityError::Recovery { .. } => RAI_STATUS_RECOVERY,
            _ => RAI_STATUS_SETTING,
        })
    }

    /// Returns the strategy of the core.
    pub(crate) fn strategy(&self) -> Result<Strategy, rai_status_t> {
        Ok(Strategy::DEFAULT
            .with_policy(match self.policy {
                RAI_POLICY_T1 => Policy::T1,
                RAI_POLICY_T2 => Policy::T2,
                RAI_POLICY_TOP => Policy::TOp,
                _ => return Err(RAI_STATUS_POLICY),
            })
            .with_method(match self.method {
                RAI_METHOD_AUTO => Method::Auto,
                RAI_METHOD_BAARDA => Method::Baarda,
                #[cfg(feature = "searches")]
                RAI_METHOD_SIMULTANEOUS => Method::Parity(Isolation::Simultaneous),
                #[cfg(feature = "searches")]
                RAI_METHOD_SEQUENTIAL => Method::Parity(Isolation::Sequential),
                #[cfg(feature = "searches")]
                RAI_METHOD_HYBRID => Method::Parity(Isolation::Hybrid),
                #[cfg(feature = "searches")]
                RAI_METHOD_GROUPING => Method::Parity(Isolation::Grouping),
                #[cfg(feature = "searches")]
                RAI_METHOD_RANSAC => Method::Ransac,
                #[cfg(feature = "araim")]
                RAI_METHOD_SEPARATION => Method::Araim,
                _ => return Err(RAI_STATUS_METHOD),
            })
            .with_levels(match self.levels {
                RAI_LEVELS_BOUND => Levels::Bound,
                RAI_LEVELS_SLOPE => Levels::Slope,
                _ => return Err(RAI_STATUS_LEVELS),
            })
            .with_clock_aid(self.clock_aid != 0)
            .with_noise(Noise::Auto))
    }
}

/// Returns the status of a core's refusal of the requirements.
pub(crate) fn refusal_of(error: MonitorError) -> rai_status_t {
    match error {
        MonitorError::Requirements(RequirementsError::HorizontalAlertLimit(_)) => RAI_STATUS_HAL,
        MonitorError::Requirements(RequirementsError::VerticalAlertLimit(_)) => RAI_STATUS_VAL,
        MonitorError::Threshold(ThresholdError::FalseAlarm { .. }) => RAI_STATUS_FALSE_ALARM,
        MonitorError::Threshold(ThresholdError::MissedDetection { .. }) => RAI_STATUS_MISSED_DETECTION,
        _ => RAI_STATUS_SETTING,
    }
}
