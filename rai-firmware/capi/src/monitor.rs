//! Ranges in, verdict out.

use rai_core::epoch::{Epoch, Observation};
use rai_core::frame::Ecef;
use rai_core::monitor::{MonitorError, Search};
use rai_core::satellite::SatelliteId;
use rai_core::single::{self, CAPACITY, Monitor, MonitorWorkspace};

use crate::pointer::{Object, can_give, give, slice, status_of, take};
use crate::settings::{rai_settings_t, refusal_of};
#[allow(clippy::wildcard_imports)] // The statuses are all of the module.
use crate::status::*;
use crate::storage::{RAI_MAX_SATELLITES, RAI_MONITOR_SIZE, RAI_MONITOR_WORDS};
use crate::verdict::rai_verdict_t;

const _: () = assert!(RAI_MAX_SATELLITES == CAPACITY);

/// A monitor's memory. What is in it is the library's affair; all that counts is its size and that it is aligned.
#[repr(C)]
pub struct rai_monitor_t {
    /// Not for reading.
    pub opaque: [u64; RAI_MONITOR_WORDS],
}

type Stored = Object<Watch, 1>;

/// A monitor with the epoch that is being judged and what a search keeps, so that neither takes stack.
struct Watch {
    /// As it was made, or was not: to take it out of the result would lay it out on the stack.
    made: Result<Monitor, MonitorError>,
    memory: MonitorWorkspace,
    epoch: Epoch<CAPACITY>,
}

impl Watch {
    fn monitor(&mut self) -> Result<&mut Monitor, rai_status_t> {
        self.made.as_mut().map_err(|&mut error| refusal_of(error))
    }
}

const _: () = assert!(
    size_of::<Stored>() <= RAI_MONITOR_SIZE && align_of::<Stored>() <= align_of::<rai_monitor_t>(),
    "the monitor has outgrown RAI_MONITOR_SIZE: raise it, and RAI_ABI_VERSION with it"
);

// The same for linker scripts, and for whoever reads the library without running it.
#[cfg(target_os = "none")]
core::arch::global_asm!(
    ".globl __rai_monitor_bytes",
    ".set __rai_monitor_bytes, {}",
    const size_of::<Stored>()
);

/// One satellite's corrected range and where the satellite was when it sent the signal.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rai_range_t {
    /// Satellite position in the earth-fixed frame at the instant of transmission, m.
    pub x_m: f64,
    /// The same.
    pub y_m: f64,
    /// The same.
    pub z_m: f64,
    /// Pseudorange corrected for satellite clock, relativity, group delay and atmosphere, m.
    pub range_m: f64,
    /// Standard deviation of `range_m`, m.
    pub sigma_m: f64,
    /// The satellite's system, a letter: `RAI_SYSTEM_…`.
    pub system: u8,
    /// Its number within the system, 1 to 99.
    pub number: u8,
    /// For later use; 0.
    pub reserved: [u8; 6],
}

const _: () = assert!(size_of::<rai_range_t>() == 48, "a field came or moved: raise RAI_ABI_VERSION");

/// Makes a monitor that knows no position yet in memory of the caller.
///
/// Refuses null and misaligned pointers, less than `rai_monitor_size()` bytes, and settings by what is wrong with them; memory that
/// held a monitor holds it still then.
///
/// # Safety
/// `memory` is null or points to `length` bytes that nobody else uses during the call; `settings` is null or points to a struct
/// of the size that it begins with.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_monitor_init(
    memory: *mut rai_monitor_t,
    length: usize,
    settings: *const rai_settings_t,
) -> rai_status_t {
    // SAFETY: as promised by the caller.
    let (room, settings) =
        unsafe { (Stored::room(memory.cast(), length), take(settings, rai_settings_t::at_start())) };
    status_of(room.and_then(|room| {
        let settings = settings?;
        let requirements = settings.checked()?;
        // SAFETY: all fields are written.
        unsafe {
            room.fill(
                |watch: *mut Watch| {
                    (&raw mut (*watch).made).write(Monitor::new(requirements));
                    (&raw mut (*watch).memory).write(MonitorWorkspace::new());
                    (&raw mut (*watch).epoch).write(Epoch::new(0.0));
                },
                |watch| configure(watch.monitor()?, &settings),
            )
        }
    }))
}

/// Replaces the settings; what is remembered stays. Refused settings change nothing.
///
/// # Safety
/// `monitor` is null or points to memory of that size with initialised contents, not used elsewhere during the call; `settings`
/// is null or points to a struct of the size that it begins with.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_monitor_configure(
    monitor: *mut rai_monitor_t,
    settings: *const rai_settings_t,
) -> rai_status_t {
    // SAFETY: as promised by the caller.
    let watch = unsafe { Stored::at(monitor.cast()) };
    // SAFETY: as promised by the caller.
    let settings = unsafe { take(settings, rai_settings_t::at_start()) };
    status_of(watch.and_then(|watch| configure(watch.monitor()?, &settings?)))
}

// Not inlined, as what checks the settings.
#[inline(never)]
fn configure(monitor: &mut Monitor, settings: &rai_settings_t) -> Result<(), rai_status_t> {
    // All is read before anything is changed.
    let (strategy, continuity) = (settings.strategy()?, settings.continuity()?);
    monitor.set_requirements(settings.requirements()?).map_err(refusal_of)?;
    monitor.set_strategy(strategy);
    monitor.set_continuity(continuity).map_err(|_| RAI_STATUS_SETTING)
}

/// The last position counts for nothing: the next may be anywhere.
///
/// # Safety
/// `monitor` is null or points to memory of that size with initialised contents, not used elsewhere during the call.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_monitor_forget(monitor: *mut rai_monitor_t) -> rai_status_t {
    // SAFETY: as promised by the caller.
    status_of(unsafe { Stored::at(monitor.cast()) }.and_then(|watch| {
        watch.monitor()?.forget_position();
        Ok(())
    }))
}

/// Judges one epoch: `count` ranges of one instant.
///
/// `time_s` counts seconds of any continuous time scale. A range that cannot be one is left out and counted in the verdict; the
/// others are judged. The verdict is written whenever the status is `RAI_STATUS_OK`, and only then.
///
/// # Safety
/// `monitor` is null or points to memory of that size with initialised contents, not used elsewhere during the call; `ranges` is
/// null or points to `count` ranges; `verdict` is null or points to a struct of the size that it begins with.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_monitor_judge(
    monitor: *mut rai_monitor_t,
    time_s: f64,
    ranges: *const rai_range_t,
    count: usize,
    verdict: *mut rai_verdict_t,
) -> rai_status_t {
    // SAFETY: as promised by the caller.
    let arguments = unsafe { (Stored::at(monitor.cast()), slice(ranges, count), can_give(verdict)) };
    let (watch, ranges) = match arguments {
        (Ok(watch), Ok(ranges), Ok(())) => (watch, ranges),
        (Err(status), ..) | (_, Err(status), _) | (.., Err(status)) => return status,
    };
    if !time_s.is_finite() {
        return RAI_STATUS_TIME;
    }
    status_of(judge(watch, time_s, ranges).and_then(|judged| {
        // SAFETY: as promised by the caller.
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
    let assessment = single::judge(monitor, &watch.epoch, start, Search::Anew, None, &mut watch.memory);
    monitor.learn(assessment, None);
    Ok(rai_verdict_t { refused_count, refused_status, ..rai_verdict_t::of(&assessment.report) })
}

fn add(epoch: &mut Epoch<CAPACITY>, range: &rai_range_t) -> Result<(), rai_status_t> {
    let satellite = SatelliteId::from_name(range.system.into(), range.number).ok_or(RAI_STATUS_SATELLITE)?;
    let position = Ecef::new(range.x_m, range.y_m, range.z_m);
    let observation = Observation { satellite, position, range_m: range.range_m, sigma_m: range.sigma_m };
    epoch.push(observation).map_err(of_refused_range)
}

/// Bytes that a monitor takes here; at most `RAI_MONITOR_SIZE`.
#[unsafe(no_mangle)]
pub extern "C" fn rai_monitor_size() -> usize {
    size_of::<Stored>()
}

/// The alignment that a monitor needs here, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn rai_monitor_align() -> usize {
    align_of::<Stored>()
}
