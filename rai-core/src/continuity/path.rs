//! Integral of velocity and clock drift, with which later positions and clocks are compared.
//!
//! For each step longer than [`SMOOTH_STEP_S`], the integral is uncertain by what happens between
//! two epochs:
//!
//! ```text
//! of the position  a Δt²/8 + (V_j + V_{j−1}) Δt/2      a  an unknown acceleration, m/s²; V  HPL + VPL of a velocity, m/s
//! of the clock     0.6 m (Δt/1 s)^1.5                  six times the bridge of a quartz with h₋₂ = 2e-20/s
//!                  15 m/s (Δt − 5 s)                   beyond 5 s: a quartz in the wind
//! ```
//!
//! The drift of a quartz walks at random. Between two known drifts its clock departs from the
//! trapezoid by half as much as without the second one. The frequency of a poor one also sways with
//! its temperature, by 50 ppb within a minute, of which epochs every 30 s see little. The departures
//! of two steps are independent, so that their squares add up. Between buildings a velocity of few satellites may be
//! wrong by 40 m/s, and its level is large. A short step makes little of it, a gap a leap.

use nalgebra::Vector3;

use super::discrepancy::Discrepancy;
use super::oscillator::whole_milliseconds_m;
use crate::frame::Ecef;

/// Longest step of the integral, s.
pub(super) const LONGEST_STEP_S: f64 = 60.0;

/// Longest gap across which a clock is compared, s.
pub(super) const LONGEST_GAP_S: f64 = 900.0;

/// Largest departure of a quartz from its last drift, m/s: 0.1 ppm.
const WANDER_M_S: f64 = 30.0;

/// Longest step within which an acceleration counts as constant, s.
const SMOOTH_STEP_S: f64 = 2.0;

/// Largest acceleration of a vehicle between two epochs, m/s².
pub(super) const ACCELERATION_M_S2: f64 = 5.0;

/// Six times the departure of a quartz from the trapezoid over one second, m.
const BRIDGE_M: f32 = 0.6;

/// Longest step within which the drift sways along a line, s.
const SWAY_S: f32 = 5.0;

/// Largest sway of a quartz whose temperature changes, m/s: 50 ppb.
const SWAY_M_S: f32 = 15.0;

/// An epoch with its rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moment {
    pub(super) time_s: f64,
    pub(super) position: Ecef,
    pub(super) level_m: f32,
    pub(super) clock_m: f64,
    pub(super) velocity_m_s: Vector3<f32>,
    /// `HPL + VPL` of the velocity, m/s.
    pub(super) velocity_level_m_s: f32,
    pub(super) drift_m_s: f64,
    /// True if the clock is of another system than that of the epoch before.
    pub(super) is_of_another_clock: bool,
}

/// Integral of the rates since the origin, the first of the compared epochs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Path {
    pub(super) origin_s: f64,
    /// Clock of the origin, m.
    first_clock_m: f64,
    position: Ecef,
    clock_m: f64,
    unknown_m: f32,
    /// Square of what the walk of the clock's drift explains, m².
    unknown_clock_m2: f32,
}

impl Path {
    /// Begins the integral at an epoch.
    pub(super) const fn from(now: &Moment) -> Self {
        let Moment { time_s, position, clock_m, .. } = *now;
        Self {
            origin_s: time_s,
            first_clock_m: clock_m,
            position,
            clock_m,
            unknown_m: 0.0,
            unknown_clock_m2: 0.0,
        }
    }

    /// Adds a step to the integral; returns the discrepancy after it.
    pub(super) fn advance(&mut self, last: &Moment, now: &Moment) -> Discrepancy {
        let elapsed_s = now.time_s - last.time_s;
        let half_s = (0.5 * elapsed_s) as f32;
        let moved_m = (now.velocity_m_s + last.velocity_m_s) * half_s;
        self.position = self.position + Ecef::new(moved_m.x.into(), moved_m.y.into(), moved_m.z.into());
        let drift_m = 0.5 * elapsed_s * (now.drift_m_s + last.drift_m_s);
        let step_m = now.clock_m - last.clock_m;
        self.clock_m += if now.is_of_another_clock {
            // The offset between two systems is unknown, so that the discrepancy stays.
            step_m
        } else {
            drift_m + whole_milliseconds_m(step_m - elapsed_s * now.drift_m_s)
        };
        if elapsed_s > SMOOTH_STEP_S {
            let elapsed_s = elapsed_s as f32;
            let wrong_m_s = 0.5 * (last.velocity_level_m_s + now.velocity_level_m_s);
            self.unknown_m += (ACCELERATION_M_S2 as f32 / 8.0 * elapsed_s + wrong_m_s) * elapsed_s;
            let sway_m = SWAY_M_S * (elapsed_s - SWAY_S).max(0.0);
            self.unknown_clock_m2 +=
                BRIDGE_M * BRIDGE_M * elapsed_s * elapsed_s * elapsed_s + sway_m * sway_m;
        }
        Discrepancy {
            position: way_m(self.position, now.position),
            clock_m: (now.clock_m - self.clock_m) as f32,
            moved_m: (now.clock_m - self.first_clock_m) as f32,
            unknown_m: self.unknown_m,
            unknown_clock_m2: self.unknown_clock_m2,
            level_m: now.level_m,
        }
    }

    /// Takes the clock of an epoch as the right one.
    pub(super) const fn set_clock(&mut self, clock_m: f64) {
        self.clock_m = clock_m;
    }
}

/// Returns the way from one position to another one, m.
// Not inlined, so that its callers share one copy.
#[inline(never)]
pub(super) fn way_m(from: Ecef, to: Ecef) -> Vector3<f32> {
    let way = to - from;
    Vector3::new(way.x_m as f32, way.y_m as f32, way.z_m as f32)
}

/// Returns true if a clock contradicts its past across a gap, except for whole milliseconds.
pub(super) fn across_gap(last: &Moment, now: &Moment) -> bool {
    let elapsed_s = now.time_s - last.time_s;
    if !(LONGEST_STEP_S..=LONGEST_GAP_S).contains(&elapsed_s) || now.is_of_another_clock {
        return false;
    }
    let error_m = now.clock_m - last.clock_m - 0.5 * elapsed_s * (now.drift_m_s + last.drift_m_s);
    let error_m = libm::fabs(error_m - whole_milliseconds_m(error_m));
    // NaN fails this comparison, so that it counts as a contradiction.
    !(error_m <= WANDER_M_S * elapsed_s + f64::from(now.level_m))
}
