//! Screen: dismisses modes whose terms are clear on every axis.

use nalgebra::Vector3;

use super::Axis;
use crate::integrity::araim::modes::Mode;
use crate::integrity::araim::subsets::Bounds;
use crate::least_squares::infinity;
use crate::numeric::real::Real;
use crate::numeric::space::{difference, magnitudes, products};

/// A distance beyond every level, m. Its square is finite in single precision.
const FAR_M: f64 = 1e12;

/// `λ` of [`Bounds`]: about `u σ/T` of modes that nearly matter.
const LAMBDA: f64 = 1.5;

/// The screen: [`Axis::is_clear`] for all three axes at once.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Screen<T> {
    references_m: Vector3<T>,
    /// Squares of the references, m².
    references_m2: Vector3<T>,
    /// Clear bounds of east and north, and of up.
    clear: [T; 2],
}

impl<T: Real> Screen<T> {
    /// Returns the screen of axes without risk.
    pub(in super::super) fn closed() -> Self {
        let everywhere = Vector3::new(infinity(), infinity(), infinity());
        Self { references_m: everywhere, references_m2: everywhere, clear: [T::zero(); 2] }
    }

    pub(in super::super) fn of(axes: &[Axis<T>; 3]) -> Self {
        let [east, north, up] = axes;
        let references_m = Vector3::new(east.reference_m, north.reference_m, up.reference_m);
        // Both horizontal axes have the same risk.
        Self {
            references_m,
            references_m2: products(&references_m, &references_m),
            clear: [east.clear, up.clear],
        }
    }

    /// Returns the bounds for modes with at most this probability; `limits` are the squares of `K`.
    pub(in super::super) fn bounds(&self, ln_probability: T, limits: &Vector3<T>) -> Bounds<T> {
        let far = T::narrow(FAR_M);
        let near = |reference_m: T| if reference_m < far { reference_m } else { far };
        let needed = self.needed(ln_probability);
        Bounds {
            separation: [limits.x, limits.z].map(|limit| limit * T::narrow(1.0 + LAMBDA)),
            variance: needed.map(|needed| needed * T::narrow(1.0 + 1.0 / LAMBDA)),
            references_m: Vector3::new(
                near(self.references_m.x),
                near(self.references_m.y),
                near(self.references_m.z),
            ),
            worst: T::zero(),
            evenness: T::one(),
            effective: infinity(),
        }
    }

    /// Returns `u²`.
    #[inline]
    fn needed(&self, ln_probability: T) -> [T; 2] {
        self.clear.map(|clear| {
            let needed = clear + ln_probability + ln_probability;
            if needed > T::zero() { needed } else { T::zero() }
        })
    }

    /// Returns true if a mode without biases needs no evaluation.
    #[inline]
    pub(in super::super) fn is_clear(
        &self,
        mode: &Mode<T>,
        thresholds: &Vector3<T>,
        variance: &Vector3<T>,
    ) -> bool {
        self.clears(mode, thresholds, variance, &self.references_m2)
    }

    /// Returns true if a mode whose biases are at most these needs no evaluation.
    #[inline]
    pub(in super::super) fn is_clear_with(
        &self,
        mode: &Mode<T>,
        thresholds: &Vector3<T>,
        variance: &Vector3<T>,
        bias_m: &Vector3<T>,
    ) -> bool {
        // The square keeps the sign, so that a negative margin remains negative.
        let margins = difference(&self.references_m, bias_m);
        let margins = products(&margins, &magnitudes(&margins));
        self.clears(mode, thresholds, variance, &margins)
    }

    /// Works like [`Self::is_clear`], with the squares of the margins below the references.
    #[inline]
    fn clears(
        &self,
        mode: &Mode<T>,
        thresholds: &Vector3<T>,
        variance: &Vector3<T>,
        margins: &Vector3<T>,
    ) -> bool {
        let [horizontal, vertical] = self.needed(mode.ln_probability);
        let is_clear = |margin: T, threshold: T, spread: T| {
            let rest = margin - threshold - spread;
            rest * rest.abs() > T::narrow(4.0) * threshold * spread
        };
        is_clear(margins.x, thresholds.x, horizontal * variance.x)
            && is_clear(margins.y, thresholds.y, horizontal * variance.y)
            && is_clear(margins.z, thresholds.z, vertical * variance.z)
    }
}
