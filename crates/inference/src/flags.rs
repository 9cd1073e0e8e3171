//! Flags of an estimate, as a set of bits.
//!
//! A flag belongs to the sample that it was returned with. An estimate depends on [`crate::WINDOW`]
//! samples, and the earlier ones may have flags. To exclude every flagged input, join the flags of
//! the last [`crate::WINDOW`] estimates.
//!
//! Bits 0 to 14 belong to this crate; bits 15 to 31 are free for the caller.

use core::ops::{BitOr, BitOrAssign};

/// Set of flags of one estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags(u32);

impl Flags {
    /// No flag.
    pub const NONE: Self = Self(0);
    /// The radial clearance is outside the training range.
    pub const OUTSIDE_CLEARANCE: Self = Self(1 << 0);
    /// The deformation is above the training range.
    pub const OUTSIDE_DEFORMATION: Self = Self(1 << 1);
    /// The ratio of rate to approach speed in a contact is outside the training range and was
    /// clipped to it; or one of the two exceeds the integers of a [`crate::Sample`].
    pub const OUTSIDE_RATE_RATIO: Self = Self(1 << 2);
    /// The sliding speed in a contact is outside the training range and was clipped to it.
    pub const OUTSIDE_SLIDING_SPEED: Self = Self(1 << 3);
    /// The estimated normal force is above every force of the training set.
    pub const OUTSIDE_FORCE: Self = Self(1 << 4);
    /// Saturation: at least one activation was clipped at full scale.
    pub const SATURATED: Self = Self(1 << 5);
    /// An input was infinite or not a number: the forces are 0 and the history restarts.
    pub const NON_FINITE: Self = Self(1 << 6);
    /// Fewer than [`crate::WINDOW`] samples have been seen since the start or the last reset. After
    /// this flag ends, the normal force no longer depends on the start. The friction network still
    /// depends on earlier forces until 2 [`crate::WINDOW`] - 1 samples have been seen. Training and
    /// verification score both forces after one window.
    pub const WARMING_UP: Self = Self(1 << 7);
    /// The sample was missing: the forces are 0 and the history restarts.
    pub const MISSING: Self = Self(1 << 8);
    /// Memory was corrupted: a bit of the networks' history, of a value that waited on the stack,
    /// or of a kernel's weight pointer has flipped. A caller that checks the model image while it
    /// is in use reports a changed image with this flag, too; this crate checks the image only when
    /// it loads it.
    pub const CORRUPTED: Self = Self(1 << 9);
    /// The friction network gave a coefficient of 1 or more; no bearing of the training set has
    /// one.
    pub const IMPLAUSIBLE_FRICTION: Self = Self(1 << 10);
    /// All flags that mean "outside the training range".
    pub const OUTSIDE_TRAINING: Self = Self(
        Self::OUTSIDE_CLEARANCE.0
            | Self::OUTSIDE_DEFORMATION.0
            | Self::OUTSIDE_RATE_RATIO.0
            | Self::OUTSIDE_SLIDING_SPEED.0
            | Self::OUTSIDE_FORCE.0,
    );

    /// Returns the set with these bits.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// Bits of the set.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Decides whether every flag of `other` is in this set.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Decides whether any flag of `other` is in this set.
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Returns this set if the condition holds, else the empty set.
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
    fn the_flags_of_this_crate_use_fifteen_bits() {
        let all = Flags::OUTSIDE_TRAINING
            | Flags::SATURATED
            | Flags::NON_FINITE
            | Flags::WARMING_UP
            | Flags::MISSING
            | Flags::CORRUPTED
            | Flags::IMPLAUSIBLE_FRICTION;
        assert!(all.bits() < 1 << 15);
    }
}
