//! Small dense least squares: normal equations of a few columns over many samples, with a ridge where wanted.

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

/// Cholesky of a matrix that ought to be positive definite; a dead direction gets the least ridge that makes it so.
pub(crate) fn factor(matrix: &DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    let size = matrix.diagonal().amax().max(f64::MIN_POSITIVE);
    for exponent in [0, -13, -11, -9, -7] {
        let mut m = matrix.clone();
        if exponent != 0 {
            for i in 0..m.nrows() {
                m[(i, i)] += size * 10f64.powi(exponent);
            }
        }
        if let Some(c) = m.cholesky() {
            return Some(c);
        }
    }
    None
}
