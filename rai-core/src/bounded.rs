//! Collection into a vector of fixed capacity without a reachable panic.
//!
//! `heapless::Vec` also collects, but panics beyond its capacity, and a linker cannot prove that
//! the capacity always suffices.

use heapless::Vec;

/// Most satellites in one epoch of [`single`](crate::single): 48, more than three systems show at
/// once anywhere on earth, or fewer without the feature `satellites-48`.
pub const CAPACITY: usize = if cfg!(feature = "satellites-48") {
    48
} else if cfg!(feature = "satellites-32") {
    32
} else {
    16
};

// A build that needs so many has them, whatever else is on.
const _: () = assert!(CAPACITY >= 32 || !cfg!(feature = "satellites-32"));
const _: () = assert!(CAPACITY >= 48 || !cfg!(feature = "satellites-48"));

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
