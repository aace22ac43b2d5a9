//! Absolute lengths, whose small differences are computed exactly and then converted to a scalar.
//!
//! A range of 26,000 km must be accurate to a millimetre, which takes twelve digits. Its difference
//! to the distance of the satellite takes seven. For the scalar `f64` an absolute length is a
//! double. For `f32` it is a multiple of 2⁻¹⁴ m, a [`Grid`]. On a processor that emulates doubles,
//! 64-bit integers add exactly and multiply in five instructions; a double takes seventy.
//!
//! ```text
//! |v| = D + ρ        D ≈ √(v·v), computed in f32 and then taken as exact        ρ = (v·v − D²) / 2D
//! ```
//!
//! `v·v − D²` is exact: its terms overflow 64 bits and wrap, but their sum fits. The neglected part
//! of `ρ` is `ρ²/2D`.
//!
//! | symbol | where | unit |
//! |---|---|---|
//! | `D` | [`Length::whole`] | m, with `f32` in steps of 1/8 m |
//! | `D`, rounded | [`Length::rounded`] | [`Absolute::UNIT_M`] |
//! | `ρ` | [`Length::rest`] | m, with `f32` below 8·10⁻⁷ of `D` |
//!
//! With `f32` a coordinate is rounded by at most 31 µm, and `ρ²/2D` is below 2 µm for a satellite
//! of any navigation system. Lengths up to [`Grid::LONGEST_M`] are computed correctly. Longer ones
//! give an unspecified value, without panic.

use core::fmt::Debug;

use super::{sqrt, sqrt_f64};

/// A length in two parts, a large and a small one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length<A, T> {
    /// Large part, exact.
    pub whole: A,
    /// Large part, rounded to the scalar, in [`Absolute::UNIT_M`].
    pub rounded: T,
    /// Small part, m.
    pub rest: T,
}

/// A coordinate or a range, m, whose differences fit a scalar `T`.
pub trait Absolute<T>: Copy + Debug + PartialEq {
    /// Unit of [`Self::units`], m, a power of two.
    const UNIT_M: T;

    /// Converts a number of metres. NaN and too large values become the largest or the smallest
    /// value.
    fn of(metres: f64) -> Self;
    /// Works like [`Self::of`] for coordinates and ranges of an [`Epoch`](crate::epoch::Epoch),
    /// which are no larger than 10¹⁰ m. Another number gives an unspecified value.
    fn of_admitted(metres: f64) -> Self;
    /// Returns this length minus another.
    #[must_use]
    fn less(self, other: Self) -> Self;
    /// Returns the number of metres, exactly.
    fn widen(self) -> f64;
    /// Returns a difference in the scalar, m.
    fn narrow(self) -> T;
    /// Returns a vector for directions, in [`Self::UNIT_M`]. A direction is a quotient, so that the
    /// unit cancels.
    fn units(coordinates: [Self; 3]) -> [T; 3];
    /// Returns a vector for directions, m.
    fn vector(coordinates: [Self; 3]) -> [T; 3];
    /// Returns the length of a vector.
    fn length(coordinates: [Self; 3]) -> Length<Self, T>;
}

impl Absolute<f64> for f64 {
    const UNIT_M: f64 = 1.0;

    fn of(metres: f64) -> Self {
        metres
    }

    fn of_admitted(metres: f64) -> Self {
        metres
    }

    fn less(self, other: Self) -> Self {
        self - other
    }

    fn widen(self) -> f64 {
        self
    }

    fn narrow(self) -> f64 {
        self
    }

    fn units(coordinates: [Self; 3]) -> [f64; 3] {
        coordinates
    }

    fn vector(coordinates: [Self; 3]) -> [f64; 3] {
        coordinates
    }

    fn length([x, y, z]: [Self; 3]) -> Length<Self, f64> {
        let length = sqrt_f64(x * x + y * y + z * z);
        Length { whole: length, rounded: length, rest: 0.0 }
    }
}

/// A multiple of 2⁻¹⁴ m.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid(i64);

impl Grid {
    /// Longest vector whose length is computed correctly, m: twice the largest distance of a
    /// satellite or a receiver.
    pub const LONGEST_M: f64 = 2e8;

    /// Number of binary digits after the point.
    const DIGITS: i32 = 14;

    /// Largest number, above 10¹¹ m. Sums of a few such numbers do not wrap.
    const LARGEST: i64 = 1 << 51;

    /// Number of binary digits that are removed from a coordinate so that it fits 32 bits.
    const COARSER: i32 = 11;
    /// Number of binary digits after the point that then remain.
    const COARSE_DIGITS: i32 = Self::DIGITS - Self::COARSER;

    /// Rounds a multiple of 2^−`digits` m to the nearest multiple, halves upwards, for `digits` of
    /// 15 to 63.
    #[must_use]
    pub const fn of_multiple(units: i64, digits: u32) -> Self {
        // Removes all digits after the grid's, except for one, by which the number is rounded.
        let shift = digits.saturating_sub(Self::DIGITS as u32 + 1);
        Self((units.wrapping_shr(shift) + 1) >> 1)
    }
}

// The longest vector, in units of its coarse form, must fit 32 bits.
const _: () = assert!(Grid::LONGEST_M * ((1 << Grid::COARSE_DIGITS) as f64) < i32::MAX as f64);

impl Absolute<f32> for Grid {
    const UNIT_M: f32 = 1.0 / (1 << Self::COARSE_DIGITS) as f32;

    /// Rounds to the nearest multiple, halves away from 0.
    fn of(metres: f64) -> Self {
        Self(if HAS_DOUBLES { by_doubles(metres) } else { by_bits(metres) })
    }

    fn of_admitted(metres: f64) -> Self {
        Self(if HAS_DOUBLES { by_addition(metres) } else { by_bits(metres) })
    }

    fn less(self, other: Self) -> Self {
        Self(self.0.wrapping_sub(other.0))
    }

    fn widen(self) -> f64 {
        if HAS_DOUBLES { self.0 as f64 * STEP_M } else { of_bits(self.0) }
    }

    fn narrow(self) -> f32 {
        const STEP_M: f32 = 1.0 / (1 << Grid::DIGITS) as f32;
        let units = if HAS_DOUBLES && is_rounded_once(self.0) { self.0 as f32 } else { in_two_words(self.0) };
        units * STEP_M
    }

    fn units(coordinates: [Self; 3]) -> [f32; 3] {
        let [x, y, z] = coordinates;
        [coarse(x), coarse(y), coarse(z)]
    }

    fn vector(coordinates: [Self; 3]) -> [f32; 3] {
        let [x, y, z] = Self::units(coordinates);
        [x * Self::UNIT_M, y * Self::UNIT_M, z * Self::UNIT_M]
    }

    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn length(coordinates: [Self; 3]) -> Length<Self, f32> {
        // The upper half of the digits suffices, because the lower ones are below a nanometre.
        // `SCALE` converts the quotient to metres.
        const LOWER: u32 = 31;
        const SCALE: f32 = (1_u64 << LOWER) as f32 / (1_u64 << (Grid::DIGITS + Grid::COARSER + 1)) as f32;
        let [x, y, z] = coordinates;
        let root = {
            let (x, y, z) = (coarse(x), coarse(y), coarse(z));
            sqrt(x * x + y * y + z * z)
        };
        let (whole, rounded) =
            if HAS_DOUBLES && root >= WHOLE { (by_sum(root), root) } else { by_conversion(root) };
        let square = |Self(value)| i64::wrapping_mul(value, value);
        let squares = square(x).wrapping_add(square(y)).wrapping_add(square(z));
        let squares = squares.wrapping_sub(square(Self(whole)));
        let rest = (squares >> LOWER) as i32 as f32 * SCALE / rounded;
        Length { whole: Self(whole), rounded, rest }
    }
}

/// True for a processor that adds doubles by an instruction, as hosts do.
///
/// It has the integers of the others for less: a sum with a power of two shifts the digits of a
/// number to a fixed place, where they are read as an integer.
const HAS_DOUBLES: bool = cfg!(not(target_os = "none"));

/// Returns the nearest multiple of 2⁻¹⁴ m as [`Grid`] defines it, from the bits of the double.
fn by_bits(metres: f64) -> i64 {
    const MANTISSA_BITS: i32 = 52;
    const BIAS: i32 = 1023;
    // The upper word decides, so that only one shift needs both words.
    let upper = (metres.to_bits() >> 32) as i32;
    let exponent = upper >> (MANTISSA_BITS - 32) & 0x7FF;
    let mantissa = metres.to_bits() & ((1 << MANTISSA_BITS) - 1) | 1 << MANTISSA_BITS;
    // Number of digits after the grid's, except for one, by which the number is rounded.
    let shift = BIAS + MANTISSA_BITS - Grid::DIGITS - 1 - exponent;
    let magnitude = match shift {
        // Infinity and NaN have the largest exponent.
        ..=0 => Grid::LARGEST,
        1..=52 => (((mantissa >> shift) + 1) >> 1).cast_signed(),
        _ => 0,
    };
    let sign = i64::from(upper >> 31);
    (magnitude ^ sign) - sign
}

/// Step of the grid, m.
const STEP_M: f64 = 1.0 / (1 << Grid::DIGITS) as f64;

/// Returns a number of steps in metres, exactly.
///
/// The double is composed of its bits, because a conversion and a product are library calls on this
/// processor.
fn of_bits(units: i64) -> f64 {
    const BIAS: u32 = 1023;
    /// Leading zeros of a number whose first bit is in the place of a mantissa's.
    const OF_MANTISSA: u32 = 11;
    let size = units.unsigned_abs();
    let zeros = size.leading_zeros();
    if size == 0 || zeros < OF_MANTISSA {
        return units as f64 * STEP_M;
    }
    // The first bit of the mantissa adds 1 to the exponent.
    let exponent = BIAS + 63 - 1 - Grid::DIGITS as u32 - zeros;
    let bits = (size << (zeros - OF_MANTISSA)) + (u64::from(exponent) << 52);
    f64::from_bits(bits | units.cast_unsigned() & 1 << 63)
}

/// A double whose neighbours are 2⁻¹⁴ m away, up to [`Grid::LARGEST`] steps on both sides.
const CENTRE: f64 = 1.5 * (Grid::LARGEST >> (Grid::DIGITS - 1)) as f64;

/// Returns the same as [`by_bits`] for numbers below [`Grid::LARGEST`] steps, by the rounding of a
/// sum.
fn by_addition(metres: f64) -> i64 {
    // A sum rounds a half to the even neighbour. With its last bit set, no number is a half: a half
    // becomes larger, and the number below it has this bit already.
    let beside_half = f64::from_bits(metres.to_bits() | 1);
    (beside_half + CENTRE).to_bits().wrapping_sub(CENTRE.to_bits()).cast_signed()
}

/// Returns the same as [`by_bits`], by the rounding of a sum. Only the sign of a NaN may differ.
fn by_doubles(metres: f64) -> i64 {
    /// The number that is rounded up to the largest.
    const LARGEST_M: f64 = ((Grid::LARGEST >> Grid::DIGITS) as f64).next_down();
    // An instruction each: the order of the comparisons settles NaN.
    let metres = if metres < LARGEST_M { metres } else { LARGEST_M };
    by_addition(if metres > -LARGEST_M { metres } else { -LARGEST_M })
}

/// Number below which [`in_two_words`] rounds once, as a conversion by an instruction does.
const ROUNDED_ONCE: i64 = 1 << 46;

/// Returns true from −[`ROUNDED_ONCE`] up to it.
fn is_rounded_once(units: i64) -> bool {
    const DIGITS: u32 = ROUNDED_ONCE.trailing_zeros() + 1;
    units.wrapping_add(ROUNDED_ONCE).cast_unsigned() >> DIGITS == 0
}

/// Returns a single from two words, which the processor converts: below [`ROUNDED_ONCE`] both
/// exactly, so that one rounding remains.
fn in_two_words(units: i64) -> f32 {
    const LOWER: u32 = 22;
    let upper = (units >> LOWER) as i32 as f32 * (1 << LOWER) as f32;
    let lower = (units & ((1 << LOWER) - 1)) as i32 as f32;
    upper + lower
}

/// Single from which on all are whole numbers.
const WHOLE: f32 = (1 << 23) as f32;

/// Returns a length in steps of the grid and in its own unit, without the digits behind the point,
/// and 1 at least. It is below 2³².
fn by_conversion(root: f32) -> (i64, f32) {
    let approximate = (root as u32).max(1);
    (i64::from(approximate) << Grid::COARSER, approximate as f32)
}

/// Returns the first result of [`by_conversion`] for a whole number, by the digits of a sum.
fn by_sum(root: f32) -> i64 {
    /// A double whose neighbours are 2⁻¹¹ away.
    const BASE: f64 = (1_u64 << (52 - Grid::COARSER)) as f64;
    (f64::from(root) + BASE).to_bits().wrapping_sub(BASE.to_bits()).cast_signed()
}

/// Returns a coordinate in units of 2⁻³ m, which fits 32 bits.
fn coarse(Grid(value): Grid) -> f32 {
    (value >> Grid::COARSER) as i32 as f32
}

#[cfg(test)]
mod tests {
    use super::{
        Absolute, Grid, ROUNDED_ONCE, WHOLE, by_addition, by_bits, by_conversion, by_doubles, by_sum,
        in_two_words, of_bits,
    };

    /// Patterns of bits that repeat only after 2⁶⁴ (`SplitMix64`).
    fn patterns() -> impl Iterator<Item = u64> {
        let mut state = 2026_u64;
        core::iter::from_fn(move || {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mixed = (state ^ state >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
            Some(mixed ^ mixed >> 31)
        })
    }

    fn agree(metres: f64) {
        for metres in [metres, -metres] {
            let (have, want) = (by_doubles(metres), by_bits(metres));
            let is_alike = if metres.is_nan() { have.abs() == want.abs() } else { have == want };
            assert!(is_alike, "{metres:e}: {have}, not {want}");
            if metres.abs() <= 1e10 {
                assert_eq!(by_addition(metres), by_bits(metres), "{metres:e}");
            }
        }
    }

    #[test]
    fn both_ways_to_the_grid_agree_on_any_double() {
        patterns().take(1_000_000).for_each(|bits| agree(f64::from_bits(bits)));
        // Lengths of the exponents that decide: from below a unit to beyond the largest.
        for bits in patterns().take(2_000_000) {
            let exponent = 1023 - 16 + bits % 56;
            agree(f64::from_bits(exponent << 52 | bits >> 12));
        }
    }

    #[test]
    fn both_ways_to_the_grid_agree_on_halves_and_their_neighbours() {
        for bits in patterns().take(500_000) {
            let half = (bits >> (11 + bits % 53)) as f64 / 32_768.0;
            [half.next_down(), half, half.next_up()].into_iter().for_each(agree);
        }
        let edges = [0.0, 0.5 / 16_384.0, 137_438_953_472.0, f64::MIN_POSITIVE, f64::MAX, f64::INFINITY];
        for edge in edges {
            [edge.next_down(), edge, edge.next_up()].into_iter().for_each(agree);
        }
        [f64::NAN, f64::from_bits(u64::MAX), f64::from_bits(0x7FF0_0000_0000_0001)]
            .into_iter()
            .for_each(agree);
    }

    #[test]
    fn the_grid_rounds_as_the_standard_library_does() {
        for bits in patterns().take(1_000_000) {
            // Up to 2³⁷ m, with 0 to 31 digits behind the point; the last digit is a half.
            let units = (bits >> (13 + bits % 32)) as f64 / 2.0;
            let metres = units / 16_384.0;
            if units < Grid::LARGEST as f64 {
                assert_eq!(by_bits(metres), units.round() as i64, "{metres:e}");
            }
        }
    }

    #[test]
    fn both_ways_from_the_grid_agree() {
        patterns().take(1_000_000).map(|bits| (bits >> (bits % 64)).cast_signed()).for_each(|units| {
            for units in [units, -units] {
                assert_eq!(
                    Absolute::<f32>::widen(Grid(units)).to_bits(),
                    of_bits(units).to_bits(),
                    "{units}"
                );
            }
        });
        assert_eq!(of_bits(0).to_bits(), 0);
    }

    #[test]
    fn a_conversion_rounds_once_as_two_words_do() {
        let agree = |units: i64| {
            for units in [units, -units] {
                assert_eq!((units as f32).to_bits(), in_two_words(units).to_bits(), "{units}");
            }
        };
        let limit = ROUNDED_ONCE;
        [0, 1, (1 << 24) - 1, (1 << 24) + 1, (1 << 22) - 1, 1 << 22, limit - 1].into_iter().for_each(agree);
        patterns().take(1_000_000).for_each(|bits| agree((bits >> (18 + bits % 46)).cast_signed()));
        // A number whose 25th digit and last digit are 1 alone tells one rounding from two.
        (25..46).for_each(|digits| agree((1 << digits) + (1 << (digits - 24)) + 1));
    }

    #[test]
    fn a_whole_length_has_the_digits_of_its_conversion() {
        // Every length below 2³² that is a single without digits behind the point, in steps.
        let last = (u32::MAX as f32).next_down().to_bits();
        for bits in (WHOLE.to_bits()..=last).step_by(7).chain([last]) {
            let root = f32::from_bits(bits);
            assert_eq!((by_sum(root), root), by_conversion(root), "{root}");
        }
    }
}
