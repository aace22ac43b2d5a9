//! Orbits broadcast as a state vector: GLONASS.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `r`, `v`, `a` at `t_b` | [`StateBroadcast::position_m`], `velocity_m_s`, `acceleration_m_s2` | m, m/s, m/s², PZ-90 |
//! | `−τ_n`, `γ_n` | [`StateBroadcast::clock_s`], `clock_s_s` | s, s/s |
//! | `Δτ_n` | [`StateBroadcast::delay_l2_s`]: delay of L2 behind L1 | s |
//!
//! The position at another instant is computed from the forces on the satellite
//! ([`super::forces`]). `γ_n` includes relativity.
//!
//! An integration from `t_b` takes up to seven steps. [`StateVector::advance`] stores the state
//! after the last whole step (node), so that an instant soon after it takes one step. The node
//! depends only on the message, and changes no result.
//!
//! Every element stays the integer that was broadcast. In single precision a velocity would be
//! wrong by up to 0.1 mm/s, which is a decimetre in a quarter of an hour.
//!
//! Reference: [GLO-ICD] 5.1, appendix J.1.
//!
//! [GLO-ICD]: crate#references

use nalgebra::Vector3;
use raim_core::internals::numeric::sqrt_f64;
use raim_core::satellite::SatelliteId;

use super::elapsed::Elapsed;
use super::fixed::nearest;
use super::forces::{Node, State};
use super::motion::Motion;
use super::orbit_types::{GLONASS_AXES_M, GLONASS_COS2_INCLINATIONS, GLONASS_ECCENTRICITY};
use super::{BroadcastError, Health};
use crate::time::GpsTime;

/// Steps of the message: 2⁻¹¹ km, 2⁻²⁰ km/s, 2⁻³⁰ km/s².
const POSITION_STEP_M: f64 = 1e3 / (1 << 11) as f64;
const VELOCITY_STEP_M_S: f64 = 1e3 / (1 << 20) as f64;
const ACCELERATION_STEP_M_S2: f64 = 1e3 / (1 << 30) as f64;

/// One GLONASS satellite's message with the day resolved.
///
/// It may hold any values; [`Ephemeris::of_state`](super::Ephemeris::of_state) checks them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateBroadcast {
    /// Satellite, by its slot.
    pub satellite: SatelliteId,
    /// Health that the satellite broadcasts.
    pub health: Health,
    /// Broadcast standard deviation of the range error (`F_T`), m; `None` if the satellite promises
    /// none.
    pub accuracy_m: Option<f32>,
    /// Reference time `t_b`, with leap seconds added.
    pub toe: GpsTime,
    /// Position at `toe`, m.
    pub position_m: [f64; 3],
    /// Velocity at `toe` in the earth-fixed frame, m/s.
    pub velocity_m_s: [f64; 3],
    /// Acceleration by sun and moon, m/s².
    pub acceleration_m_s2: [f32; 3],
    /// Satellite clock minus system time at `toe`, `−τ_n`, s.
    pub clock_s: f64,
    /// Rate of the satellite clock, `γ_n`, s/s.
    pub clock_s_s: f64,
    /// Delay of L2 behind L1 at the antenna, `Δτ_n`, s.
    pub delay_l2_s: f32,
}

/// A checked state vector; each element in the steps of the message. It is packed like the other
/// forms.
#[derive(Clone, Copy, Debug)]
#[repr(Rust, packed(4))]
pub struct StateVector {
    /// State of the last node, `node_steps` steps from the reference time.
    node: State,
    node_steps: i8,
    acceleration: [i8; 3],
    position: [i32; 3],
    velocity: [i32; 3],
}

/// Compares the broadcast elements; the node follows from them.
impl PartialEq for StateVector {
    fn eq(&self, other: &Self) -> bool {
        (self.position, self.velocity, self.acceleration)
            == (other.position, other.velocity, other.acceleration)
    }
}

impl StateVector {
    /// Returns the checked elements, rounded to the steps of the message.
    pub(super) fn new(broadcast: &StateBroadcast) -> Result<Self, BroadcastError> {
        check(broadcast)?;
        let steps = |value: f64, step: f64| libm::round(value / step) as i32;
        let mut vector = Self {
            node: State { position: Vector3::zeros(), velocity: Vector3::zeros() },
            node_steps: 0,
            // At most 107 steps of the message.
            acceleration: broadcast
                .acceleration_m_s2
                .map(|pull_m_s2| steps(f64::from(pull_m_s2), ACCELERATION_STEP_M_S2) as i8),
            position: broadcast.position_m.map(|position_m| steps(position_m, POSITION_STEP_M)),
            velocity: broadcast.velocity_m_s.map(|velocity_m_s| steps(velocity_m_s, VELOCITY_STEP_M_S)),
        };
        vector.keep(vector.reference());
        Ok(vector)
    }

    /// Returns the motion at an instant counted from the reference time, or `None` beyond the
    /// limit.
    pub(super) fn at(&self, since_toe: Elapsed) -> Option<Motion> {
        let seconds = since_toe.to_s();
        let state = self.node_of(Node::steps_to(seconds)?).state_at(seconds, self.pull_m_s2());
        let position_m: [f64; 3] = state.position.into();
        // Exact for every satellite, whose distance takes 25 of the 53 bits.
        let position_m36 = position_m.map(|coordinate_m| nearest(coordinate_m, 36));
        Some(Motion { position_m36, relativity_s62: 0 })
    }

    /// Keeps the node before the departure of signals that are received this long after the
    /// reference time.
    pub(super) fn advance(&mut self, received_s: f64) {
        /// Longest travel of a signal, s; the node must be on the way to departure and arrival.
        const TRAVEL_S: f64 = 0.15;
        let nearest_s = if received_s > 0.0 { (received_s - TRAVEL_S).max(0.0) } else { received_s };
        if let Some(steps) = Node::steps_to(nearest_s).filter(|steps| *steps != self.node_steps) {
            self.keep(self.node_of(steps));
        }
    }

    /// Returns the node after `steps`, from the kept node if it is on the way, else from the
    /// reference time.
    fn node_of(&self, steps: i8) -> Node {
        let kept = Node { steps: self.node_steps, state: self.node };
        let start = if kept.is_on_the_way_to(steps) { kept } else { self.reference() };
        start.advanced(steps, self.pull_m_s2())
    }

    fn keep(&mut self, node: Node) {
        (self.node, self.node_steps) = (node.state, node.steps);
    }

    fn reference(&self) -> Node {
        Node::at_reference(State {
            position: self.position.map(|steps| POSITION_STEP_M * f64::from(steps)).into(),
            velocity: self.velocity.map(|steps| VELOCITY_STEP_M_S * f64::from(steps)).into(),
        })
    }

    fn pull_m_s2(&self) -> Vector3<f32> {
        self.acceleration.map(|steps| ACCELERATION_STEP_M_S2 as f32 * f32::from(steps)).into()
    }
}

/// Returns true when the ellipse that touches the orbit at the reference time is one of GLONASS, as
/// [`orbit_types`](super::orbit_types) has it. NaN and an orbit that leaves the earth are in no
/// range.
fn is_of_glonass(broadcast: &StateBroadcast) -> bool {
    /// [GLO-ICD] appendix J.1: gravity, m³/s², and rotation of the earth, rad/s.
    ///
    /// [GLO-ICD]: crate#references
    const MU: f64 = 3.986_004_418e14;
    const EARTH_RATE_RAD_S: f64 = 7.292_115e-5;
    let [x, y, z] = broadcast.position_m;
    let [rotating_vx, rotating_vy, vz] = broadcast.velocity_m_s;
    let (vx, vy) = (rotating_vx - EARTH_RATE_RAD_S * y, rotating_vy + EARTH_RATE_RAD_S * x);
    let squared = |[x, y, z]: [f64; 3]| x * x + y * y + z * z;
    let normal = [y * vz - z * vy, z * vx - x * vz, x * vy - y * vx];
    let [_, _, polar] = normal;
    let momentum = squared(normal);
    let per_axis = 2.0 / sqrt_f64(squared([x, y, z])) - squared([vx, vy, vz]) / MU;
    GLONASS_AXES_M.contains(&(1.0 / per_axis))
        && 1.0 - momentum * per_axis / MU <= GLONASS_ECCENTRICITY * GLONASS_ECCENTRICITY
        && polar > 0.0
        && GLONASS_COS2_INCLINATIONS.contains(&(polar * polar / momentum))
}

/// Checks every field against the bounds of a satellite 16,000 km to 64,000 km from the centre. NaN
/// is in no range.
fn check(broadcast: &StateBroadcast) -> Result<(), BroadcastError> {
    let [x_m, y_m, z_m] = broadcast.position_m;
    let radius_m2 = x_m * x_m + y_m * y_m + z_m * z_m;
    let has_state = (1.6e7 * 1.6e7..=6.4e7 * 6.4e7).contains(&radius_m2);
    let has_rates = broadcast.velocity_m_s.iter().all(|velocity| velocity.abs() <= 1e4)
        && broadcast.acceleration_m_s2.iter().all(|acceleration| acceleration.abs() <= 1e-4);
    let has_clock = broadcast.clock_s.abs() <= 0.0625
        && broadcast.clock_s_s.abs() <= 1e-7
        && broadcast.delay_l2_s.abs() <= 1e-6
        && (0.0..=1e4).contains(&broadcast.accuracy_m.unwrap_or(0.0));
    match (has_state, has_rates, has_clock) {
        (false, _, _) => Err(BroadcastError::SemiMajorAxis),
        (_, false, _) => Err(BroadcastError::Correction),
        (_, _, false) => Err(BroadcastError::Clock),
        _ if !is_of_glonass(broadcast) => Err(BroadcastError::OrbitType),
        _ => Ok(()),
    }
}
