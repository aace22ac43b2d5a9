//! Every attack in its quick form, so that the module continues to withstand it.
//!
//! `cargo xtask attack --long` runs them at length.

use std::collections::BTreeSet;

use adversary::attack::record::{Entry, Record};
use adversary::attack::{Effort, attacks};
use rig::shared;

fn hold(name: &str) {
    let attack = attacks().into_iter().find(|attack| attack.name == name).expect("an attack of that name");
    let outcome = attack.attempt(Effort::Quick).expect("an attack that can be tried");
    println!("{name}: {}", outcome.words());
    assert!(outcome.is_held(), "{name} is not held: {}", outcome.words());
    // Without the recordings, some attacks measure less.
    if shared::path("data").is_some() {
        let record = Record::committed().expect("a record");
        let want = record.entry(name, Effort::Quick).map(|entry| &entry.figures);
        let have = Entry::of(&outcome, Effort::Quick, "").figures;
        assert_eq!(Some(&have), want, "{name}: `cargo xtask attack --record` records the new figures");
    }
}

/// Defines a test for each attack, under its name. Those after `at_length` take seconds.
macro_rules! attacks {
    ({ $($test:ident = $name:literal,)* } at_length { $($long_test:ident = $long_name:literal,)* }) => {
        $(#[test]
        fn $test() {
            hold($name);
        })*

        mod at_length {
            $(#[test]
            fn $long_test() {
                super::hold($long_name);
            })*
        }

        #[test]
        fn every_attack_has_a_test() {
            let tested = BTreeSet::from([$($name,)* $($long_name,)*]);
            let known: BTreeSet<&str> = attacks().iter().map(|attack| attack.name).collect();
            assert_eq!(known, tested);
        }
    };
}

attacks! {
    {
    ranges_that_agree_by_chance_end_no_alert = "false-tracking",
    ranges_that_agree_by_chance_are_no_beginning = "false-tracking-afterwards",
    place_that_leaps_is_not_promised = "leap",
    time_that_leaps_with_the_place_makes_nothing_reachable = "leap-of-time",
    step_of_any_size_stays_within_the_levels = "step",
    ramp_of_any_size_stays_within_the_levels = "ramp",
    gross_fault_of_one_satellite_costs_no_epoch = "gross-fault",
    satellite_beside_its_orbit_stays_within_the_levels = "orbit",
    clock_forecast_does_not_follow_a_fault = "clock-ramp",
    two_faults_seldom_pass = "two-faults",
    pairs_that_cannot_be_told_apart_are_an_alert = "chosen-pairs",
    side_of_the_sky_that_is_late_seldom_passes = "reflections",
    system_that_stands_elsewhere_is_not_blamed_on_some_satellites = "shifted-system",
    few_satellites_that_stand_elsewhere_are_not_blamed_on_others = "few-shifted",
    counterfeit_system_that_outnumbers_a_genuine_one_is_not_promised = "two-truths",
    broken_system_costs_no_promise = "broken-system",
    noise_beyond_the_sigmas_is_beyond_levels_no_more_often_than_measured = "noise-four-times",
    orbits_astray_are_beyond_levels_no_more_often_than_measured = "orbits-astray",
    rounded_ranges_are_beyond_levels_no_more_often_than_measured = "rounded-ranges",
    early_ephemeris_does_not_block_later_ones = "early-ephemeris",
    absent_satellites_lock_no_real_one_out = "absent-satellites",
    crowd_of_satellites_displaces_none_in_view = "crowd",
    dense_ionosphere_stays_within_the_levels = "ionosphere",
    ionosphere_with_a_slope_stays_within_the_levels = "ionosphere-slope",
    coefficients_of_zero_shrink_no_level = "ionosphere-zeros",
    one_forged_page_of_the_ionosphere_outdoes_no_level = "ionosphere-forged",
    step_on_one_frequency_is_noticed_under_simulated_skies = "one-frequency-simulated",
    signal_out_of_service_is_not_used = "health",
    empty_message_from_the_future_costs_no_epoch = "empty-ahead",
    empty_message_of_the_next_epoch_promises_nothing_wrong = "empty-next",
    epochs_that_are_held_back_are_not_promised = "held-back",
    recording_that_is_sent_again_is_not_promised = "sent-again",
    recording_of_another_week_is_not_promised = "week-old",
    place_that_walks_off_from_its_velocity_is_an_alert = "walk-off",
    clock_that_is_dragged_off_its_drift_is_an_alert = "drag-off",
    silence_makes_no_far_place_good = "after-silence",
    systems_tagged_a_millisecond_apart_are_one_epoch = "systems-apart",
    wrong_week_outvotes_nobody = "wrong-week",
    leaps_of_time_do_not_move_the_week = "moved-week",
    ranges_a_little_ahead_cost_no_epoch = "near-ahead",
    one_epoch_from_later_makes_no_other_late = "once-later",
    another_cycle_of_weeks_locks_out_no_system = "other-cycle",
    four_ephemerides_of_another_week_outvote_nobody = "outvoted-week",
    sets_dated_with_the_week_before_theirs_move_no_week = "week-edge",
    end_of_a_cycle_of_weeks_costs_nothing = "cycle-edge",
    first_epoch_elsewhere_is_outlasted = "first-elsewhere",
    one_word_of_leap_seconds_costs_nothing = "leap-seconds",
    another_stations_ranges_are_not_the_receivers = "two-stations",
    nobody_stands_in_for_a_receiver_in_a_tunnel = "tunnel",
    station_of_the_same_number_is_promised_in_no_order = "namesake",
    what_comes_twice_is_no_other_receiver = "twice",
    namesake_that_announces_more_is_not_promised = "namesake-first",
    namesake_half_a_second_later_is_not_promised = "namesake-between",
    namesake_that_takes_over_is_not_promised = "namesake-later",
    orbits_that_turn_together_carry_nothing_away = "turned-orbits",
    clocks_that_step_together_carry_nothing_away = "stepping-clocks",
    sets_that_leap_together_are_not_believed_beside_true_ones = "leaping-orbits",
    false_sets_that_came_first_end_with_a_true_one = "false-first-sets",
    one_false_set_costs_no_position = "one-false-set",
    two_halves_of_one_instant_are_no_two_promises = "half-epochs",
    satellite_under_two_numbers_is_not_used = "doubled-satellite",
    second_frequency_that_no_ionosphere_explains_is_not_used = "second-frequency",
    time_to_alert_hides_no_silence = "time-to-alert",
    settings_that_nobody_confirmed_promise_nothing = "restarts",
    fault_that_is_promised_never_to_happen_is_seen = "never-faulty",
    quiet_minutes_take_nothing_off_a_promise = "learned-sigmas",
    warning_that_was_true_once_costs_no_hour = "suspicion-once",
    receiver_that_is_sure_is_not_talked_out_of_it = "suspicion-denied",
    sky_that_rises_away_from_a_height_is_noticed = "rising-sky",
    delays_that_are_not_broadcast_are_within_the_sigmas = "unsaid-delays",
    no_muddle_makes_a_promise_wrong_or_ends_all_promises = "upheaval",
    clock_that_is_set_back_from_now_on_is_promised_again = "steering",
    nominal_recordings_are_protected_and_within_their_levels = "nominal-recordings",
    reflections_between_buildings_seldom_pass = "urban",
    } at_length {
    several_gross_faults_pass_no_test = "gross-pairs",
    step_on_one_frequency_is_noticed_at_real_stations = "one-frequency-recorded",
    rates_of_the_wrong_sign_are_no_velocity = "negated-rates",
    rates_that_mean_nothing_are_seldom_a_velocity = "random-rates",
    repeater_is_seen_without_range_rates = "repeater",
    time_tags_that_are_wrong_are_an_alert = "wrong-tags",
    time_tags_that_are_wrong_teach_no_sigma = "wrong-tags-learned",
    signals_of_one_strength_confirm_a_suspicion = "alike-strengths",
    height_that_is_wrong_vouches_for_nothing = "wrong-height",
    ramps_of_satellite_and_altimeter_are_noticed = "altimeter-ramps",
    signals_of_unsaid_strength_are_no_strong_ones = "unsaid-strength",
    healthy_receivers_give_no_own_signs = "false-signs",
    streets_seldom_pass = "streets",
    signed_sky_is_jammed_and_attacked = "sky",
    ramp_after_quiet_minutes_stays_within_the_levels = "ramp-after-quiet",
    street_after_quiet_minutes_seldom_passes = "street-after-quiet",
    walks_of_twenty_minutes_are_promised_no_more_once_seen = "long-walk-off",
    leaps_stairs_and_waves_are_promised_no_more_once_seen = "leaps-and-waves",
    silences_of_fast_receivers_are_no_contradictions = "gaps",
    }
}
