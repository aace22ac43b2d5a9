//! Parts that all boards with a Cortex-M share: time, guarded stack, faults, log, rings of the
//! ports, memory over a restart, and memory functions.
//!
//! A board is a package with a binary. It implements `Chip`, starts its pin, clock, ports and
//! watchdog, and calls `start::run` with a `CortexBoard` of the chip. `handlers!` gives its image
//! the handlers of panics and faults and the log, of which an image has one each. On a host this
//! library is empty.
#![no_std]
#![cfg(target_os = "none")]
#![deny(unsafe_code)]

pub mod board;
pub mod fault;
pub mod log;
mod memory;
pub mod pin;
pub mod rings;
mod sealed;
pub mod stack;
pub mod start;
pub mod time;

use core::ops::Range;

use embedded_hal::digital::OutputPin;

/// True if the image has a log.
pub const HAS_LOG: bool = raim_firmware::board::HAS_LOG;

/// What only a chip knows.
pub trait Chip {
    /// Output that is the integrity pin.
    type Output: OutputPin;

    /// Addresses in which the stack lies.
    const RAM: Range<usize>;

    /// Drives the integrity pin low, whatever owns it.
    fn drop_integrity_pin();

    /// Queues one frame of the log, whole or not at all. Interrupts are held back.
    fn send_log(frame: &[u8]);

    /// Returns the largest rate at which the clock may run fast, parts per million.
    fn clock_error_ppm(&self) -> u32;

    /// Feeds the watchdog.
    fn feed_watchdog(&mut self);

    /// Sets the rate of the GNSS port, bit/s.
    fn set_gnss_rate(&mut self, baud: u32);
}

/// Logs words of a level, in an image with a log.
#[macro_export]
macro_rules! log {
    ($level:ident, $($words:tt)+) => {
        if $crate::HAS_LOG {
            defmt::$level!($($words)+);
        }
    };
}

/// Gives an image the handlers of panics and hard faults, and the log, of a [`Chip`].
#[macro_export]
macro_rules! handlers {
    ($chip:ty) => {
        #[panic_handler]
        fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
            $crate::fault::panicked::<$chip>(info)
        }

        #[cortex_m_rt::exception]
        #[allow(unsafe_code)]
        unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
            $crate::fault::hard::<$chip>(frame)
        }

        defmt::timestamp!("{=u64:us}", $crate::time::now_us());

        #[defmt::global_logger]
        struct Logger;

        // SAFETY: `acquire` holds interrupts back until `release`; the core is single, so nothing
        // else logs in between.
        #[allow(unsafe_code)]
        unsafe impl defmt::Logger for Logger {
            fn acquire() {
                $crate::log::acquire();
            }

            // The port's interrupt empties the ring. Waiting for it here could last for ever,
            // because interrupts are held back.
            unsafe fn flush() {}

            unsafe fn write(bytes: &[u8]) {
                // SAFETY: defmt calls it between `acquire` and `release`.
                unsafe { $crate::log::write(bytes) }
            }

            unsafe fn release() {
                // SAFETY: defmt calls it once for each `acquire`.
                unsafe { $crate::log::release::<$chip>() }
            }
        }
    };
}
