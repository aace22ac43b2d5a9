//! Ranges that are wrong: of one satellite, of several, of a system, of a frequency.

mod after_quiet;
mod broken_system;
mod doubled_satellite;
mod false_tracking;
mod gross_pairs;
mod health;
mod ionosphere;
mod learned_sigmas;
mod one_frequency;
mod poor_ranges;
mod reflections;
mod second_frequency;
pub mod several_faults;
pub mod several_record;
mod shifted_system;
mod single_fault;
mod two_truths;
mod unsaid_delays;
mod unsaid_strength;
mod wrong_tags;

use super::Attack;

/// Attacks of this folder.
pub(super) const ATTACKS: &[&Attack] = &[
    &false_tracking::ATTACK,
    &false_tracking::AFTERWARDS,
    &single_fault::STEPS,
    &single_fault::RAMPS,
    &single_fault::GROSS,
    &gross_pairs::ATTACK,
    &several_faults::PAIRS,
    &several_faults::CHOSEN,
    &reflections::ATTACK,
    &shifted_system::WHOLE,
    &shifted_system::FEW,
    &two_truths::ATTACK,
    &broken_system::ATTACK,
    &poor_ranges::NOISE,
    &poor_ranges::ORBITS,
    &poor_ranges::ROUNDED,
    &ionosphere::EVEN,
    &ionosphere::SLOPED,
    &ionosphere::ZEROS,
    &ionosphere::FORGED,
    &one_frequency::RECORDED,
    &one_frequency::SIMULATED,
    &health::ATTACK,
    &doubled_satellite::ATTACK,
    &second_frequency::ATTACK,
    &learned_sigmas::ATTACK,
    &after_quiet::RAMP,
    &after_quiet::STREET,
    &after_quiet::SUSPICION,
    &wrong_tags::BRIEFLY,
    &wrong_tags::LEARNED,
    &unsaid_delays::ATTACK,
    &unsaid_strength::ATTACK,
];
