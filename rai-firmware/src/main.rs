//! Wiring of the board.
#![allow(missing_docs)]
fn main() {}
