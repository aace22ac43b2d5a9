//! Points of the curve P-256, in single operations that fit a slice.
//!
//! A point is `(X : Y : Z)` with `x = X / Z`, `y = Y / Z` on `y² = x³ − 3x + b`. One formula adds any two
//! points, also equal, opposite and infinite ones, so that no signature meets a special case.
//!
//! The field is that of the crate `p256`. Its own points are not used, because they hide their
//! coordinates: the last step would be an inversion, which takes five slices.
//!
//! Reference: [Renes2016] algorithm 4.
//!
//! [Renes2016]: crate#references

use p256::{FieldBytes, FieldElement};

/// Bytes of a coordinate.
pub(super) type Bytes = [u8; 32];

/// Coefficient `b` of the curve, and the generator.
const B: Bytes = [
    0x5a, 0xc6, 0x35, 0xd8, 0xaa, 0x3a, 0x93, 0xe7, 0xb3, 0xeb, 0xbd, 0x55, 0x76, 0x98, 0x86, 0xbc, 0x65,
    0x1d, 0x06, 0xb0, 0xcc, 0x53, 0xb0, 0xf6, 0x3b, 0xce, 0x3c, 0x3e, 0x27, 0xd2, 0x60, 0x4b,
];
const GENERATOR: [Bytes; 2] = [
    [
        0x6b, 0x17, 0xd1, 0xf2, 0xe1, 0x2c, 0x42, 0x47, 0xf8, 0xbc, 0xe6, 0xe5, 0x63, 0xa4, 0x40, 0xf2, 0x77,
        0x03, 0x7d, 0x81, 0x2d, 0xeb, 0x33, 0xa0, 0xf4, 0xa1, 0x39, 0x45, 0xd8, 0x98, 0xc2, 0x96,
    ],
    [
        0x4f, 0xe3, 0x42, 0xe2, 0xfe, 0x1a, 0x7f, 0x9b, 0x8e, 0xe7, 0xeb, 0x4a, 0x7c, 0x0f, 0x9e, 0x16, 0x2b,
        0xce, 0x33, 0x57, 0x6b, 0x31, 0x5e, 0xce, 0xcb, 0xb6, 0x40, 0x68, 0x37, 0xbf, 0x51, 0xf5,
    ],
];

/// Point of the curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) x: FieldElement,
    pub(super) y: FieldElement,
    pub(super) z: FieldElement,
}

impl Point {
    /// The point at infinity.
    pub(super) const INFINITE: Self =
        Self { x: FieldElement::ZERO, y: FieldElement::ONE, z: FieldElement::ZERO };

    /// Returns the generator.
    pub(super) fn generator() -> Self {
        let [x, y] = GENERATOR;
        Self { x: element(&x).unwrap_or_default(), y: element(&y).unwrap_or_default(), z: FieldElement::ONE }
    }

    /// Returns the sum of two points, for 17,000 to 26,000 instructions.
    // Not inlined, so that its callers share one copy.
    #[inline(never)]
    pub(super) fn plus(&self, other: &Self) -> Self {
        let b = element(&B).unwrap_or_default();
        let (xx, yy, zz) = (self.x * other.x, self.y * other.y, self.z * other.z);
        let xy = (self.x + self.y) * (other.x + other.y) - (xx + yy);
        let yz = (self.y + self.z) * (other.y + other.z) - (yy + zz);
        let xz = (self.x + self.z) * (other.x + other.z) - (xx + zz);
        let part = xz - b * zz;
        let part = part.double() + part;
        let (minus, plus) = (yy - part, yy + part);
        let zz3 = zz.double() + zz;
        let rest = b * xz - zz3 - xx;
        let rest = rest.double() + rest;
        let xx3 = xx.double() + xx - zz3;
        Self { x: xy * plus - yz * rest, y: plus * minus + xx3 * rest, z: yz * minus + xy * xx3 }
    }
}

/// Returns an element of the field; `None` if the bytes are not less than its order.
pub(super) fn element(bytes: &Bytes) -> Option<FieldElement> {
    let found = FieldElement::from_bytes(&FieldBytes::from(*bytes));
    bool::from(found.is_some()).then(|| found.unwrap_or(FieldElement::ZERO))
}

/// Returns `x³ − 3x + b`.
pub(super) fn square_of_y(x: &FieldElement) -> FieldElement {
    let three = FieldElement::ONE.double() + FieldElement::ONE;
    (x.square() - three) * x + element(&B).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use p256::elliptic_curve::sec1::ToEncodedPoint as _;
    use p256::{ProjectivePoint, Scalar};

    use super::*;

    fn theirs(scalar: u64) -> ProjectivePoint {
        ProjectivePoint::GENERATOR * Scalar::from(scalar)
    }

    fn assert_same(have: &Point, want: ProjectivePoint) {
        let want = want.to_affine().to_encoded_point(false);
        match (want.x(), want.y()) {
            (Some(x), Some(y)) => {
                assert_eq!(have.x, FieldElement::from_bytes(x).unwrap() * have.z);
                assert_eq!(have.y, FieldElement::from_bytes(y).unwrap() * have.z);
                assert_ne!(have.z, FieldElement::ZERO);
            }
            _ => assert_eq!(have.z, FieldElement::ZERO),
        }
    }

    /// The sums are those of another implementation, also of equal, opposite and infinite points.
    #[test]
    fn sums_are_those_of_the_crate() {
        let mut all = std::vec![(Point::INFINITE, ProjectivePoint::IDENTITY)];
        let one = Point::generator();
        let mut point = one;
        for scalar in 1..12 {
            assert_same(&point, theirs(scalar));
            let opposite = Point { y: -point.y, ..point };
            all.extend([(point, theirs(scalar)), (opposite, -theirs(scalar))]);
            point = point.plus(&one);
        }
        for (first, want_first) in &all {
            for (second, want_second) in &all {
                assert_same(&first.plus(second), *want_first + *want_second);
            }
        }
    }

    #[test]
    fn generator_is_on_the_curve() {
        let Point { x, y, .. } = Point::generator();
        assert_eq!(y.square(), square_of_y(&x));
    }
}
