//! The panic handler. No panic is reachable (the linker proves it), but a program without an
//! operating system needs a handler.
//!
//! The handler calls `rai_panic`, which the library defines weakly as an endless loop. A C program
//! may define a function of that name, which then decides how to fail safe.

use core::panic::PanicInfo;

#[cfg(target_arch = "arm")]
core::arch::global_asm!(
    ".section .text.rai_panic,\"ax\",%progbits",
    ".weak rai_panic",
    ".type rai_panic,%function",
    ".thumb_func",
    "rai_panic:",
    "b rai_panic",
);

#[cfg(any(target_arch = "riscv32", target_arch = "riscv64"))]
core::arch::global_asm!(
    ".section .text.rai_panic,\"ax\",%progbits",
    ".weak rai_panic",
    ".type rai_panic,%function",
    "rai_panic:",
    "j rai_panic",
);

#[allow(unsafe_code)]
// SAFETY: the function takes nothing, touches no memory of this library and does not return.
unsafe extern "C" {
    safe fn rai_panic() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    rai_panic()
}
