//! Four numbers, with which a host computes at once.
//!
//! ```text
//! a + b        a − b        a b        |a|        each of its four numbers by itself
//! ```
//!
//! A range has three directions and a residual, and every sum over the ranges treats them alike. A
//! host adds or multiplies four singles by one instruction. The compiler does not find this form in
//! sums that were written one by one. A microcontroller has no such instruction, and a browser gains
//! nothing by it: there the four numbers lie [`Apart`], and those that nobody reads are not computed.
//!
//! Each number is rounded as it would be alone, so that a host has the bits of the chip.
#![allow(clippy::inline_always, reason = "what is not inlined computes numbers that nobody reads")]

use core::fmt::Debug;
use core::ops::{Add, Mul, Sub};

use nalgebra::RealField;

/// Four numbers of type `T`.
pub trait Four<T>: Number {
    /// Joins four numbers.
    fn join(numbers: [T; 4]) -> Self;
    /// Repeats a number four times.
    fn repeat(number: T) -> Self;
    /// Returns the four numbers.
    fn numbers(self) -> [T; 4];
    /// Returns the magnitude of each number.
    #[must_use]
    fn magnitudes(self) -> Self;
}

/// Number that can be added, subtracted and multiplied.
pub trait Number:
    Copy + Debug + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
}

impl<T> Number for T where T: Copy + Debug + PartialEq + Add<Output = T> + Sub<Output = T> + Mul<Output = T> {}

/// Four numbers, each of which is computed by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart<T>([T; 4]);

impl<T: Add<Output = T>> Add for Apart<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, Self([e, f, g, h]): Self) -> Self {
        let Self([a, b, c, d]) = self;
        Self([a + e, b + f, c + g, d + h])
    }
}

impl<T: Sub<Output = T>> Sub for Apart<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, Self([e, f, g, h]): Self) -> Self {
        let Self([a, b, c, d]) = self;
        Self([a - e, b - f, c - g, d - h])
    }
}

impl<T: Mul<Output = T>> Mul for Apart<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, Self([e, f, g, h]): Self) -> Self {
        let Self([a, b, c, d]) = self;
        Self([a * e, b * f, c * g, d * h])
    }
}

impl<T: RealField + Copy> Four<T> for Apart<T> {
    #[inline(always)]
    fn join(numbers: [T; 4]) -> Self {
        Self(numbers)
    }
    #[inline(always)]
    fn repeat(number: T) -> Self {
        // Written out, because `[number; 4]` is a loop if compiled for size.
        Self([number, number, number, number])
    }
    #[inline(always)]
    fn numbers(self) -> [T; 4] {
        self.0
    }
    #[inline(always)]
    fn magnitudes(self) -> Self {
        let Self([a, b, c, d]) = self;
        Self([a.abs(), b.abs(), c.abs(), d.abs()])
    }
}

#[cfg(not(any(target_os = "none", target_family = "wasm")))]
impl Four<f32> for wide::f32x4 {
    #[inline]
    fn join(numbers: [f32; 4]) -> Self {
        Self::new(numbers)
    }
    #[inline]
    fn repeat(number: f32) -> Self {
        Self::splat(number)
    }
    #[inline]
    fn numbers(self) -> [f32; 4] {
        self.to_array()
    }
    #[inline]
    fn magnitudes(self) -> Self {
        self.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::{Apart, Four};

    /// Returns the bits of sum, difference, product and magnitude.
    fn bits<F: Four<f32>>(a: [f32; 4], b: [f32; 4]) -> [[u32; 4]; 4] {
        let (a, b) = (F::join(a), F::join(b));
        [a + b, a - b, a * b, a.magnitudes()].map(|result| result.numbers().map(f32::to_bits))
    }

    #[test]
    fn four_at_once_are_four_apart_bit_by_bit() {
        let mut state = 2026_u32;
        let mut number = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // From 2⁻⁶⁰ to 2⁶⁰, with either sign.
            f32::from_bits((state & 0x807F_FFFF) | (67 + (state >> 8) % 121) << 23)
        };
        for _ in 0..100_000 {
            let (a, b) = ([(); 4].map(|()| number()), [(); 4].map(|()| number()));
            assert_eq!(bits::<wide::f32x4>(a, b), bits::<Apart<f32>>(a, b), "{a:?} {b:?}");
        }
        let edges = [0.0, -0.0, f32::MIN_POSITIVE, f32::MAX];
        for other in [[1.0; 4], [-0.0; 4], [f32::EPSILON; 4], [f32::MIN_POSITIVE; 4]] {
            assert_eq!(bits::<wide::f32x4>(edges, other), bits::<Apart<f32>>(edges, other), "{other:?}");
        }
        let three = <wide::f32x4 as Four<f32>>::repeat(3.0);
        assert_eq!(three.numbers().map(f32::to_bits), [3.0_f32.to_bits(); 4]);
    }
}
