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

attacks! {
    ranges_that_agree_by_chance_end_no_alert: false_tracking::ATTACK,
    ranges_that_agree_by_chance_are_no_beginning: false_tracking::AFTERWARDS,
    step_of_any_size_stays_within_the_levels: single_fault::STEPS,
    ramp_of_any_size_stays_within_the_levels: single_fault::RAMPS,
    gross_fault_of_one_satellite_costs_no_epoch: single_fault::GROSS,
    several_gross_faults_pass_no_test: gross_pairs::ATTACK,
    two_faults_seldom_pass: several_faults::PAIRS,
    pairs_that_cannot_be_told_apart_are_an_alert: several_faults::CHOSEN,
    side_of_the_sky_that_is_late_seldom_passes: reflections::ATTACK,
    system_that_stands_elsewhere_is_not_blamed_on_some_satellites: shifted_system::WHOLE,
    few_satellites_that_stand_elsewhere_are_not_blamed_on_others: shifted_system::FEW,
    counterfeit_system_that_outnumbers_a_genuine_one_is_not_promised: two_truths::ATTACK,
    broken_system_costs_no_promise: broken_system::ATTACK,
    noise_beyond_the_sigmas_is_beyond_levels_no_more_often_than_measured: poor_ranges::NOISE,
    orbits_astray_are_beyond_levels_no_more_often_than_measured: poor_ranges::ORBITS,
    rounded_ranges_are_beyond_levels_no_more_often_than_measured: poor_ranges::ROUNDED,
    dense_ionosphere_stays_within_the_levels: ionosphere::EVEN,
    ionosphere_with_a_slope_stays_within_the_levels: ionosphere::SLOPED,
    coefficients_of_zero_shrink_no_level: ionosphere::ZEROS,
    one_forged_page_of_the_ionosphere_outdoes_no_level: ionosphere::FORGED,
    step_on_one_frequency_is_noticed_at_real_stations: one_frequency::RECORDED,
    step_on_one_frequency_is_noticed_under_simulated_skies: one_frequency::SIMULATED,
    signal_out_of_service_is_not_used: health::ATTACK,
    satellite_under_two_numbers_is_not_used: doubled_satellite::ATTACK,
    second_frequency_that_no_ionosphere_explains_is_not_used: second_frequency::ATTACK,
    quiet_minutes_take_nothing_off_a_promise: learned_sigmas::ATTACK,
    ramp_after_quiet_minutes_stays_within_the_levels: after_quiet::RAMP,
    street_after_quiet_minutes_seldom_passes: after_quiet::STREET,
    warning_that_was_true_once_costs_no_hour: after_quiet::SUSPICION,
    time_tags_that_are_wrong_are_an_alert: wrong_tags::BRIEFLY,
    time_tags_that_are_wrong_teach_no_sigma: wrong_tags::LEARNED,
    delays_that_are_not_broadcast_are_within_the_sigmas: unsaid_delays::ATTACK,
    signals_of_unsaid_strength_are_no_strong_ones: unsaid_strength::ATTACK,
}
