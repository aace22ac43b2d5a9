//! Classic RAIM: what the residuals of one solution say. From the global test to the satellites to leave out, and to what
//! an undetected fault can do.
//!
//! | module | question |
//! |---|---|
//! | [`detection`], [`threshold`] | is something wrong? |
//! | [`baarda`], [`parity`], [`ransac`] | which satellites is it? |
//! | [`exclusion`], [`sets`] | how did it end, and would another exclusion have done as well? |
//! | [`shift`] | would a constellation at a place of its own have done? |
//! | [`tags`] | would a wrong time of all ranges have done? |
//! | [`levels`] | how wrong could we be without noticing? |

pub mod baarda;
pub mod detection;
pub mod exclusion;
pub mod levels;
pub mod parity;
pub mod ransac;
pub mod sets;
pub mod shift;
pub mod tags;
pub mod threshold;

/// Each element with those after it: nested, every combination once, in lexicographic order.
fn tails<E>(elements: &[E]) -> impl Iterator<Item = (&E, &[E])> {
    (0..elements.len()).filter_map(|first| elements.get(first..)?.split_first())
}
