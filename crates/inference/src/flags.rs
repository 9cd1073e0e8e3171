//! What an estimate has to say about itself, as a set of bits.
//!
//! Remarks are about the sample they travel with. An estimate looks back at [`crate::WINDOW`] samples, those before with remarks of
//! their own: a caller who wants none of that history to be remarked on joins the flags of so many estimates.
//!
//! Bits 0 to 14 belong to this crate; bits 15 to 31 are free for the caller.

use core::ops::{BitOr, BitOrAssign};

/// Set of remarks on one estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags(u32);

impl Flags {
    /// No remark.
    pub const NONE: Self = Self(0);
    /// The radial clearance is outside the range the networks were trained on.
    pub const OUTSIDE_CLEARANCE: Self = Self(1 << 0);
    /// The deformation is above the range.
    pub const OUTSIDE_DEFORMATION: Self = Self(1 << 1);
    /// In contact, the rate over the approach speed is outside the range, and the network saw the nearest end; or one of the two is
    /// beyond the whole numbers of a [`crate::Sample`].
    pub const OUTSIDE_RATE_RATIO: Self = Self(1 << 2);
    /// In contact, the sliding speed is outside the range; the network saw the nearest end.
    pub const OUTSIDE_SLIDING_SPEED: Self = Self(1 << 3);
    /// The predicted normal force is above every force of the training set.
    pub const OUTSIDE_FORCE: Self = Self(1 << 4);
    /// At least one activation was clipped at full scale.
    pub const SATURATED: Self = Self(1 << 5);
    /// An input was infinite or not a number: the forces are 0 and the history starts anew.
    pub const NON_FINITE: Self = Self(1 << 6);
    /// Fewer samples than the window holds have been seen since the start or the last reset. The normal force behind them no
    /// longer depends on the start; the friction network then still looks back at forces from before, until
    /// 2 [`crate::WINDOW`] - 1 samples have been seen. (Training and verification judge both forces after one window.)
    pub const WARMING_UP: Self = Self(1 << 7);
    /// There was no sample: the forces are 0 and the history starts anew.
    pub const MISSING: Self = Self(1 << 8);
    /// Something is no longer what it was: a bit of the model's image has changed since it was loaded (nothing in this crate finds that out; whoever
    /// checks an image in use says it with this), a bit of the networks' history, found with the column that leaves it, or of what waited on the stack while the
    /// networks worked; or a kernel's way through its layer did not end where the layer does.
    pub const ALTERED: Self = Self(1 << 9);
    /// The friction network gave a coefficient of 1 or more, which no bearing has that it was trained on.
    pub const IMPLAUSIBLE_FRICTION: Self = Self(1 << 10);
    /// Every remark that means "outside the training range".
    pub const OUTSIDE_TRAINING: Self = Self(
        Self::OUTSIDE_CLEARANCE.0
            | Self::OUTSIDE_DEFORMATION.0
            | Self::OUTSIDE_RATE_RATIO.0
            | Self::OUTSIDE_SLIDING_SPEED.0
            | Self::OUTSIDE_FORCE.0,
    );

    /// The set with these bits.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// The bits of the set.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Whether every remark of `other` is in this set.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether any remark of `other` is in this set.
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// This set if the condition holds, else the empty one.
    pub const fn when(self, condition: bool) -> Self {
        if condition { self } else { Self::NONE }
    }
}

impl BitOr for Flags {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for Flags {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_join_and_contain() {
        let both = Flags::SATURATED | Flags::OUTSIDE_FORCE;
        assert!(both.contains(Flags::SATURATED) && both.contains(Flags::OUTSIDE_FORCE));
        assert!(!both.contains(Flags::OUTSIDE_TRAINING) && both.intersects(Flags::OUTSIDE_TRAINING));
        assert_eq!(Flags::from_bits(both.bits()), both);
        assert_eq!(Flags::NON_FINITE.when(false), Flags::NONE);
    }

    #[test]
    fn this_crate_stays_in_its_fifteen_bits() {
        let all = Flags::OUTSIDE_TRAINING
            | Flags::SATURATED
            | Flags::NON_FINITE
            | Flags::WARMING_UP
            | Flags::MISSING
            | Flags::ALTERED
            | Flags::IMPLAUSIBLE_FRICTION;
        assert!(all.bits() < 1 << 15);
    }
}
