//! Velocity of the receiver's antenna, from range rates.

use raim_core::internals::velocity::Velocity;

use crate::pointer::{Versioned, give, status_of};
use crate::receiver::{at, rai_receiver_t};
use crate::status::rai_status_t;

/// Velocity at an epoch. All numbers are NaN if the range rates gave none that passed its test.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rai_velocity_t {
    /// `sizeof(rai_velocity_t)`, set by the caller.
    pub size: u32,
    /// Degrees of freedom of the test of the range rates.
    pub dof: u8,
    /// Number of satellites whose range rate was left out.
    pub excluded_count: u8,
    /// Reserved for later use.
    pub reserved: [u8; 2],
    /// Velocity to the east, m/s.
    pub east_m_s: f64,
    /// Velocity to the north, m/s.
    pub north_m_s: f64,
    /// Velocity upwards, m/s.
    pub up_m_s: f64,
    /// Covariance of east, north and up in this order: EE, EN, EU, NN, NU, UU, m²/s².
    pub covariance_m2_s2: [f64; 6],
    /// Drift of the receiver clock times the speed of light, m/s.
    pub clock_drift_m_s: f64,
    /// Bound on the horizontal error, m/s.
    pub horizontal_level_m_s: f64,
    /// Bound on the vertical error, m/s.
    pub vertical_level_m_s: f64,
    /// Statistic of the test, `√(SSE/dof)`.
    pub statistic: f64,
    /// Threshold of the test.
    pub threshold: f64,
}

#[allow(unsafe_code)]
// SAFETY: `repr(C)`, its size first, and integers and doubles, of which every pattern of bits is a
// value.
unsafe impl Versioned for rai_velocity_t {
    const FIRST_SIZE: usize = 120;
}

const _: () =
    assert!(size_of::<rai_velocity_t>() == 120, "a field came or moved: raise RAI_ABI_VERSION if it moved");

impl rai_velocity_t {
    const NONE: Self = Self {
        size: size_of::<Self>() as u32,
        dof: 0,
        excluded_count: 0,
        reserved: [0; 2],
        east_m_s: f64::NAN,
        north_m_s: f64::NAN,
        up_m_s: f64::NAN,
        covariance_m2_s2: [f64::NAN; 6],
        clock_drift_m_s: f64::NAN,
        horizontal_level_m_s: f64::NAN,
        vertical_level_m_s: f64::NAN,
        statistic: f64::NAN,
        threshold: f64::NAN,
    };

    fn of(velocity: &Velocity) -> Self {
        let [east_m_s, north_m_s, up_m_s] = velocity.east_north_up_m_s;
        Self {
            dof: velocity.test.dof,
            excluded_count: velocity.excluded.len() as u8,
            east_m_s,
            north_m_s,
            up_m_s,
            covariance_m2_s2: velocity.covariance_m2_s2,
            clock_drift_m_s: velocity.drift_m_s,
            horizontal_level_m_s: velocity.levels_m_s.hpl_m,
            vertical_level_m_s: velocity.levels_m_s.vpl_m,
            statistic: velocity.test.statistic,
            threshold: velocity.test.threshold,
            ..Self::NONE
        }
    }
}

/// Writes the velocity at the last epoch.
///
/// # Safety
/// As for `rai_receiver_pin`; `velocity` is null or points to a struct of the size that it begins
/// with.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rai_receiver_velocity(
    receiver: *const rai_receiver_t,
    velocity: *mut rai_velocity_t,
) -> rai_status_t {
    // SAFETY: guaranteed by the caller.
    let receiver = unsafe { at(receiver) };
    status_of(receiver.and_then(|receiver| {
        // After a silence the last velocity is of no epoch that the report is about.
        let known = receiver.last_report().and_then(|_| receiver.velocity());
        // SAFETY: guaranteed by the caller.
        unsafe { give(velocity, &known.map_or(rai_velocity_t::NONE, rai_velocity_t::of)) }
    }))
}
