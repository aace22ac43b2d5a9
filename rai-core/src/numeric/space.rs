//! Sums and products of vectors in space, written out.
//!
//! nalgebra's operators are loops over a general shape. Compiled for speed they melt away; compiled for size each is a call
//! through memory, three to five times as dear as its arithmetic. What every satellite or every mode needs is written with these
//! instead, and is then as fast at `opt-level = "s"` as at `2`, in less flash.
//!
//! ```text
//! dot        a·b                 difference   a − b          symmetric_product   S v
//! scaled     f a                 plus_scaled  a + f b        add_outer_product   S + a bᵀ
//! ```
//!
//! A symmetric matrix is read and written in its lower triangle alone: six numbers stay in registers where nine do not.

#![allow(
    clippy::inline_always,
    reason = "a call costs more than what is called, in instructions and in bytes"
)]

use nalgebra::{Matrix3, Vector3};

use super::real::Real;

/// `a·b`.
#[inline(always)]
pub(crate) fn dot<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> T {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// `f a`.
#[inline(always)]
pub(crate) fn scaled<T: Real>(factor: T, a: &Vector3<T>) -> Vector3<T> {
    Vector3::new(factor * a.x, factor * a.y, factor * a.z)
}

/// `a − b`.
#[inline(always)]
pub(crate) fn difference<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.x - b.x, a.y - b.y, a.z - b.z)
}

/// `a + f b`.
#[inline(always)]
pub(crate) fn plus_scaled<T: Real>(a: &Vector3<T>, factor: T, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.x + factor * b.x, a.y + factor * b.y, a.z + factor * b.z)
}

/// `S v` of a symmetric matrix.
#[inline(always)]
pub(crate) fn symmetric_product<T: Real>(matrix: &Matrix3<T>, vector: &Vector3<T>) -> Vector3<T> {
    Vector3::new(
        matrix.m11 * vector.x + matrix.m21 * vector.y + matrix.m31 * vector.z,
        matrix.m21 * vector.x + matrix.m22 * vector.y + matrix.m32 * vector.z,
        matrix.m31 * vector.x + matrix.m32 * vector.y + matrix.m33 * vector.z,
    )
}

/// Adds `a bᵀ` to a symmetric matrix.
#[inline(always)]
pub(crate) fn add_outer_product<T: Real>(matrix: &mut Matrix3<T>, a: &Vector3<T>, b: &Vector3<T>) {
    matrix.m11 += a.x * b.x;
    matrix.m21 += a.y * b.x;
    matrix.m22 += a.y * b.y;
    matrix.m31 += a.z * b.x;
    matrix.m32 += a.z * b.y;
    matrix.m33 += a.z * b.z;
}
