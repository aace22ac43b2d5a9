//! Places, clocks and heights that move although the receiver does not.

mod alike_strengths;
mod clock_ramp;
mod false_rates;
mod leap;
mod rates_apart;
mod repeater;
mod steering;
mod walks;
mod wrong_height;

use super::Attack;

/// Attacks of this folder.
pub(super) const ATTACKS: &[&Attack] = &[
    &leap::ATTACK,
    &leap::WITH_TIME,
    &clock_ramp::ATTACK,
    &false_rates::NEGATED,
    &false_rates::RANDOM,
    &rates_apart::WALK,
    &rates_apart::DRAG,
    &rates_apart::SILENCE,
    &walks::LONG,
    &walks::LEAPS,
    &repeater::ATTACK,
    &steering::ATTACK,
    &alike_strengths::ATTACK,
    &wrong_height::WRONG,
    &wrong_height::RISING,
    &wrong_height::RAMPS,
];
