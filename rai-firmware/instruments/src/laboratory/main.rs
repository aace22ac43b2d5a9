//! The measuring image: runs stages of the module on the chip's processor and reports cost and
//! result of each.
//!
//! ```text
//! host: requests.bin ──► [stage, scalar, epoch or bytes] ──► run
//!                                  run ──► [ticks, result bits] ──► answers.bin :host
//! ```
//!
//! It is no image to flash, because it talks to the host by semihosting, which needs a debugger or
//! the emulator. No interrupt runs, so that the ticks between two readings of the core clock belong
//! to the stage alone. Under `-icount shift=0` they count its instructions, 168 ticks for each
//! thousand.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![deny(unsafe_code)]
#![allow(unreachable_pub)] // A binary's modules have no outside.

#[cfg(target_os = "none")]
mod answer;
#[cfg(target_os = "none")]
mod authentication;
#[cfg(target_os = "none")]
mod copies;
#[cfg(target_os = "none")]
mod epochs;
#[cfg(target_os = "none")]
mod precision;
#[cfg(target_os = "none")]
mod request;
#[cfg(target_os = "none")]
mod roots;
#[cfg(target_os = "none")]
mod semihosting;
#[cfg(target_os = "none")]
mod stages;
#[cfg(target_os = "none")]
mod stopwatch;
#[cfg(target_os = "none")]
mod thread;
#[cfg(target_os = "none")]
mod wire;

/// Prints where the image runs, because it needs the emulator.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this program runs in the emulator: `cargo xtask bench` starts it");
}

#[cfg(target_os = "none")]
mod image {
    use cortex_m::singleton;
    use cortex_m_rt::entry;
    // The functions of memory, as in the images that are flashed.
    use raim_board_arm as _;
    // The vector table needs the chip's interrupts.
    #[cfg(feature = "stm32f405")]
    use stm32f4 as _;

    use crate::request::Requests;
    use crate::stopwatch::Stopwatch;
    use crate::{answer::Answers, semihosting, stages};

    #[entry]
    fn main() -> ! {
        let Some(peripherals) = cortex_m::Peripherals::take() else { semihosting::exit(false) };
        let mut stopwatch = Stopwatch::start(peripherals.SYST);
        // Among the statics, because the stack is for the stages.
        let (Some(requests), Some(answers)) = (
            singleton!(: Option<Requests> = Requests::open()).and_then(Option::as_mut),
            singleton!(: Option<Answers> = Answers::open()).and_then(Option::as_mut),
        ) else {
            semihosting::exit(false)
        };
        while let Some(request) = requests.next() {
            if stages::run(&request, &mut stopwatch, answers).is_none() {
                semihosting::exit(false)
            }
        }
        semihosting::exit(true)
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        semihosting::exit(false)
    }
}
