//! Cholesky factor of a small matrix, `M = L Lᵀ`, and solutions by it.
//!
//! ```text
//! L_ij = (M_ij − Σ_k<j L_ik L_jk) / L_jj        L_jj = √(M_jj − Σ_k<j L_jk²)
//! ```
//!
//! The matrix has four rows, as for a position with one clock; a smaller one is extended by ones on
//! the diagonal. nalgebra's factorisation uses views, which can panic, and is compiled for each
//! size.

use super::real::Real;

/// Number of rows.
pub(crate) const ORDER: usize = 4;

/// A vector.
pub(crate) type Vector<T> = [T; ORDER];

/// A matrix by its rows, which are also the columns of a symmetric one.
pub(crate) type Matrix<T> = [Vector<T>; ORDER];

/// `L`, by its rows.
pub(crate) struct Cholesky<T>(Matrix<T>);

impl<T: Real> Cholesky<T> {
    /// Factorises a symmetric matrix; only the lower triangle is read. Returns `None` if the matrix
    /// is not positive definite.
    pub(crate) fn new(matrix: &Matrix<T>) -> Option<Self> {
        let mut lower = [[T::zero(); ORDER]; ORDER];
        for (i, given) in matrix.iter().enumerate() {
            let (above, rest) = lower.split_at_mut_checked(i)?;
            let row = rest.first_mut()?;
            for (j, other) in above.iter().enumerate() {
                let left = (0..j).fold(entry(given, j), |left, k| left - entry(row, k) * entry(other, k));
                *row.get_mut(j)? = left / entry(other, j);
            }
            let pivot = (0..i).fold(entry(given, i), |left, k| left - entry(row, k) * entry(row, k));
            // NaN also returns here.
            if !(pivot > T::zero()) {
                return None;
            }
            *row.get_mut(i)? = pivot.sqrt_approx();
        }
        Some(Self(lower))
    }

    /// Returns `M⁻¹ b`.
    pub(crate) fn solve(&self, right_hand_side: &Vector<T>) -> Vector<T> {
        let mut solved = *right_hand_side;
        for (i, row) in self.0.iter().enumerate() {
            let left = (0..i).fold(entry(&solved, i), |left, k| left - entry(row, k) * entry(&solved, k));
            put(&mut solved, i, left / entry(row, i));
        }
        for (i, row) in self.0.iter().enumerate().rev() {
            let below = self.0.iter().zip(&solved).skip(i + 1);
            let sum = below.fold(T::zero(), |sum, (below, &solved)| sum + entry(below, i) * solved);
            let left = entry(&solved, i) - sum;
            put(&mut solved, i, left / entry(row, i));
        }
        solved
    }

    /// Returns `M⁻¹`.
    pub(crate) fn inverse(&self) -> Matrix<T> {
        let mut inverse = [[T::zero(); ORDER]; ORDER];
        for (i, column) in inverse.iter_mut().enumerate() {
            put(column, i, T::one());
            *column = self.solve(column);
        }
        inverse
    }

    /// Returns `det M`.
    pub(crate) fn determinant(&self) -> T {
        let root = self.0.iter().enumerate().fold(T::one(), |product, (i, row)| product * entry(row, i));
        root * root
    }
}

/// Returns `tr M`.
pub(crate) fn trace<T: Real>(matrix: &Matrix<T>) -> T {
    matrix.iter().enumerate().fold(T::zero(), |sum, (i, row)| sum + entry(row, i))
}

/// Returns `M v` for a symmetric matrix, column by column.
pub(crate) fn product<T: Real>(matrix: &Matrix<T>, vector: &Vector<T>) -> Vector<T> {
    let mut product = [T::zero(); ORDER];
    for (column, &factor) in matrix.iter().zip(vector) {
        for (sum, &entry) in product.iter_mut().zip(column) {
            *sum += entry * factor;
        }
    }
    product
}

/// Returns `a·b`, as two independent sums.
pub(crate) fn dot<T: Real>(a: &Vector<T>, b: &Vector<T>) -> T {
    let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (*a, *b);
    (a0 * b0 + a2 * b2) + (a1 * b1 + a3 * b3)
}

/// Adds `a bᵀ` to a matrix.
pub(crate) fn add_outer_product<T: Real>(matrix: &mut Matrix<T>, a: &Vector<T>, b: &Vector<T>) {
    for (row, &of_a) in matrix.iter_mut().zip(a) {
        for (entry, &of_b) in row.iter_mut().zip(b) {
            *entry += of_a * of_b;
        }
    }
}

/// Returns one of the four elements.
fn entry<T: Real>(vector: &Vector<T>, index: usize) -> T {
    vector.get(index).copied().unwrap_or_else(T::zero)
}

fn put<T: Real>(vector: &mut Vector<T>, index: usize, value: T) {
    if let Some(slot) = vector.get_mut(index) {
        *slot = value;
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use nalgebra::{Matrix4, Vector4};

    use super::*;

    const MATRIX: Matrix<f64> =
        [[4.0, 1.0, -0.5, 0.25], [1.0, 3.0, 0.75, -1.0], [-0.5, 0.75, 2.5, 0.125], [0.25, -1.0, 0.125, 1.5]];

    /// To the last digit, because the order of the operations is the same.
    #[test]
    fn factor_solves_as_nalgebra_does() {
        let want = nalgebra::Cholesky::new(Matrix4::from(MATRIX)).unwrap();
        let factor = Cholesky::new(&MATRIX).unwrap();
        assert_eq!(Matrix4::from(factor.inverse()), want.inverse());
        assert_eq!(
            Vector4::from(product(&factor.inverse(), &[1.0, 2.0, 3.0, 4.0])),
            want.inverse() * Vector4::new(1.0, 2.0, 3.0, 4.0)
        );
        assert_eq!(factor.determinant().to_bits(), want.determinant().to_bits());
        let right_hand_side = [1.0, -2.0, 0.5, 3.0];
        let want = want.solve(&Vector4::from(right_hand_side));
        assert_eq!(Vector4::from(factor.solve(&right_hand_side)), want);
    }

    #[test]
    fn matrix_without_a_root_has_no_factor() {
        for pivot in [0.0, -1.0, f64::NAN] {
            let mut matrix = MATRIX;
            matrix[2][2] = pivot;
            assert!(Cholesky::new(&matrix).is_none(), "{pivot}");
        }
    }
}
