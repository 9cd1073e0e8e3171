//! Samples for the Kalman filter, and a digest of its estimates.
//!
//! The journal circles the bearing of the default bench. It is pressed in by up to 50 um, leaves
//! the surface now and then, and slides slowly around every reversal. The motion is prescribed, so
//! forces and motion do not belong together: for bits and counts that does not matter.

use crate::noise::Noise;
use contact::BearingMaterial;
use controller::configuration::BENCH_B;
use controller::estimator::filter_configuration;
use controller::filter::{Filter, FilterConfiguration, FilterEstimate, Measurement};
use core::f32::consts::TAU;

/// Samples of a digest: 0.4 s.
const SAMPLES: u32 = 4000;

/// Configuration of the filter for the default bench with its declared uncertainties.
pub fn default_bench() -> FilterConfiguration {
    let mut config = filter_configuration(BearingMaterial::Babbitt, &BENCH_B.bench, &BENCH_B.monitor);
    config.noise.drive_force_n = 20.0;
    config
}

/// A filter and the samples that it gets.
#[derive(Clone, Debug)]
pub struct Orbit {
    /// The filter.
    pub filter: Filter,
    config: FilterConfiguration,
    noise: Noise,
    samples: u32,
    measures_drive_force: bool,
}

impl Orbit {
    /// Starts an orbit, with a measured drive force or without.
    pub fn new(measures_drive_force: bool) -> Option<Self> {
        let config = default_bench();
        let filter = Filter::new(&config).ok()?;
        Some(Self { filter, config, noise: Noise(1), samples: 0, measures_drive_force })
    }

    /// Returns the next sample.
    pub fn measure(&mut self) -> Measurement {
        let time = self.samples as f32 * 1e-4;
        self.samples += 1;
        let config = &self.config;
        let mut noise = |deviation: f32| deviation * self.noise.within(1000) as f32 * 1e-3;
        let deformation = 22e-6 + 28e-6 * libm::sinf(TAU * 17.0 * time);
        let distance = config.radial_clearance_m + deformation;
        let direction = TAU * (0.75 + 0.5 * time);
        let (y, z) = (distance * libm::cosf(direction), distance * libm::sinf(direction));
        let displacement = 0.5 * config.stroke_m * (1.0 - libm::cosf(TAU * 5.0 * time));
        Measurement {
            journal_y_m: y + noise(0.3e-6),
            journal_z_m: z + noise(0.3e-6),
            shaft_angle_rad: libm::asinf((displacement - y) / config.drive_lever_m) + noise(30e-6),
            load_force_n: 1e4 + noise(1.0),
            drive_force_n: self.measures_drive_force.then(|| 500.0 + noise(1000.0)),
        }
    }
}

/// Returns a digest of all estimates of two orbits, nothing if the configuration is refused.
pub fn digest() -> Option<u64> {
    let mut sum = 0;
    for measures_drive_force in [false, true] {
        let mut orbit = Orbit::new(measures_drive_force)?;
        for _ in 0..SAMPLES {
            let measured = orbit.measure();
            numbers(&orbit.filter.step(&measured)).iter().for_each(|number| {
                // FNV-1a over words.
                sum = (sum ^ u64::from(number.to_bits())).wrapping_mul(0x0100_0000_01b3);
            });
        }
    }
    Some(sum)
}

fn numbers(estimate: &FilterEstimate) -> [f32; 14] {
    [
        estimate.normal_force_n,
        estimate.friction_force_n,
        estimate.force_y_n,
        estimate.force_z_n,
        estimate.force_sd_n,
        estimate.friction_torque_nm,
        estimate.friction_torque_sd_nm,
        estimate.deformation_m,
        estimate.clearance_m,
        estimate.clearance_sd_m,
        estimate.stiffness_factor,
        estimate.stiffness_sd,
        estimate.friction_factor,
        estimate.friction_sd,
    ]
}
