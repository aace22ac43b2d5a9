//! Collection into a vector of fixed capacity without a reachable panic.
//!
//! `heapless::Vec` also collects, but panics beyond its capacity, and a linker cannot prove that
//! the capacity always suffices.

use heapless::Vec;

/// Most rows of an epoch, which are its satellites and aiding rows: sets of them fit one word.
pub const MAX_ROWS: usize = u64::BITS as usize;

/// Fewest rows that an epoch must have room for: a position and one clock need four.
const MIN_ROWS: usize = 4;

/// Refuses a capacity while compiling.
pub(crate) const fn assert_capacity(rows: usize) {
    assert!(MIN_ROWS <= rows && rows <= MAX_ROWS, "an epoch must have room for 4 to 64 satellites");
}

/// Returns the elements, up to the capacity.
pub(crate) fn gather<E, const N: usize>(elements: impl IntoIterator<Item = E>) -> Vec<E, N> {
    let mut gathered = Vec::new();
    fill(&mut gathered, elements);
    gathered
}

/// Adds the elements, up to the capacity, to a vector in place, so that no copy takes stack.
pub(crate) fn fill<E, const N: usize>(gathered: &mut Vec<E, N>, elements: impl IntoIterator<Item = E>) {
    for element in elements {
        if gathered.push(element).is_err() {
            break;
        }
    }
}
