//! Rows of the committed tables that a build contains.
//!
//! Without the feature `tables` they are those of the phases of flight, which all need the same two
//! probabilities ([`crate::requirements`]). Without `double-tables` they are in single precision,
//! because a build for `f32` alone cannot use more digits. Rows end at the capacity of the epochs
//! that they are for. All rows take 26 KB of flash, those for 48 satellites in single precision 10,
//! one pair of these 0.6.
#![allow(clippy::indexing_slicing, reason = "while compiling, where an index beyond the end is an error")]

use super::{MAX_DOF, MAX_TESTS, table};
use crate::bounded::MAX_ROWS;
use crate::numeric::probability::Probability;

#[cfg(feature = "tables")]
mod taken {
    pub(super) const ALARMS: [usize; 9] = [0, 1, 2, 3, 4, 5, 6, 7, 8];
    pub(super) const MISSES: [usize; 4] = [0, 1, 2, 3];
}

#[cfg(not(feature = "tables"))]
mod taken {
    use super::super::table;
    use crate::requirements;

    /// Index of the phases' probability of false alarm in the tables.
    pub(super) const ALARMS: [usize; 1] = [6];
    /// Index of their probability of missed detection in the tables.
    pub(super) const MISSES: [usize; 1] = [0];

    const _: () =
        assert!(table::FALSE_ALARM[ALARMS[0]].get().to_bits() == requirements::FALSE_ALARM.get().to_bits());
    const _: () = assert!(
        table::MISSED_DETECTION[MISSES[0]].get().to_bits() == requirements::MISSED_DETECTION.get().to_bits()
    );
}

use taken::{ALARMS, MISSES};

pub(super) static FALSE_ALARM: [Probability; ALARMS.len()] = probabilities(&table::FALSE_ALARM, ALARMS);
pub(super) static MISSED_DETECTION: [Probability; MISSES.len()] =
    probabilities(&table::MISSED_DETECTION, MISSES);
/// Scalar of the rows. A test rounds its threshold to its precision. With either scalar, a test in
/// single precision therefore has the same threshold.
#[cfg(not(feature = "double-tables"))]
pub(super) type TableScalar = f32;
/// Scalar of the rows.
#[cfg(feature = "double-tables")]
pub(super) type TableScalar = f64;

/// Rows for epochs of at most `N` ranges, which have fewer than `N` degrees of freedom and make at
/// most `N` tests.
pub(super) struct Rows<const N: usize>;

impl<const N: usize> Rows<N> {
    pub(super) const TAU1: &'static [[TableScalar; N]; ALARMS.len()] = &fronts(&table::TAU1, ALARMS);
    pub(super) const W_TEST: &'static [[TableScalar; N]; ALARMS.len()] = &fronts(&table::W_TEST, ALARMS);
    pub(super) const LAMBDA: &'static [[[TableScalar; N]; MISSES.len()]; ALARMS.len()] = &{
        let (mut blocks, mut alarm) = ([[[0.0; N]; MISSES.len()]; ALARMS.len()], 0);
        while alarm < ALARMS.len() {
            blocks[alarm] = fronts(&table::LAMBDA[ALARMS[alarm]], MISSES);
            alarm += 1;
        }
        blocks
    };

    /// Returns the part of a row of degrees of freedom that the table has.
    pub(super) fn dof(row: &[TableScalar; N]) -> &[TableScalar] {
        row.get(..MAX_DOF).unwrap_or(row)
    }
}

// No row of tests is longer than the table.
const _: () = assert!(MAX_ROWS <= MAX_TESTS);

const fn probabilities<const N: usize>(all: &[Probability], taken: [usize; N]) -> [Probability; N] {
    let (mut probabilities, mut index) = ([all[0]; N], 0);
    while index < N {
        probabilities[index] = all[taken[index]];
        index += 1;
    }
    probabilities
}

/// Returns the fronts of the selected rows; zeros beyond their ends.
const fn fronts<const LONG: usize, const SHORT: usize, const N: usize>(
    rows: &[[f64; LONG]],
    taken: [usize; N],
) -> [[TableScalar; SHORT]; N] {
    let (mut fronts, mut index) = ([[0.0; SHORT]; N], 0);
    while index < N {
        let mut column = 0;
        while column < SHORT && column < LONG {
            fronts[index][column] = rows[taken[index]][column] as TableScalar;
            column += 1;
        }
        index += 1;
    }
    fronts
}
