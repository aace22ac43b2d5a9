//! Rows of the committed tables that a build contains.
//!
//! Without the feature `tables` these are the rows of the phases of flight, which all need the same
//! two probabilities ([`crate::requirements`]). Without `double-tables` rows end at the capacity of
//! [`single`](crate::single) and are in its precision, because a build for `single` alone cannot
//! use the rest.
//!
//! | features | flash |
//! |---|---|
//! | `tables`, `double-tables` | 26 KB |
//! | `tables` | 10 KB |
//! | neither | 0.8 KB |
#![allow(clippy::indexing_slicing, reason = "while compiling, where an index beyond the end is an error")]

use super::table;
use crate::bounded::CAPACITY;
use crate::numeric::probability::Probability;

/// Length of the rows for one or more degrees of freedom.
const DOF: usize = if cfg!(feature = "double-tables") { super::MAX_DOF } else { CAPACITY };
/// Length of the rows for one or more w-tests.
const TESTS: usize = if cfg!(feature = "double-tables") { super::MAX_TESTS } else { CAPACITY };

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

pub(super) static TAU1: [[TableScalar; DOF]; ALARMS.len()] = fronts(&table::TAU1, ALARMS);
pub(super) static W_TEST: [[TableScalar; TESTS]; ALARMS.len()] = fronts(&table::W_TEST, ALARMS);
pub(super) static LAMBDA: [[[TableScalar; DOF]; MISSES.len()]; ALARMS.len()] = {
    let (mut blocks, mut alarm) = ([[[0.0; DOF]; MISSES.len()]; ALARMS.len()], 0);
    while alarm < ALARMS.len() {
        blocks[alarm] = fronts(&table::LAMBDA[ALARMS[alarm]], MISSES);
        alarm += 1;
    }
    blocks
};

const fn probabilities<const N: usize>(all: &[Probability], taken: [usize; N]) -> [Probability; N] {
    let (mut probabilities, mut index) = ([all[0]; N], 0);
    while index < N {
        probabilities[index] = all[taken[index]];
        index += 1;
    }
    probabilities
}

/// Returns the first elements of the selected rows.
const fn fronts<const LONG: usize, const SHORT: usize, const N: usize>(
    rows: &[[f64; LONG]],
    taken: [usize; N],
) -> [[TableScalar; SHORT]; N] {
    let (mut fronts, mut index) = ([[0.0; SHORT]; N], 0);
    while index < N {
        let mut column = 0;
        while column < SHORT {
            fronts[index][column] = rows[taken[index]][column] as TableScalar;
            column += 1;
        }
        index += 1;
    }
    fronts
}
