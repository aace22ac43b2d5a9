//! Collection into a vector of fixed capacity without a reachable panic.
//!
//! `heapless::Vec` also collects, but panics beyond its capacity, and a linker cannot prove that
//! the capacity always suffices.

use heapless::Vec;

/// Most satellites in one epoch of [`single`](crate::single): more than three systems show at once
/// anywhere on earth, or fewer if memory is scarce.
pub const CAPACITY: usize = if cfg!(feature = "satellites-16") {
    16
} else if cfg!(feature = "satellites-32") {
    32
} else {
    48
};

/// Returns the elements, as far as the capacity goes.
pub(crate) fn gather<E, const N: usize>(elements: impl IntoIterator<Item = E>) -> Vec<E, N> {
    let mut gathered = Vec::new();
    fill(&mut gathered, elements);
    gathered
}

/// Adds the elements, as far as the capacity goes, to a vector in place, so that no copy takes
/// stack.
pub(crate) fn fill<E, const N: usize>(gathered: &mut Vec<E, N>, elements: impl IntoIterator<Item = E>) {
    for element in elements {
        if gathered.push(element).is_err() {
            break;
        }
    }
}
