//! Noise levels of the filter, from the sensors' noise, the declared uncertainties and the bench's
//! own forces.

use super::arithmetic::larger;
use super::configuration::{FilterConfiguration, GRAVITY, Uncertainty};
use super::contact::ContactModel;
use super::state::{Bias, RESIDUAL};
use crate::integrity::words;

/// Time in s in which a factor may drift by its declared deviation. A bearing warms up in minutes.
const DRIFT_S: f32 = 30.0;
/// Acceleration that the equations of motion miss from sample to sample, as a share of gravity.
const MODEL_ERROR: f32 = 0.01;
/// Duration in s for which that acceleration lasts: a sample at the design rate.
const MODEL_ERROR_S: f32 = 1e-4;
/// Time in s over which the squares of the innovations are averaged.
const INNOVATION_TIME_S: f32 = 0.01;

/// Variances that a sample adds or brings.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoiseLevels {
    /// Variance of a speed that the equations of motion miss in a sample, m2/s2.
    pub(super) speed_variance: f32,
    /// Variance of a measured position, m2.
    pub(super) position_variance: f32,
    /// Smallest variance of a force that an estimate may claim, N2: the square of the elastic force
    /// of a deformation as large as the noise of the position sensors.
    pub(super) min_force_variance: f32,
    /// Speed of a fall through the clearance, m/s: the deviation of the journal's at the start.
    pub(super) fall_speed: f32,
    /// Share of a new sample in the average of the innovations.
    pub(super) innovation_share: f32,
    /// Square of the inertia as seen at the crank pin, kg2.
    pub(super) reflected_square: f32,
    /// Variance of the residual force without load, N2, and its rise with the load's square.
    residual: [f32; 2],
    /// Share of the residual force's variance that is new after a sample.
    residual_share: f32,
    /// Drift of stiffness, clearance, friction and damping in a sample.
    drift: [f32; 4],
}
words!(NoiseLevels {
    speed_variance,
    position_variance,
    min_force_variance,
    fall_speed,
    innovation_share,
    reflected_square,
    residual,
    residual_share,
    drift,
});

impl NoiseLevels {
    pub(super) fn new(config: &FilterConfiguration) -> Self {
        let Uncertainty { inertia_share, lever_share, .. } = config.uncertainty;
        let time = config.sample_period_s;
        let [stiffness, clearance, friction] = config.factor_sds();
        // Not 0 for a bench that is described as exact: the equations miss that much.
        let missed = MODEL_ERROR * GRAVITY * config.mass_kg;
        let drive = inertia_share * config.reflected_mass() * config.jerk_sd() / config.frequency();
        let drive = larger(drive, missed);
        let cranks = lever_share * config.load_lever_m / config.drive_lever_m;
        let noise = config.noise.position_m;
        let min_force = ContactModel::new(config).force_of_noise(noise);
        let acceleration = MODEL_ERROR * GRAVITY;
        Self {
            speed_variance: acceleration * acceleration * MODEL_ERROR_S * time,
            position_variance: noise * noise,
            min_force_variance: min_force * min_force,
            fall_speed: libm::sqrtf(4.0 * GRAVITY * config.radial_clearance_m),
            innovation_share: (time / INNOVATION_TIME_S).min(1.0),
            reflected_square: config.reflected_mass() * config.reflected_mass(),
            residual: [drive * drive, 2.0 * cranks * cranks],
            residual_share: 2.0 * time / config.residual_time(),
            drift: [stiffness, clearance, friction, config.damping_sd()]
                .map(|deviation| deviation * deviation * time / DRIFT_S),
        }
    }

    /// Returns the variances that a sample adds to the factors alone.
    pub(super) fn factor_drift(&self) -> Bias {
        let [stiffness, clearance, friction, damping] = self.drift;
        Bias::new(0.0, stiffness, clearance, friction, damping, 0.0)
    }

    /// Variance of the residual force along Y, N2: the part of the drive's and the load's force
    /// that the uncertain inertia and cranks leave open. `load` in N.
    pub(super) fn residual_variance(&self, load: f32) -> f32 {
        let [base, by_load] = self.residual;
        base + by_load * load * load
    }

    /// Returns the variances that a sample adds to the bias; load in N, variance of the drive's
    /// acceleration in m2/s4.
    pub(super) fn bias_variances(&self, load: f32, drive_variance: f32) -> Bias {
        let residual = self.residual_variance(load) + self.reflected_square * drive_variance;
        let mut variances = self.factor_drift();
        variances[RESIDUAL] = residual * self.residual_share;
        variances
    }
}
