//! Two four-bar windows in natural coordinates: problem A02 of the IFToMM multibody benchmark
//! library with `N = 2`.
//!
//! Five links of 1 m and 1 kg with evenly distributed mass: three rockers on the ground at `(0,0)`,
//! `(1,0)`, `(2,0)`, and two couplers between their tips `B0`, `B1`, `B2`, whose positions are the
//! coordinates. The start is upright with `B0` at 1 m/s along x, `g = 9.81`. Whenever the rockers
//! lie flat the constraints become dependent; the problem tests the passage through this
//! configuration.

use super::{Mechanism, simulate};
use crate::integrate::IntegrationError;
use contact::GRAVITY_M_S2;
use nalgebra::{SMatrix, SVector};

/// The mechanism of the benchmark.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FourBar;

/// Vectors along the links: the three rockers from the ground, then the two couplers.
fn links(q: &SVector<f64, 6>) -> [(f64, f64); 5] {
    [
        (q[0], q[1]),
        (q[2] - 1.0, q[3]),
        (q[4] - 2.0, q[5]),
        (q[2] - q[0], q[3] - q[1]),
        (q[4] - q[2], q[5] - q[3]),
    ]
}

/// Coordinates of a link's two ends; the ground has none.
const ENDS: [(Option<usize>, usize); 5] = [(None, 0), (None, 2), (None, 4), (Some(0), 2), (Some(2), 4)];

impl Mechanism<6, 5> for FourBar {
    fn mass(&self, _: &SVector<f64, 6>) -> SMatrix<f64, 6, 6> {
        // Uniform bar: a third of its mass at either end, a sixth between them.
        let mut mass = SMatrix::zeros();
        for (start, end) in ENDS {
            for axis in 0..2 {
                mass[(end + axis, end + axis)] += 1.0 / 3.0;
                if let Some(start) = start {
                    mass[(start + axis, start + axis)] += 1.0 / 3.0;
                    mass[(start + axis, end + axis)] += 1.0 / 6.0;
                    mass[(end + axis, start + axis)] += 1.0 / 6.0;
                }
            }
        }
        mass
    }

    fn force(&self, _: &SVector<f64, 6>, _: &SVector<f64, 6>) -> SVector<f64, 6> {
        let mut force = SVector::zeros();
        for (start, end) in ENDS {
            force[end + 1] -= 0.5 * GRAVITY_M_S2;
            if let Some(start) = start {
                force[start + 1] -= 0.5 * GRAVITY_M_S2;
            }
        }
        force
    }

    fn constraint(&self, q: &SVector<f64, 6>) -> SVector<f64, 5> {
        let links = links(q);
        SVector::from_fn(|i, _| 0.5 * (links[i].0.powi(2) + links[i].1.powi(2) - 1.0))
    }

    fn jacobian(&self, q: &SVector<f64, 6>) -> SMatrix<f64, 5, 6> {
        let mut jacobian = SMatrix::zeros();
        for (row, ((x, y), (start, end))) in links(q).into_iter().zip(ENDS).enumerate() {
            (jacobian[(row, end)], jacobian[(row, end + 1)]) = (x, y);
            if let Some(start) = start {
                (jacobian[(row, start)], jacobian[(row, start + 1)]) = (-x, -y);
            }
        }
        jacobian
    }

    fn bias(&self, _: &SVector<f64, 6>, v: &SVector<f64, 6>) -> SVector<f64, 5> {
        SVector::from_fn(|row, _| {
            let (start, end) = ENDS[row];
            let rate = |axis: usize| v[end + axis] - start.map_or(0.0, |start| v[start + axis]);
            -(rate(0).powi(2) + rate(1).powi(2))
        })
    }

    fn stabilisation_per_s(&self) -> f64 {
        50.0
    }
}

/// Positions of `B0` at ascending times.
pub(in crate::known_answers) fn positions_m(times_s: &[f64]) -> Result<Vec<[f64; 2]>, IntegrationError> {
    let upright = [0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0];
    let states = simulate::<_, 6, 5, 12>(&FourBar, upright, times_s, 1e-11)?;
    Ok(states.iter().map(|[x, y, ..]| [*x, *y]).collect())
}
