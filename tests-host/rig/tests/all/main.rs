//! Tests of the program behind `cargo xtask replay` and its like.

mod command_line;
mod first_steps;
mod long_recordings;
