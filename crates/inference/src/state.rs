//! What goes in and what comes out of one step, in SI units.

use crate::flags::Flags;

/// Physical inputs of one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactState {
    /// Radial clearance `R_B - R_J` in m.
    pub radial_clearance_m: f32,
    /// Deformation `d = a - D` in m; below 0 there is a gap of that width.
    pub deformation_m: f32,
    /// Rate `d'` of the deformation in m/s, positive while approaching.
    pub deformation_rate_m_s: f32,
    /// Approach speed latched at the onset of the contact in m/s; the image's floor is applied inside.
    pub approach_speed_m_s: f32,
    /// Relative tangential speed of the contact points in m/s.
    pub sliding_speed_m_s: f32,
}

impl ContactState {
    /// Whether every input is a finite number.
    pub fn is_finite(&self) -> bool {
        self.radial_clearance_m.is_finite()
            && self.deformation_m.is_finite()
            && self.deformation_rate_m_s.is_finite()
            && self.approach_speed_m_s.is_finite()
            && self.sliding_speed_m_s.is_finite()
    }
}

/// Outputs of one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Normal force in N, never below 0, exactly 0 without contact.
    pub normal_force_n: f32,
    /// Friction force in N along the sliding direction: opposed to the sliding speed.
    pub friction_force_n: f32,
    /// Remarks on this estimate.
    pub flags: Flags,
    /// Number of activations clipped to 16 bits in this sample.
    pub saturated: u16,
}
