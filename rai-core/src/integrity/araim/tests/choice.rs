//! The choice of the monitored modes, against the rule read literally.
//!
//! The reference lists every set of events, moves those within a constellation to the fault of that
//! constellation, and takes small sets until hardly any probability is left.

use std::collections::BTreeMap;
use std::prelude::rust_2024::*;
use std::vec;

use super::{Dice, Each, Sky, close, sky, watched};
use crate::integrity::araim::modes::{Mode, row};
use crate::integrity::araim::{Allocation, Prior, Priors};
use crate::least_squares::Workspace;
use crate::satellite::Constellation;

#[test]
fn the_choice_is_that_of_the_rule_read_literally() {
    let mut dice = Dice(5);
    for count in [5, 7, 9, 12] {
        let sky = sky(&mut dice, count);
        let mut workspace = Workspace::of(sky.epoch.clone());
        let snapshot = workspace.solve();
        let Ok(snapshot) = snapshot else { continue };
        for (fault, consolidation) in [(1e-5, 0.01), (3e-4, 0.05), (1e-2, 0.0), (0.05, 0.02)] {
            let priors: Vec<_> = sky
                .priors
                .iter()
                .map(|&prior| Prior { fault: fault * (0.5 + dice.roll()), ..prior })
                .collect();
            let constellations = [1e-8, 1e-4, 2e-4, 3e-3];
            let allocation = Allocation { consolidation, ..Allocation::vertical_guidance() };
            let all = Priors { satellites: &priors, constellations };
            let monitored = watched(&snapshot, &all, &allocation);
            let (want, unmonitored_probability) = literal(&sky, &priors, constellations, &allocation);
            let mut have = Vec::new();
            let _ = monitored.modes.visit(
                &monitored.modes.remains(0),
                &(1..=3),
                &|_| true,
                &mut Each(|mode: &Mode<_>| {
                    have.push((monitored.modes.taken_by(mode.hypothesis), mode.probability));
                    core::ops::ControlFlow::Continue(())
                }),
            );
            have.sort_by_key(|&(set, _)| set);
            assert_eq!(have.len(), want.len(), "{count} satellites, {fault}");
            for ((set, probability), (want_set, want)) in have.iter().zip(&want) {
                assert_eq!(set, want_set);
                close("p", probability / want, 1.0, 1e-10);
            }
            close("P_nm", monitored.modes.unmonitored_probability / unmonitored_probability, 1.0, 1e-10);
        }
    }
}

/// Returns the modes of the rule: sets of rows with their probabilities, and the probability of all
/// others.
fn literal(
    sky: &Sky,
    priors: &[Prior<f64>],
    constellations: [f64; Constellation::COUNT],
    allocation: &Allocation,
) -> (Vec<(u64, f64)>, f64) {
    let events = Events::of(sky, priors, constellations);
    let most = if events.more_than(2) <= allocation.unmonitored_probability { 2 } else { 3 };
    let listed = events.consolidated(events.listed(most), allocation.consolidation);
    let (mut watched, mut optional): (Vec<_>, Vec<_>) =
        listed.into_iter().partition(|mode| mode.probability > allocation.integrity());
    optional.sort_by_key(|mode| mode.rows.count_ones());
    let unmonitored = |from: usize| {
        events.more_than(most) + optional[from..].iter().map(|mode| mode.probability).sum::<f64>()
    };
    let is_little = |&from: &usize| unmonitored(from) <= allocation.unmonitored_probability;
    let from = (0..optional.len()).find(is_little).unwrap_or(optional.len());
    watched.extend_from_slice(&optional[..from]);
    (merged(&watched), unmonitored(from))
}

/// A fault of a satellite or of a constellation.
struct Event {
    /// Rows that it takes.
    rows: u64,
    probability: f64,
}

/// A set of events that happen at once, and no others.
#[derive(Clone, PartialEq)]
struct Listed {
    events: Vec<usize>,
    rows: u64,
    probability: f64,
}

struct Events {
    /// Those of satellites, then those of constellations.
    all: Vec<Event>,
    satellites: usize,
    /// Probability that none happens.
    healthy: f64,
}

impl Events {
    fn of(sky: &Sky, priors: &[Prior<f64>], constellations: [f64; Constellation::COUNT]) -> Self {
        let of_satellite =
            |(i, prior): (usize, &Prior<f64>)| Event { rows: row(i), probability: prior.fault };
        let mut all: Vec<_> = priors.iter().enumerate().map(of_satellite).collect();
        for (constellation, &probability) in constellations.iter().enumerate() {
            let of_it = (0..priors.len()).filter(|&i| sky.constellations[i] == constellation);
            let rows = of_it.fold(0, |set, i| set | row(i));
            if rows != 0 {
                all.push(Event { rows, probability });
            }
        }
        let healthy = all.iter().map(|event| 1.0 - event.probability).product();
        Self { all, satellites: priors.len(), healthy }
    }

    fn odds(&self, event: usize) -> f64 {
        let probability = self.all[event].probability;
        probability / (1.0 - probability)
    }

    /// Probability of more than so many events, by elementary symmetric sums.
    fn more_than(&self, events: usize) -> f64 {
        let mut exactly = vec![self.healthy];
        exactly.resize(self.all.len() + 1, 0.0);
        for event in 0..self.all.len() {
            for k in (1..exactly.len()).rev() {
                exactly[k] += exactly[k - 1] * self.odds(event);
            }
        }
        exactly.iter().skip(events + 1).sum()
    }

    /// All sets of one to so many events, the small ones first.
    fn listed(&self, most: usize) -> Vec<Listed> {
        let mut sets = vec![vec![]];
        let mut listed = Vec::new();
        for _ in 0..most {
            let longer = sets.iter().flat_map(|set: &Vec<usize>| {
                let next = set.last().map_or(0, |&last| last + 1);
                (next..self.all.len()).map(move |event| set.iter().copied().chain([event]).collect())
            });
            sets = longer.collect();
            listed.extend(sets.iter().map(|set| self.set(set)));
        }
        listed
    }

    fn set(&self, events: &[usize]) -> Listed {
        Listed {
            events: events.to_vec(),
            rows: events.iter().fold(0, |set, &event| set | self.all[event].rows),
            probability: events.iter().fold(self.healthy, |p, &event| p * self.odds(event)),
        }
    }

    /// Adds to the fault of each constellation the much less probable sets within it.
    fn consolidated(&self, mut listed: Vec<Listed>, consolidation: f64) -> Vec<Listed> {
        for own in self.satellites..self.all.len() {
            let whole = self.set(&[own]);
            let is_within = |mode: &Listed| {
                mode.events != whole.events
                    && mode.rows & !whole.rows == 0
                    && mode.probability < consolidation * whole.probability
            };
            let (within, mut kept): (Vec<_>, Vec<_>) = listed.into_iter().partition(is_within);
            let added: f64 = within.iter().map(|mode| mode.probability).sum();
            kept.iter_mut()
                .filter(|mode| mode.events == whole.events)
                .for_each(|mode| mode.probability += added);
            listed = kept;
        }
        listed
    }
}

/// Adds up the probabilities of equal rows.
fn merged(modes: &[Listed]) -> Vec<(u64, f64)> {
    let mut merged = BTreeMap::new();
    for mode in modes {
        *merged.entry(mode.rows).or_insert(0.0) += mode.probability;
    }
    merged.into_iter().collect()
}
