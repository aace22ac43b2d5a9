//! Satellites of an epoch, one by one, for a program on a computer: the package for Python.
//!
//! A watcher reads the bytes that a receiver reads, because the receiver reports verdicts and not
//! satellites. It is not part of the header, and it allocates, because only a computer runs it.

use core::mem::MaybeUninit;

use raim::satellites::{Fate, Seen, Watcher};

use crate::pointer::{places, slice, status_of};
use crate::receiver::{at, rai_receiver_t};
use crate::residual::counted;
use crate::status::{RAI_STATUS_NULL, RAI_STATUS_SHORT, rai_status_t};

/// A satellite of an epoch. Unknown values are NaN.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rai_seen_t {
    /// Angle from north over east, rad.
    pub azimuth_rad: f64,
    /// Angle above the horizon, rad.
    pub elevation_rad: f64,
    /// C/N0 of its strongest signal, dB-Hz.
    pub cn0_dbhz: f64,
    /// Range minus distance and receiver clock, m.
    pub residual_m: f64,
    /// Standard deviation of the range, m.
    pub sigma_m: f64,
    /// Residual over its standard deviation.
    pub w_test: f64,
    /// System of the satellite, a letter.
    pub system: u8,
    /// Number of the satellite within the system.
    pub number: u8,
    /// Number of its treatment; 0 if it is used. `rai_fate_text` has the words.
    pub fate: u8,
    /// Reserved for later use.
    pub reserved: [u8; 5],
}

impl rai_seen_t {
    fn of(seen: &Seen) -> Self {
        let (letter, number) = seen.satellite.name();
        let known = |value: Option<f64>| value.unwrap_or(f64::NAN);
        Self {
            azimuth_rad: known(seen.azimuth_rad),
            elevation_rad: known(seen.elevation_rad),
            cn0_dbhz: known(seen.cn0_dbhz),
            residual_m: known(seen.residual_m),
            sigma_m: known(seen.sigma_m),
            w_test: known(seen.w_test),
            // The letters are ASCII.
            system: letter as u8,
            number,
            fate: seen.fate as u8,
            reserved: [0; 5],
        }
    }
}

/// Returns a watcher before the first byte; `rai_watcher_free` releases it.
#[unsafe(no_mangle)]
pub extern "C" fn rai_watcher_make() -> *mut Watcher {
    Box::into_raw(Box::new(Watcher::new()))
}

/// Releases a watcher.
///
/// # Safety
/// `watcher` is null or comes from `rai_watcher_make`, and is not used afterwards.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_watcher_free(watcher: *mut Watcher) {
    if !watcher.is_null() {
        // SAFETY: guaranteed by the caller.
        drop(unsafe { Box::from_raw(watcher) });
    }
}

/// Takes the bytes that the receiver takes next.
///
/// # Safety
/// `watcher` is null or comes from `rai_watcher_make`, and is not used elsewhere during the call.
/// `bytes` is null or points to `count` bytes.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_watcher_hear(
    watcher: *mut Watcher,
    bytes: *const u8,
    count: usize,
    now_ms: u64,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let (watcher, bytes) = unsafe { (watcher.as_mut(), slice(bytes, count)) };
    status_of(watcher.ok_or(RAI_STATUS_NULL).and_then(|watcher| {
        watcher.hear(bytes?, now_ms);
        Ok(())
    }))
}

/// Writes the satellites of the epoch that the receiver has just judged, and their number to
/// `count`. Refuses a `capacity` below the number of satellites; 64 are always enough.
///
/// # Safety
/// As for `rai_watcher_hear` and `rai_receiver_residuals`.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_watcher_view(
    watcher: *mut Watcher,
    receiver: *const rai_receiver_t,
    seen: *mut rai_seen_t,
    capacity: usize,
    count: *mut usize,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let (watcher, receiver, places) =
        unsafe { (watcher.as_mut(), at(receiver), places::<rai_seen_t>(seen, capacity)) };
    let write = || {
        let (watcher, receiver, places) = (watcher.ok_or(RAI_STATUS_NULL)?, receiver?, places?);
        let satellites = watcher.view(receiver).satellites;
        if places.len() < satellites.len() {
            return Err(RAI_STATUS_SHORT);
        }
        places.iter_mut().zip(&satellites).for_each(|(place, one): (&mut MaybeUninit<_>, _)| {
            place.write(rai_seen_t::of(one));
        });
        Ok(satellites.len())
    };
    // SAFETY: guaranteed by the caller.
    status_of(unsafe { counted(count, write) })
}

/// Returns the words of a treatment, without an end mark, and writes their length to `length`; null
/// for an unknown number.
///
/// # Safety
/// `length` is null or points to a number that no other code uses during the call.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_fate_text(fate: u8, length: *mut usize) -> *const u8 {
    // SAFETY: guaranteed by the caller.
    match (Fate::ALL.get(usize::from(fate)), unsafe { length.as_mut() }) {
        (Some(fate), Some(length)) => {
            *length = fate.words().len();
            fate.words().as_ptr()
        }
        _ => core::ptr::null(),
    }
}
