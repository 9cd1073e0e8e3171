//! Estimate of a sample.

use crate::integrity::words;

/// Estimate of a sample with its standard deviations.
#[derive(Clone, Copy, Debug, Default)]
pub struct FilterEstimate {
    /// Normal force, N.
    pub normal_force_n: f32,
    /// Standard deviation of the normal force, N; above 0.
    pub normal_force_sd_n: f32,
    /// Friction force, positive in the direction of positive sliding, N.
    pub friction_force_n: f32,
    /// Force of the bearing on the journal along Y, N.
    pub force_y_n: f32,
    /// Force of the bearing on the journal along Z, N.
    pub force_z_n: f32,
    /// Standard deviation of the force vector, N; above 0.
    pub force_sd_n: f32,
    /// Torque of the bearing on the shaft, N m.
    pub friction_torque_nm: f32,
    /// Standard deviation of the torque, N m; above 0.
    pub friction_torque_sd_nm: f32,
    /// Deformation, m; negative without contact.
    pub deformation_m: f32,
    /// Radial clearance, m.
    pub clearance_m: f32,
    /// Standard deviation of the clearance, m.
    pub clearance_sd_m: f32,
    /// Stiffness over the described one.
    pub stiffness_factor: f32,
    /// Standard deviation of the stiffness factor.
    pub stiffness_sd: f32,
    /// Friction over the described one.
    pub friction_factor: f32,
    /// Standard deviation of the friction factor.
    pub friction_sd: f32,
    /// Direction of the journal from the bearing's centre along Y.
    pub(crate) normal_y: f32,
    /// The same along Z.
    pub(crate) normal_z: f32,
    /// Rate of the deformation, m/s.
    pub deformation_rate_m_s: f32,
    /// Approach speed of the onset, m/s, corrected by the estimated damping; at least its floor.
    pub approach_speed_m_s: f32,
    /// Sliding speed, m/s.
    pub sliding_speed_m_s: f32,
    /// Normal force of the described law at this contact, N.
    pub law_force_n: f32,
    /// Friction force of the described law at this contact, N.
    pub(crate) law_friction_n: f32,
    /// True as long as the start still dominates the uncertainty.
    pub is_converging: bool,
    /// False if the innovations are larger than model and sensors explain. The variances of force
    /// and torque are then multiplied by the excess.
    pub fits: bool,
}
words!(FilterEstimate {
    normal_force_n,
    normal_force_sd_n,
    friction_force_n,
    force_y_n,
    force_z_n,
    force_sd_n,
    friction_torque_nm,
    friction_torque_sd_nm,
    deformation_m,
    clearance_m,
    clearance_sd_m,
    stiffness_factor,
    stiffness_sd,
    friction_factor,
    friction_sd,
    normal_y,
    normal_z,
    deformation_rate_m_s,
    approach_speed_m_s,
    sliding_speed_m_s,
    law_force_n,
    law_friction_n,
    is_converging,
    fits,
});

impl FilterEstimate {
    /// Returns true if forces, deviations and factors are numbers.
    pub(super) fn is_finite(&self) -> bool {
        let sums = [
            self.force_y_n + self.force_z_n + self.force_sd_n + self.normal_force_sd_n,
            self.friction_torque_nm + self.friction_torque_sd_nm,
            self.clearance_m + self.stiffness_factor + self.friction_factor,
        ];
        sums.iter().all(|sum| sum.is_finite())
    }

    /// Estimate while nothing is known: before the first complete sample, and after a state that
    /// was no longer finite.
    pub(crate) const UNKNOWN: Self = Self {
        normal_force_n: 0.0,
        normal_force_sd_n: f32::INFINITY,
        friction_force_n: 0.0,
        force_y_n: 0.0,
        force_z_n: 0.0,
        force_sd_n: f32::INFINITY,
        friction_torque_nm: 0.0,
        friction_torque_sd_nm: f32::INFINITY,
        deformation_m: 0.0,
        clearance_m: 0.0,
        clearance_sd_m: f32::INFINITY,
        stiffness_factor: 1.0,
        stiffness_sd: f32::INFINITY,
        friction_factor: 1.0,
        friction_sd: f32::INFINITY,
        normal_y: 1.0,
        normal_z: 0.0,
        deformation_rate_m_s: 0.0,
        approach_speed_m_s: 0.0,
        sliding_speed_m_s: 0.0,
        law_force_n: 0.0,
        law_friction_n: 0.0,
        is_converging: true,
        fits: true,
    };
}
