//! Choice of the cut between monitored and unmonitored modes. It gathers the odds of every
//! satellite and constellation. Then it sums the probability by size, beginning with the largest
//! sets, until the share of unmonitored faults is used up.

use core::ops::{ControlFlow, Range};

use heapless::Vec;

use super::combination::{Event, Simultaneous, combinations_backwards};
use super::consolidation::{OddsRange, add_to};
use super::sets::{EVENTS, NONE, ROWS, RowSet, event, row};
use super::{Cutoff, Modes, PriorOdds};
use crate::bit_set::{bit, count_of};
use crate::integrity::araim::AraimError;
use crate::numeric::real::Real;
use crate::satellite::Constellation;

/// Odds of a row's fault.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct FaultOdds<T> {
    pub(super) odds: T,
    pub(super) ln: T,
    pub(super) constellation: usize,
}

impl<T: Real> FaultOdds<T> {
    /// Returns the odds of a row that never fails.
    pub(super) fn never() -> Self {
        Self { odds: T::zero(), ln: T::zero(), constellation: NONE }
    }

    /// Returns the odds of a satellite, by its constellation and its probability.
    ///
    /// # Errors
    /// [`AraimError::Prior`] for a probability outside [0, 0.5).
    fn of((constellation, probability): (usize, T)) -> Result<Self, AraimError> {
        let odds = fault_odds(probability)?;
        let ln = if odds > T::zero() { odds.ln() } else { T::zero() };
        Ok(Self { odds, ln, constellation })
    }
}

/// Returns `P/(1 − P)`.
///
/// # Errors
/// [`AraimError::Prior`] for a probability outside [0, 0.5).
fn fault_odds<T: Real>(probability: T) -> Result<T, AraimError> {
    let is_valid = probability >= T::zero() && probability < T::narrow(0.5);
    if is_valid { Ok(probability / (T::one() - probability)) } else { Err(AraimError::Prior) }
}

impl<'r, T: Real> Modes<'r, T> {
    /// Stores the satellites. Returns the probabilities of simultaneous faults.
    pub(super) fn gather<const N: usize>(
        &mut self,
        satellites: impl Iterator<Item = Option<(Constellation, T)>>,
        room: &'r mut PriorOdds<T, N>,
        alike: &mut [OddsRange<T>; Constellation::COUNT],
    ) -> Result<Simultaneous<T>, AraimError> {
        let mut simultaneous = Simultaneous::nothing();
        // Satellites of one constellation are mostly adjacent and share their probability.
        let never = (NONE, T::zero());
        let (mut run, mut of_run, mut start) = (never, FaultOdds::never(), 0);
        room.clear();
        for satellite in satellites {
            let own = satellite.map_or(never, |(constellation, fault)| (constellation as usize, fault));
            if own != run {
                self.take_over(&of_run, start..room.len(), alike);
                (run, of_run, start) = (own, FaultOdds::of(own)?, room.len());
            }
            // Without the first condition a smaller epoch would compare too.
            if N > ROWS && room.len() == ROWS {
                return Err(AraimError::Rows);
            }
            room.push(of_run).map_err(|_| AraimError::Rows)?;
            if of_run.odds > T::zero() {
                simultaneous.add(of_run.odds);
            }
        }
        self.take_over(&of_run, start..room.len(), alike);
        self.odds = room;
        self.satellites = self.members.iter().fold(0, |set, members| set | members);
        for (size, &members) in self.sizes.iter_mut().zip(&self.members) {
            *size = count_of(members);
        }
        for (odds, members) in self.constellations.iter_mut().zip(&self.members) {
            let fault = fault_odds(*odds)?;
            *odds = if *members == 0 { T::zero() } else { fault };
        }
        Ok(simultaneous)
    }

    /// Stores adjacent rows of equal odds.
    #[inline(never)]
    fn take_over(
        &mut self,
        of_each: &FaultOdds<T>,
        rows: Range<usize>,
        alike: &mut [OddsRange<T>; Constellation::COUNT],
    ) {
        let FaultOdds { odds, constellation, .. } = *of_each;
        let of_constellation = self.members.get_mut(constellation).zip(alike.get_mut(constellation));
        let Some((members, alike)) = of_constellation else { return };
        let set = bit(rows.end).wrapping_sub(bit(rows.start));
        *members |= set;
        if odds > T::zero() {
            self.fallible |= set;
            alike.add(odds, rows.len());
            if odds > self.likeliest.odds {
                self.likeliest = FaultOdds { constellation: NONE, ..*of_each };
            }
            if odds < self.rarest_odds {
                self.rarest_odds = odds;
            }
        }
    }

    /// Iterates over all events, satellites first.
    #[inline]
    pub(super) fn events(&self) -> impl Iterator<Item = Event<T>> {
        let satellites = self.odds.iter().enumerate().map(|(index, odds)| Event {
            rows: row(index),
            bit: row(index),
            size: 1,
            constellation: odds.constellation,
            odds: odds.odds,
        });
        let whole = self.constellations.iter().zip(&self.members).zip(&self.sizes).enumerate();
        let whole = whole.map(|(id, ((&odds, &rows), &size))| Event {
            rows,
            bit: event(id),
            size,
            constellation: id,
            odds,
        });
        satellites.chain(whole).filter(|event| event.odds > T::zero())
    }

    /// Returns all events as a list.
    #[inline(never)]
    pub(super) fn gathered(&self) -> Vec<Event<T>, { RowSet::BITS as usize }> {
        // Never full, because sets of all events fit one word.
        crate::bounded::gather(self.events())
    }

    /// Sets `p_0` and the limit of simultaneous events. Returns the probability of more events.
    pub(super) fn count_events(&mut self, of_satellites: Simultaneous<T>, limit: T) -> T {
        let mut simultaneous = of_satellites;
        let mut count = count_of(self.fallible);
        for &odds in self.constellations.iter().filter(|&&odds| odds > T::zero()) {
            simultaneous.add(odds);
            count += 1;
        }
        let Simultaneous { none, three, more, .. } = simultaneous;
        self.healthy = none;
        self.ln_healthy = none.ln();
        let beyond_two = three + more;
        self.limit = if beyond_two <= limit { 2 } else { EVENTS };
        self.limit = self.limit.min(count);
        if self.limit == EVENTS { more } else { beyond_two }
    }

    /// Returns true if monitoring every satellite's fault is mandatory.
    pub(super) fn must_monitor_all_singles(&self) -> bool {
        self.healthy * self.rarest_odds > self.mandatory
    }

    /// Chooses the cut.
    pub(super) fn cut(&mut self, tail: T, share: T, alike: &[OddsRange<T>; Constellation::COUNT]) {
        let mut sums = [T::zero(); ROWS + 1];
        self.is_regular = self.sum_by_constellation(alike, &mut sums).is_some();
        if !self.is_regular {
            sums = [T::zero(); ROWS + 1];
            self.sum_one_by_one(&mut sums);
        }
        for (id, &size) in self.sizes.iter().enumerate() {
            let probability = self.loss(id);
            if probability > T::zero() && !(probability > self.mandatory) {
                add_to(&mut sums, size, probability);
            }
        }
        // No combination takes more satellites than there are rows.
        let mut unmonitored_probability = tail;
        let cut = sums.iter().enumerate().take(self.odds.len() + 1).rev().find(|&(_, &sum)| {
            let fits = unmonitored_probability + sum <= share;
            unmonitored_probability += if fits { sum } else { T::zero() };
            !fits
        });
        self.unmonitored_probability = unmonitored_probability;
        if let Some((size, _)) = cut {
            self.cut_within(size, share);
        }
    }

    /// Chooses the cut among the combinations of one size.
    #[inline(never)]
    fn cut_within(&mut self, size: usize, share: T) {
        let events = self.gathered();
        let (mut sum, mut cutoff) = (self.unmonitored_probability, Cutoff { size, count: 0, events: 0 });
        for count in (1..=self.limit).rev() {
            let walk = combinations_backwards(&events, count, &mut |combination| {
                let probability = self.probability_of(&combination);
                let optional = combination.size == size
                    && !(probability > self.mandatory)
                    && self.consolidates(&combination, probability).is_none();
                if optional {
                    if !(sum + probability <= share) {
                        (cutoff.count, cutoff.events) = (count as u32, combination.events);
                        return ControlFlow::Break(());
                    }
                    sum += probability;
                }
                ControlFlow::Continue(())
            });
            if walk.is_break() {
                break;
            }
        }
        self.unmonitored_probability = sum;
        self.cutoff = cutoff;
    }
}
