//! Rivals: options that explain the data as well as the best one.

use super::Choice;
use crate::bit_set::count_of;
use crate::integrity::araim::modes::Hypothesis;
use crate::integrity::araim::monitored::MonitoredModes;
use crate::numeric::real::Real;

/// Returns the option with the smallest SSE. It is rivalled if the SSE of another one is larger by
/// at most `tie`.
///
/// `agreeing` returns an option with its SSE, if this is below a limit and nothing contradicts the
/// option.
pub(super) fn best<T: Real>(
    options: impl Iterator<Item = Hypothesis>,
    tie: T,
    agreeing: &mut impl FnMut(Hypothesis, Option<T>) -> Option<(T, Hypothesis)>,
) -> Option<Choice> {
    let mut best: Option<(T, Choice)> = None;
    for option in options {
        let limit = best.map(|(least, _)| least + tie);
        let Some((sse, option)) = agreeing(option, limit) else { continue };
        best = match best {
            Some((least, choice)) if sse >= least => Some((least, Choice { is_rivalled: true, ..choice })),
            Some((least, _)) => Some((sse, Choice { option, is_rivalled: least - sse <= tie })),
            None => Some((sse, Choice { option, is_rivalled: false })),
        };
    }
    best.map(|(_, choice)| choice)
}

/// Returns true if the option is a constellation of two satellites, and only one other
/// constellation is in view.
///
/// Two satellites agree on any position, so that a fault of either constellation explains the data.
/// Only a third constellation could decide.
pub(super) fn is_pair_beside_one<T: Real>(monitored: &MonitoredModes<'_, T>, option: Hypothesis) -> bool {
    let in_view = monitored.modes.members.iter().filter(|members| **members != 0).count();
    count_of(monitored.modes.taken_by(option)) == 2 && in_view == 2
}
