//! Tests that take many seconds each: builds of other images and of the libraries for C, and long
//! runs on the emulated boards. `cargo xtask check` runs them, and `cargo xtask test` the others.

mod board_clock_aid;
mod board_recording;
mod capi;
mod capi_bits;
mod clock_tree;
mod cmake;
mod no_panic;
mod page;
mod parity;
mod python;
mod receivers;
mod second_board;
mod zephyr_sample;
