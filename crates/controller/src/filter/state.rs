//! State of the filter and its covariance, in blocks: the motion, which has dynamics, and the bias,
//! which hardly has.

use nalgebra::{SMatrix, SVector};

/// Number of states of the motion: y, z, y', z' in m and m/s.
pub(super) const MOTION: usize = 4;
/// Number of states of the bias: residual force in N, stiffness factor less 1, clearance less the
/// described one in m, friction factor less 1, damping factor less 1.
pub(super) const BIAS: usize = 5;
/// Places in the bias.
pub(super) const RESIDUAL: usize = 0;
pub(super) const STIFFNESS: usize = 1;
pub(super) const CLEARANCE: usize = 2;
pub(super) const FRICTION: usize = 3;
pub(super) const DAMPING: usize = 4;

pub(super) type Motion = SVector<f32, MOTION>;
pub(super) type Bias = SVector<f32, BIAS>;
/// Derivative of a scalar over motion and bias.
pub(super) type Gradient = SVector<f32, { MOTION + BIAS }>;

/// Covariance of motion and bias.
#[derive(Clone, Copy, Debug)]
pub(super) struct Covariance {
    motion: SMatrix<f32, MOTION, MOTION>,
    cross: SMatrix<f32, MOTION, BIAS>,
    bias: SMatrix<f32, BIAS, BIAS>,
}

/// Transition of the motion over a step, by motion and by bias.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transition {
    pub(super) by_motion: SMatrix<f32, MOTION, MOTION>,
    pub(super) by_bias: SMatrix<f32, MOTION, BIAS>,
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

impl Covariance {
    /// Returns the covariance of independent states.
    pub(super) fn from_deviations(motion: &Motion, bias: &Bias) -> Self {
        Self {
            motion: SMatrix::from_diagonal(&motion.component_mul(motion)),
            cross: SMatrix::zeros(),
            bias: SMatrix::from_diagonal(&bias.component_mul(bias)),
        }
    }

    /// Advances by a transition; the bias has unit dynamics but for the residual force.
    pub(super) fn advance(&mut self, transition: &Transition) {
        let Transition { by_motion, by_bias, residual } = transition;
        let moved = by_motion * self.motion + by_bias * self.cross.transpose();
        let mut cross = by_motion * self.cross + by_bias * self.bias;
        let motion = moved * by_motion.transpose() + cross * by_bias.transpose();
        self.motion = (motion + motion.transpose()) * 0.5;
        cross.column_mut(RESIDUAL).scale_mut(*residual);
        self.cross = cross;
        self.bias.column_mut(RESIDUAL).scale_mut(*residual);
        self.bias.row_mut(RESIDUAL).scale_mut(*residual);
    }

    /// Adds process noise: variances of the speeds, and of the bias.
    pub(super) fn add_noise(&mut self, speeds: &SMatrix<f32, 2, 2>, bias: &Bias) {
        let mut block = self.motion.fixed_view_mut::<2, 2>(2, 2);
        block += speeds;
        self.bias.set_diagonal(&(self.bias.diagonal() + bias));
    }

    /// Forgets everything about a bias and sets its deviation.
    pub(super) fn restart_bias(&mut self, place: usize, deviation: f32) {
        self.cross.column_mut(place).fill(0.0);
        self.bias.column_mut(place).fill(0.0);
        self.bias.row_mut(place).fill(0.0);
        if let Some(variance) = self.bias.get_mut((place, place)) {
            *variance = deviation * deviation;
        }
    }

    /// Returns the covariance of the state with a linear function of it.
    fn covariance_with(&self, gradient: &Gradient) -> (Motion, Bias) {
        let motion = gradient.fixed_rows::<MOTION>(0);
        let bias = gradient.fixed_rows::<BIAS>(MOTION);
        (self.motion * motion + self.cross * bias, self.cross.tr_mul(&motion) + self.bias * bias)
    }

    /// Returns the variance of a linear function of the state, 0 or more.
    pub(super) fn variance(&self, gradient: &Gradient) -> f32 {
        let (motion, bias) = self.covariance_with(gradient);
        let sum =
            gradient.fixed_rows::<MOTION>(0).dot(&motion) + gradient.fixed_rows::<BIAS>(MOTION).dot(&bias);
        sum.max(0.0)
    }

    /// Returns the variance of the deformation in a direction.
    pub(super) fn deformation_variance(&self, normal_y: f32, normal_z: f32) -> f32 {
        let (p, c) = (&self.motion, &self.cross);
        let along = normal_y * normal_y * p.m11 + normal_z * normal_z * p.m22;
        let across =
            normal_y * normal_z * p.m12 - normal_y * c[(0, CLEARANCE)] - normal_z * c[(1, CLEARANCE)];
        (along + 2.0 * across + self.bias_variance(CLEARANCE)).max(0.0)
    }

    /// Returns the variance of a linear function of the speeds.
    pub(super) fn speed_variance(&self, by_y: f32, by_z: f32) -> f32 {
        let p = &self.motion;
        (by_y * by_y * p.m33 + 2.0 * by_y * by_z * p.m34 + by_z * by_z * p.m44).max(0.0)
    }

    /// Returns the variance of a bias.
    pub(super) fn bias_variance(&self, place: usize) -> f32 {
        self.bias.get((place, place)).copied().unwrap_or_default().max(0.0)
    }

    /// Returns true if every variance is a number above 0.
    pub(super) fn is_positive(&self) -> bool {
        self.motion.diagonal().iter().chain(self.bias.diagonal().iter()).all(|v| v.is_finite() && *v > 0.0)
    }

    /// Corrects by the position of the journal along an axis, 0 for y and 1 for z.
    pub(super) fn correct_position(&mut self, axis: usize, innovation: f32, noise: f32) -> Correction {
        let motion = self.motion.column(axis).into_owned();
        let bias = self.cross.row(axis).transpose();
        let variance = motion.get(axis).copied().unwrap_or_default() + noise;
        self.correct(motion, bias, innovation, variance)
    }

    /// Corrects by a linear function of the state.
    pub(super) fn correct_scalar(&mut self, gradient: &Gradient, innovation: f32, noise: f32) -> Correction {
        let (motion, bias) = self.covariance_with(gradient);
        let variance = self.variance(gradient) + noise;
        self.correct(motion, bias, innovation, variance)
    }

    /// Subtracts the information of a measurement; `variance` of the innovation, above 0.
    fn correct(&mut self, motion: Motion, bias: Bias, innovation: f32, variance: f32) -> Correction {
        let inverse = 1.0 / variance;
        let (motion_gain, bias_gain) = (motion * inverse, bias * inverse);
        self.motion -= motion_gain * motion.transpose();
        self.cross -= motion_gain * bias.transpose();
        self.bias -= bias_gain * bias.transpose();
        Correction {
            motion: motion_gain * innovation,
            bias: bias_gain * innovation,
            normalised: innovation * innovation * inverse,
        }
    }
}
