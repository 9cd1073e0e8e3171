//! Accelerations and multipliers of a constrained system of rigid bodies.
//!
//! `M q'' = f + G^T l`, `G q'' = c`: the multipliers solve `(G M^-1 G^T) l = c - G M^-1 f`. The
//! matrix is scaled to a unit diagonal and solved by Cholesky's method. If constraints are almost
//! dependent the solution is that of least squares, so that a mechanism may pass through a
//! configuration in which its constraints become dependent for an instant.

use super::joint::Row;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Pivot of the scaled matrix below which least squares are used. Its filter there leaves a regular
/// solution unchanged to rounding.
const REGULAR: f64 = 1e-3;
/// Eigenvalue of the scaled matrix at which a direction fades out.
const DEPENDENT: f64 = 1e-10;
/// Maximum number of iterations of an eigenvalue problem.
const EIGEN_SWEEPS: usize = 1000;

/// Returns the multipliers with which the accelerations `free`, those without constraints, satisfy
/// every row, and adds their effect to `free`. `inverse` holds the inverse masses of each body;
/// `target` is the required value of `G q''` for each row.
pub(super) fn constrain(rows: &[Row], inverse: &[[f64; 3]], target: &[f64], free: &mut [f64]) -> Vec<f64> {
    if rows.is_empty() {
        return Vec::new();
    }
    let count = rows.len();
    let coupling =
        DMatrix::from_fn(
            count,
            count,
            |i, j| if j <= i { coupled(&rows[i], &rows[j], inverse) } else { 0.0 },
        );
    let scale: Vec<f64> = (0..count).map(|i| 1.0 / coupling[(i, i)].sqrt()).collect();
    let matrix = DMatrix::from_fn(count, count, |i, j| {
        coupling[if j <= i { (i, j) } else { (j, i) }] * scale[i] * scale[j]
    });
    let right = DVector::from_fn(count, |i, _| (target[i] - applied(&rows[i], free)) * scale[i]);
    let solution = solve(matrix, &right);
    let multipliers: Vec<f64> = solution.iter().zip(&scale).map(|(l, s)| l * s).collect();
    for (row, multiplier) in rows.iter().zip(&multipliers) {
        for (body, jacobian) in row.bodies.iter().zip(row.jacobian) {
            let Some(body) = *body else { continue };
            for axis in 0..3 {
                free[3 * body + axis] += inverse[body][axis] * jacobian[axis] * multiplier;
            }
        }
    }
    multipliers
}

/// Value of a row on accelerations or rates of the bodies.
pub(super) fn applied(row: &Row, values: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (body, jacobian) in row.bodies.iter().zip(row.jacobian) {
        if let Some(values) = body.and_then(|body| values.get(3 * body..3 * body + 3)) {
            sum += jacobian[0] * values[0] + jacobian[1] * values[1] + jacobian[2] * values[2];
        }
    }
    sum
}

/// Entry of `G M^-1 G^T`.
fn coupled(a: &Row, b: &Row, inverse: &[[f64; 3]]) -> f64 {
    let mut sum = 0.0;
    for (body_a, jacobian_a) in a.bodies.iter().zip(a.jacobian) {
        for (body_b, jacobian_b) in b.bodies.iter().zip(b.jacobian) {
            if let (Some(body), true) = (*body_a, body_a == body_b) {
                sum += (0..3).map(|k| jacobian_a[k] * inverse[body][k] * jacobian_b[k]).sum::<f64>();
            }
        }
    }
    sum
}

/// Solves a symmetric system with a unit diagonal.
fn solve(matrix: DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    if let Some(factor) = matrix.clone().cholesky()
        && factor.l_dirty().diagonal().iter().all(|pivot| pivot * pivot > REGULAR)
    {
        return factor.solve(right);
    }
    least_squares(matrix, right)
}

/// Solves a symmetric, possibly singular system. Tikhonov's filter on the eigenvalues, iterated
/// three times, lets a direction fade out smoothly where the system becomes singular. A hard cut
/// would be a discontinuity for the integrator.
fn least_squares(matrix: DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let count = right.len();
    let Some(eigen) = SymmetricEigen::try_new(matrix, f64::EPSILON, EIGEN_SWEEPS) else {
        return DVector::from_element(count, f64::NAN);
    };
    let floor = DEPENDENT * eigen.eigenvalues.amax();
    let mut solution = DVector::zeros(count);
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        let value = value.max(0.0);
        let filter = 1.0 - (floor / (value + floor)).powi(3);
        let share = vector.dot(right) * filter / value.max(f64::MIN_POSITIVE);
        solution.axpy(share, &vector, 1.0);
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_squares_solves_regular_and_dependent_systems() {
        let regular = DMatrix::from_row_slice(3, 3, &[4.0, 1.0, 0.5, 1.0, 3.0, -0.2, 0.5, -0.2, 2.0]);
        let x = DVector::from_vec(vec![1.0, -2.0, 3.0]);
        assert!((least_squares(regular.clone(), &(&regular * &x)) - &x).norm() < 1e-13);
        // Rank 2: the third row is the sum of the first two.
        let rows = DMatrix::from_row_slice(3, 3, &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
        let gram = &rows * rows.transpose();
        let found = least_squares(gram.clone(), &(&gram * &x));
        assert!((&gram * &found - &gram * &x).norm() < 1e-12, "{found}");
        assert!(found.norm() < x.norm());
    }

    #[test]
    fn both_solutions_agree_where_the_choice_changes() {
        let near = 1.0 - 0.5 * REGULAR;
        let matrix = DMatrix::from_row_slice(2, 2, &[1.0, near, near, 1.0]);
        let right = DVector::from_vec(vec![0.3, -0.8]);
        let regular = matrix.clone().cholesky().unwrap().solve(&right);
        let found = least_squares(matrix, &right);
        assert!((&found - &regular).norm() < 1e-12 * regular.norm(), "{found} {regular}");
    }
}
