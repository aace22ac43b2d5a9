//! Places, clocks and heights that move although the receiver does not.

mod alike_strengths;
mod clock_ramp;
mod false_rates;
mod leap;
mod rates_apart;
mod repeater;
mod starts;
mod steering;
mod walks;
mod wrong_height;

attacks! {
    place_that_leaps_is_not_promised: leap::ATTACK,
    time_that_leaps_with_the_place_makes_nothing_reachable: leap::WITH_TIME,
    clock_forecast_does_not_follow_a_fault: clock_ramp::ATTACK,
    rates_of_the_wrong_sign_are_no_velocity: false_rates::NEGATED,
    rates_that_mean_nothing_are_seldom_a_velocity: false_rates::RANDOM,
    place_that_walks_off_from_its_velocity_is_an_alert: rates_apart::WALK,
    clock_that_is_dragged_off_its_drift_is_an_alert: rates_apart::DRAG,
    silence_makes_no_far_place_good: rates_apart::SILENCE,
    walks_of_twenty_minutes_are_promised_no_more_once_seen: walks::LONG,
    leaps_stairs_and_waves_are_promised_no_more_once_seen: walks::LEAPS,
    repeater_is_seen_without_range_rates: repeater::ATTACK,
    clock_that_is_set_back_from_now_on_is_promised_again: steering::ATTACK,
    receiver_that_starts_anew_is_promised_again_soon: starts::ATTACK,
    signals_of_one_strength_confirm_a_suspicion: alike_strengths::ATTACK,
    height_that_is_wrong_vouches_for_nothing: wrong_height::WRONG,
    sky_that_rises_away_from_a_height_is_noticed: wrong_height::RISING,
    ramps_of_satellite_and_altimeter_are_noticed: wrong_height::RAMPS,
}
