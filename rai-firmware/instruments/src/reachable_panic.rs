//! A panic that the proof of `no_panic` must find: an image of one function.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![deny(unsafe_code)]

#[cfg(target_os = "none")]
#[path = "no_panic/handler.rs"]
mod handler;

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;

    use cortex_m_rt::entry;
    use stm32f4 as _; // The table of its interrupts is part of every image.

    #[entry]
    fn main() -> ! {
        black_box(element as fn(_, _) -> _);
        loop {
            cortex_m::asm::wfi();
        }
    }

    /// Indexes out of bounds.
    fn element(elements: &[u8], index: usize) -> u8 {
        elements[index]
    }
}

/// Does nothing, because the proof is in the linking.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this image is not for running: its link shows that a panic is found");
}
