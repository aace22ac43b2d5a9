//! Orbits and clocks that satellites do not have.

pub(super) mod early_ephemeris;
mod false_orbits;
pub(super) mod faulty_orbit;

attacks! {
    satellite_beside_its_orbit_stays_within_the_levels: faulty_orbit::ATTACK,
    early_ephemeris_does_not_block_later_ones: early_ephemeris::EARLY,
    absent_satellites_lock_no_real_one_out: early_ephemeris::ABSENT,
    crowd_of_satellites_displaces_none_in_view: early_ephemeris::CROWD,
    orbits_that_turn_together_carry_nothing_away: false_orbits::TURNED,
    clocks_that_step_together_carry_nothing_away: false_orbits::CLOCKS,
    sets_that_leap_together_are_not_believed_beside_true_ones: false_orbits::LEAP,
    false_sets_that_came_first_end_with_a_true_one: false_orbits::FIRST,
    one_false_set_costs_no_position: false_orbits::ONE,
}
