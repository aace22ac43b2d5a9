//! Keys of the curve P-256, and their signatures.
//!
//! ```text
//! Q = d G      r = x(k G)      s = (z + r d) / k
//! ```
//!
//! | symbol | what |
//! |---|---|
//! | `d`, `Q` | secret, public key |
//! | `k` | number that is used once; here it follows from the message, and nothing is secret |
//! | `z` | SHA-256 of the message |

use p256::elliptic_curve::PrimeField as _;
use p256::elliptic_curve::ops::Reduce;
use p256::elliptic_curve::sec1::ToEncodedPoint as _;
use p256::{AffinePoint, ProjectivePoint, Scalar, U256};
use sha2::{Digest as _, Sha256};

/// Secret of a public key.
#[derive(Clone, Debug)]
pub struct Secret(Scalar);

impl Secret {
    /// Returns the secret of the test key.
    pub fn test() -> Self {
        Self::of(b"RAI test key")
    }

    /// Returns the secret that follows from a name.
    pub fn of(name: &[u8]) -> Self {
        Self(number(name))
    }

    /// Returns the public key: the point of the curve in its compressed form.
    pub fn public(&self) -> [u8; 33] {
        point(self.0).to_encoded_point(true).as_bytes().try_into().expect("33 bytes")
    }

    /// Returns the signature of a message whose hash is given.
    pub(super) fn sign(&self, hash: &[u8; 32], once: &[u8]) -> [u8; 64] {
        let z = <Scalar as Reduce<U256>>::reduce_bytes(&(*hash).into());
        let k = number(once);
        let coordinates = point(k).to_encoded_point(false);
        let r = <Scalar as Reduce<U256>>::reduce_bytes(coordinates.x().expect("a coordinate"));
        let s = k.invert().expect("not zero") * (z + r * self.0);
        [r.to_repr(), s.to_repr()].concat().try_into().expect("64 bytes")
    }
}

fn number(name: &[u8]) -> Scalar {
    <Scalar as Reduce<U256>>::reduce_bytes(&Sha256::digest(name))
}

fn point(number: Scalar) -> AffinePoint {
    (ProjectivePoint::GENERATOR * number).to_affine()
}
