//! What comes out of one step.

use crate::flags::Flags;

/// Outputs of one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Estimate {
    /// Normal force in mN, never below 0, exactly 0 without contact.
    pub normal_force_mn: i32,
    /// Friction force in mN along the sliding direction: opposed to the sliding speed.
    pub friction_force_mn: i32,
    /// Remarks on this estimate.
    pub flags: Flags,
    /// Number of activations clipped at full scale in this sample.
    pub saturated: u16,
}

impl Estimate {
    /// Normal force in N.
    pub fn normal_force_n(&self) -> f32 {
        newtons(self.normal_force_mn)
    }

    /// Friction force in N along the sliding direction.
    pub fn friction_force_n(&self) -> f32 {
        newtons(self.friction_force_mn)
    }
}

fn newtons(millinewtons: i32) -> f32 {
    millinewtons as f32 / 1000.0
}
