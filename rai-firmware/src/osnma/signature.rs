//! Signature of a root key: ECDSA with P-256 and SHA-256, in slices.
//!
//! ```text
//! right if  z G + r Q = ± s R,  R on the curve with x = r
//! ```
//!
//! | symbol | what |
//! |---|---|
//! | `z` | hash of the message |
//! | `r`, `s` | signature, from 1 to `n − 1` |
//! | `G`, `Q` | generator; the public key |
//! | `n` | order of the curve |
//!
//! This is the usual equation `x(s⁻¹ (z G + r Q)) ≡ r (mod n)` times `s`. It needs no arithmetic modulo
//! `n`, which would take 3 KiB of flash, but a second multiplication of a point. A signature whose
//! point has `x = r + n` is refused; one in 2¹²⁸ is such.
//!
//! | slices | step |
//! |---|---|
//! | 16 | `y` of the key: the power `(p + 1) / 4`, 16 bits a slice |
//! | 1 | `G + Q` |
//! | 256 | `z G + r Q`, a bit of both a slice: doubled, then plus `G`, `Q`, `G + Q` or none |
//! | 16 | `y` of `R` |
//! | 256 | `s R` |
//!
//! Nothing here is secret, so that the time may depend on the numbers.
//!
//! Reference: [FIPS-186-5] 6.4.2.
//!
//! [FIPS-186-5]: crate#references

use p256::FieldElement;

use super::curve::{Bytes, Point, element, square_of_y};

/// Bits of an exponent in a slice.
const BITS: u16 = 16;

/// `(p + 1) / 4`, in words of [`BITS`].
const ROOT: [u16; 16] = [0x3fff, 0xffff, 0xc000, 0, 0x4000, 0, 0, 0, 0, 0, 0x4000, 0, 0, 0, 0, 0];

/// `n`.
const ORDER: Bytes = [
    0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xbc, 0xe6, 0xfa,
    0xad, 0xa7, 0x17, 0x9e, 0x84, 0xf3, 0xb9, 0xca, 0xc2, 0xfc, 0x63, 0x25, 0x51,
];

/// What the verification does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// Raises the square of `y` to a power, a word of the exponent at a time.
    Lift(u8),
    /// Adds generator and key.
    Join,
    /// Takes the bit with this number of the factors.
    Multiply(u8),
    Done(bool),
}

/// Verification of a signature that has begun.
#[derive(Clone, Copy, Debug)]
pub(super) struct Verification {
    hash: Bytes,
    r: Bytes,
    s: Bytes,
    is_odd: bool,
    /// True from `R` on.
    is_second: bool,
    step: Step,
    /// The key, then `R`.
    point: Point,
    /// `G + Q`, then the first sum.
    other: Point,
    /// The sum, and before it the power in `x`.
    sum: Point,
}

impl Verification {
    /// Begins a verification by a key in its compressed form.
    pub(super) fn new(key: &[u8; 33], hash: Bytes, signature: &[u8; 64]) -> Self {
        let [form, x @ ..] = key;
        let (first, second) = signature.split_at(32);
        let half = |half: &[u8]| half.first_chunk().copied().unwrap_or_default();
        let (r, s): (Bytes, Bytes) = (half(first), half(second));
        let is_factor = |bytes: &Bytes| *bytes != [0; 32] && *bytes < ORDER;
        let is_valid = is_factor(&r) && is_factor(&s) && matches!(form, 2 | 3);
        let mut verification = Self {
            hash,
            r,
            s,
            is_odd: *form == 3,
            is_second: false,
            step: Step::Done(false),
            point: Point::INFINITE,
            other: Point::INFINITE,
            sum: Point::INFINITE,
        };
        if is_valid {
            verification.lift_from(x);
        }
        verification
    }

    /// Takes one step; returns the outcome if it was the last.
    #[inline(never)]
    pub(super) fn go_on(&mut self) -> Option<bool> {
        match self.step {
            Step::Lift(part) => self.lift(part),
            Step::Join => {
                self.other = Point::generator().plus(&self.point);
                self.step = Step::Multiply(0);
            }
            Step::Multiply(number) => self.multiply(number),
            Step::Done(is_right) => return Some(is_right),
        }
        None
    }

    /// Begins to look for the point with this `x`.
    fn lift_from(&mut self, x: &Bytes) {
        let x = element(x);
        self.step = if x.is_some() { Step::Lift(0) } else { Step::Done(false) };
        let x = x.unwrap_or(FieldElement::ZERO);
        self.point = Point { x, y: square_of_y(&x), z: FieldElement::ONE };
        self.sum.x = FieldElement::ONE;
    }

    fn lift(&mut self, part: u8) {
        let square = self.point.y;
        let power = &mut self.sum.x;
        if let Some(word) = ROOT.get(usize::from(part)) {
            for bit in (0..BITS).rev() {
                *power = power.square();
                if word >> bit & 1 != 0 {
                    *power *= square;
                }
            }
            self.step = Step::Lift(part + 1);
            return;
        }
        if power.square() != square {
            self.step = Step::Done(false);
            return;
        }
        self.point.y = if bool::from(power.is_odd()) == self.is_odd { *power } else { -*power };
        self.sum = Point::INFINITE;
        self.step = if self.is_second { Step::Multiply(0) } else { Step::Join };
    }

    fn multiply(&mut self, number: u8) {
        let bit = |factor: &Bytes| {
            let byte = factor.get(usize::from(number / 8)).copied().unwrap_or_default();
            byte >> (7 - number % 8) & 1 != 0
        };
        let (has_generator, has_point) =
            if self.is_second { (false, bit(&self.s)) } else { (bit(&self.hash), bit(&self.r)) };
        let doubled = self.sum.plus(&self.sum);
        let generator;
        let more = match (has_generator, has_point) {
            (false, false) => None,
            (true, false) => {
                generator = Point::generator();
                Some(&generator)
            }
            (false, true) => Some(&self.point),
            (true, true) => Some(&self.other),
        };
        self.sum = more.map_or(doubled, |more| doubled.plus(more));
        self.step = Step::Multiply(number.wrapping_add(1));
        if number == u8::MAX {
            if self.is_second {
                self.step = Step::Done(self.is_right());
            } else {
                (self.other, self.is_second) = (self.sum, true);
                let r = self.r;
                self.lift_from(&r);
            }
        }
    }

    /// Compares the two sums, of which either may have the other's opposite `y`.
    fn is_right(&self) -> bool {
        let (first, second) = (&self.other, &self.sum);
        let is_finite = first.z != FieldElement::ZERO && second.z != FieldElement::ZERO;
        is_finite && first.x * second.z == second.x * first.z
    }
}

#[cfg(test)]
mod tests {
    use p256::elliptic_curve::PrimeField as _;
    use p256::elliptic_curve::ops::Reduce;
    use p256::elliptic_curve::sec1::ToEncodedPoint as _;
    use p256::{FieldBytes, ProjectivePoint, Scalar, U256};

    use super::*;

    fn scalar(bytes: Bytes) -> Scalar {
        <Scalar as Reduce<U256>>::reduce_bytes(&FieldBytes::from(bytes))
    }

    /// Returns key, hash and signature, by the arithmetic of the crate.
    fn signed(seed: u8) -> ([u8; 33], Bytes, [u8; 64]) {
        let number = |kind: u8| core::array::from_fn(|index| (index as u8).wrapping_mul(7 * seed) ^ kind);
        let (secret, nonce, hash) = (scalar(number(0x31)), scalar(number(0x75)), number(0xC4));
        let key = (ProjectivePoint::GENERATOR * secret).to_affine().to_encoded_point(true);
        let point = (ProjectivePoint::GENERATOR * nonce).to_affine().to_encoded_point(false);
        let r = scalar((*point.x().expect("a coordinate")).into());
        let s = nonce.invert().expect("not zero") * (scalar(hash) + r * secret);
        let mut signature = [0; 64];
        signature[..32].copy_from_slice(&r.to_repr());
        signature[32..].copy_from_slice(&s.to_repr());
        (key.as_bytes().try_into().expect("33 bytes"), hash, signature)
    }

    fn is_right(key: &[u8; 33], hash: Bytes, signature: &[u8; 64]) -> bool {
        let mut verification = Verification::new(key, hash, signature);
        (0..600).find_map(|_| verification.go_on()).expect("an end")
    }

    #[test]
    fn signatures_are_right_and_with_one_bit_changed_they_are_wrong() {
        for seed in 1..4 {
            let (key, hash, signature) = signed(seed);
            assert!(is_right(&key, hash, &signature), "signature {seed}");
            for bit in (0..8 * 33).step_by(29) {
                let mut other = key;
                other[bit / 8] ^= 1 << (bit % 8);
                assert!(!is_right(&other, hash, &signature), "bit {bit} of the key");
            }
            for bit in (0..8 * 32).step_by(37) {
                let mut other = hash;
                other[bit / 8] ^= 1 << (bit % 8);
                assert!(!is_right(&key, other, &signature), "bit {bit} of the hash");
            }
            for bit in (0..8 * 64).step_by(41) {
                let mut other = signature;
                other[bit / 8] ^= 1 << (bit % 8);
                assert!(!is_right(&key, hash, &other), "bit {bit} of the signature");
            }
        }
    }

    /// The opposite of `s` signs the same, as everywhere in ECDSA.
    #[test]
    fn numbers_beyond_the_order_and_zero_are_no_signature() {
        let (key, hash, signature) = signed(5);
        let mut opposite = signature;
        let s = scalar(*signature[32..].first_chunk().expect("32 bytes"));
        opposite[32..].copy_from_slice(&(-s).to_repr());
        assert!(is_right(&key, hash, &opposite));
        for half in [0, 32] {
            for value in [[0; 32], ORDER, [0xFF; 32]] {
                let mut other = signature;
                other[half..half + 32].copy_from_slice(&value);
                assert!(!is_right(&key, hash, &other), "{value:x?}");
            }
        }
    }
}
