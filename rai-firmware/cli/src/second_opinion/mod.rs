//! Second opinions on the core: slow, obvious and exact methods, for comparison only.
//!
//! They share no formula with the core.
//!
//! | module | content |
//! |---|---|
//! | [`dense`] | least squares with all columns, by matrix inversion |
//! | [`chi_square`] | exact tails of the χ² distributions |
//! | [`thresholds`] | thresholds of the tests for any probabilities |
//! | [`ransac_traditional`] | RANSAC over every minimal subset |

pub mod chi_square;
pub mod dense;
pub mod ransac_traditional;
pub mod thresholds;
