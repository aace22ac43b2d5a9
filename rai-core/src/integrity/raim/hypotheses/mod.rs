//! Rival hypotheses: explanations of the residuals other than a fault of the rows that were left
//! out.
//!
//! | module | hypothesis |
//! |---|---|
//! | [`separability`] | another set of rows is faulty |
//! | [`broken_system`] | a whole constellation is faulty, and all others agree |
//! | [`constellation_shift`] | a whole constellation determines another position |
//! | [`time_tag`] | all ranges have the same wrong time tag |

pub(crate) mod broken_system;
pub mod constellation_shift;
pub mod separability;
pub mod time_tag;
