//! What a line may bring: messages, other stations, settings and warnings.

mod forged_frames;
mod half_epochs;
mod held_back;
mod namesakes;
mod odd_ranges;
mod settings;
pub(super) mod suspicions;
mod two_stations;
mod upheaval;
mod week_edge;

attacks! {
    empty_message_from_the_future_costs_no_epoch: odd_ranges::AHEAD,
    empty_message_of_the_next_epoch_promises_nothing_wrong: odd_ranges::NEXT,
    epochs_that_are_held_back_are_not_promised: held_back::ATTACK,
    recording_that_is_sent_again_is_not_promised: held_back::AGAIN,
    recording_of_another_week_is_not_promised: held_back::WEEK_OLD,
    systems_tagged_a_millisecond_apart_are_one_epoch: odd_ranges::APART,
    wrong_week_outvotes_nobody: odd_ranges::WEEK,
    leaps_of_time_do_not_move_the_week: forged_frames::MOVED,
    ranges_a_little_ahead_cost_no_epoch: forged_frames::NEAR,
    one_epoch_from_later_makes_no_other_late: forged_frames::LATER,
    another_cycle_of_weeks_locks_out_no_system: forged_frames::CYCLE,
    four_ephemerides_of_another_week_outvote_nobody: forged_frames::OUTVOTED,
    sets_dated_with_the_week_before_theirs_move_no_week: week_edge::ATTACK,
    end_of_a_cycle_of_weeks_costs_nothing: week_edge::CYCLE,
    first_epoch_elsewhere_is_outlasted: forged_frames::FIRST,
    one_word_of_leap_seconds_costs_nothing: forged_frames::LEAP_SECONDS,
    another_stations_ranges_are_not_the_receivers: two_stations::ATTACK,
    nobody_stands_in_for_a_receiver_in_a_tunnel: two_stations::TUNNEL,
    station_of_the_same_number_is_promised_in_no_order: two_stations::NAMESAKE,
    what_comes_twice_is_no_other_receiver: two_stations::TWICE,
    namesake_that_announces_more_is_not_promised: namesakes::JOINED,
    namesake_half_a_second_later_is_not_promised: namesakes::IN_TURN,
    namesake_that_takes_over_is_not_promised: namesakes::TAKEN_OVER,
    two_halves_of_one_instant_are_no_two_promises: half_epochs::ATTACK,
    time_to_alert_hides_no_silence: settings::TIME_TO_ALERT,
    settings_that_nobody_confirmed_promise_nothing: settings::RESTARTS,
    fault_that_is_promised_never_to_happen_is_seen: settings::NEVER,
    receiver_that_is_sure_is_not_talked_out_of_it: suspicions::ATTACK,
    no_muddle_makes_a_promise_wrong_or_ends_all_promises: upheaval::ATTACK,
}
