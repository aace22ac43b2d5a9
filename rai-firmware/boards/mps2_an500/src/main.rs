//! The emulated MPS2 board with the image AN500, a Cortex-M7 with doubles in hardware, as an
//! example of a port.
//!
//! | part | peripheral |
//! |---|---|
//! | host, GNSS, log port | UART 0, 1, 2 (CMSDK) |
//! | integrity pin | user LED 0 of the board's registers |
//! | time | `SysTick`, one interrupt per millisecond |
//! | watchdog | CMSDK watchdog, fed by the epoch loop alone |
//!
//! The emulator keeps no reset flags, so that a start without the record of a fault reports
//! `UNKNOWN`. The LED register is written but not emulated; the log shows the pin.
//!
//! References: [AN500]; [CMSDK] (UART, watchdog).
//!
//! [AN500]: raim_firmware#references
//! [CMSDK]: raim_firmware#references
#![cfg_attr(target_os = "none", no_std, no_main)]
#![deny(unsafe_code)]
#![allow(unreachable_pub)] // A binary has no public interface.

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod ports;
#[cfg(target_os = "none")]
mod registers;

/// Prints where the image runs, because it needs the emulator.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this program runs in the emulator: tests start it");
}
