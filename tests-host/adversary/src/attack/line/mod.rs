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

use super::Attack;

/// Attacks of this folder.
pub(super) const ATTACKS: &[&Attack] = &[
    &odd_ranges::AHEAD,
    &odd_ranges::NEXT,
    &held_back::ATTACK,
    &held_back::AGAIN,
    &held_back::WEEK_OLD,
    &odd_ranges::APART,
    &odd_ranges::WEEK,
    &forged_frames::MOVED,
    &forged_frames::NEAR,
    &forged_frames::LATER,
    &forged_frames::CYCLE,
    &forged_frames::OUTVOTED,
    &week_edge::ATTACK,
    &week_edge::CYCLE,
    &forged_frames::FIRST,
    &forged_frames::LEAP_SECONDS,
    &two_stations::ATTACK,
    &two_stations::TUNNEL,
    &two_stations::NAMESAKE,
    &two_stations::TWICE,
    &namesakes::JOINED,
    &namesakes::IN_TURN,
    &namesakes::TAKEN_OVER,
    &half_epochs::ATTACK,
    &settings::TIME_TO_ALERT,
    &settings::RESTARTS,
    &settings::NEVER,
    &suspicions::ATTACK,
    &upheaval::ATTACK,
];
