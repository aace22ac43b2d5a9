//! Square roots by the processor's instruction.
//!
//! ```text
//! vsqrt.f32  s0, s0
//! ```
//!
//! `core` has no square root, and libm computes that of a Cortex-M4F in software, by 76
//! instructions. IEEE 754 defines the result to the last bit, so that the instruction and libm
//! agree and a host has the bits of the chip.
//!
//! | processor | root |
//! |---|---|
//! | Arm with floating-point registers in its calling convention (`eabihf`) | `VSQRT.F32` for a single, and from it that of a double; flush-to-zero and default NaN are off after a reset |
//! | WebAssembly with vectors (`simd128`), as in a browser | `f32.sqrt` and `f64.sqrt` |
//! | any other | libm: an instruction on x86-64 and 64-bit Arm, else software |
//!
//! The crate exists because the instruction needs `unsafe`, which `raim-core` forbids. Reference:
//! IEEE 754-2019, §5.4.1.
#![cfg_attr(not(test), no_std)]
#![deny(unsafe_code)]

/// Returns `√x`, correctly rounded: −0 for −0, NaN for other negative numbers and for NaN.
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
#[cfg_attr(compiled_for_size, inline(never))]
#[cfg_attr(not(compiled_for_size), inline)]
#[must_use]
#[allow(unsafe_code, reason = "an instruction that the language has no word for")]
pub fn sqrt(x: f32) -> f32 {
    let mut bits = x.to_bits();
    // The compiler accepts operands in floating-point registers only if there are those of
    // doubles, so that the operand comes in another one and `s0` keeps its value.
    // SAFETY: two registers of the block change, and flags of exceptions, which nobody reads. The
    // instruction traps nowhere, and a target of this convention has it.
    unsafe {
        core::arch::asm!(
            "vmov {kept}, s0",
            "vmov s0, {bits}",
            "vsqrt.f32 s0, s0",
            "vmov {bits}, s0",
            "vmov s0, {kept}",
            bits = inout(reg) bits,
            kept = out(reg) _,
            options(pure, nomem, nostack),
        );
    }
    f32::from_bits(bits)
}

/// Returns `√x`, correctly rounded: −0 for −0, NaN for other negative numbers and for NaN.
#[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
#[inline]
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    return browser::sqrt(x);
    #[cfg(not(all(target_arch = "wasm32", target_feature = "simd128")))]
    libm::sqrtf(x)
}

/// Returns the same of a double.
#[inline]
#[must_use]
pub fn sqrt_f64(x: f64) -> f64 {
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    return browser::sqrt_f64(x);
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    return double::root(x);
    #[cfg(not(any(
        all(target_arch = "wasm32", target_feature = "simd128"),
        all(target_arch = "arm", target_abi = "eabihf")
    )))]
    libm::sqrt(x)
}

#[cfg(any(test, all(target_arch = "arm", target_abi = "eabihf")))]
mod double;

/// Roots of vectors of equal numbers: `core` has words for those, and the compiler makes them the
/// instruction of one number.
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod browser {
    use core::arch::wasm32::{
        f32x4_extract_lane, f32x4_splat, f32x4_sqrt, f64x2_extract_lane, f64x2_splat, f64x2_sqrt,
    };

    #[inline]
    pub(super) fn sqrt(x: f32) -> f32 {
        f32x4_extract_lane::<0>(f32x4_sqrt(f32x4_splat(x)))
    }

    #[inline]
    pub(super) fn sqrt_f64(x: f64) -> f64 {
        f64x2_extract_lane::<0>(f64x2_sqrt(f64x2_splat(x)))
    }
}

/// The example of the readme.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(test)]
mod tests {
    use super::sqrt;

    /// Returns the root of the double, rounded. Its 53 digits are more than twice the 24 of a
    /// single and two, so that two roundings give what one gives.
    fn by_double(x: f32) -> f32 {
        f64::from(x).sqrt() as f32
    }

    #[test]
    fn roots_are_those_of_the_double_rounded() {
        // Zero, subnormal and normal numbers, every exponent; infinity and NaN at the end.
        for bits in (0..=f32::INFINITY.to_bits()).step_by(1_021).chain([1, f32::INFINITY.to_bits()]) {
            let x = f32::from_bits(bits);
            assert_eq!(sqrt(x).to_bits(), by_double(x).to_bits(), "{x}");
        }
    }

    #[test]
    fn negative_numbers_have_no_root_but_zero() {
        assert_eq!(sqrt(-0.0).to_bits(), (-0.0_f32).to_bits());
        for x in [-1.0, -f32::MIN_POSITIVE, f32::from_bits(0x8000_0001), f32::NEG_INFINITY, f32::NAN] {
            assert!(sqrt(x).is_nan(), "{x}");
        }
    }
}
