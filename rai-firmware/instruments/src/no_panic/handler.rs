//! Panic handler that exists nowhere: it calls a symbol that no library defines.

use core::panic::PanicInfo;

#[allow(unsafe_code)]
// SAFETY: the symbol is defined nowhere, so an image that could call it never runs.
unsafe extern "C" {
    safe fn rai_a_panic_is_reachable_here() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    rai_a_panic_is_reachable_here()
}
