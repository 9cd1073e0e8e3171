//! What comes out of one step.

use crate::flags::Flags;
use crate::held::{WordSum, read_anew};

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
    /// Of the forces as they were computed.
    sum: WordSum,
}

impl Estimate {
    /// An estimate with the sum of its forces.
    #[inline]
    pub(crate) fn new(normal_force_mn: i32, friction_force_mn: i32, flags: Flags, saturated: u16) -> Self {
        let sum = Self::summed(normal_force_mn, friction_force_mn);
        Self { normal_force_mn, friction_force_mn, flags, saturated, sum }
    }

    /// Whether a bit of the forces is not what was computed, as far as they have waited in memory.
    #[inline]
    pub fn is_spoilt(&mut self) -> bool {
        read_anew(self);
        Self::summed(self.normal_force_mn, self.friction_force_mn) != self.sum
    }

    #[inline]
    fn summed(normal_force_mn: i32, friction_force_mn: i32) -> WordSum {
        WordSum::of(&[normal_force_mn.cast_unsigned(), friction_force_mn.cast_unsigned()])
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_that_is_not_the_one_computed_shows() {
        let mut sound = Estimate::new(40_000, -300, Flags::NONE, 0);
        assert!(!sound.is_spoilt() && !Estimate::default().is_spoilt());
        for bit in 0..32 {
            assert!(Estimate { normal_force_mn: 40_000 ^ 1 << bit, ..sound }.is_spoilt());
            assert!(Estimate { friction_force_mn: -300 ^ 1 << bit, ..sound }.is_spoilt());
        }
    }
}
