//! Residuals of the ranges of an epoch, one for each satellite.

use core::mem::MaybeUninit;

use raim_core::epoch::{Epoch, Observation};
use raim_core::report::Report;

use crate::monitor::{last, rai_monitor_t};
use crate::pointer::{places, status_of};
#[cfg(feature = "receiver")]
use crate::receiver::{at, rai_receiver_t};
use crate::status::{RAI_STATUS_MISALIGNED, RAI_STATUS_NULL, RAI_STATUS_SHORT, rai_status_t};

/// Residual of one satellite's range.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rai_residual_t {
    /// Range minus distance and receiver clock, m: positive for a range that is too long; NaN if no
    /// satellite of its system is used. The residual of an excluded satellite is its bias.
    pub residual_m: f64,
    /// Standard deviation of the range, m.
    pub sigma_m: f64,
    /// System of the satellite, a letter: `RAI_SYSTEM_…`.
    pub system: u8,
    /// Number of the satellite within the system.
    pub number: u8,
    /// True (1) if the satellite is part of the position, else 0.
    pub is_used: u8,
    /// Reserved for later use.
    pub reserved: [u8; 5],
}

const _: () = assert!(size_of::<rai_residual_t>() == 24, "a field came or moved: raise RAI_ABI_VERSION");

impl rai_residual_t {
    fn of<const N: usize>(observation: &Observation, report: &Report<N>) -> Self {
        let (letter, number) = observation.satellite.name();
        let solution = report.solution.as_ref();
        Self {
            residual_m: solution
                .and_then(|solution| solution.residual_m::<f32>(observation))
                .unwrap_or(f64::NAN),
            sigma_m: observation.sigma_m,
            // The letters are ASCII.
            system: letter as u8,
            number,
            is_used: report.used.contains(&observation.satellite).into(),
            reserved: [0; 5],
        }
    }
}

/// Writes the residuals of an epoch with a position; none of one without.
fn write<const N: usize>(
    epoch: &Epoch<N>,
    report: &Report<N>,
    places: &mut [MaybeUninit<rai_residual_t>],
) -> Result<usize, rai_status_t> {
    let observations = if report.solution.is_some() { epoch.observations() } else { &[] };
    if places.len() < observations.len() {
        return Err(RAI_STATUS_SHORT);
    }
    for (place, observation) in places.iter_mut().zip(observations) {
        place.write(rai_residual_t::of(observation, report));
    }
    Ok(observations.len())
}

/// Stores a number behind a caller's pointer, after the call that may refuse.
///
/// # Safety
/// `count` is null or points to a number that no other code uses during the call.
#[allow(unsafe_code)]
pub(crate) unsafe fn counted(
    count: *mut usize,
    call: impl FnOnce() -> Result<usize, rai_status_t>,
) -> Result<(), rai_status_t> {
    if count.is_null() {
        return Err(RAI_STATUS_NULL);
    }
    if !count.is_aligned() {
        return Err(RAI_STATUS_MISALIGNED);
    }
    let known = call()?;
    // SAFETY: not null, aligned, and not shared during the call.
    unsafe { count.write(known) };
    Ok(())
}

/// Writes the residuals of the epoch that the last call of `rai_monitor_judge` has judged, and
/// their number to `count`. Without a position there are none.
///
/// Refuses a `capacity` below the number of satellites; `RAI_MAX_SATELLITES` is always enough.
///
/// # Safety
/// `monitor` is null or points to memory of that size with initialised contents, not used elsewhere
/// during the call. `residuals` is null or points to `capacity` residuals, `count` is null or
/// points to a number.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_monitor_residuals(
    monitor: *const rai_monitor_t,
    residuals: *mut rai_residual_t,
    capacity: usize,
    count: *mut usize,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let (last, places) = unsafe { (last(monitor), places(residuals, capacity)) };
    let write = || last.and_then(|(epoch, report)| write(epoch, report, places?));
    // SAFETY: guaranteed by the caller.
    status_of(unsafe { counted(count, write) })
}

/// Writes the residuals of the last epoch, after all corrections, and their number to `count`.
/// Without a position, and after a silence, there are none.
///
/// Refuses a `capacity` below the number of satellites; `RAI_MAX_SATELLITES` is always enough.
///
/// # Safety
/// As for `rai_receiver_pin`; `residuals` is null or points to `capacity` residuals, `count` is
/// null or points to a number.
#[cfg(feature = "receiver")]
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_residuals(
    receiver: *const rai_receiver_t,
    residuals: *mut rai_residual_t,
    capacity: usize,
    count: *mut usize,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let (receiver, places) = unsafe { (at(receiver), places(residuals, capacity)) };
    let write = || {
        let (receiver, places) = (receiver?, places?);
        receiver
            .last_epoch()
            .zip(receiver.last_report())
            .map_or(Ok(0), |(epoch, report)| write(epoch, report, places))
    };
    // SAFETY: guaranteed by the caller.
    status_of(unsafe { counted(count, write) })
}
