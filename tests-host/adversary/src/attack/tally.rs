//! Counts of the outcomes of an attack.

use std::borrow::Borrow;
use std::collections::BTreeMap;
use std::ops::AddAssign;

use raim::outcomes::{Outcome, Outcomes};

use super::Figure;
use super::seen::Seen;

/// Probability of missed detection at start.
pub const MISSED: f64 = 1e-3;

/// Outcomes of the epochs, and what else an attack counts.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Number of judged epochs by outcome; a promised one has the pin high.
    pub outcomes: Outcomes,
    /// Number of misleading epochs with more than one satellite left out.
    pub misled_by_several: usize,
    /// Satellites used, summed over all reports.
    pub used: u32,
    /// Satellites left out of promised epochs, summed.
    pub left_out: usize,
    /// Largest horizontal error of a promised epoch, m.
    pub worst_horizontal_m: f64,
    /// Largest vertical error of a promised epoch, m.
    pub worst_vertical_m: f64,
    /// Number of epochs by reason.
    pub reasons: BTreeMap<String, usize>,
}

impl Tally {
    /// Counts an epoch. A verdict without an epoch is none.
    pub fn add(&mut self, seen: &Seen) {
        let state = &seen.reported.state;
        self.used += state.used;
        if !state.has_epoch() {
            return;
        }
        *self.reasons.entry(state.reason.clone()).or_default() += 1;
        self.outcomes.add(match state.state {
            _ if seen.is_promised => {
                Outcome::Promised { is_misleading: seen.is_misleading(), is_hazardous: seen.is_hazardous() }
            }
            'A' => Outcome::Alert,
            _ => Outcome::Unavailable,
        });
        if seen.is_promised {
            self.misled_by_several += usize::from(seen.is_misleading() && seen.reported.excluded.len() > 1);
            self.left_out += seen.reported.excluded.len();
            self.worst_horizontal_m = self.worst_horizontal_m.max(seen.horizontal_error_m);
            self.worst_vertical_m = self.worst_vertical_m.max(seen.vertical_error_m);
        }
    }

    /// Counts several epochs.
    pub fn add_all(&mut self, seen: &[Seen]) {
        for seen in seen {
            self.add(seen);
        }
    }

    /// Returns the number of judged epochs, as a figure has it.
    pub fn epochs(&self) -> f64 {
        self.outcomes.epochs() as f64
    }

    /// Returns the number of promised epochs.
    pub fn promised(&self) -> f64 {
        self.outcomes.promised as f64
    }

    /// Returns the number of promised epochs beyond a level.
    pub fn misleading(&self) -> f64 {
        self.outcomes.misleading as f64
    }

    /// Returns the number of alerts.
    pub fn alerts(&self) -> f64 {
        self.outcomes.alerts as f64
    }

    /// Returns the share of the epochs that are promised.
    pub fn share(&self) -> f64 {
        self.promised() / self.epochs().max(1.0)
    }

    /// Returns the same share in percent.
    pub fn percent(&self) -> f64 {
        100.0 * self.promised() / self.epochs().max(1.0)
    }

    /// Returns the share of the promised epochs that are beyond a level.
    pub fn beyond(&self) -> f64 {
        self.misleading() / self.promised().max(1.0)
    }

    /// Returns the lower end of the 95 % interval of the rate of misleading epochs.
    pub fn least_rate(&self) -> f64 {
        least_rate(self.outcomes.misleading, self.outcomes.epochs())
    }

    /// Returns the largest error of a promised epoch, horizontal or vertical, m.
    pub fn worst_m(&self) -> f64 {
        self.worst_horizontal_m.max(self.worst_vertical_m)
    }

    /// Returns the number of epochs with this reason.
    pub fn of_reason(&self, reason: &str) -> usize {
        self.reasons.get(reason).copied().unwrap_or(0)
    }

    /// Returns epochs, promises and their largest error, and bounds the misleading ones by
    /// `misleading`.
    pub fn figures(&self, misleading: f64) -> Vec<Figure> {
        vec![
            Figure::plain("epochs", self.epochs()),
            Figure::plain("protected", self.promised()),
            Figure::at_most("beyond their level", self.misleading(), misleading),
            Figure::plain("largest error of them, m", self.worst_m()),
        ]
    }

    /// Returns the same figures if misleading epochs are allowed with a probability. The rate is
    /// too high only if chance does not explain it (95 %).
    pub fn figures_by_rate(&self, probability: f64) -> Vec<Figure> {
        let mut figures = self.figures(f64::INFINITY);
        figures.push(Figure::at_most("their rate is above", self.least_rate(), probability));
        figures
    }
}

impl AddAssign<&Self> for Tally {
    fn add_assign(&mut self, other: &Self) {
        self.outcomes += other.outcomes;
        self.misled_by_several += other.misled_by_several;
        self.used += other.used;
        self.left_out += other.left_out;
        self.worst_horizontal_m = self.worst_horizontal_m.max(other.worst_horizontal_m);
        self.worst_vertical_m = self.worst_vertical_m.max(other.worst_vertical_m);
        for (reason, count) in &other.reasons {
            *self.reasons.entry(reason.clone()).or_default() += count;
        }
    }
}

impl<T: Borrow<Self>> FromIterator<T> for Tally {
    fn from_iter<I: IntoIterator<Item = T>>(tallies: I) -> Self {
        let mut sum = Self::default();
        tallies.into_iter().for_each(|tally| sum += tally.borrow());
        sum
    }
}

/// Returns the lower end of the 95 % interval of a probability, after `hits` in `trials`
/// ([Wilson1927]).
///
/// [Wilson1927]: crate#references
pub fn least_rate(hits: usize, trials: usize) -> f64 {
    /// Two-sided 95 % point of the normal distribution.
    const NORMAL: f64 = 1.96;
    if hits == 0 {
        return 0.0;
    }
    let (count, rate) = (trials as f64, hits as f64 / trials as f64);
    let square = NORMAL * NORMAL / count;
    let half = NORMAL * (rate * (1.0 - rate) / count + square / (4.0 * count)).sqrt();
    (rate + square / 2.0 - half) / (1.0 + square)
}

#[cfg(test)]
mod tests {
    use super::least_rate;

    #[test]
    fn lower_end_is_that_of_the_formula_worked_by_hand() {
        assert!((least_rate(8, 10) - 0.4902).abs() < 1e-3, "{}", least_rate(8, 10));
        assert!(least_rate(0, 100) <= 0.0);
    }
}
