//! Orbits and clocks that satellites do not have.

pub(super) mod early_ephemeris;
mod false_orbits;
pub(super) mod faulty_orbit;

use super::Attack;

/// Attacks of this folder.
pub(super) const ATTACKS: &[&Attack] = &[
    &faulty_orbit::ATTACK,
    &early_ephemeris::EARLY,
    &early_ephemeris::ABSENT,
    &early_ephemeris::CROWD,
    &false_orbits::TURNED,
    &false_orbits::CLOCKS,
    &false_orbits::LEAP,
    &false_orbits::FIRST,
    &false_orbits::ONE,
];
