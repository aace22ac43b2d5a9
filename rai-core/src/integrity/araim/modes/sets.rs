//! Sets of rows and of events, as bits of a word, and the hypotheses made of them.

pub(super) use crate::bit_set::above;
use crate::bit_set::count_of;
pub(in crate::integrity::araim) use crate::bit_set::members;
use crate::satellite::Constellation;

/// Largest number of rows of an epoch: rows and constellations together fit one word.
pub const ROWS: usize = RowSet::BITS as usize - Constellation::COUNT;

/// Largest number of simultaneous events.
pub(in crate::integrity::araim) const EVENTS: usize = 3;

/// A set of rows, or of events: rows by their index, constellations above them.
pub(in crate::integrity::araim) type RowSet = u64;

/// Returns the bit of a row.
pub(in crate::integrity::araim) fn row(index: usize) -> RowSet {
    if index < ROWS { 1 << index } else { 0 }
}

/// Returns the bit of a constellation's event.
pub(super) fn event(constellation: usize) -> RowSet {
    1u64.checked_shl((ROWS + constellation) as u32).unwrap_or(0)
}

/// Returns the events of constellations, given by a bit for each id.
pub(super) fn losses(constellations: usize) -> RowSet {
    let ids = (0..Constellation::COUNT).filter(|id| constellations >> id & 1 != 0);
    ids.fold(0, |events, id| events | event(id))
}

/// The rows among a set of events.
pub(super) const ROW_EVENTS: RowSet = (1 << ROWS) - 1;

/// A fault hypothesis: whole constellations, and rows of the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Hypothesis {
    /// Constellations, a bit for each id.
    pub constellations: u8,
    rows: [u8; EVENTS],
}

impl Hypothesis {
    /// Index in place of a missing row.
    const NO_ROW: u8 = u8::MAX;

    /// The fault-free hypothesis.
    pub const NONE: Self = Self { constellations: 0, rows: [Self::NO_ROW; EVENTS] };

    pub(super) fn of(constellations: usize, rows: [usize; EVENTS]) -> Self {
        let [first, second, third] = rows;
        Self { constellations: constellations as u8, rows: [first as u8, second as u8, third as u8] }
    }

    /// Iterates over the indices of the rows of other constellations, ascending.
    pub fn rows(self) -> impl Iterator<Item = usize> {
        self.rows.into_iter().take_while(|&row| row != Self::NO_ROW).map(usize::from)
    }

    /// Returns the indices of the rows of other constellations, `None` for missing ones.
    pub fn named(self) -> [Option<usize>; EVENTS] {
        self.rows.map(|row| (row != Self::NO_ROW).then_some(usize::from(row)))
    }

    /// Returns the hypothesis of one faulty row.
    pub(in crate::integrity::araim) fn of_row(index: usize) -> Self {
        Self::of(0, [index, NONE, NONE])
    }

    /// Adds another row to a hypothesis with at most one row.
    #[inline]
    pub(super) fn and(mut self, index: usize) -> Self {
        let [first, second, _] = &mut self.rows;
        *if *first == Self::NO_ROW { first } else { second } = index as u8;
        self
    }

    /// Returns the hypothesis of faulty constellations, a bit for each id.
    pub(in crate::integrity::araim) fn of_constellations(constellations: u8) -> Self {
        Self { constellations, ..Self::NONE }
    }

    /// Returns true for a pair of rows without constellations, if another hypothesis without
    /// constellations has the same first row.
    #[inline]
    pub(in crate::integrity::araim) fn is_pair_after(self, other: Self) -> bool {
        let ([first, second, third], [of_other, ..]) = (self.rows, other.rows);
        let is_pair = second != Self::NO_ROW && third == Self::NO_ROW;
        is_pair && first == of_other && self.constellations | other.constellations == 0
    }

    // Written out and inlined: every mode asks for them several times.
    #[inline]
    pub(in crate::integrity::araim) fn slots(self) -> [usize; EVENTS] {
        let [first, second, third] = self.rows;
        [usize::from(first), usize::from(second), usize::from(third)]
    }
}

/// Index in place of a missing row.
pub(super) const NONE: usize = Hypothesis::NO_ROW as usize;
/// Returns true if a combination is listed after another one of as many events. The order is that
/// of the words, satellites first.
pub(super) fn is_listed_after(events: RowSet, other: RowSet) -> bool {
    let differing = events ^ other;
    let first = differing & differing.wrapping_neg();
    other & first != 0
}

/// Iterates over every set of at most `most` events of a pool. The empty set is first, and each set
/// comes before those that extend it.
pub(super) fn subsets(pool: RowSet, most: u32) -> impl Iterator<Item = RowSet> {
    let lowest = |set: RowSet| set & set.wrapping_neg();
    core::iter::successors(Some(0), move |&last: &RowSet| {
        let (mut set, mut behind) = (last, pool & above_all(last));
        if behind != 0 && (count_of(set) as u32) < most {
            return Some(set | lowest(behind));
        }
        // Replaces the last event by the next one, or removes it and replaces the one before.
        while set != 0 {
            behind = pool & above_all(set);
            set &= !highest(set);
            if behind != 0 {
                return Some(set | lowest(behind));
            }
        }
        None
    })
}

/// Returns the last of a set's events.
fn highest(set: RowSet) -> RowSet {
    set & !(RowSet::MAX >> 1).unbounded_shr(set.leading_zeros())
}

/// Returns all bits above a set's events.
fn above_all(set: RowSet) -> RowSet {
    !RowSet::MAX.unbounded_shr(set.leading_zeros())
}

#[cfg(test)]
#[test]
fn every_subset_is_listed_once_and_each_before_those_behind_it() {
    let have = subsets(0b1_1010, 2).collect::<heapless::Vec<_, 8>>();
    let want = [0, 0b10, 0b1010, 0b1_0010, 0b1000, 0b1_1000, 0b1_0000];
    assert_eq!(have, want);
    assert!(subsets(0b1_1010, 0).eq([0]), "none but the empty set");
}
