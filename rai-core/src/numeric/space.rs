//! Sums and products of vectors in space, written out.
//!
//! nalgebra's operators are loops over a general shape. If compiled for speed, they cost nothing.
//! If compiled for size, each is a call through memory, three to five times as expensive as its
//! arithmetic. Operations on every satellite or every mode use these functions instead. At
//! `opt-level = "s"` they are as fast as at `2`, in less flash.
//!
//! ```text
//! dot        a·b                 difference   a − b          product             M v
//! cross      a × b               plus_scaled  a + f b        transposed_product  Mᵀ v
//! scaled     f a                 sum          a + b          symmetric_product   S v
//! products   a_i b_i             magnitudes   |a_i|          matrix_product      A B
//! trace      tr M                diagonal     M_ii           matrix_sum, matrix_difference  A ± B
//! upper_triangle  S, six numbers                     combination     v_1 c_1 + v_2 c_2 + v_3 c_3
//! add_outer_product  S + a bᵀ    add_outer_square  S + a aᵀ/f    add_whole_outer_product  M + a bᵀ
//! ```
//!
//! Functions read and write only the lower triangle of a symmetric matrix, because six numbers stay
//! in registers and nine do not.

use nalgebra::{Matrix3, Vector3};

use super::four::Four;
use super::real::Real;

/// Returns `a·b`.
#[inline]
pub(crate) fn dot<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> T {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// Returns true for the zero vector, and for one whose square is too small for the scalar.
pub(crate) fn is_zero<T: Real>(a: &Vector3<T>) -> bool {
    dot(a, a) == T::zero()
}

/// Returns `a × b`.
#[inline]
pub(crate) fn cross<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

/// Returns the zero vector.
#[inline]
pub(crate) fn zero<T: Real>() -> Vector3<T> {
    Vector3::new(T::zero(), T::zero(), T::zero())
}

/// Returns the zero matrix.
#[inline]
pub(crate) fn zeros<T: Real>() -> Matrix3<T> {
    let zero = T::zero();
    Matrix3::new(zero, zero, zero, zero, zero, zero, zero, zero, zero)
}

/// Returns the identity matrix.
#[inline]
pub(crate) fn identity<T: Real>() -> Matrix3<T> {
    let (zero, one) = (T::zero(), T::one());
    Matrix3::new(one, zero, zero, zero, one, zero, zero, zero, one)
}

/// Returns `f a`.
#[inline]
pub(crate) fn scaled<T: Real>(factor: T, a: &Vector3<T>) -> Vector3<T> {
    Vector3::new(factor * a.x, factor * a.y, factor * a.z)
}

/// Returns `a/f`.
#[inline]
pub(crate) fn divided<T: Real>(a: &Vector3<T>, divisor: T) -> Vector3<T> {
    Vector3::new(a.x / divisor, a.y / divisor, a.z / divisor)
}

/// Returns `a + b`.
#[inline]
pub(crate) fn sum<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.x + b.x, a.y + b.y, a.z + b.z)
}

/// Returns `a − b`.
#[inline]
pub(crate) fn difference<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.x - b.x, a.y - b.y, a.z - b.z)
}

/// Returns `a + f b`.
#[inline]
pub(crate) fn plus_scaled<T: Real>(a: &Vector3<T>, factor: T, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.x + factor * b.x, a.y + factor * b.y, a.z + factor * b.z)
}

/// Returns `a_i b_i`, axis by axis.
#[inline]
pub(crate) fn products<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.x * b.x, a.y * b.y, a.z * b.z)
}

/// Returns `|a_i|`, axis by axis.
#[inline]
pub(crate) fn magnitudes<T: Real>(a: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.x.abs(), a.y.abs(), a.z.abs())
}

/// Returns `M_ii`.
#[inline]
pub(crate) fn diagonal<T: Real>(matrix: &Matrix3<T>) -> Vector3<T> {
    Vector3::new(matrix.m11, matrix.m22, matrix.m33)
}

/// Returns `A + B`.
#[inline]
pub(crate) fn matrix_sum<T: Real>(a: &Matrix3<T>, b: &Matrix3<T>) -> Matrix3<T> {
    let ([a1, a2, a3], [b1, b2, b3]) = (columns(a), columns(b));
    of_columns(&[sum(&a1, &b1), sum(&a2, &b2), sum(&a3, &b3)])
}

/// Returns `A − B`.
#[inline]
pub(crate) fn matrix_difference<T: Real>(a: &Matrix3<T>, b: &Matrix3<T>) -> Matrix3<T> {
    let ([a1, a2, a3], [b1, b2, b3]) = (columns(a), columns(b));
    of_columns(&[difference(&a1, &b1), difference(&a2, &b2), difference(&a3, &b3)])
}

/// Returns `A B`.
#[inline(never)]
pub(crate) fn matrix_product<T: Real>(a: &Matrix3<T>, b: &Matrix3<T>) -> Matrix3<T> {
    let [b1, b2, b3] = columns(b);
    of_columns(&[product(a, &b1), product(a, &b2), product(a, &b3)])
}

/// Returns `M v`.
#[inline]
pub(crate) fn product<T: Real>(matrix: &Matrix3<T>, vector: &Vector3<T>) -> Vector3<T> {
    Vector3::new(
        matrix.m11 * vector.x + matrix.m12 * vector.y + matrix.m13 * vector.z,
        matrix.m21 * vector.x + matrix.m22 * vector.y + matrix.m23 * vector.z,
        matrix.m31 * vector.x + matrix.m32 * vector.y + matrix.m33 * vector.z,
    )
}

/// Returns `Mᵀ v`.
#[inline]
pub(crate) fn transposed_product<T: Real>(matrix: &Matrix3<T>, vector: &Vector3<T>) -> Vector3<T> {
    Vector3::new(
        matrix.m11 * vector.x + matrix.m21 * vector.y + matrix.m31 * vector.z,
        matrix.m12 * vector.x + matrix.m22 * vector.y + matrix.m32 * vector.z,
        matrix.m13 * vector.x + matrix.m23 * vector.y + matrix.m33 * vector.z,
    )
}

/// Returns `S v` of a symmetric matrix.
#[inline]
pub(crate) fn symmetric_product<T: Real>(matrix: &Matrix3<T>, vector: &Vector3<T>) -> Vector3<T> {
    Vector3::new(
        matrix.m11 * vector.x + matrix.m21 * vector.y + matrix.m31 * vector.z,
        matrix.m21 * vector.x + matrix.m22 * vector.y + matrix.m32 * vector.z,
        matrix.m31 * vector.x + matrix.m32 * vector.y + matrix.m33 * vector.z,
    )
}

/// Returns `M v` of a matrix with four rows, from its columns `c_i`.
#[allow(clippy::inline_always, reason = "shorter in its place than a call is")]
#[inline(always)]
pub(crate) fn combination<T: Real>(columns: &[T::Four; 3], vector: &Vector3<T>) -> T::Four {
    let [x, y, z] = *columns;
    x * T::Four::repeat(vector.x) + y * T::Four::repeat(vector.y) + z * T::Four::repeat(vector.z)
}

/// Adds `a bᵀ` to a symmetric matrix.
#[inline]
pub(crate) fn add_outer_product<T: Real>(matrix: &mut Matrix3<T>, a: &Vector3<T>, b: &Vector3<T>) {
    matrix.m11 += a.x * b.x;
    matrix.m21 += a.y * b.x;
    matrix.m22 += a.y * b.y;
    matrix.m31 += a.z * b.x;
    matrix.m32 += a.z * b.y;
    matrix.m33 += a.z * b.z;
}

/// Adds `a aᵀ/f` to a symmetric matrix.
#[inline]
pub(crate) fn add_outer_square<T: Real>(matrix: &mut Matrix3<T>, a: &Vector3<T>, divisor: T) {
    matrix.m11 += a.x * a.x / divisor;
    matrix.m21 += a.y * a.x / divisor;
    matrix.m22 += a.y * a.y / divisor;
    matrix.m31 += a.z * a.x / divisor;
    matrix.m32 += a.z * a.y / divisor;
    matrix.m33 += a.z * a.z / divisor;
}

/// Adds `a bᵀ` to a matrix that is not symmetric.
#[inline]
pub(crate) fn add_whole_outer_product<T: Real>(matrix: &mut Matrix3<T>, a: &Vector3<T>, b: &Vector3<T>) {
    add_outer_product(matrix, a, b);
    matrix.m12 += a.x * b.y;
    matrix.m13 += a.x * b.z;
    matrix.m23 += a.y * b.z;
}

/// Copies the lower triangle to the upper one.
#[inline]
pub(crate) fn mirror<T: Real>(matrix: &mut Matrix3<T>) {
    matrix.m12 = matrix.m21;
    matrix.m13 = matrix.m31;
    matrix.m23 = matrix.m32;
}

/// Returns the upper triangle of a symmetric matrix, row by row, in doubles.
#[inline]
pub(crate) fn upper_triangle<T: Real>(matrix: &Matrix3<T>) -> [f64; 6] {
    [matrix.m11, matrix.m21, matrix.m31, matrix.m22, matrix.m32, matrix.m33].map(T::widen)
}

/// Returns `tr M`.
#[inline]
pub(crate) fn trace<T: Real>(matrix: &Matrix3<T>) -> T {
    matrix.m11 + matrix.m22 + matrix.m33
}

/// Returns `det S` of a symmetric matrix.
#[inline]
pub(crate) fn symmetric_determinant<T: Real>(matrix: &Matrix3<T>) -> T {
    matrix.m11 * (matrix.m22 * matrix.m33 - matrix.m32 * matrix.m32)
        - matrix.m21 * (matrix.m21 * matrix.m33 - matrix.m31 * matrix.m32)
        + matrix.m31 * (matrix.m21 * matrix.m32 - matrix.m31 * matrix.m22)
}

/// Returns the columns of a matrix.
#[inline]
pub(crate) fn columns<T: Real>(matrix: &Matrix3<T>) -> [Vector3<T>; 3] {
    [
        Vector3::new(matrix.m11, matrix.m21, matrix.m31),
        Vector3::new(matrix.m12, matrix.m22, matrix.m32),
        Vector3::new(matrix.m13, matrix.m23, matrix.m33),
    ]
}

/// Returns the matrix of three columns.
#[inline]
pub(crate) fn of_columns<T: Real>([first, second, third]: &[Vector3<T>; 3]) -> Matrix3<T> {
    #[rustfmt::skip]
    let matrix = Matrix3::new(
        first.x, second.x, third.x,
        first.y, second.y, third.y,
        first.z, second.z, third.z,
    );
    matrix
}
