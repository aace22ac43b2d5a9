//! Which satellite is it? From a detected fault to the satellites to leave out.

pub mod baarda;
pub mod parity;
pub mod ransac;

/// Each element with those after it: nested, every combination once, in lexicographic order.
fn tails<E>(elements: &[E]) -> impl Iterator<Item = (&E, &[E])> {
    (0..elements.len()).filter_map(|first| elements.get(first..)?.split_first())
}
