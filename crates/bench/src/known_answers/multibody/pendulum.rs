//! Simple pendulum in Cartesian coordinates: problem A01 of the IFToMM multibody benchmark library.
//!
//! A point mass of 1 kg on a massless rod of 1 m, `g = 9.81`, released at `x = -1, y = 0`. The only
//! constraint is the rod's length.

use super::{Mechanism, simulate};
use crate::integrate::IntegrationError;
use contact::GRAVITY_M_S2;
use nalgebra::{SMatrix, SVector};

/// The pendulum of the benchmark.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pendulum;

impl Mechanism<2, 1> for Pendulum {
    fn mass(&self, _: &SVector<f64, 2>) -> SMatrix<f64, 2, 2> {
        SMatrix::identity()
    }

    fn force(&self, _: &SVector<f64, 2>, _: &SVector<f64, 2>) -> SVector<f64, 2> {
        SVector::from([0.0, -GRAVITY_M_S2])
    }

    fn constraint(&self, q: &SVector<f64, 2>) -> SVector<f64, 1> {
        SVector::from([0.5 * (q.norm_squared() - 1.0)])
    }

    fn jacobian(&self, q: &SVector<f64, 2>) -> SMatrix<f64, 1, 2> {
        q.transpose()
    }

    fn bias(&self, _: &SVector<f64, 2>, v: &SVector<f64, 2>) -> SVector<f64, 1> {
        SVector::from([-v.norm_squared()])
    }

    fn stabilisation_per_s(&self) -> f64 {
        20.0
    }
}

/// Positions at ascending times.
pub(in crate::known_answers) fn positions_m(times_s: &[f64]) -> Result<Vec<[f64; 2]>, IntegrationError> {
    let states = simulate::<_, 2, 1, 4>(&Pendulum, [-1.0, 0.0, 0.0, 0.0], times_s, 1e-13)?;
    Ok(states.iter().map(|[x, y, ..]| [*x, *y]).collect())
}

/// Period: twice the time between two passes through the bottom, each located by Newton's method on
/// `x(t) = 0`.
pub(in crate::known_answers) fn period_s() -> Result<f64, IntegrationError> {
    let mut passes = [0.6, 1.8];
    for _ in 0..6 {
        let states = simulate::<_, 2, 1, 4>(&Pendulum, [-1.0, 0.0, 0.0, 0.0], &passes, 1e-13)?;
        for (time, [x, _, rate, _]) in passes.iter_mut().zip(states) {
            *time -= x / rate;
        }
    }
    Ok(2.0 * (passes[1] - passes[0]))
}
