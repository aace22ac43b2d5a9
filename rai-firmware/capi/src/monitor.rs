//! The monitor: ranges in, verdict out.

use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::Ecef;
use raim_core::internals::velocity::VelocityError;
use raim_core::monitor::{MonitorError, Search};
use raim_core::report::Report;
use raim_core::requirements::Requirements;
use raim_core::satellite::SatelliteId;
use raim_single::{CAPACITY, Monitor, MonitorMemory};

use crate::pointer::{Object, can_give, give, slice, status_of, take};
use crate::settings::{rai_settings_t, refusal_of};
#[allow(clippy::wildcard_imports)] // The statuses are all of the module.
use crate::status::*;
use crate::storage::{RAI_MAX_SATELLITES, RAI_MONITOR_SIZE, RAI_MONITOR_WORDS};
use crate::verdict::rai_verdict_t;

const _: () = assert!(RAI_MAX_SATELLITES == CAPACITY);

/// Memory of a monitor. Its contents are private to the library; only its size and alignment
/// matter.
#[repr(C)]
pub struct rai_monitor_t {
    /// Private contents.
    pub opaque: [u64; RAI_MONITOR_WORDS],
}

type Stored = Object<Watch, 1>;

/// A monitor with the epoch under judgement and the memory of a search, so that neither takes
/// stack.
struct Watch {
    /// Result of the construction, because taking the monitor out of it would put it on the stack.
    made: Result<Monitor, MonitorError>,
    memory: MonitorMemory,
    epoch: Epoch<CAPACITY>,
}

impl Watch {
    fn monitor(&mut self) -> Result<&mut Monitor, rai_status_t> {
        self.made.as_mut().map_err(|&mut error| refusal_of(error))
    }
}

/// Returns the last epoch of a monitor and its report.
///
/// # Safety
/// As for `Stored::at`.
#[allow(unsafe_code)]
pub(crate) unsafe fn last<'a>(
    handle: *const rai_monitor_t,
) -> Result<(&'a Epoch<CAPACITY>, &'a Report<CAPACITY>), rai_status_t> {
    // SAFETY: guaranteed by the caller.
    let watch = unsafe { Stored::at(handle.cast_mut().cast()) }?;
    Ok((&watch.epoch, &watch.memory.outcome().report))
}

const _: () = assert!(
    size_of::<Stored>() <= RAI_MONITOR_SIZE && align_of::<Stored>() <= align_of::<rai_monitor_t>(),
    "the monitor has outgrown RAI_MONITOR_SIZE: raise it, and RAI_ABI_VERSION with it"
);

// The same for linker scripts, and for tools that read the library without running it.
#[cfg(target_os = "none")]
core::arch::global_asm!(
    ".globl __rai_monitor_bytes",
    ".set __rai_monitor_bytes, {}",
    const size_of::<Stored>()
);

/// Corrected range of one satellite, with the satellite's position at transmission.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rai_range_t {
    /// Satellite position in the earth-fixed frame at the instant of transmission, x, m.
    pub x_m: f64,
    /// Satellite position in the earth-fixed frame at the instant of transmission, y, m.
    pub y_m: f64,
    /// Satellite position in the earth-fixed frame at the instant of transmission, z, m.
    pub z_m: f64,
    /// Pseudorange corrected for satellite clock, relativity, group delay and atmosphere, m.
    pub range_m: f64,
    /// Standard deviation of `range_m`, m.
    pub sigma_m: f64,
    /// System of the satellite, a letter: `RAI_SYSTEM_…`.
    pub system: u8,
    /// Number of the satellite within the system, 1 to 99.
    pub number: u8,
    /// Reserved for later use; must be 0.
    pub reserved: [u8; 6],
}

const _: () = assert!(size_of::<rai_range_t>() == 48, "a field came or moved: raise RAI_ABI_VERSION");

/// Makes a monitor without a position in memory of the caller.
///
/// Refuses null and misaligned pointers, less than `rai_monitor_size()` bytes, and settings out of
/// their range. A refusal leaves a monitor that was in the memory as it is.
///
/// # Safety
/// `memory` is null or points to `length` bytes that no other code uses during the call. `settings`
/// is null or points to a struct of the size that it begins with.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_monitor_init(
    memory: *mut rai_monitor_t,
    length: usize,
    settings: *const rai_settings_t,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let (room, settings) =
        unsafe { (Stored::room(memory.cast(), length), take(settings, rai_settings_t::at_start())) };
    status_of(room.and_then(|room| {
        let settings = settings?;
        let requirements = settings.checked()?;
        // SAFETY: all fields are written.
        unsafe {
            room.fill(
                |watch: *mut Watch| {
                    make(watch, requirements);
                    Ok(())
                },
                |watch| configure(watch.monitor()?, &settings),
            )
        }
    }))
}

/// Replaces the settings and keeps the state. Refused settings change nothing.
///
/// # Safety
/// `monitor` is null or points to memory of that size with initialised contents, not used elsewhere
/// during the call. `settings` is null or points to a struct of the size that it begins with.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_monitor_configure(
    monitor: *mut rai_monitor_t,
    settings: *const rai_settings_t,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let watch = unsafe { Stored::at(monitor.cast()) };
    // SAFETY: guaranteed by the caller.
    let settings = unsafe { take(settings, rai_settings_t::at_start()) };
    status_of(watch.and_then(|watch| configure(watch.monitor()?, &settings?)))
}

/// Writes all fields.
///
/// # Safety
/// `watch` points to room for it.
// Not inlined, so that its copies are not on the stack beneath what follows.
#[allow(unsafe_code)]
#[inline(never)]
unsafe fn make(watch: *mut Watch, requirements: Requirements) {
    // SAFETY: guaranteed by the caller.
    unsafe {
        (&raw mut (*watch).made).write(Monitor::new(requirements));
        (&raw mut (*watch).memory).write(MonitorMemory::new());
        (&raw mut (*watch).epoch).write(Epoch::new(0.0));
    }
}

// Not inlined, like the check of the settings.
#[inline(never)]
fn configure(monitor: &mut Monitor, settings: &rai_settings_t) -> Result<(), rai_status_t> {
    // All settings are read before any is changed.
    let (strategy, continuity) = (settings.strategy()?, settings.continuity()?);
    monitor.set_requirements(settings.requirements()?).map_err(refusal_of)?;
    monitor.set_strategy(strategy).map_err(|_| RAI_STATUS_METHOD)?;
    monitor.set_continuity(continuity).map_err(|_| RAI_STATUS_SETTING)
}

/// Forgets the last position, so that the next may be anywhere.
///
/// # Safety
/// `monitor` is null or points to memory of that size with initialised contents, not used elsewhere
/// during the call.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_monitor_forget(monitor: *mut rai_monitor_t) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    status_of(unsafe { Stored::at(monitor.cast()) }.and_then(|watch| {
        watch.monitor()?.forget_position();
        Ok(())
    }))
}

/// Judges one epoch: `count` ranges of one instant.
///
/// `time_s` counts seconds of any continuous time scale. An invalid range is left out and counted
/// in the verdict; the others are judged. The verdict is written if, and only if, the status is
/// `RAI_STATUS_OK`.
///
/// # Safety
/// `monitor` is null or points to memory of that size with initialised contents, not used elsewhere
/// during the call. `ranges` is null or points to `count` ranges. `verdict` is null or points to a
/// struct of the size that it begins with.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_monitor_judge(
    monitor: *mut rai_monitor_t,
    time_s: f64,
    ranges: *const rai_range_t,
    count: usize,
    verdict: *mut rai_verdict_t,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let arguments = unsafe { (Stored::at(monitor.cast()), slice(ranges, count), can_give(verdict)) };
    let (watch, ranges) = match arguments {
        (Ok(watch), Ok(ranges), Ok(())) => (watch, ranges),
        (Err(status), ..) | (_, Err(status), _) | (.., Err(status)) => return status,
    };
    if !time_s.is_finite() {
        return RAI_STATUS_TIME;
    }
    status_of(judge(watch, time_s, ranges).and_then(|judged| {
        // SAFETY: guaranteed by the caller.
        unsafe { give(verdict, &judged) }
    }))
}

fn judge(watch: &mut Watch, time_s: f64, ranges: &[rai_range_t]) -> Result<rai_verdict_t, rai_status_t> {
    let monitor = watch.made.as_mut().map_err(|&mut error| refusal_of(error))?;
    watch.epoch.restart(time_s);
    let (mut refused_count, mut refused_status) = (0_u8, RAI_STATUS_OK);
    for range in ranges {
        if let Err(status) = add(&mut watch.epoch, range) {
            if refused_count == 0 {
                refused_status = status;
            }
            refused_count = refused_count.saturating_add(1);
        }
    }
    let start = monitor.start();
    let assessment = raim_single::judge(monitor, &watch.epoch, start, Search::Anew, None, &mut watch.memory);
    monitor.learn(assessment, None, Err(VelocityError::Redundancy));
    Ok(rai_verdict_t { refused_count, refused_status, ..rai_verdict_t::of(&assessment.report) })
}

fn add(epoch: &mut Epoch<CAPACITY>, range: &rai_range_t) -> Result<(), rai_status_t> {
    let satellite = SatelliteId::from_name(range.system.into(), range.number).ok_or(RAI_STATUS_SATELLITE)?;
    let position = Ecef::new(range.x_m, range.y_m, range.z_m);
    let observation = Observation { satellite, position, range_m: range.range_m, sigma_m: range.sigma_m };
    epoch.push(observation).map_err(of_refused_range)
}

/// Returns the bytes of a monitor on this processor, at most `RAI_MONITOR_SIZE`.
#[unsafe(no_mangle)]
pub extern "C" fn rai_monitor_size() -> usize {
    size_of::<Stored>()
}

/// Returns the alignment of a monitor on this processor, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn rai_monitor_align() -> usize {
    align_of::<Stored>()
}
