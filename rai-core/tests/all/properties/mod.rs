//! What must hold whatever the satellites are: no promise without its grounds, no dependence on what does not matter.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

mod any_input;
mod precision;
mod removal;
mod skies;
mod symmetries;
