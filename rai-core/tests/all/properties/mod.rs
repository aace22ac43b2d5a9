//! Properties for any satellites: no protection without its grounds, no dependence on irrelevant
//! inputs.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

mod any_input;
mod precision;
mod removal;
mod skies;
mod symmetries;
