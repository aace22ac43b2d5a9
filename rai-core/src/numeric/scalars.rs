//! Single and double precision as scalars of linearised values.

use super::absolute::Grid;
use super::angle::sine;
use super::four::Apart;
use super::normal;
use super::precision::{DOUBLE, Precision, SINGLE};
use super::real::{Real, Tail};
use super::{sqrt, sqrt_f64};

impl Real for f64 {
    type Absolute = f64;
    type Four = Apart<f64>;

    const UNTESTABLE: Self = 1e-9;
    const UNMOVED: Self = 1e-6;
    const SINGULAR: Self = 1e12;
    const TIE: Self = 1e-9;
    const CHI_SQUARE: Precision<Self> = DOUBLE;

    #[inline]
    fn narrow(value: f64) -> Self {
        value
    }
    #[inline]
    fn widen(self) -> f64 {
        self
    }
    fn sqrt_approx(self) -> Self {
        sqrt_f64(self)
    }
    fn inverse_sqrt_approx(self) -> Self {
        sqrt_f64(self).recip()
    }
    fn sine_and_cosine(self) -> (Self, Self) {
        libm::sincos(self)
    }
    fn normal_tail(u: Self) -> Tail<Self> {
        normal::double_tail(u)
    }
    fn normal_quantile(p: Self) -> Self {
        normal::double_quantile(p)
    }
}

impl Real for f32 {
    type Absolute = Grid;
    #[cfg(any(target_os = "none", target_family = "wasm"))]
    type Four = Apart<f32>;
    #[cfg(not(any(target_os = "none", target_family = "wasm")))]
    type Four = wide::f32x4;

    // Some hundred units in the last place of sums over 40 satellites, with which it is compared.
    const UNTESTABLE: Self = 1e-5;
    const UNMOVED: Self = 1e-4;
    const SINGULAR: Self = 2e5;
    // Accuracy of a w-test: the |w| of a constellation's only two satellites are equal, but
    // computed they differ by up to 8e-5.
    const TIE: Self = 1e-3;
    const CHI_SQUARE: Precision<Self> = SINGLE;

    #[inline]
    fn narrow(value: f64) -> Self {
        value as f32
    }
    #[inline]
    fn widen(self) -> f64 {
        f64::from(self)
    }
    #[inline]
    fn sqrt_approx(self) -> Self {
        sqrt(self)
    }
    #[inline]
    fn inverse_sqrt_approx(self) -> Self {
        sqrt(self).recip()
    }
    fn sine_and_cosine(self) -> (Self, Self) {
        // Excess of a quarter turn over its nearest single.
        const BEYOND: f32 = -4.371_139e-8;
        (sine(self), sine(core::f32::consts::FRAC_PI_2 - self + BEYOND))
    }
    fn normal_tail(u: Self) -> Tail<Self> {
        normal::single_tail(u)
    }
    fn normal_quantile(p: Self) -> Self {
        normal::single_quantile(p)
    }
}
