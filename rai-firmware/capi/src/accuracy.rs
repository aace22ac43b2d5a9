//! Accuracy of a position: covariance, dilution of precision, clocks, and size of the residuals.

use raim_core::report::Report;
use raim_core::satellite::Constellation;

use crate::monitor::{last, rai_monitor_t};
use crate::pointer::{Versioned, give, status_of};
#[cfg(feature = "receiver")]
use crate::receiver::{at, rai_receiver_t};
use crate::status::rai_status_t;

/// Accuracy of the position of an epoch. An undefined number is NaN.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rai_accuracy_t {
    /// `sizeof(rai_accuracy_t)`, set by the caller.
    pub size: u32,
    /// System of the satellite used with the largest w-test, `RAI_SYSTEM_…`; 0 if there is none.
    pub suspect_system: u8,
    /// Number of that satellite within the system.
    pub suspect_number: u8,
    /// Reserved for later use.
    pub reserved: [u8; 2],
    /// W-test of that satellite, in standard deviations, with its sign.
    pub suspect_w_test: f64,
    /// Covariance of east, north and up in this order: EE, EN, EU, NN, NU, UU, m².
    pub covariance_m2: [f64; 6],
    /// Horizontal dilution of precision.
    pub hdop: f64,
    /// Vertical dilution of precision.
    pub vdop: f64,
    /// Root mean square of the residuals of the satellites used, m.
    pub residual_rms_m: f64,
    /// Mean of SSE/dof over the last 60 tested epochs: about 1 if the sigmas are right.
    pub sigma_check: f64,
    /// Receiver clock of GPS and QZSS times the speed of light, m.
    pub gps_clock_m: f64,
    /// Receiver clock of GLONASS times the speed of light, m.
    pub glonass_clock_m: f64,
    /// Receiver clock of Galileo times the speed of light, m.
    pub galileo_clock_m: f64,
    /// Receiver clock of `BeiDou` times the speed of light, m.
    pub beidou_clock_m: f64,
}

#[allow(unsafe_code)]
// SAFETY: `repr(C)`, its size first, and integers and doubles, of which every pattern of bits is a
// value.
unsafe impl Versioned for rai_accuracy_t {
    const FIRST_SIZE: usize = 128;
}

const _: () =
    assert!(size_of::<rai_accuracy_t>() == 128, "a field came or moved: raise RAI_ABI_VERSION if it moved");

impl rai_accuracy_t {
    fn of<const N: usize>(report: Option<&Report<N>>) -> Self {
        let solution = report.and_then(|report| report.solution.as_ref());
        let suspect = report.and_then(|report| report.suspect);
        let (system, number) = suspect.map_or(('\0', 0), |suspect| suspect.satellite.name());
        let clock_m = |constellation: Constellation| {
            let known = solution.and_then(|solution| solution.clocks_m.get(constellation as usize).copied());
            known.flatten().unwrap_or(f64::NAN)
        };
        Self {
            size: size_of::<Self>() as u32,
            // The letters are ASCII.
            suspect_system: system as u8,
            suspect_number: number,
            reserved: [0; 2],
            suspect_w_test: suspect.map_or(f64::NAN, |suspect| suspect.w_test),
            covariance_m2: solution.map_or([f64::NAN; 6], |solution| solution.covariance_m2),
            hdop: solution.map_or(f64::NAN, |solution| solution.hdop),
            vdop: solution.map_or(f64::NAN, |solution| solution.vdop),
            residual_rms_m: solution.and(report).map_or(f64::NAN, |report| report.residual_rms_m),
            sigma_check: report.and_then(|report| report.sigma_check).unwrap_or(f64::NAN),
            gps_clock_m: clock_m(Constellation::Gps),
            glonass_clock_m: clock_m(Constellation::Glonass),
            galileo_clock_m: clock_m(Constellation::Galileo),
            beidou_clock_m: clock_m(Constellation::Beidou),
        }
    }
}

/// Writes the accuracy of the position that the last call of `rai_monitor_judge` has found.
///
/// # Safety
/// `monitor` is null or points to memory of that size with initialised contents, not used elsewhere
/// during the call. `accuracy` is null or points to a struct of the size that it begins with.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_monitor_accuracy(
    monitor: *const rai_monitor_t,
    accuracy: *mut rai_accuracy_t,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let last = unsafe { last(monitor) };
    // SAFETY: guaranteed by the caller.
    status_of(last.and_then(|(_, report)| unsafe { give(accuracy, &rai_accuracy_t::of(Some(report))) }))
}

/// Writes the accuracy of the position of the last epoch. After a silence all numbers are NaN.
///
/// # Safety
/// As for `rai_receiver_pin`; `accuracy` is null or points to a struct of the size that it begins
/// with.
#[cfg(feature = "receiver")]
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_accuracy(
    receiver: *const rai_receiver_t,
    accuracy: *mut rai_accuracy_t,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let receiver = unsafe { at(receiver) };
    let of = |receiver: &mut _| rai_accuracy_t::of(raim_firmware::receiver::Receiver::last_report(receiver));
    // SAFETY: guaranteed by the caller.
    status_of(receiver.and_then(|receiver| unsafe { give(accuracy, &of(receiver)) }))
}
