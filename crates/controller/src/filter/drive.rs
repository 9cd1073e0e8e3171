//! Drive motion tracked from the measured angle.
//!
//! The displacement of the fork is `y + R_d sin(angle)`: measured, not commanded, so a drive that
//! lags is followed. A Kalman filter of displacement, speed, acceleration and jerk; the jerk is a
//! first-order Markov process whose deviation and time follow from stroke and period. The gains
//! settle within twice the jerk's correlation time and are then kept, so that rounding cannot
//! accumulate in the covariance.

use super::configuration::FilterConfiguration;
use crate::integrity::words;
use nalgebra::{Matrix4, Vector4};

/// Multiple of the jerk's correlation time after which the gains are kept.
const SETTLING: f32 = 2.0;

/// Displacement, speed, acceleration and jerk of the drive, SI units.
#[derive(Clone, Copy, Debug)]
pub(super) struct DriveTracker {
    state: Vector4<f32>,
    covariance: Matrix4<f32>,
    gain: Vector4<f32>,
    remaining_s: f32,
}
words!(DriveTracker { state, covariance, gain, remaining_s });

/// Constants of the drive's motion over a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct DriveModel {
    period: f32,
    /// Half of the period's square.
    half_square: f32,
    /// A sixth of its cube.
    sixth_cube: f32,
    /// Share of the jerk that is left after a sample.
    jerk_share: f32,
    /// Variance that the jerk gains in a sample.
    jerk_noise: f32,
    noise_variance: f32,
}
words!(DriveModel { period, half_square, sixth_cube, jerk_share, jerk_noise, noise_variance });

/// Motion of the drive at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct DriveMotion {
    pub(super) displacement: f32,
    pub(super) speed: f32,
    pub(super) acceleration: f32,
}

impl DriveModel {
    pub(super) fn new(config: &FilterConfiguration) -> Self {
        let (jerk, time, noise) = (config.jerk_sd(), config.jerk_time(), config.displacement_noise());
        let period = config.sample_period_s;
        Self {
            period,
            half_square: 0.5 * period * period,
            sixth_cube: period * period * period / 6.0,
            jerk_share: 1.0 - period / time,
            jerk_noise: jerk * jerk * 2.0 * period / time,
            noise_variance: noise * noise,
        }
    }

    /// Returns a state one sample on.
    fn moved(&self, state: &Vector4<f32>) -> Vector4<f32> {
        let Self { period, half_square: half, sixth_cube: sixth, jerk_share, .. } = *self;
        let [displacement, speed, acceleration, jerk] = (*state).into();
        Vector4::new(
            displacement + period * speed + half * acceleration + sixth * jerk,
            speed + period * acceleration + half * jerk,
            acceleration + period * jerk,
            jerk_share * jerk,
        )
    }
}

impl DriveTracker {
    /// Starts at a measured displacement with unknown motion.
    pub(super) fn new(config: &FilterConfiguration, displacement: f32) -> Self {
        let (jerk, time, noise) = (config.jerk_sd(), config.jerk_time(), config.displacement_noise());
        let acceleration = jerk * time;
        let sds = Vector4::new(noise, 0.5 * acceleration * time, acceleration, jerk);
        Self {
            state: Vector4::new(displacement, 0.0, 0.0, 0.0),
            covariance: Matrix4::from_diagonal(&sds.component_mul(&sds)),
            gain: Vector4::zeros(),
            remaining_s: SETTLING * time,
        }
    }

    /// Returns the present motion.
    pub(super) fn motion(&self) -> DriveMotion {
        let [displacement, speed, acceleration, _] = self.state.into();
        DriveMotion { displacement, speed, acceleration }
    }

    /// Variance of the acceleration.
    pub(super) fn acceleration_variance(&self) -> f32 {
        self.covariance.m33
    }

    /// Extrapolates the motion by a sample.
    pub(super) fn advance(&mut self, model: &DriveModel) {
        self.state = model.moved(&self.state);
    }

    /// Corrects the extrapolated motion by a measured displacement.
    pub(super) fn correct(&mut self, model: &DriveModel, displacement: f32) {
        if self.remaining_s > 0.0 {
            self.remaining_s -= model.period;
            self.update_gain(model);
        }
        self.state += self.gain * (displacement - self.state.x);
    }

    /// Advances the covariance by a sample and derives the gain from it.
    fn update_gain(&mut self, model: &DriveModel) {
        let moved = |matrix: &Matrix4<f32>| {
            let [x, speed, acceleration, jerk] = matrix.data.0.map(Vector4::from);
            Matrix4::from_columns(&[
                model.moved(&x),
                model.moved(&speed),
                model.moved(&acceleration),
                model.moved(&jerk),
            ])
        };
        let mut predicted = moved(&moved(&self.covariance).transpose());
        predicted.m44 += model.jerk_noise;
        let first = predicted.column(0).into_owned();
        self.gain = first * (1.0 / (first.x + model.noise_variance));
        for column in 0..4 {
            for row in 0..=column {
                let value = predicted[(row, column)] - self.gain[row] * first[column];
                self.covariance[(row, column)] = value;
                self.covariance[(column, row)] = value;
            }
        }
    }
}
