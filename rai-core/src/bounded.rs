//! Collection into a vector of fixed capacity without a reachable panic.
//!
//! `heapless::Vec` also collects, but panics beyond its capacity, and a linker cannot prove that
//! the capacity always suffices.

use heapless::Vec;

/// Largest number of satellites in one epoch of [`single`](crate::single). 48 are more than three
/// systems have in view anywhere on earth; without the feature `satellites-48` there are fewer.
pub const CAPACITY: usize = if cfg!(feature = "satellites-48") {
    48
} else if cfg!(feature = "satellites-32") {
    32
} else {
    16
};

// The features of other crates in a build must not reduce the capacity.
const _: () = assert!(CAPACITY >= 32 || !cfg!(feature = "satellites-32"));
const _: () = assert!(CAPACITY >= 48 || !cfg!(feature = "satellites-48"));

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
