//! Accelerations and multipliers of a constrained system of rigid bodies.
//!
//! `q'' = W (f + G^T l) + b`, `G q'' = c`, with the mobility `W` of each body: the multipliers
//! solve `(G W G^T) l = c - G (W f + b)`. Two constraints are coupled only by a common body, so the
//! matrix has an envelope, which its factors `L D L^T` keep (George and Liu, Computer Solution of
//! Large Sparse Positive Definite Systems, 1981, section 4). If constraints are almost dependent
//! the solution is that of least squares, so that a mechanism may pass through a configuration in
//! which its constraints become dependent for an instant.

use super::body::dot3;
use super::joint::{IdealJoint, Row};
use super::suspension::Mobility;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Pivot below which least squares are used, of a matrix scaled to the diagonal that bodies without
/// constraints have. Their filter there leaves a regular solution unchanged to rounding.
const REGULAR: f64 = 1e-3;
/// Eigenvalue of the scaled matrix at which a direction fades out.
const DEPENDENT: f64 = 1e-10;
/// Maximum number of iterations of an eigenvalue problem.
const EIGEN_SWEEPS: usize = 1000;

/// Solver of the constraints of one mechanism, with its memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Solver {
    /// First constraint that each one is coupled with.
    first: Vec<usize>,
    /// Accelerations of both bodies per unit of each multiplier.
    response: Vec<[[f64; 3]; 2]>,
    /// Diagonal that the matrix would have without other constraints.
    diagonal: Vec<f64>,
    /// Lower half of the matrix by rows, then its factors: `L`, and the reciprocals of `D`.
    factors: Vec<f64>,
    /// Right side, then the multipliers.
    multipliers: Vec<f64>,
}

impl Solver {
    /// Solver of constraints in the order of these joints.
    pub(super) fn new<'a>(joints: impl Iterator<Item = &'a IdealJoint>) -> Self {
        Self::for_pairs(joints.map(|joint| [joint.first.body, joint.second.body]).collect())
    }

    /// Solver of constraints between these pairs of bodies.
    fn for_pairs(pairs: Vec<[Option<usize>; 2]>) -> Self {
        let is_coupled = |a: &[Option<usize>; 2], b: &[Option<usize>; 2]| {
            a.iter().flatten().any(|body| b.contains(&Some(*body)))
        };
        let first = |(i, pair): (usize, &[Option<usize>; 2])| {
            pairs.iter().position(|other| is_coupled(other, pair)).map_or(i, |first| first.min(i))
        };
        let first: Vec<usize> = pairs.iter().enumerate().map(first).collect();
        let count = first.len();
        Self {
            first,
            response: vec![[[0.0; 3]; 2]; count],
            diagonal: vec![0.0; count],
            factors: vec![0.0; count * count],
            multipliers: vec![0.0; count],
        }
    }

    /// Multipliers of the last solution.
    pub(super) fn multipliers(&self) -> &[f64] {
        &self.multipliers
    }

    /// Finds the multipliers with which the accelerations `free`, those without constraints,
    /// satisfy every row, and adds their effect to `free`. `masses` holds the masses of each body;
    /// `target` is the required value of `G q''` for a row.
    pub(super) fn constrain(
        &mut self,
        rows: &[Row],
        (mobilities, masses): (&[Mobility], &[[f64; 3]]),
        target: impl Fn(&Row) -> f64,
        free: &mut [[f64; 3]],
    ) {
        for (i, row) in rows.iter().enumerate() {
            self.multipliers[i] = target(row) - row.applied(|body| free[body]);
            self.diagonal[i] = 0.0;
            for (side, (body, jacobian)) in row.bodies.into_iter().zip(row.jacobian).enumerate() {
                let Some(body) = body else { continue };
                let mobility = &mobilities[body];
                self.response[i][side] = mobility.acceleration(jacobian);
                if !matches!(mobility, Mobility::Prescribed) {
                    self.diagonal[i] +=
                        (0..3).map(|k| jacobian[k] * jacobian[k] / masses[body][k]).sum::<f64>();
                }
            }
        }
        if self.factorise(rows) {
            self.substitute();
        } else {
            self.least_squares(rows);
        }
        for ((row, response), multiplier) in rows.iter().zip(&self.response).zip(&self.multipliers) {
            for (body, response) in row.bodies.into_iter().zip(response) {
                let Some(body) = body else { continue };
                for (sum, response) in free[body].iter_mut().zip(response) {
                    *sum += response * multiplier;
                }
            }
        }
    }

    /// Entry of `G W G^T`.
    fn coupled(&self, rows: &[Row], i: usize, j: usize) -> f64 {
        let mut sum = 0.0;
        for (body, response) in rows[i].bodies.into_iter().zip(self.response[i]) {
            for (other, jacobian) in rows[j].bodies.into_iter().zip(rows[j].jacobian) {
                if body.is_some() && body == other {
                    sum += dot3(response, jacobian);
                }
            }
        }
        sum
    }

    /// Factorises the matrix and returns whether its constraints are independent enough.
    fn factorise(&mut self, rows: &[Row]) -> bool {
        let count = rows.len();
        for i in 0..count {
            for j in self.first[i]..=i {
                let entry = self.coupled(rows, i, j);
                let (before, own) = self.factors.split_at_mut(i * count);
                let other = if j < i { &before[j * count..j * count + j] } else { &[] };
                let from = self.first[i].max(self.first[j]);
                if j < i {
                    // Entries left of `j` are still `L D` here.
                    let sum: f64 = (from..j).map(|k| own[k] * other[k]).sum();
                    own[j] = entry - sum;
                    continue;
                }
                let mut pivot = entry;
                for k in from..i {
                    let scaled = own[k] * before[k * count + k];
                    pivot -= own[k] * scaled;
                    own[k] = scaled;
                }
                if !(pivot > REGULAR * self.diagonal[i]) {
                    return false;
                }
                own[i] = 1.0 / pivot;
            }
        }
        true
    }

    /// Solves with the factors.
    fn substitute(&mut self) {
        let count = self.first.len();
        for i in 0..count {
            for k in self.first[i]..i {
                self.multipliers[i] -= self.factors[i * count + k] * self.multipliers[k];
            }
        }
        for i in (0..count).rev() {
            self.multipliers[i] *= self.factors[i * count + i];
        }
        for i in (0..count).rev() {
            for k in self.first[i]..i {
                self.multipliers[k] -= self.factors[i * count + k] * self.multipliers[i];
            }
        }
    }

    /// Solves by least squares with the matrix scaled to a unit diagonal.
    fn least_squares(&mut self, rows: &[Row]) {
        let count = rows.len();
        let scale = |i: usize| if self.diagonal[i] > 0.0 { 1.0 / self.diagonal[i].sqrt() } else { 0.0 };
        let scale: Vec<f64> = (0..count).map(scale).collect();
        let matrix = DMatrix::from_fn(count, count, |i, j| {
            self.coupled(rows, i.max(j), i.min(j)) * scale[i] * scale[j]
        });
        let right = DVector::from_fn(count, |i, _| self.multipliers[i] * scale[i]);
        for ((multiplier, found), scale) in
            self.multipliers.iter_mut().zip(&least_squares(matrix, &right)).zip(scale)
        {
            *multiplier = found * scale;
        }
    }
}

/// Solves a symmetric, possibly singular system. Tikhonov's filter on the eigenvalues, iterated
/// three times, lets a direction fade out smoothly where the system becomes singular. A hard cut
/// would be a discontinuity for the integrator.
fn least_squares(matrix: DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let count = right.len();
    let Some(eigen) = SymmetricEigen::try_new(matrix, f64::EPSILON, EIGEN_SWEEPS) else {
        return DVector::from_element(count, f64::NAN);
    };
    let floor = (DEPENDENT * eigen.eigenvalues.amax()).max(f64::MIN_POSITIVE);
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

    /// Two chains of bodies whose rows are not in their order: the envelope has zeros inside.
    #[test]
    fn the_multipliers_satisfy_every_row_and_are_those_of_least_squares() {
        let rows: Vec<Row> = [(0, 1), (4, 5), (1, 2), (5, 6), (2, 3), (0, 7), (3, 4)]
            .iter()
            .enumerate()
            .flat_map(|(i, (a, b))| [(i, *a, *b, 1.0), (i + 7, *a, *b, -0.5)])
            .map(|(i, a, b, sign)| {
                let entry = |k: usize| ((7 * i + 3 * k + 1) as f64).sin();
                let side = |k: usize| [1.0 - sign * 0.5 + 0.2 * entry(k), sign, entry(k + 3)];
                let (bodies, jacobian) = ([Some(a), Some(b)], [side(0), side(1).map(|x| -x)]);
                Row { bodies, jacobian, value: 0.0, drive_rate: 0.0, target: entry(5) }
            })
            .collect();
        let masses = vec![[2.0, 2.0, 0.3]; 8];
        let mobilities: Vec<Mobility> =
            masses.iter().map(|mass| Mobility::Free(mass.map(|m| 1.0 / m))).collect();
        let mut solver = Solver::for_pairs(rows.iter().map(|row| row.bodies).collect());
        let mut free = vec![[0.4, -0.2, 1.0]; 8];
        solver.constrain(&rows, (&mobilities, &masses), |row| row.target, &mut free);
        let found = solver.multipliers().to_vec();
        assert!(found.iter().any(|l| l.abs() > 0.01));
        for row in &rows {
            assert!((row.applied(|body| free[body]) - row.target).abs() < 1e-12);
        }
        for (i, row) in rows.iter().enumerate() {
            solver.multipliers[i] = row.target - row.applied(|_| [0.4, -0.2, 1.0]);
        }
        solver.least_squares(&rows);
        for (a, b) in found.iter().zip(solver.multipliers()) {
            assert!((a - b).abs() < 1e-10, "{a} {b}");
        }
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
