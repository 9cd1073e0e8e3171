//! Samples for the Kalman filter, and a digest of its estimates.
//!
//! The journal circles the bearing of the default bench. It is pressed in by up to 50 um, leaves
//! the surface now and then, and slides slowly around every reversal. The motion is prescribed, so
//! forces and motion do not belong together: for bits and counts that does not matter.

use crate::noise::Noise;
use contact::BearingMaterial;
use controller::filter::{
    Filter, FilterConfiguration, FilterEstimate, Measurement, SensorNoise, Uncertainty,
};
use core::f32::consts::TAU;

/// Samples of a digest: 0.4 s.
const SAMPLES: u32 = 4000;

/// Configuration of the filter for the default bench with its declared uncertainties.
pub fn default_bench() -> FilterConfiguration {
    let material = BearingMaterial::Babbitt;
    let friction = material.friction_law();
    FilterConfiguration {
        sample_period_s: 1e-4,
        mass_kg: 150.0,
        inertia_kg_m2: 60.0,
        drive_lever_m: 0.3,
        load_lever_m: 0.36,
        journal_radius_m: 0.0695,
        radial_clearance_m: 5e-4,
        effective_modulus_pa: material.effective_modulus_pa() as f32,
        dissipation_factor: material.damping_per_mille() as f32 * 1e-3,
        friction: contact::FrictionLaw {
            coulomb_coefficient: friction.coulomb_coefficient as f32,
            static_coefficient: friction.static_coefficient as f32,
            stribeck_speed_m_s: friction.stribeck_speed_m_s as f32,
            shape: friction.shape,
            viscous_slope_s_m: friction.viscous_slope_s_m as f32,
            viscous_onset_m_s: friction.viscous_onset_m_s as f32,
            regularisation_m_s: friction.regularisation_m_s as f32,
        },
        latch_floor_m_s: 1e-3,
        stroke_m: 0.172,
        period_s: 1.0,
        noise: SensorNoise { position_m: 0.2e-6, angle_rad: 20e-6, drive_force_n: 20.0 },
        uncertainty: Uncertainty {
            mass_share: 0.02,
            inertia_share: 0.05,
            clearance_m: 10e-6,
            stiffness_share: 0.05,
            friction_share: 0.03,
            lever_share: 0.003,
        },
    }
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
    pub fn next(&mut self) -> Measurement {
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
            let measured = orbit.next();
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
