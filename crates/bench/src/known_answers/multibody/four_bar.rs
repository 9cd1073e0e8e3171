//! Two four-bar windows: problem A02 of the IFToMM multibody benchmark library with `N = 2`.
//!
//! Five uniform links of 1 m and 1 kg: three rockers on the ground at `(0,0)`, `(1,0)`, `(2,0)`,
//! and two couplers between their tips `B0`, `B1`, `B2`. The start is upright with `B0` at 1 m/s
//! along x, `g = 9.81`. Whenever the rockers lie flat the constraints become dependent; the problem
//! tests the passage through this configuration.

use super::states_at;
use crate::integrate::IntegrationError;
use crate::plants::mechanism::{Builder, Mechanism};
use contact::GRAVITY_M_S2;

fn four_bar() -> Mechanism {
    let mut builder = Builder::new([0.0, -GRAVITY_M_S2], 50.0);
    let foot = |i: usize| [i as f64, 0.0];
    let tip = |i: usize| [i as f64, 1.0];
    let rockers = [0, 1, 2].map(|i| {
        let rocker = builder.bar(1.0, None, [foot(i), tip(i)], [0.5, 0.0, -1.0]);
        builder.revolute([None, rocker], foot(i));
        rocker
    });
    for i in 0..2 {
        let coupler = builder.bar(1.0, None, [tip(i), tip(i + 1)], [1.0, 0.0, 0.0]);
        builder.revolute([rockers[i], coupler], tip(i));
        builder.revolute([coupler, rockers[i + 1]], tip(i + 1));
    }
    builder.build()
}

/// Positions of `B0` at the given times: twice those of the first rocker's middle.
pub(in crate::known_answers) fn positions_m(times_s: &[f64]) -> Result<Vec<[f64; 2]>, IntegrationError> {
    let states = states_at(&four_bar(), times_s, 1e-12)?;
    let tip = |rocker: [f64; 3]| [2.0 * rocker[0], 2.0 * rocker[1]];
    Ok(states.iter().map(|s| tip(s.bodies[0].position)).collect())
}
