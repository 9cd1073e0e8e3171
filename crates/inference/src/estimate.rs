//! Output of one step.

use crate::flags::Flags;
use crate::word_sum::{WordSum, read_anew};

/// Outputs of one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Estimate {
    /// Normal force in mN, never below 0, exactly 0 without contact.
    pub normal_force_mn: i32,
    /// Friction force in mN along the sliding direction: opposed to the sliding speed.
    pub friction_force_mn: i32,
    /// Flags of this estimate.
    pub flags: Flags,
    /// Number of activations clipped at full scale in this sample.
    pub saturated: u16,
    /// Word sum of both forces, formed when they were computed.
    sum: WordSum,
}

impl Estimate {
    /// Creates an estimate and forms the sum of its forces.
    #[inline]
    pub(crate) fn new(normal_force_mn: i32, friction_force_mn: i32, flags: Flags, saturated: u16) -> Self {
        let sum = Self::summed(normal_force_mn, friction_force_mn);
        Self { normal_force_mn, friction_force_mn, flags, saturated, sum }
    }

    /// Decides whether a bit of the forces has flipped in memory since they were computed.
    #[inline]
    pub fn is_corrupted(&mut self) -> bool {
        read_anew(self);
        Self::summed(self.normal_force_mn, self.friction_force_mn) != self.sum
    }

    #[inline]
    fn summed(normal_force_mn: i32, friction_force_mn: i32) -> WordSum {
        WordSum::from_words(&[normal_force_mn.cast_unsigned(), friction_force_mn.cast_unsigned()])
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
    fn a_flipped_bit_of_either_force_is_detected() {
        let mut intact = Estimate::new(40_000, -300, Flags::NONE, 0);
        assert!(!intact.is_corrupted() && !Estimate::default().is_corrupted());
        for bit in 0..32 {
            assert!(Estimate { normal_force_mn: 40_000 ^ 1 << bit, ..intact }.is_corrupted());
            assert!(Estimate { friction_force_mn: -300 ^ 1 << bit, ..intact }.is_corrupted());
        }
    }
}
