//! Andrews' squeezing mechanism: problem A03 of the IFToMM multibody benchmark library, from the
//! test set for IVP solvers (Mazzia and Magherini, after Hairer and Wanner II, VII.7).
//!
//! Seven bodies in the plane, driven by a constant torque. Coordinates: beta, theta, gamma, phi,
//! delta, omega, epsilon in rad. Six constraints, two for each of the loops that close in the point
//! of beta and theta. Lengths in m, masses in kg.

use super::{Mechanism, simulate};
use crate::integrate::IntegrationError;
use nalgebra::{SMatrix, SVector};

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
const SS: f64 = 0.035;
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

/// The mechanism of the test set.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Squeezer;

/// Sine and cosine of the directions in the constraints: beta, beta + theta, gamma, phi + delta,
/// delta, omega + epsilon, epsilon.
fn directions(q: &SVector<f64, 7>) -> [(f64, f64); 7] {
    [q[0], q[0] + q[1], q[2], q[3] + q[4], q[4], q[5] + q[6], q[6]].map(f64::sin_cos)
}

impl Mechanism<7, 6> for Squeezer {
    fn mass(&self, q: &SVector<f64, 7>) -> SMatrix<f64, 7, 7> {
        let (cos_theta, sin_phi, sin_omega) = (q[1].cos(), q[3].sin(), q[5].sin());
        let (e, f) = (E - EA, ZF - FA);
        let mut m = SMatrix::zeros();
        m[(0, 0)] = M[0] * RA * RA + M[1] * (RR * RR - 2.0 * DA * RR * cos_theta + DA * DA) + I[0] + I[1];
        m[(1, 0)] = M[1] * (DA * DA - DA * RR * cos_theta) + I[1];
        m[(1, 1)] = M[1] * DA * DA + I[1];
        m[(2, 2)] = M[2] * (SA * SA + SB * SB) + I[2];
        m[(3, 3)] = M[3] * e * e + I[3];
        m[(4, 3)] = M[3] * (e * e + ZT * e * sin_phi) + I[3];
        m[(4, 4)] =
            M[3] * (ZT * ZT + 2.0 * ZT * e * sin_phi + e * e) + M[4] * (TA * TA + TB * TB) + I[3] + I[4];
        m[(5, 5)] = M[5] * f * f + I[5];
        m[(6, 5)] = M[5] * (f * f - U * f * sin_omega) + I[5];
        m[(6, 6)] =
            M[5] * (f * f - 2.0 * U * f * sin_omega + U * U) + M[6] * (UA * UA + UB * UB) + I[5] + I[6];
        for (i, j) in [(0, 1), (3, 4), (5, 6)] {
            m[(i, j)] = m[(j, i)];
        }
        m
    }

    fn force(&self, q: &SVector<f64, 7>, v: &SVector<f64, 7>) -> SVector<f64, 7> {
        let (sin, cos) = q[2].sin_cos();
        let (x, y) = (SD * cos + SC * sin + B[0] - C[0], SD * sin - SC * cos + B[1] - C[1]);
        let length = x.hypot(y);
        let pull = -SPRING_N_M * (length - SPRING_LENGTH) / length;
        let (fx, fy) = (pull * x, pull * y);
        let crank = M[1] * DA * RR * q[1].sin();
        let upper = M[3] * ZT * (E - EA) * q[3].cos();
        let lower = M[5] * U * (ZF - FA) * q[5].cos();
        SVector::from([
            TORQUE_NM - crank * v[1] * (v[1] + 2.0 * v[0]),
            crank * v[0] * v[0],
            fx * (SC * cos - SD * sin) + fy * (SD * cos + SC * sin),
            upper * v[4] * v[4],
            -upper * v[3] * (v[3] + 2.0 * v[4]),
            -lower * v[6] * v[6],
            lower * v[5] * (v[5] + 2.0 * v[6]),
        ])
    }

    fn constraint(&self, q: &SVector<f64, 7>) -> SVector<f64, 6> {
        let [b, bt, g, pd, d, oe, e] = directions(q);
        let (x, y) = (RR * b.1 - D * bt.1, RR * b.0 - D * bt.0);
        SVector::from([
            x - SS * g.0 - B[0],
            y + SS * g.1 - B[1],
            x - E * pd.0 - ZT * d.1 - A[0],
            y + E * pd.1 - ZT * d.0 - A[1],
            x - ZF * oe.1 - U * e.0 - A[0],
            y - ZF * oe.0 + U * e.1 - A[1],
        ])
    }

    fn jacobian(&self, q: &SVector<f64, 7>) -> SMatrix<f64, 6, 7> {
        let [b, bt, g, pd, d, oe, e] = directions(q);
        let mut j = SMatrix::zeros();
        for row in [0, 2, 4] {
            (j[(row, 0)], j[(row, 1)]) = (-RR * b.0 + D * bt.0, D * bt.0);
            (j[(row + 1, 0)], j[(row + 1, 1)]) = (RR * b.1 - D * bt.1, -D * bt.1);
        }
        (j[(0, 2)], j[(1, 2)]) = (-SS * g.1, -SS * g.0);
        (j[(2, 3)], j[(2, 4)]) = (-E * pd.1, -E * pd.1 + ZT * d.0);
        (j[(3, 3)], j[(3, 4)]) = (-E * pd.0, -E * pd.0 - ZT * d.1);
        (j[(4, 5)], j[(4, 6)]) = (ZF * oe.0, ZF * oe.0 - U * e.1);
        (j[(5, 5)], j[(5, 6)]) = (-ZF * oe.1, -ZF * oe.1 - U * e.0);
        j
    }

    fn bias(&self, q: &SVector<f64, 7>, v: &SVector<f64, 7>) -> SVector<f64, 6> {
        // Every constraint is a sum of sines and cosines. Its second derivative less `G q''` is
        // minus the same term times the square of the direction's rate.
        let [b, bt, g, pd, d, oe, e] = directions(q);
        let [wb, wbt, wg, wpd, wd, woe, we] =
            [v[0], v[0] + v[1], v[2], v[3] + v[4], v[4], v[5] + v[6], v[6]].map(|w| w * w);
        let (x, y) = (RR * b.1 * wb - D * bt.1 * wbt, RR * b.0 * wb - D * bt.0 * wbt);
        SVector::from([
            x - SS * g.0 * wg,
            y + SS * g.1 * wg,
            x - E * pd.0 * wpd - ZT * d.1 * wd,
            y + E * pd.1 * wpd - ZT * d.0 * wd,
            x - ZF * oe.1 * woe - U * e.0 * we,
            y - ZF * oe.0 * woe + U * e.1 * we,
        ])
    }

    fn stabilisation_per_s(&self) -> f64 {
        3000.0
    }
}

/// The seven angles at a time.
pub(in crate::known_answers) fn angles_rad(time_s: f64) -> Result<[f64; 7], IntegrationError> {
    let initial: [f64; 14] = std::array::from_fn(|i| START.get(i).copied().unwrap_or_default());
    let states = simulate::<_, 7, 6, 14>(&Squeezer, initial, &[time_s], 1e-12)?;
    let last = states.first().copied().unwrap_or([f64::NAN; 14]);
    Ok(std::array::from_fn(|i| last[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Jacobian and bias are derivatives of the constraints along a motion.
    #[test]
    fn the_start_is_consistent_and_the_derivatives_match_the_constraints() {
        let start = SVector::from(START);
        assert!(Squeezer.constraint(&start).norm() < 1e-16);
        let q = start + SVector::<f64, 7>::from_fn(|i, _| 0.1 * (i as f64 - 3.0));
        let v = SVector::<f64, 7>::from_fn(|i, _| 1.0 + 0.3 * i as f64);
        let h = 1e-4;
        let (after, before) = (Squeezer.constraint(&(q + v * h)), Squeezer.constraint(&(q - v * h)));
        let rate = (after - before) / (2.0 * h);
        assert!((rate - Squeezer.jacobian(&q) * v).norm() < 1e-8);
        let curvature = (after - Squeezer.constraint(&q) * 2.0 + before) / (h * h);
        assert!((curvature + Squeezer.bias(&q, &v)).norm() < 1e-6);
    }
}
