//! The proof that nothing panics, by the linker: an image that links only if no panic is reachable.
//!
//! The image passes out pointers to every function of the documented interface of [`raim_core`], in
//! both precisions, and of [`raim_firmware`]. The compiler must therefore translate them, and all
//! that they call, for all arguments. The panic handler calls a symbol that exists nowhere. Any
//! bounds check, unwrap or division that optimisation leaves would call the handler. If the image
//! links, none is left.
//!
//! The proof holds for this compiler, the profile `firmware` (fat link-time optimisation, one
//! codegen unit) and this target, which are those of the shipped image. It does not cover the
//! board's own files, overflow (which wraps in this profile), derived `Debug` and `Clone`, or a
//! stack that is too deep.
//!
//! `rig::no_panic` builds it with the calls that it reads from the documentation, names the functions
//! that prevent linking, and proves the shipped images and the library for C likewise.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![deny(unsafe_code)]
#![allow(unreachable_pub)] // A binary's modules have no outside.

#[cfg(target_os = "none")]
mod handler;
#[cfg(all(target_os = "none", interface))]
mod stand_in;

/// Takes every element, so that all of an iterator is reached.
#[cfg(all(target_os = "none", interface))]
pub fn exhaust(elements: impl Iterator) {
    elements.for_each(|element| {
        ::core::hint::black_box(&element);
    });
}

#[cfg(target_os = "none")]
mod image {
    use cortex_m_rt::entry;
    use stm32f4 as _; // The table of its interrupts is part of every image.

    /// Every function of the documented interface.
    #[cfg(interface)]
    #[allow(clippy::too_many_lines, reason = "a line for each function")]
    mod calls {
        include!(env!("RAI_INTERFACE"));
    }

    #[entry]
    fn main() -> ! {
        #[cfg(interface)]
        calls::reach_all();
        loop {
            cortex_m::asm::wfi();
        }
    }
}

/// Does nothing, because the proof is in the linking.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this image is not for running: that it links for the chip is the proof");
}
