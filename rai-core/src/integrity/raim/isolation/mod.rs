//! Isolation: searches for the faulty rows of a snapshot whose global test fails.
//!
//! | module | method |
//! |---|---|
//! | [`exclusion`] | the result of every search |
//! | [`sets`] | enumeration of all sets of one, two and three rows |
//! | [`baarda`] | sequential exclusion of the largest w-test |
//! | [`parity`] | searches in parity space |
//! | [`ransac`] | consensus of disjoint subsets |

pub mod baarda;
pub mod exclusion;
pub mod parity;
pub mod ransac;
pub mod sets;
