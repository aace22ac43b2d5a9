//! No attacker: real receivers and harmless skies, of which no epoch may be lost or mislead.

mod false_signs;
mod gaps;
pub(super) mod recordings;
pub(super) mod streets;

attacks! {
    nominal_recordings_are_protected_and_within_their_levels: recordings::NOMINAL,
    reflections_between_buildings_seldom_pass: recordings::URBAN,
    healthy_receivers_give_no_own_signs: false_signs::ATTACK,
    silences_of_fast_receivers_are_no_contradictions: gaps::ATTACK,
    streets_seldom_pass: streets::ATTACK,
}
