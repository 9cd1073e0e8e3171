//! What lies on the stack while the networks work, half of a tick: the contact's direction and motion, with a sum that tells whether they are still what was
//! put there. A bit that flips there would spoil the forces of this tick or what the next one goes on with, by too little for any limit.

use super::carried::Carried;
use super::geometry::ContactFrame;
use super::observer::Radial;

/// What waits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waiting {
    pub(super) normal_y: i32,
    pub(super) normal_z: i32,
    pub(super) radial: Radial,
    pub(super) approach_nm_s: u32,
    sum: Carried,
}

impl Waiting {
    #[inline]
    pub(super) fn new(contact: &ContactFrame, radial: Radial, approach_nm_s: u32) -> Self {
        let ContactFrame { normal_y, normal_z, .. } = *contact;
        let mut waiting = Self { normal_y, normal_z, radial, approach_nm_s, sum: Carried::default() };
        waiting.sum = waiting.summed();
        waiting
    }

    /// Whether a bit is not what it was.
    #[inline]
    pub(super) fn is_spoilt(&self) -> bool {
        self.summed() != self.sum
    }

    #[inline]
    fn summed(&self) -> Carried {
        let mut sum = Carried::default();
        sum.word(self.normal_y.cast_unsigned());
        sum.word(self.normal_z.cast_unsigned());
        sum.word(self.radial.deformation.cast_unsigned());
        sum.word(self.radial.rate_nm_s.cast_unsigned());
        sum.word(self.approach_nm_s);
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_that_waits_counts() {
        let radial = Radial { deformation: 450_000, rate_nm_s: -300_000 };
        let waiting = Waiting::new(&ContactFrame::at(-300_000, -400_000), radial, 3_000_000);
        assert!(!waiting.is_spoilt());
        let flips: [fn(&mut Waiting, u32); 5] = [
            |w, b| w.normal_y ^= 1 << b,
            |w, b| w.normal_z ^= 1 << b,
            |w, b| w.radial.deformation ^= 1 << b,
            |w, b| w.radial.rate_nm_s ^= 1 << b,
            |w, b| w.approach_nm_s ^= 1 << b,
        ];
        for flip in flips {
            for bit in 0..32 {
                let mut there = waiting;
                flip(&mut there, bit);
                assert!(there.is_spoilt(), "bit {bit}");
            }
        }
    }
}
