//! Safe state: what replaces an estimate that cannot be trusted.
//!
//! | state | while | output |
//! |---|---|---|
//! | starting | no estimate has been trusted yet | the live estimate with its flags |
//! | live | no distrust, or none for the recovery time | the live estimate |
//! | held | distrust now or within the recovery time | the last trusted estimate |
//! | lost | held for longer than the configured time | as held, but forces and torque 0 |
//!
//! Distrust is a flag of [`crate::flags::DISTRUSTED`]. A held estimate has forces, torque,
//! deformation and angle of the last trusted one, infinite deviations, the other values and flags
//! of this sample, and `HELD`.
//!
//! A hold ends by itself after the configured number of samples without distrust. This recovery
//! time covers the histories of the networks. Whether the machine has to stop is decided by the
//! reader of the flags.

use link::EstimateFrame;
use link::track::SafeState;

use crate::flags::HELD;
use crate::integrity::{WordSum, words};

/// The numbers of an estimate that are held: three forces and a torque, then deformation and angle.
type Trusted = [u32; 6];

/// Times of the safe state.
#[derive(Clone, Debug)]
pub(super) struct Holding {
    recovery_samples: u32,
    lost_samples: u32,
}
words!(Holding { recovery_samples, lost_samples });

/// State of the safe state.
#[derive(Clone, Debug, Default)]
pub(super) struct HoldingState {
    trusted: Trusted,
    /// Samples without distrust, at most the recovery time.
    clean: u32,
    /// Samples of the current hold; 0 while live.
    held_samples: u32,
    /// All ones once an estimate has been trusted.
    has_trusted: u32,
}

impl Holding {
    pub(super) const fn new(recovery_samples: u32, lost_samples: u32) -> Self {
        Self { recovery_samples, lost_samples }
    }

    /// Replaces an estimate if it is distrusted or a hold lasts. Returns whether a hold lasts,
    /// whether it has begun, and the word sum of the output's numbers.
    #[inline(never)]
    pub(super) fn apply(
        &self,
        state: &mut HoldingState,
        estimate: &mut EstimateFrame,
        is_distrusted: bool,
    ) -> (bool, bool, WordSum) {
        // Before anything has been trusted there is nothing to recover from.
        let settled = self.recovery_samples & !state.has_trusted;
        let clean = state.clean.wrapping_add(1).min(self.recovery_samples).max(settled);
        state.clean = clean & u32::from(is_distrusted).wrapping_sub(1);
        let is_unsettled = (state.clean < self.recovery_samples) | is_distrusted;
        let hold = u32::from(is_unsettled).wrapping_neg() & state.has_trusted;
        state.has_trusted |= u32::from(!is_distrusted).wrapping_neg();
        let begins = (hold != 0) & (state.held_samples == 0);
        state.held_samples = state.held_samples.saturating_add(1) & hold;
        let force_mask = u32::from(state.held_samples <= self.lost_samples).wrapping_neg();

        let [normal, y, z, torque, deformation, angle] = &mut state.trusted;
        let apply = |trusted: &mut u32, value: &mut f32, mask: u32| {
            *trusted = (*trusted & hold) | (value.to_bits() & !hold);
            *value = f32::from_bits(*trusted & mask);
        };
        apply(normal, &mut estimate.normal_force_n, force_mask);
        apply(y, &mut estimate.force_y_n, force_mask);
        apply(z, &mut estimate.force_z_n, force_mask);
        apply(torque, &mut estimate.friction_torque_nm, force_mask);
        apply(deformation, &mut estimate.deformation_m, u32::MAX);
        apply(angle, &mut estimate.contact_angle_rad, u32::MAX);
        if hold != 0 {
            estimate.forget_deviations();
        }
        estimate.flags |= HELD.bits() & hold;
        (hold != 0, begins, WordSum::from_words(&estimate.value_bits()))
    }

    pub(super) const fn state(&self, state: &HoldingState) -> SafeState {
        match (state.has_trusted, state.held_samples) {
            (0, _) => SafeState::Starting,
            (_, 0) => SafeState::Live,
            (_, held) if held > self.lost_samples => SafeState::Lost,
            _ => SafeState::Held,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn live(index: u32) -> EstimateFrame {
        EstimateFrame {
            sequence: index,
            time_us: 100 * index,
            normal_force_n: 1000.0 + index as f32,
            force_y_n: 1.0,
            force_z_n: 2.0,
            friction_torque_nm: -3.0,
            deformation_m: 1e-6 * index as f32,
            contact_angle_rad: 0.5,
            flags: 5,
            saturated: 1,
            ..EstimateFrame::default()
        }
    }

    /// A safe state with its times.
    struct TestHolding(Holding, HoldingState);

    impl TestHolding {
        fn new() -> Self {
            Self(Holding::new(10, 100), HoldingState::default())
        }

        fn state(&self) -> SafeState {
            self.0.state(&self.1)
        }
    }

    /// The output, whether it is held, and whether the hold has begun.
    fn apply(holding: &mut TestHolding, index: u32, distrusted: bool) -> (EstimateFrame, bool, bool) {
        let mut estimate = live(index);
        let (held, begins, value_sum) = holding.0.apply(&mut holding.1, &mut estimate, distrusted);
        assert_eq!(value_sum, WordSum::from_words(&estimate.value_bits()));
        (estimate, held, begins)
    }

    #[test]
    fn nothing_is_held_before_the_first_trusted_estimate() {
        let mut holding = TestHolding::new();
        for index in 0..50 {
            assert_eq!(apply(&mut holding, index, true), (live(index), false, false));
            assert_eq!(holding.state(), SafeState::Starting);
        }
        for index in 50..100 {
            assert_eq!(
                apply(&mut holding, index, false),
                (live(index), false, false),
                "nothing to recover from"
            );
        }
        assert_eq!(holding.state(), SafeState::Live);
    }

    #[test]
    fn a_hold_repeats_the_last_trusted_estimate_and_ends_after_the_recovery_time() {
        let mut holding = TestHolding::new();
        apply(&mut holding, 0, false);
        for index in 1..=3 {
            let (out, held, begins) = apply(&mut holding, index, true);
            assert_eq!((held, begins), (true, index == 1));
            assert_eq!((out.normal_force_n, out.deformation_m), (1000.0, 0.0));
            assert_eq!((out.sequence, out.flags, out.saturated), (index, 5 | HELD.bits(), 1));
        }
        for index in 4..=12 {
            assert!(apply(&mut holding, index, false).1, "{index}");
            assert_eq!(holding.state(), SafeState::Held);
        }
        assert_eq!(apply(&mut holding, 13, false), (live(13), false, false), "the tenth without distrust");
        assert_eq!(holding.state(), SafeState::Live);
    }

    #[test]
    fn a_fault_within_the_recovery_time_restarts_it_within_the_same_hold() {
        let mut holding = TestHolding::new();
        apply(&mut holding, 0, false);
        apply(&mut holding, 1, true);
        for index in 2..8 {
            apply(&mut holding, index, false);
        }
        assert!(!apply(&mut holding, 8, true).2);
        let held = (9..40).filter(|index| apply(&mut holding, *index, false).1).count();
        assert_eq!(held, 9);
    }

    #[test]
    fn the_forces_of_a_hold_that_lasts_too_long_are_0() {
        let mut holding = TestHolding::new();
        apply(&mut holding, 7, false);
        for index in 1..=200 {
            let (out, ..) = apply(&mut holding, index, true);
            let lost = index > 100;
            assert_eq!(out.normal_force_n, if lost { 0.0 } else { 1007.0 }, "{index}");
            assert_eq!(out.friction_torque_nm, if lost { 0.0 } else { -3.0 });
            assert_eq!(out.deformation_m, 7e-6);
            assert_eq!(holding.state(), if lost { SafeState::Lost } else { SafeState::Held });
        }
    }
}
