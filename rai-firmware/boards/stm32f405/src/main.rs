//! The integrity module on an STM32F405: the only package that knows its registers.
//!
//! | part | peripheral and pins |
//! |---|---|
//! | GNSS port | USART2, PA3 in; PA2 out is connected, but nothing is sent |
//! | host port | USART1, PA10 in, PA9 out |
//! | log port | USART3, PB10 out; RTT for a debug probe |
//! | integrity pin, LED | PC6, PC7, both low until the receiver raises them |
//! | time | `SysTick`, one interrupt per millisecond |
//! | watchdog | IWDG, fed by the epoch loop alone |
//!
//! There is no switch between silicon and emulator. Every wait is bounded and every fallback has a
//! name (`clock::Source`). A peripheral that does not answer is reported and does not stop the
//! module.
//!
//! PC6 needs a pull-down of 10 kΩ or less, because it floats from reset to start-up. All ports
//! start at 115200 baud, 8N1.
//!
//! References: [RM0090] reference manual of the family, [DS8626] data sheet of the chip.
//!
//! [RM0090]: raim_firmware#references
//! [DS8626]: raim_firmware#references
#![cfg_attr(target_os = "none", no_std, no_main)]
#![deny(unsafe_code)]
#![allow(unreachable_pub)] // A binary has no public interface.

#[cfg(target_os = "none")]
mod board;
#[cfg(any(target_os = "none", test))]
mod clock;
#[cfg(any(target_os = "none", test))]
mod fault;
#[cfg(target_os = "none")]
mod pins;
#[cfg(target_os = "none")]
mod ports;
#[cfg(target_os = "none")]
mod watchdog;

/// Prints where the image runs, because it needs the chip or the emulator.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this program runs on the chip: `cargo xtask demo` shows it in the emulator");
}
