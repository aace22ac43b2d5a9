//! Tests of the program behind `cargo xtask replay` and its like.

mod command_line;
mod long_recordings;
