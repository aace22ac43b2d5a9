//! Wiring: the board's ports to the receiver, and the epoch loop around it.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![allow(unreachable_pub)] // A binary's modules have no outside.

#[cfg(any(target_os = "none", test))]
mod board;
#[cfg(target_os = "none")]
mod firmware;
#[cfg(target_os = "none")]
mod log;

/// The image runs on the chip or in the emulator; on a host there is only this advice.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this program runs on the chip: `cargo xtask demo` shows it in the emulator");
}
