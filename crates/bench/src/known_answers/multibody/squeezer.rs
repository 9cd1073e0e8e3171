//! Andrews' squeezing mechanism: problem A03 of the IFToMM multibody benchmark library, from the
//! test set for IVP solvers (Mazzia and Magherini, after Hairer and Wanner II, VII.7).
//!
//! Seven bodies in the plane, driven by a constant torque. The published coordinates are beta,
//! theta, gamma, phi, delta, omega, epsilon in rad; here each body has its own coordinates and ten
//! revolute joints connect them. Three of these share the point E, in which the loops close.
//! Lengths in m, masses in kg.

use super::states_at;
use crate::integrate::IntegrationError;
use crate::plants::mechanism::{Body, Builder, Mechanism};

/// Masses of the seven bodies.
const M: [f64; 7] = [0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498];
/// Moments of inertia about the centres of mass.
const I: [f64; 7] = [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5];
/// Fixed points A, B and the spring's C.
const A: [f64; 2] = [-0.06934, -0.00227];
const B: [f64; 2] = [-0.03635, 0.03273];
const C: [f64; 2] = [0.014, 0.072];
/// Spring coefficient and unstretched length.
const SPRING_N_M: f64 = 4530.0;
const SPRING_LENGTH: f64 = 0.07785;
/// Driving torque.
const TORQUE_NM: f64 = 0.033;
const D: f64 = 0.028;
const DA: f64 = 0.0115;
const E: f64 = 0.02;
const EA: f64 = 0.01421;
const RR: f64 = 0.007;
const RA: f64 = 0.00092;
const SA: f64 = 0.01874;
const SB: f64 = 0.01043;
const SC: f64 = 0.018;
const SD: f64 = 0.02;
const TA: f64 = 0.02308;
const TB: f64 = 0.00916;
const U: f64 = 0.04;
const UA: f64 = 0.01228;
const UB: f64 = 0.00449;
const ZF: f64 = 0.02;
const ZT: f64 = 0.04;
const FA: f64 = 0.01421;

/// Angles of the consistent start; all rates are 0.
const START: [f64; 7] = [
    -0.061_713_890_014_276_45,
    0.0,
    0.455_279_819_163_070_4,
    0.222_668_390_165_885_88,
    0.487_364_979_543_842_55,
    -0.222_668_390_165_885_88,
    1.230_547_444_549_821_2,
];

/// Angles of the bodies from the published coordinates.
fn angles_of_bodies([beta, theta, gamma, phi, delta, omega, epsilon]: [f64; 7]) -> [f64; 7] {
    [beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon]
}

/// Point at coordinates along a body's own axes from a point.
fn from(point: [f64; 2], angle_rad: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = angle_rad.sin_cos();
    [point[0] + cos * x - sin * y, point[1] + sin * x + cos * y]
}

/// The mechanism of the test set.
fn squeezer() -> Mechanism {
    let angles = angles_of_bodies(START);
    let mut builder = Builder::new([0.0; 2], 3000.0);
    let f = from([0.0; 2], angles[0], [RR, 0.0]);
    let e = from(f, angles[1], [-D, 0.0]);
    let g = from(A, angles[4], [ZT, 0.0]);
    let h = from(A, angles[6], [0.0, -U]);
    let centres = [
        from([0.0; 2], angles[0], [RA, 0.0]),
        from(f, angles[1], [-DA, 0.0]),
        from(B, angles[2], [SB, -SA]),
        from(g, angles[3], [0.0, -(E - EA)]),
        from(A, angles[4], [TA, TB]),
        from(h, angles[5], [ZF - FA, 0.0]),
        from(A, angles[6], [UA, -UB]),
    ];
    let bodies = std::array::from_fn::<_, 7, _>(|i| {
        let start = [centres[i][0], centres[i][1], angles[i]];
        builder.body(Body { mass_kg: M[i], inertia_kg_m2: I[i], start, start_rate: [0.0; 3] })
    });
    let [k1, k2, k3, k4, k5, k6, k7] = bodies;
    for (pair, at_m) in [
        ([None, k1], [0.0; 2]),
        ([k1, k2], f),
        ([None, k3], B),
        ([None, k5], A),
        ([None, k7], A),
        ([k5, k4], g),
        ([k7, k6], h),
        ([k2, k3], e),
        ([k2, k4], e),
        ([k2, k6], e),
    ] {
        builder.revolute(pair, at_m);
    }
    let end_m = from(B, angles[2], [SD, -SC]);
    builder.spring([None, k3], [C, end_m], (SPRING_N_M, 0.0), Some(SPRING_LENGTH));
    builder.load(k1, [0.0; 2], ([0.0; 2], TORQUE_NM), 0.0);
    builder.build()
}

/// The seven published angles at a time.
pub(in crate::known_answers) fn angles_rad(time_s: f64) -> Result<[f64; 7], IntegrationError> {
    let states = states_at(&squeezer(), &[time_s], 1e-12)?;
    let mut angles = [f64::NAN; 7];
    for (angle, body) in angles.iter_mut().zip(states.iter().flat_map(|state| &state.bodies)) {
        *angle = body.position[2];
    }
    let [k1, k2, gamma, k4, delta, k6, epsilon] = angles;
    Ok([k1, k2 - k1, gamma, k4 - delta, delta, k6 - epsilon, epsilon])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance of B and E on the third body.
    const SS: f64 = 0.035;

    #[test]
    fn the_published_start_closes_every_loop() {
        let mechanism = squeezer();
        let state = mechanism.initial_state(true);
        let frames = mechanism.frames(0.0, &state);
        let rows = mechanism.joints.iter().map(|joint| joint.row(0.0, &frames));
        let open = rows.map(|row| row.value.abs()).fold(0.0, f64::max);
        assert!(open < 1e-16, "{open}");
        // Every joint is closed where it is built; the loops close in the points of the bodies.
        let point = |body: usize, x: f64, y: f64| {
            let position = mechanism.bodies[body].start;
            from([position[0], position[1]], position[2], [x, y])
        };
        let e = point(1, -(D - DA), 0.0);
        for other in [point(2, -SB, SA - SS), point(3, 0.0, -EA), point(5, FA, 0.0)] {
            assert!((0..2).all(|k| (e[k] - other[k]).abs() < 1e-15), "{e:?} {other:?}");
        }
    }
}
