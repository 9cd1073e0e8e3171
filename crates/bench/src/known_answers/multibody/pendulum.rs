//! Simple pendulum in Cartesian coordinates: problem A01 of the IFToMM multibody benchmark library.
//!
//! A point mass of 1 kg on a massless rod of 1 m, `g = 9.81`, released at `x = -1, y = 0`. The rod
//! acts on the centre of mass, so the body's moment of inertia has no effect.

use super::states_at;
use crate::integrate::IntegrationError;
use crate::plants::mechanism::{Body, Builder, Mechanism, Snapshot};
use contact::GRAVITY_M_S2;

/// Relative tolerance of the runs.
const TOLERANCE: f64 = 1e-13;

fn pendulum() -> Mechanism {
    let mut builder = Builder::new([0.0, -GRAVITY_M_S2], 20.0);
    let start = [-1.0, 0.0, 0.0];
    let mass = builder.body(Body { mass_kg: 1.0, inertia_kg_m2: 1.0, start, start_rate: [0.0; 3] });
    builder.rod([None, mass], [[0.0, 0.0], [-1.0, 0.0]]);
    builder.build()
}

fn states(times_s: &[f64]) -> Result<Vec<Snapshot>, IntegrationError> {
    states_at(&pendulum(), times_s, TOLERANCE)
}

/// Positions at the given times.
pub(in crate::known_answers) fn positions_m(times_s: &[f64]) -> Result<Vec<[f64; 2]>, IntegrationError> {
    Ok(states(times_s)?.iter().map(|s| [s.bodies[0].position[0], s.bodies[0].position[1]]).collect())
}

/// Period: twice the time between two passes through the bottom, each located by Newton's method on
/// `x(t) = 0`.
pub(in crate::known_answers) fn period_s() -> Result<f64, IntegrationError> {
    let mut passes = [0.6, 1.8];
    for _ in 0..6 {
        let states = states(&passes)?;
        for (time, state) in passes.iter_mut().zip(states) {
            *time -= state.bodies[0].position[0] / state.bodies[0].rate[0];
        }
    }
    Ok(2.0 * (passes[1] - passes[0]))
}
