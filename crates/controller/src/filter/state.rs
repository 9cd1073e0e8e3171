//! State of the filter and its covariance, in blocks: the motion, which has dynamics, and the bias,
//! which hardly has.
//!
//! No product of dense matrices: every operation is a sum of multiples of columns, and uses that
//! the blocks of motion and bias are symmetric.

use super::arithmetic::larger;
use crate::integrity::words;
use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

/// Number of states of the motion: y, z, y', z' in m and m/s.
pub(super) const MOTION: usize = 4;
/// Number of states of the bias: residual force in N, stiffness factor less 1, clearance less the
/// described one in m, friction factor less 1, logarithm of the damping factor, mass factor less 1.
pub(super) const BIAS: usize = 6;
/// Places in the bias.
pub(super) const RESIDUAL: usize = 0;
pub(super) const STIFFNESS: usize = 1;
pub(super) const CLEARANCE: usize = 2;
pub(super) const FRICTION: usize = 3;
pub(super) const DAMPING: usize = 4;
pub(super) const MASS: usize = 5;

pub(super) type Motion = SVector<f32, MOTION>;
pub(super) type Bias = SVector<f32, BIAS>;

/// Derivative of a scalar over motion and bias.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gradient {
    pub(super) motion: Motion,
    pub(super) bias: Bias,
}

/// Covariance of a linear function of the state with the state, and the function's variance.
pub(super) struct Projection {
    pub(super) motion: Motion,
    pub(super) bias: Bias,
    /// Variance, 0 or more.
    pub(super) variance: f32,
}

/// Covariance of motion and bias.
#[derive(Clone, Copy, Debug)]
pub(super) struct Covariance {
    /// Block of the motion; symmetric.
    motion: SMatrix<f32, MOTION, MOTION>,
    /// Covariance of the bias with the motion, a column for each state of the motion.
    cross: SMatrix<f32, BIAS, MOTION>,
    /// Block of the bias; symmetric.
    bias: SMatrix<f32, BIAS, BIAS>,
}
words!(Covariance { motion, cross, bias });

/// Transition of the motion over a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transition {
    /// Derivatives of positions and speeds over the positions.
    pub(super) by_position: [Matrix2<f32>; 2],
    /// Derivatives of positions and speeds over the speeds.
    pub(super) by_speed: [Matrix2<f32>; 2],
    /// Positions and speeds at the end for a constant unit acceleration.
    pub(super) response: [Matrix2<f32>; 2],
    /// Derivatives of the accelerations along Y and Z over the bias.
    pub(super) accelerations: [Bias; 2],
    /// Share of the residual force that is left.
    pub(super) residual: f32,
}

/// Change of the state by one measurement, and its normalised innovation.
pub(super) struct Correction {
    pub(super) motion: Motion,
    pub(super) bias: Bias,
    /// Square of the innovation over its variance.
    pub(super) normalised: f32,
}

impl Projection {
    /// Returns the covariance with another linear function.
    pub(super) fn covariance(&self, gradient: &Gradient) -> f32 {
        self.motion.dot(&gradient.motion) + self.bias.dot(&gradient.bias)
    }
}

impl Covariance {
    /// Returns the covariance of independent states.
    pub(super) fn from_deviations(motion: &Motion, bias: &Bias) -> Self {
        Self {
            motion: SMatrix::from_diagonal(&motion.component_mul(motion)),
            cross: SMatrix::zeros(),
            bias: SMatrix::from_diagonal(&bias.component_mul(bias)),
        }
    }

    /// Starts a new motion with a variance of the positions and a covariance of the speeds; the
    /// bias does not depend on it.
    pub(super) fn restart_motion(&mut self, position_variance: f32, speeds: &Matrix2<f32>) {
        self.motion = SMatrix::zeros();
        self.motion.m11 = position_variance;
        self.motion.m22 = position_variance;
        self.motion.fixed_view_mut::<2, 2>(2, 2).copy_from(speeds);
        self.cross = SMatrix::zeros();
    }

    /// Advances by a transition; the bias has unit dynamics but for the residual force.
    pub(super) fn advance(&mut self, transition: &Transition) {
        let [along_y, along_z] = &transition.accelerations;
        // Covariances of the accelerations that the bias causes: with the bias, with the motion.
        let (bias_y, bias_z) = (product(&self.bias, along_y), product(&self.bias, along_z));
        let (motion_y, motion_z) = (self.cross.tr_mul(along_y), self.cross.tr_mul(along_z));
        let mut motion = SMatrix::<f32, MOTION, MOTION>::zeros();
        let mut cross = SMatrix::<f32, BIAS, MOTION>::zeros();
        let rows = transition.rows();
        for (place, ([y, z, speed_y, speed_z], [by_y, by_z])) in (0..MOTION).zip(&rows) {
            let column = mixed(&self.cross, [*y, *z, *speed_y, *speed_z]) + bias_y * *by_y + bias_z * *by_z;
            let moved =
                mixed(&self.motion, [*y, *z, *speed_y, *speed_z]) + motion_y * *by_y + motion_z * *by_z;
            let (caused_y, caused_z) = (column.dot(along_y), column.dot(along_z));
            for (other, ([y, z, speed_y, speed_z], [by_y, by_z])) in (0..MOTION).zip(&rows).skip(place) {
                let sum = moved.x * y + moved.y * z + moved.z * speed_y + moved.w * speed_z;
                let value = sum + caused_y * by_y + caused_z * by_z;
                // Not an index: its check would link a panic.
                for at in [(other, place), (place, other)] {
                    if let Some(element) = motion.get_mut(at) {
                        *element = value;
                    }
                }
            }
            cross.set_column(place, &column);
        }
        self.motion = motion;
        cross.row_mut(RESIDUAL).scale_mut(transition.residual);
        self.cross = cross;
        self.bias.column_mut(RESIDUAL).scale_mut(transition.residual);
        self.bias.row_mut(RESIDUAL).scale_mut(transition.residual);
    }

    /// Adds process noise: variances of the speeds, and of the bias.
    pub(super) fn add_noise(&mut self, speeds: &Matrix2<f32>, bias: &Bias) {
        let mut block = self.motion.fixed_view_mut::<2, 2>(2, 2);
        block += speeds;
        self.bias.set_diagonal(&(self.bias.diagonal() + bias));
    }

    /// Forgets everything about a bias and sets its deviation.
    pub(super) fn restart_bias(&mut self, place: usize, deviation: f32) {
        self.cross.row_mut(place).fill(0.0);
        self.bias.column_mut(place).fill(0.0);
        self.bias.row_mut(place).fill(0.0);
        self.bias[(place, place)] = deviation * deviation;
    }

    /// Returns the covariance of the state with a linear function of it.
    pub(super) fn project(&self, gradient: &Gradient) -> Projection {
        let Gradient { motion, bias } = gradient;
        let mut projection = Projection {
            motion: mixed(&self.motion, (*motion).into()) + self.cross.tr_mul(bias),
            bias: mixed(&self.cross, (*motion).into()) + product(&self.bias, bias),
            variance: 0.0,
        };
        projection.variance = larger(projection.covariance(gradient), 0.0);
        projection
    }

    /// Returns the variance of a linear function of the motion and one bias.
    pub(super) fn variance(&self, motion: &Motion, place: usize, by_bias: f32) -> f32 {
        let own = mixed(&self.motion, (*motion).into()).dot(motion);
        let shared: f32 = self.cross.row(place).iter().zip(motion).map(|(c, by)| c * by).sum();
        own + by_bias * (2.0 * shared + by_bias * self.bias_variance(place))
    }

    /// Returns the variance of the deformation in a direction.
    pub(super) fn deformation_variance(&self, normal_y: f32, normal_z: f32) -> f32 {
        let (p, c) = (&self.motion, &self.cross);
        let along = normal_y * normal_y * p.m11 + normal_z * normal_z * p.m22;
        let across =
            normal_y * normal_z * p.m12 - normal_y * c[(CLEARANCE, 0)] - normal_z * c[(CLEARANCE, 1)];
        larger(along + 2.0 * across + self.bias_variance(CLEARANCE), 0.0)
    }

    /// Returns the variance of a linear function of the speeds.
    pub(super) fn speed_variance(&self, by_y: f32, by_z: f32) -> f32 {
        let p = &self.motion;
        larger(by_y * by_y * p.m33 + 2.0 * by_y * by_z * p.m34 + by_z * by_z * p.m44, 0.0)
    }

    /// Returns the variance of a bias.
    pub(super) fn bias_variance(&self, place: usize) -> f32 {
        larger(self.bias[(place, place)], 0.0)
    }

    /// Returns true if every variance is a number above 0. That of a mass which is not estimated is
    /// 0.
    pub(super) fn is_positive(&self) -> bool {
        let (motion, bias) = (self.motion.diagonal(), self.bias.diagonal());
        let positive = |variances: &[f32]| variances.iter().all(|v| v.is_finite() && *v > 0.0);
        positive(motion.as_slice()) && positive(&bias.as_slice()[..MASS]) && bias[MASS] >= 0.0
    }

    /// Corrects by the position of the journal along an axis, 0 for y and 1 for z.
    pub(super) fn correct_position<const AXIS: usize>(&mut self, innovation: f32, noise: f32) -> Correction {
        let motion = self.motion.column(AXIS).into_owned();
        let bias = self.cross.column(AXIS).into_owned();
        let variance = motion[AXIS];
        self.correct(&Projection { motion, bias, variance }, innovation, noise)
    }

    /// Corrects by the measurement of a linear function of the state.
    pub(super) fn correct(&mut self, measured: &Projection, innovation: f32, noise: f32) -> Correction {
        let Projection { motion, bias, variance } = measured;
        let inverse = 1.0 / (variance + noise);
        let (motion_gain, bias_gain) = (motion * inverse, bias * inverse);
        subtract(&mut self.motion, &motion_gain, motion);
        subtract(&mut self.bias, &bias_gain, bias);
        for (mut column, gain) in self.cross.column_iter_mut().zip(&motion_gain) {
            column -= bias * *gain;
        }
        Correction {
            motion: motion_gain * innovation,
            bias: bias_gain * innovation,
            normalised: innovation * innovation * inverse,
        }
    }
}

impl Transition {
    /// Returns, for each state of the motion, its derivatives over the motion and its response to
    /// the accelerations.
    fn rows(&self) -> [([f32; MOTION], [f32; 2]); MOTION] {
        let Self { by_position: [p, q], by_speed: [u, v], response: [r, s], .. } = self;
        [
            ([p.m11, p.m12, u.m11, u.m12], [r.m11, r.m12]),
            ([p.m21, p.m22, u.m21, u.m22], [r.m21, r.m22]),
            ([q.m11, q.m12, v.m11, v.m12], [s.m11, s.m12]),
            ([q.m21, q.m22, v.m21, v.m22], [s.m21, s.m22]),
        ]
    }
}

/// Returns a sum of multiples of a matrix's columns.
fn mixed<const N: usize>(matrix: &SMatrix<f32, N, MOTION>, shares: [f32; MOTION]) -> SVector<f32, N> {
    let [y, z, speed_y, speed_z] = shares;
    SVector::from_fn(|row, _| {
        matrix[(row, 0)] * y + matrix[(row, 1)] * z + matrix[(row, 2)] * speed_y + matrix[(row, 3)] * speed_z
    })
}

/// Returns the product of the bias' covariance with a vector.
fn product(matrix: &SMatrix<f32, BIAS, BIAS>, by: &Bias) -> Bias {
    let [residual, stiffness, clearance, friction, damping, mass] = (*by).into();
    SVector::from_fn(|row, _| {
        matrix[(row, 0)] * residual
            + matrix[(row, 1)] * stiffness
            + matrix[(row, 2)] * clearance
            + matrix[(row, 3)] * friction
            + matrix[(row, 4)] * damping
            + matrix[(row, 5)] * mass
    })
}

/// Subtracts the product of a gain with a covariance from a symmetric matrix.
fn subtract<const N: usize>(
    matrix: &mut SMatrix<f32, N, N>,
    gain: &SVector<f32, N>,
    covariance: &SVector<f32, N>,
) {
    for column in 0..N {
        for row in 0..=column {
            let value = matrix[(row, column)] - gain[row] * covariance[column];
            matrix[(row, column)] = value;
            matrix[(column, row)] = value;
        }
    }
}

/// Vector along Y and Z.
pub(super) type Pair = Vector2<f32>;
