//! Configuration of the filter: the described bench, its sensors and what is uncertain about them.
//!
//! Two constants below, four of the noise levels and six of the filter's model are chosen once for
//! all benches.

use crate::integrity::words;
use contact::FrictionLaw;
use core::f32::consts::TAU;

/// Gravity, m/s2.
pub(super) const GRAVITY: f32 = contact::GRAVITY_M_S2 as f32;
/// Relative deviation of the damping. Published dissipation factors of one restitution differ by
/// that much.
const DAMPING_SHARE: f32 = 0.3;
/// Correlation time of the residual force as a share of the drive's period.
const RESIDUAL_SHARE: f32 = 0.02;

/// Relative excess of a value over its range that is accepted.
const ROUNDING: f32 = 1e-6;

/// Description of the bench for the filter.
#[derive(Clone, Copy, Debug)]
pub struct FilterConfiguration {
    /// Sample period, s: 50 us to 1 ms.
    pub sample_period_s: f32,
    /// Mass of the shaft, kg.
    pub mass_kg: f32,
    /// Inertia of the shaft about its axis, kg m2.
    pub inertia_kg_m2: f32,
    /// Radius of the drive's crank, m.
    pub drive_lever_m: f32,
    /// Radius of the load's crank, m.
    pub load_lever_m: f32,
    /// Radius of the journal, m.
    pub journal_radius_m: f32,
    /// Radial clearance, m.
    pub radial_clearance_m: f32,
    /// Effective modulus of bearing and journal, Pa.
    pub effective_modulus_pa: f32,
    /// Dissipation factor of the normal law. Divided by the approach speed it multiplies the rate
    /// of the deformation.
    pub dissipation_factor: f32,
    /// Dry friction, with a regularised sign.
    pub friction: FrictionLaw<f32>,
    /// Least approach speed, m/s.
    pub latch_floor_m_s: f32,
    /// Stroke of the drive, m.
    pub stroke_m: f32,
    /// Period of the drive, s.
    pub period_s: f32,
    /// Noise of the sensors.
    pub noise: SensorNoise,
    /// Declared uncertainties.
    pub uncertainty: Uncertainty,
}
words!(FilterConfiguration {
    sample_period_s,
    mass_kg,
    inertia_kg_m2,
    drive_lever_m,
    load_lever_m,
    journal_radius_m,
    radial_clearance_m,
    effective_modulus_pa,
    dissipation_factor,
    friction,
    latch_floor_m_s,
    stroke_m,
    period_s,
    noise,
    uncertainty,
});

/// Standard deviation of one sample of each sensor.
#[derive(Clone, Copy, Debug)]
pub struct SensorNoise {
    /// Position of the journal, m.
    pub position_m: f32,
    /// Angle of the shaft, rad.
    pub angle_rad: f32,
    /// Force of the drive, N; used with a measured drive force only.
    pub drive_force_n: f32,
}
words!(SensorNoise { position_m, angle_rad, drive_force_n });

/// Standard deviation of each parameter of the description.
#[derive(Clone, Copy, Debug)]
pub struct Uncertainty {
    /// Mass, relative.
    pub mass_share: f32,
    /// Inertia, relative.
    pub inertia_share: f32,
    /// Radial clearance, m.
    pub clearance_m: f32,
    /// Stiffness of the contact, relative.
    pub stiffness_share: f32,
    /// Level of friction, relative.
    pub friction_share: f32,
    /// Radii of the cranks, relative.
    pub lever_share: f32,
}
words!(Uncertainty { mass_share, inertia_share, clearance_m, stiffness_share, friction_share, lever_share });

/// Reason why a configuration is refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{name}: found {found}, expected {low} to {high}")]
pub struct FilterError {
    /// Field of the configuration.
    pub(crate) name: &'static str,
    /// Value that was found.
    pub(crate) found: f32,
    /// Smallest value that is accepted.
    pub(crate) low: f32,
    /// Largest value that is accepted.
    pub(crate) high: f32,
}

impl FilterConfiguration {
    /// Checks every value against its range.
    ///
    /// # Errors
    ///
    /// The first value out of range; not-a-number is out of range.
    pub(crate) fn check(&self) -> Result<(), FilterError> {
        let Self { noise, uncertainty, friction, .. } = self;
        let ranges = [
            ("sample_period_s", self.sample_period_s, 5e-5, 1e-3),
            ("mass_kg", self.mass_kg, 1e-2, 1e5),
            ("inertia_kg_m2", self.inertia_kg_m2, 1e-4, 1e6),
            ("drive_lever_m", self.drive_lever_m, 1e-2, 1e1),
            ("load_lever_m", self.load_lever_m, 0.0, 1e1),
            ("journal_radius_m", self.journal_radius_m, 1e-3, 1.0),
            ("radial_clearance_m", self.radial_clearance_m, 1e-6, 5e-3),
            ("effective_modulus_pa", self.effective_modulus_pa, 1e7, 1e12),
            ("dissipation_factor", self.dissipation_factor, 0.0, 10.0),
            ("friction.coulomb_coefficient", friction.coulomb_coefficient, 0.0, 1.0),
            ("friction.static_coefficient", friction.static_coefficient, 0.0, 1.0),
            ("friction.stribeck_speed_m_s", friction.stribeck_speed_m_s, 1e-4, 10.0),
            ("friction.viscous_slope_s_m", friction.viscous_slope_s_m, 0.0, 10.0),
            ("friction.viscous_onset_m_s", friction.viscous_onset_m_s, 0.0, 10.0),
            ("friction.regularisation_m_s", friction.regularisation_m_s, 1e-4, 0.1),
            ("latch_floor_m_s", self.latch_floor_m_s, 1e-4, 0.1),
            ("stroke_m", self.stroke_m, 1e-3, 2.0 * self.drive_lever_m),
            ("period_s", self.period_s, 0.05, 100.0),
            ("noise.position_m", noise.position_m, 1e-9, 1e-4),
            ("noise.angle_rad", noise.angle_rad, 1e-7, 1e-2),
            ("noise.drive_force_n", noise.drive_force_n, 1e-2, 1e5),
            ("uncertainty.mass_share", uncertainty.mass_share, 0.0, 0.5),
            ("uncertainty.inertia_share", uncertainty.inertia_share, 0.0, 0.5),
            ("uncertainty.clearance_m", uncertainty.clearance_m, 1e-8, 1e-3),
            ("uncertainty.stiffness_share", uncertainty.stiffness_share, 1e-4, 0.5),
            ("uncertainty.friction_share", uncertainty.friction_share, 1e-4, 0.5),
            ("uncertainty.lever_share", uncertainty.lever_share, 0.0, 0.1),
        ];
        // Values that were converted from integers are rounded.
        let is_outside = |&(_, found, low, high): &(&str, f32, f32, f32)| {
            !(low * (1.0 - ROUNDING)..=high * (1.0 + ROUNDING)).contains(&found)
        };
        match ranges.into_iter().find(is_outside) {
            Some((name, found, low, high)) => Err(FilterError { name, found, low, high }),
            None => Ok(()),
        }
    }

    /// Angular frequency of the drive, rad/s.
    pub(super) fn frequency(&self) -> f32 {
        TAU / self.period_s
    }

    /// Inertia of the shaft as seen at the crank pin, kg, at the crank's middle position.
    pub(super) fn reflected_mass(&self) -> f32 {
        self.inertia_kg_m2 / (self.drive_lever_m * self.drive_lever_m)
    }

    /// Standard deviation of the drive's jerk, m/s3: a sine of the stroke at the period.
    pub(super) fn jerk_sd(&self) -> f32 {
        let frequency = self.frequency();
        0.5 * self.stroke_m * frequency * frequency * frequency
    }

    /// Correlation time of the jerk, s.
    pub(super) fn jerk_time(&self) -> f32 {
        0.5 * self.period_s
    }

    /// Standard deviation of the drive's displacement as measured by one sample, m.
    pub(super) fn displacement_noise(&self) -> f32 {
        libm::hypotf(self.noise.position_m, self.drive_lever_m * self.noise.angle_rad)
    }

    /// Correlation time of the residual force, s.
    pub(super) fn residual_time(&self) -> f32 {
        RESIDUAL_SHARE * self.period_s
    }

    /// Relative standard deviation of the damping after an onset that was seen exactly.
    pub(super) const fn damping_sd(&self) -> f32 {
        DAMPING_SHARE
    }

    /// Standard deviations of stiffness factor, clearance and friction factor.
    pub(super) const fn factor_sds(&self) -> [f32; 3] {
        let Uncertainty { stiffness_share, clearance_m, friction_share, .. } = self.uncertainty;
        [stiffness_share, clearance_m, friction_share]
    }
}
