//! Satellites of an epoch, one by one, and its time, for a program on a computer: the package for
//! Python.
//!
//! The receiver stores the account of its last verdict ([`raim_firmware::observer`]). It is not part
//! of the header, because a microcontroller has no memory for it.

use core::mem::MaybeUninit;

use heapless::Vec;
use raim_firmware::observer::{Account, Fate, Judged, Observer, WithoutEpoch};
use raim_firmware::output::nmea::TimeOfDay;
use raim_firmware::raw::EPOCH_CAPACITY;

use crate::pointer::{places, status_of};
use crate::receiver::{at, rai_receiver_t};
use crate::residual::counted;
use crate::status::{RAI_STATUS_NULL, RAI_STATUS_SHORT, rai_status_t};

/// Account of the last verdict.
#[derive(Debug)]
pub(crate) struct Watch {
    /// Satellites of its epoch in the order of their names; none after a silence.
    accounts: Vec<Account, EPOCH_CAPACITY>,
    /// UTC of the last epoch; `None` before the first.
    utc: Option<TimeOfDay>,
    /// Number of verdicts since start.
    verdicts: usize,
}

impl Watch {
    pub(crate) const fn new() -> Self {
        Self { accounts: Vec::new(), utc: None, verdicts: 0 }
    }
}

impl Observer for Watch {
    fn epoch(&mut self, judged: &Judged<'_>) {
        self.accounts = judged.accounts().take(EPOCH_CAPACITY).collect();
        self.accounts.sort_unstable_by_key(|account| account.satellite);
        (self.utc, self.verdicts) = (Some(judged.utc()), self.verdicts.wrapping_add(1));
    }

    fn without_epoch(&mut self, judged: &WithoutEpoch<'_>) {
        self.accounts.clear();
        (self.utc, self.verdicts) = (judged.utc(), self.verdicts.wrapping_add(1));
    }
}

/// Writes the second of the day in UTC of the last epoch, NaN before the first, and the number of
/// verdicts since start.
///
/// # Safety
/// As for `rai_receiver_report`; `time_s` is null or points to a number that no other code uses during
/// the call, and so does `verdicts`.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_watched(
    receiver: *const rai_receiver_t,
    time_s: *mut f64,
    verdicts: *mut usize,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let (receiver, time_s) = unsafe { (at(receiver), time_s.as_mut()) };
    let write = || {
        let Watch { utc, verdicts, .. } = receiver?.observer();
        *time_s.ok_or(RAI_STATUS_NULL)? = utc.map_or(f64::NAN, TimeOfDay::second_of_day);
        Ok(*verdicts)
    };
    // SAFETY: guaranteed by the caller.
    status_of(unsafe { counted(verdicts, write) })
}

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
    fn of(account: &Account) -> Self {
        let (letter, number) = account.satellite.name();
        let known = |value: Option<f64>| value.unwrap_or(f64::NAN);
        Self {
            azimuth_rad: known(account.azimuth_rad),
            elevation_rad: known(account.elevation_rad),
            cn0_dbhz: known(account.cn0_dbhz),
            residual_m: known(account.residual_m),
            sigma_m: known(account.sigma_m),
            w_test: known(account.w_test),
            // The letters are ASCII.
            system: letter as u8,
            number,
            fate: account.fate as u8,
            reserved: [0; 5],
        }
    }
}

/// Writes the satellites of the epoch that the receiver has judged last, and their number to
/// `count`; none after a silence. Refuses a `capacity` below the number of satellites; 64 are
/// always enough.
///
/// # Safety
/// As for `rai_receiver_residuals`.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_satellites(
    receiver: *const rai_receiver_t,
    seen: *mut rai_seen_t,
    capacity: usize,
    count: *mut usize,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let (receiver, places) = unsafe { (at(receiver), places::<rai_seen_t>(seen, capacity)) };
    let write = || {
        let (receiver, places) = (receiver?, places?);
        let Watch { accounts, .. } = receiver.observer();
        if places.len() < accounts.len() {
            return Err(RAI_STATUS_SHORT);
        }
        places.iter_mut().zip(accounts).for_each(|(place, one): (&mut MaybeUninit<_>, _)| {
            place.write(rai_seen_t::of(one));
        });
        Ok(accounts.len())
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
