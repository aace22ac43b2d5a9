//! The motion of a state vector under the earth's gravity: GLONASS.
//!
//! ```text
//! ẋ = v_x    v̇_x = (−m − k (1 − s) + ω²) x + 2 ω v_y + a_x      m = µ/r³
//! ẏ = v_y    v̇_y = (−m − k (1 − s) + ω²) y − 2 ω v_x + a_y      k = 3/2 J₂ µ a_e²/r⁵
//! ż = v_z    v̇_z = (−m − k (3 − s)) z + a_z                     s = 5 z²/r²
//! ```
//!
//! | symbol | here | unit |
//! |---|---|---|
//! | `x, y, z`; `v` | [`State`], earth-fixed | m, m/s |
//! | `a` | acceleration by sun and moon, constant over the set's time | m/s² |
//! | `µ`, `a_e`, `J₂`, `ω` | constants of PZ-90.11 | m³/s², m, 1, rad/s |
//!
//! The fourth-order method of Runge and Kutta integrates in whole steps of [`STEP_S`] from the
//! reference time, and one shorter step. The states at whole steps are nodes. A caller that stores
//! the last node continues from it, with the same bits as from the reference time. The result
//! therefore depends only on the instant. After a quarter of an hour the steps have an error of 2
//! cm. PZ-90.11 is ITRF to some centimetres, so that no rotation is applied.
//!
//! The state is in double precision, but the change in a step is in single precision. With an
//! acceleration of 0.6 m/s² the rounding is some 2e-8 m/s²: another centimetre in a quarter of an
//! hour. In return a step takes a tenth of the time.
//!
//! Reference: [GLO-ICD] appendix J, simplified algorithm.
//!
//! [GLO-ICD]: crate#references

use nalgebra::Vector3;
use raim_core::internals::numeric::sqrt;

/// Gravity of the earth, m³/s².
const MU_M3_S2: f64 = 3.986004418e14;

/// Equatorial radius, m.
const RADIUS_M: f64 = 6_378_136.0;

/// Second zonal harmonic.
const J2: f64 = 1.0826257e-3;

/// Rotation of the earth, rad/s.
const EARTH_RATE_RAD_S: f64 = 7.292115e-5;

/// Longest step, s.
const STEP_S: f64 = 150.0;

/// Longest integration from the reference time, s: half an hour, in which the acceleration by sun
/// and moon changes little.
pub(super) const LIMIT_S: f64 = 1800.0;

/// Position and velocity, or their rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    pub(super) position: Vector3<f64>,
    pub(super) velocity: Vector3<f64>,
}

/// The state after a number of whole steps from the reference time, negative before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) steps: i8,
    pub(super) state: State,
}

impl Node {
    /// Returns the node at the reference time.
    pub(super) const fn at_reference(state: State) -> Self {
        Self { steps: 0, state }
    }

    /// Returns the number of whole steps between the reference time and an instant, or `None`
    /// beyond [`LIMIT_S`].
    pub(super) fn steps_to(seconds: f64) -> Option<i8> {
        (seconds.abs() <= LIMIT_S).then(|| libm::trunc(seconds / STEP_S) as i8)
    }

    /// Returns true if it lies between the reference time and another node, or is that node.
    pub(super) const fn is_on_the_way_to(&self, steps: i8) -> bool {
        (self.steps >= 0 && self.steps <= steps) || (self.steps <= 0 && self.steps >= steps)
    }

    /// Returns the node after `steps`, from one on the way to it.
    pub(super) fn advanced(self, steps: i8, pull_m_s2: Vector3<f32>) -> Self {
        let step_s = if steps < 0 { -STEP_S } else { STEP_S };
        let mut state = self.state;
        for _ in 0..steps.abs_diff(self.steps) {
            state = state.step(step_s, pull_m_s2);
        }
        Self { steps, state }
    }

    /// Returns the state at an instant, s from the reference time, less than a step away.
    pub(super) fn state_at(&self, seconds: f64, pull_m_s2: Vector3<f32>) -> State {
        self.state.step(seconds - STEP_S * f64::from(self.steps), pull_m_s2)
    }
}

impl State {
    /// Returns the state after one step of Runge and Kutta.
    fn step(self, step_s: f64, pull_m_s2: Vector3<f32>) -> Self {
        let (position_m, velocity_m_s) = (self.position.cast(), self.velocity.cast());
        let (whole_s, half_s) = (step_s as f32, 0.5 * step_s as f32);
        let acceleration = |moved_m: Vector3<f32>, gained_m_s: Vector3<f32>| {
            acceleration_after(&[position_m, velocity_m_s, pull_m_s2], &moved_m, &gained_m_s)
        };
        let first = acceleration(Vector3::zeros(), Vector3::zeros());
        let second = acceleration(velocity_m_s * half_s, first * half_s);
        let third = acceleration((velocity_m_s + first * half_s) * half_s, second * half_s);
        let fourth = acceleration((velocity_m_s + second * half_s) * whole_s, third * whole_s);
        let middle = second + third;
        let bent_m = (first + middle) * (whole_s * whole_s * (1.0 / 6.0));
        let gained_m_s = (first + middle + middle + fourth) * (whole_s * (1.0 / 6.0));
        Self {
            position: self.position + self.velocity * step_s + bent_m.cast(),
            velocity: self.velocity + gained_m_s.cast(),
        }
    }
}

/// Returns the acceleration of a satellite, with a pull, that moved and gained speed, m/s².
// Not inlined, so that the four stages of a step share one copy.
#[inline(never)]
fn acceleration_after(
    [position_m, velocity_m_s, pull_m_s2]: &[Vector3<f32>; 3],
    moved_m: &Vector3<f32>,
    gained_m_s: &Vector3<f32>,
) -> Vector3<f32> {
    acceleration_m_s2(position_m + moved_m, velocity_m_s + gained_m_s) + pull_m_s2
}

/// Returns the acceleration by the equations of motion, without that by sun and moon, m/s².
fn acceleration_m_s2(position_m: Vector3<f32>, velocity_m_s: Vector3<f32>) -> Vector3<f32> {
    const OBLATENESS_M2: f32 = (1.5 * J2 * RADIUS_M * RADIUS_M) as f32;
    const RATE_SQUARED: f32 = (EARTH_RATE_RAD_S * EARTH_RATE_RAD_S) as f32;
    const TWICE_RATE: f32 = (2.0 * EARTH_RATE_RAD_S) as f32;
    let (p, v) = (position_m, velocity_m_s);
    let inverse_square = p.dot(&p).recip();
    let m = MU_M3_S2 as f32 * inverse_square * sqrt(inverse_square);
    let k = OBLATENESS_M2 * m * inverse_square;
    let s = 5.0 * p.z * p.z * inverse_square;
    let level = RATE_SQUARED - m - k * (1.0 - s);
    Vector3::new(level * p.x + TWICE_RATE * v.y, level * p.y - TWICE_RATE * v.x, (k * (s - 3.0) - m) * p.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// State and acceleration as a satellite broadcasts them (km, km/s, km/s² in round numbers of
    /// the message's steps).
    const START: State = State {
        position: Vector3::new(-12_413_521.0, 7_254_116.5, 21_032_207.5),
        velocity: Vector3::new(-2_190.5, -2_015.25, -590.75),
    };
    const PULL_M_S2: Vector3<f32> = Vector3::new(1.9e-6, -9.3e-7, -2.8e-6);

    fn after(seconds: f64) -> Option<State> {
        let steps = Node::steps_to(seconds)?;
        Some(Node::at_reference(START).advanced(steps, PULL_M_S2).state_at(seconds, PULL_M_S2))
    }

    fn distance_m(a: State, b: State) -> f64 {
        let apart_m = a.position - b.position;
        libm::sqrt(apart_m.dot(&apart_m))
    }

    /// Integrates the same equations from the potential: its gradient by differences, in an
    /// inertial frame. The method is that of Störmer and Verlet in steps of one second. It shares
    /// nothing but the constants with the code under test.
    fn precisely(start: State, seconds: f64, pull: Vector3<f32>) -> State {
        const STEPS_PER_S: f64 = 20.0;
        let potential = |[x, y, z]: [f64; 3]| {
            let r2 = x * x + y * y + z * z;
            let r = libm::sqrt(r2);
            let ratio = RADIUS_M * RADIUS_M / r2;
            MU_M3_S2 / r * (1.0 - J2 * ratio * (1.5 * z * z / r2 - 0.5))
        };
        let gravity = |point: [f64; 3]| {
            let mut gradient = [0.0; 3];
            for axis in 0..3 {
                const BY_M: f64 = 2_000.0;
                let moved = |by: f64| {
                    let mut moved = point;
                    moved[axis] += by;
                    potential(moved)
                };
                let (near, far) = (moved(BY_M) - moved(-BY_M), moved(2.0 * BY_M) - moved(-2.0 * BY_M));
                gradient[axis] = (8.0 * near - far) / (12.0 * BY_M);
            }
            gradient
        };
        let turn = |[x, y, z]: [f64; 3], angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            [x * cos - y * sin, x * sin + y * cos, z]
        };
        let w = EARTH_RATE_RAD_S;
        let pull: [f64; 3] = pull.cast().into();
        let mut at: [f64; 3] = start.position.into();
        let [x, y, _] = at;
        let [vx, vy, vz]: [f64; 3] = start.velocity.into();
        let mut v = [vx - w * y, vy + w * x, vz];
        let h = libm::copysign(1.0 / STEPS_PER_S, seconds);
        let steps = libm::round(seconds.abs() * STEPS_PER_S) as usize;
        // The acceleration by sun and moon is constant in the turning frame.
        let force = |at: [f64; 3], t: f64| {
            let (g, p) = (gravity(at), turn(pull, w * t));
            [g[0] + p[0], g[1] + p[1], g[2] + p[2]]
        };
        for step in 0..steps {
            let before = force(at, h * step as f64);
            for axis in 0..3 {
                v[axis] += 0.5 * h * before[axis];
                at[axis] += h * v[axis];
            }
            let after = force(at, h * (step + 1) as f64);
            for axis in 0..3 {
                v[axis] += 0.5 * h * after[axis];
            }
        }
        State { position: turn(at, -w * seconds).into(), velocity: v.into() }
    }

    #[test]
    fn after_a_quarter_of_an_hour_the_orbit_is_good_to_five_centimetres() {
        for seconds in [-900.0, -450.0, 75.0, 450.0, 900.0] {
            let have = after(seconds).expect("within the limit");
            let error_m = distance_m(have, precisely(START, seconds, PULL_M_S2));
            std::println!("{seconds} s: {error_m:.4} m");
            assert!(error_m < 0.05, "{seconds} s: {error_m} m");
        }
    }

    #[test]
    fn every_node_on_the_way_leads_to_the_same_bits() {
        for seconds in [-1799.5, -900.0, -370.25, 0.0, 149.999, 370.0, 1650.0] {
            let steps = Node::steps_to(seconds).expect("near");
            for kept in -12..=12 {
                let node = Node::at_reference(START).advanced(kept, PULL_M_S2);
                let is_between = i32::from(kept) * i32::from(steps) >= 0 && kept.abs() <= steps.abs();
                assert_eq!(node.is_on_the_way_to(steps), is_between, "{kept} to {steps}");
                if is_between {
                    let have = node.advanced(steps, PULL_M_S2).state_at(seconds, PULL_M_S2);
                    assert_eq!(Some(have), after(seconds), "{seconds} s from node {kept}");
                }
            }
        }
    }

    #[test]
    fn what_is_far_off_is_not_integrated() {
        for seconds in [LIMIT_S + 1.0, -1e9, f64::NAN, f64::INFINITY] {
            assert_eq!(after(seconds), None);
        }
    }
}
