//! The binary: a board, with the epoch loop on it.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![deny(unsafe_code)]
#![allow(unreachable_pub)] // A binary has no public interface.

#[cfg(all(target_os = "none", not(any(feature = "stm32f405", feature = "mps2-an500"))))]
compile_error!("an image is for a board: choose the feature `stm32f405` or `mps2-an500`");

/// Logs words of a level, in an image with a log.
#[cfg(target_os = "none")]
macro_rules! log {
    ($level:ident, $($words:tt)+) => {
        if cfg!(feature = "log") {
            defmt::$level!($($words)+);
        }
    };
}

#[cfg(target_os = "none")]
#[path = "board/arm/mod.rs"]
mod arm;

#[cfg(any(all(target_os = "none", feature = "stm32f405"), test))]
#[path = "board/stm32f405/mod.rs"]
mod stm32f405;
#[cfg(all(target_os = "none", feature = "stm32f405"))]
use stm32f405 as chip;

#[cfg(all(target_os = "none", feature = "mps2-an500", not(feature = "stm32f405")))]
#[path = "board/mps2_an500/mod.rs"]
mod mps2_an500;
#[cfg(all(target_os = "none", feature = "mps2-an500", not(feature = "stm32f405")))]
use mps2_an500 as chip;

/// Prints where the image runs, because it needs the chip or the emulator.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this program runs on the chip: `cargo xtask demo` shows it in the emulator");
}
