//! Small dense least squares: normal equations of a few columns over many samples.

use super::tuning;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Dot product, summed in order.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// `C'C` of columns.
pub(crate) fn gram(columns: &[Vec<f64>]) -> DMatrix<f64> {
    let n = columns.len();
    let mut out = DMatrix::zeros(n, n);
    for i in 0..n {
        for j in 0..=i {
            let value = dot(&columns[i], &columns[j]);
            out[(i, j)] = value;
            out[(j, i)] = value;
        }
    }
    out
}

/// `C'r`.
pub(crate) fn project(columns: &[Vec<f64>], residual: &[f64]) -> DVector<f64> {
    DVector::from_iterator(columns.len(), columns.iter().map(|c| dot(c, residual)))
}

/// Cholesky factor of a matrix that should be positive definite. A singular one gets the smallest
/// of a few ridges that makes it so; `None` if none does.
pub(crate) fn cholesky(matrix: &DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    let size = matrix.diagonal().amax().max(f64::MIN_POSITIVE);
    let with_ridge = |exponent: i32| {
        let mut m = matrix.clone();
        (0..m.nrows()).for_each(|i| m[(i, i)] += size * 10f64.powi(exponent));
        m.cholesky()
    };
    matrix.clone().cholesky().or_else(|| tuning::RIDGE_EXPONENTS.into_iter().find_map(with_ridge))
}
