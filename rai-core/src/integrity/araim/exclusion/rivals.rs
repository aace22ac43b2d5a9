//! Rivals: options that explain the data as well as the best one does.

use super::Choice;
use crate::bit_set::count_of;
use crate::integrity::araim::evaluation::MonitoredModes;
use crate::integrity::araim::modes::Hypothesis;
use crate::numeric::real::Real;

/// Returns the option with the smallest SSE. It is rivalled if another one's is larger by at most
/// `tie`.
///
/// `agreeing` returns an option with its SSE if that is below a limit and nothing contradicts it.
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

/// Returns true if the option is one of only two constellations with more than one satellite.
///
/// Each of two constellations explains the data by the other's fault, whatever their sizes. The
/// probability of a constellation fault does not decide, because it describes the provider and not
/// counterfeit signals. Only a third constellation does, if it has two satellites: a lone one
/// agrees with any place.
pub(super) fn is_one_of_two<T: Real>(monitored: &MonitoredModes<'_, T>, option: Hypothesis) -> bool {
    let in_view = monitored.modes.members.iter().filter(|&&members| count_of(members) > 1).count();
    option.constellations != 0 && in_view <= 2
}
