//! Memory that start-up neither clears nor fills.

use cortex_m::interrupt;
use raim_firmware::board::SEALED_BYTES;

#[allow(unsafe_code)]
#[unsafe(link_section = ".uninit.SEALED")]
static mut SEALED: core::mem::MaybeUninit<[u8; SEALED_BYTES]> = core::mem::MaybeUninit::uninit();

static mut IS_TAKEN: bool = false;

/// Returns the memory, or `None` if it was taken before.
#[allow(unsafe_code)]
pub(crate) fn take() -> Option<&'static mut [u8; SEALED_BYTES]> {
    interrupt::free(|_| {
        // SAFETY: interrupts are held back and the core is single; it is handed out once, so that
        // the reference is the only one. Any bytes are a value; a volatile read and write back
        // makes them one for the compiler as well.
        unsafe {
            if (&raw mut IS_TAKEN).replace(true) {
                return None;
            }
            let bytes = (&raw mut SEALED).cast::<[u8; SEALED_BYTES]>();
            // Byte by byte, because a copy of the whole would go through the stack, in three
            // thousand instructions without a loop.
            for index in 0..SEALED_BYTES {
                let byte = bytes.cast::<u8>().add(index);
                byte.write(byte.read_volatile());
            }
            Some(&mut *bytes)
        }
    })
}
