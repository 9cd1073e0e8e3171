//! Planar multibody systems with given constraints, in index-1 form with stabilisation.
//!
//! `M q'' + G^T l = f`, `G q'' = c - 2 a (G v) - a^2 g` over coordinates `q`, rates `v` and
//! constraints `g(q) = 0`. The constraints are differentiated twice, and errors are reduced at the
//! rate `a` (Baumgarte). The multipliers `l` come from a least-squares solution, so that a
//! mechanism may pass through a configuration in which its constraints become dependent for an
//! instant. The explicit pair of order 8 of the `differential-equations` crate integrates. SI; one
//! file per mechanism. Not modelled: contact, friction in the joints, flexible bodies.
//!
//! These benchmarks are part of the library, and not of the tests, because `host-sim validate`
//! shows them.

pub(super) mod four_bar;
pub(super) mod pendulum;
pub(super) mod squeezer;

use crate::integrate::IntegrationError;
use differential_equations::ode::OrdinaryNumericalMethod;
use differential_equations::prelude::{ExplicitRungeKutta, Interpolation, ODE};
use differential_equations::status::Status;
use nalgebra::{DMatrix, SMatrix, SVector, SymmetricEigen};

/// Maximum number of steps of a simulation.
const MAX_STEPS: usize = 1_000_000;
/// Maximum number of iterations of an eigenvalue problem.
const EIGEN_SWEEPS: usize = 1000;
/// Share of the largest eigenvalue below which an eigenvalue counts as 0.
const DEPENDENT: f64 = 1e-10;

/// A mechanism with `Q` coordinates and `C` constraints.
pub(super) trait Mechanism<const Q: usize, const C: usize> {
    /// Mass matrix.
    fn mass(&self, q: &SVector<f64, Q>) -> SMatrix<f64, Q, Q>;
    /// Applied and gyroscopic forces.
    fn force(&self, q: &SVector<f64, Q>, v: &SVector<f64, Q>) -> SVector<f64, Q>;
    /// Constraints, 0 on the surface.
    fn constraint(&self, q: &SVector<f64, Q>) -> SVector<f64, C>;
    /// Their Jacobian `G`.
    fn jacobian(&self, q: &SVector<f64, Q>) -> SMatrix<f64, C, Q>;
    /// `c = -G' v`: required value of `G q''`.
    fn bias(&self, q: &SVector<f64, Q>, v: &SVector<f64, Q>) -> SVector<f64, C>;
    /// Rate `a` in 1/s at which errors of the constraints are reduced.
    fn stabilisation_per_s(&self) -> f64;
}

struct System<'a, M, const Q: usize, const C: usize>(&'a M);

impl<M: Mechanism<Q, C>, const Q: usize, const C: usize, const N: usize> ODE<f64, [f64; N]>
    for System<'_, M, Q, C>
{
    fn diff(&self, _: f64, state: &[f64; N], derivative: &mut [f64; N]) {
        let (q, v) =
            (SVector::<f64, Q>::from_fn(|i, _| state[i]), SVector::<f64, Q>::from_fn(|i, _| state[Q + i]));
        let acceleration = acceleration(self.0, &q, &v);
        for i in 0..Q {
            derivative[i] = v[i];
            derivative[Q + i] = acceleration[i];
        }
    }
}

fn acceleration<M: Mechanism<Q, C>, const Q: usize, const C: usize>(
    mechanism: &M,
    q: &SVector<f64, Q>,
    v: &SVector<f64, Q>,
) -> SVector<f64, Q> {
    let a = mechanism.stabilisation_per_s();
    let jacobian = mechanism.jacobian(q);
    // A mass matrix that is not positive definite makes the state non-finite, which ends the
    // simulation with its time.
    let inverse =
        mechanism.mass(q).cholesky().map_or(SMatrix::<f64, Q, Q>::from_element(f64::NAN), |c| c.inverse());
    let free = inverse * mechanism.force(q, v);
    let target = mechanism.bias(q, v) - jacobian * v * (2.0 * a) - mechanism.constraint(q) * (a * a);
    let coupling = jacobian * inverse * jacobian.transpose();
    free + inverse * jacobian.transpose() * least_squares(&coupling, &(target - jacobian * free))
}

/// Solves a symmetric, possibly singular system. Tikhonov's filter on the eigenvalues, iterated
/// three times, lets a direction fade out smoothly where the system becomes singular. A hard cut
/// would be a discontinuity for the integrator.
fn least_squares<const C: usize>(matrix: &SMatrix<f64, C, C>, right: &SVector<f64, C>) -> SVector<f64, C> {
    let matrix = DMatrix::from_fn(C, C, |i, j| matrix[(i, j)]);
    let Some(eigen) = SymmetricEigen::try_new(matrix, f64::EPSILON, EIGEN_SWEEPS) else {
        return SVector::from_element(f64::NAN);
    };
    let floor = DEPENDENT * eigen.eigenvalues.amax();
    let mut solution = SVector::<f64, C>::zeros();
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        let value = value.max(0.0);
        let filter = 1.0 - (floor / (value + floor)).powi(3);
        let share = vector.dot(right) * filter / value.max(f64::MIN_POSITIVE);
        for (sum, component) in solution.iter_mut().zip(vector.iter()) {
            *sum += share * component;
        }
    }
    solution
}

/// Simulates a mechanism from time 0 and returns its state (coordinates, then rates: `N = 2 Q`) at
/// ascending times.
pub(super) fn simulate<M: Mechanism<Q, C>, const Q: usize, const C: usize, const N: usize>(
    mechanism: &M,
    initial: [f64; N],
    times_s: &[f64],
    tolerance: f64,
) -> Result<Vec<[f64; N]>, IntegrationError> {
    const { assert!(N == 2 * Q) };
    let system = System::<M, Q, C>(mechanism);
    let end_s = times_s.last().copied().unwrap_or_default();
    let mut states = Vec::with_capacity(times_s.len());
    let mut method =
        ExplicitRungeKutta::dop853().rtol(tolerance).atol(tolerance).max_steps(usize::MAX).h0(end_s * 1e-6);
    let stopped = |time_s: f64, reason: String| IntegrationError::Stopped { time_s, reason };
    method.init(&system, 0.0, end_s, &initial).map_err(|e| stopped(0.0, format!("{e:?}")))?;
    for steps in 0.. {
        let reached = method.t();
        while let Some(&t) = times_s.get(states.len()).filter(|t| **t <= reached) {
            states.push(if t <= method.t_prev() {
                *method.y_prev()
            } else {
                method.interpolate(t).map_err(|e| stopped(t, format!("{e:?}")))?
            });
        }
        if reached >= end_s {
            break;
        }
        if steps > MAX_STEPS {
            return Err(IntegrationError::TooManySteps { steps, limit: MAX_STEPS, time_s: reached });
        }
        if method.h() > end_s - reached {
            method.set_h(end_s - reached);
        }
        method.step(&system).map_err(|e| stopped(reached, format!("{e:?}")))?;
        if !matches!(method.status(), Status::RejectedStep) && !method.y().iter().all(|v| v.is_finite()) {
            return Err(stopped(reached, "the state is no longer finite".into()));
        }
    }
    Ok(states)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_squares_solves_regular_and_dependent_systems() {
        let regular = SMatrix::<f64, 3, 3>::new(4.0, 1.0, 0.5, 1.0, 3.0, -0.2, 0.5, -0.2, 2.0);
        let x = SVector::<f64, 3>::new(1.0, -2.0, 3.0);
        assert!((least_squares(&regular, &(regular * x)) - x).norm() < 1e-13);
        // Rank 2: the third row is the sum of the first two.
        let rows = SMatrix::<f64, 3, 3>::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0);
        let gram = rows * rows.transpose();
        let found = least_squares(&gram, &(gram * x));
        assert!((gram * found - gram * x).norm() < 1e-12, "{found}");
        assert!(found.norm() < x.norm());
    }
}
