//! Collecting into a vector of fixed capacity without a panic in sight.
//!
//! `heapless::Vec` collects too, but panics beyond its capacity; that the capacity always suffices is beyond what a
//! linker can prove.

use heapless::Vec;

/// The elements, as far as the capacity goes.
pub(crate) fn gather<E, const N: usize>(elements: impl IntoIterator<Item = E>) -> Vec<E, N> {
    let mut gathered = Vec::new();
    fill(&mut gathered, elements);
    gathered
}

/// Adds the elements, as far as the capacity goes: for a vector that stays where it is, of which no copy takes stack.
pub(crate) fn fill<E, const N: usize>(gathered: &mut Vec<E, N>, elements: impl IntoIterator<Item = E>) {
    for element in elements {
        if gathered.push(element).is_err() {
            break;
        }
    }
}
