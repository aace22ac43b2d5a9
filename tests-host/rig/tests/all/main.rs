//! Tests of the program behind `cargo xtask replay` and its like, and of the measuring image.

mod command_line;
mod first_steps;
mod host_and_target;
mod long_recordings;
