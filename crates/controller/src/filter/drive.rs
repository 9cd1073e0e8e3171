//! Drive motion tracked from the measured angle.
//!
//! The displacement of the fork is `y + R_d sin(angle)`: measured, not commanded, so a drive that
//! lags is followed. A Kalman filter of displacement, speed, acceleration and jerk; the jerk is a
//! first-order Markov process whose deviation and time follow from stroke and period. The gains
//! settle within twice the jerk's correlation time and are then kept, so that rounding cannot
//! accumulate in the covariance.

use super::configuration::FilterConfiguration;
use nalgebra::{Matrix4, Vector4};

/// Multiple of the jerk's correlation time after which the gains are kept.
const SETTLING: f32 = 2.0;

/// Displacement, speed, acceleration and jerk of the drive, SI units.
#[derive(Clone, Copy, Debug)]
pub(super) struct DriveTracker {
    state: Vector4<f32>,
    covariance: Matrix4<f32>,
    gain: Vector4<f32>,
    jerk_time: f32,
    jerk_variance: f32,
    noise_variance: f32,
    remaining_s: f32,
}

/// Motion of the drive at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct DriveMotion {
    pub(super) displacement: f32,
    pub(super) speed: f32,
    pub(super) acceleration: f32,
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
            jerk_time: time,
            jerk_variance: jerk * jerk,
            noise_variance: noise * noise,
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

    /// Extrapolates the motion by a time in s.
    pub(super) fn advance(&mut self, time: f32) {
        self.state = transition(time, self.jerk_time) * self.state;
    }

    /// Corrects the extrapolated motion by a measured displacement, one sample period after the
    /// last one.
    pub(super) fn correct(&mut self, period: f32, displacement: f32) {
        if self.remaining_s > 0.0 {
            self.remaining_s -= period;
            self.update_gain(period);
        }
        self.state += self.gain * (displacement - self.state.x);
    }

    /// Advances the covariance by a sample and derives the gain from it.
    fn update_gain(&mut self, period: f32) {
        let transition = transition(period, self.jerk_time);
        let mut predicted = transition * self.covariance * transition.transpose();
        predicted.m44 += self.jerk_variance * 2.0 * period / self.jerk_time;
        let first = predicted.column(0).into_owned();
        self.gain = first / (first.x + self.noise_variance);
        let corrected = predicted - self.gain * first.transpose();
        self.covariance = (corrected + corrected.transpose()) * 0.5;
    }
}

/// Returns the transition over a time for a jerk of a correlation time.
fn transition(time: f32, jerk_time: f32) -> Matrix4<f32> {
    let (half, sixth) = (0.5 * time * time, time * time * time / 6.0);
    let keeps = 1.0 - time / jerk_time;
    Matrix4::new(
        1.0, time, half, sixth, //
        0.0, 1.0, time, half, //
        0.0, 0.0, 1.0, time, //
        0.0, 0.0, 0.0, keeps,
    )
}
