//! Evidence that an engineer can hand on: requirements, faults, configuration and open points on
//! one page.
//!
//! ```text
//! requirements ─┐
//! fault tree ───┼─► evidence ─► page, text          figures: attacks and the experiment `fde`, run now
//! configuration ┘
//! ```
//!
//! | part | module |
//! |---|---|
//! | trace table: requirement, module, test, figure, and what is not met and why | [`requirement`] |
//! | fault tree from the hazard to the attacks | [`fault_tree`] |
//! | configuration index: version, settings, tables, keys, image | [`configuration`] |
//! | what is not shown | [`not_shown`] |
//! | the page and its text | [`document`] |
//!
//! The table and the tree are data. Tests check that every attack is a leaf of the tree, that every
//! file exists, and that every command names something that can be run.

pub mod configuration;
pub mod document;
pub mod fault_tree;
pub mod not_shown;
pub mod requirement;
