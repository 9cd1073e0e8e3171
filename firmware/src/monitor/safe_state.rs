//! Hold, mark, report: what stands for an estimate that cannot be trusted.
//!
//! | state | while | what goes out |
//! |---|---|---|
//! | starting | nothing has been trusted yet | the live estimate with its flags |
//! | live | no distrust, or none for the recovery time | the live estimate |
//! | held | distrust ([`crate::flags::DISTRUSTED`]) now or within the recovery time | forces, torque, deformation and angle of the last trusted estimate, the flags of this sample, `HELD` |
//! | lost | held for longer than the configured time | as held, the forces and the torque 0 |
//!
//! A hold ends by itself after so many samples without distrust; the recovery time covers the windows of conditioning and networks, so the
//! first live estimate rests on nothing from before. One that should end the machine's motion is for whoever reads the flags to decide.

use core::hash::Hash;

use link::EstimateFrame;
use link::track::SafeState;

use crate::constants::Sum;
use crate::flags::HELD;

/// The estimate's numbers that are held: four forces and torques, then deformation and angle.
type Held = [u32; 6];

/// The safe state of one run.
#[derive(Clone, Debug)]
pub(super) struct Holding {
    recovery_samples: u32,
    lost_samples: u32,
    trusted: Held,
    clean: u32,
    held: u32,
    /// All ones once an estimate has been trusted.
    started: u32,
}

impl Holding {
    pub(super) const fn new(recovery_samples: u32, lost_samples: u32) -> Self {
        Self { recovery_samples, lost_samples, trusted: [0; 6], clean: 0, held: 0, started: 0 }
    }

    pub(super) fn constants(&self, sum: &mut Sum) {
        (self.recovery_samples, self.lost_samples).hash(sum);
    }

    /// Turns a live estimate, which may be distrusted, into what goes out; returns whether a hold lasts, whether it has begun, and
    /// the parity of what goes out.
    #[inline(never)]
    pub(super) fn apply(&mut self, estimate: &mut EstimateFrame, distrusted: bool) -> (bool, bool, u32) {
        // Before anything has been trusted there is nothing to recover from.
        let settled = self.recovery_samples & !self.started;
        let clean = self.clean.wrapping_add(1).min(self.recovery_samples).max(settled);
        self.clean = clean & u32::from(distrusted).wrapping_sub(1);
        let unsettled = (self.clean < self.recovery_samples) | distrusted;
        let hold = u32::from(unsettled).wrapping_neg() & self.started;
        self.started |= u32::from(!distrusted).wrapping_neg();
        let begins = (hold != 0) & (self.held == 0);
        self.held = self.held.saturating_add(1) & hold;
        let keep = u32::from(self.held <= self.lost_samples).wrapping_neg();

        let [normal, y, z, torque, deformation, angle] = &mut self.trusted;
        let apply = |trusted: &mut u32, value: &mut f32, keep: u32| {
            *trusted = (*trusted & hold) | (value.to_bits() & !hold);
            *value = f32::from_bits(*trusted & keep);
        };
        apply(normal, &mut estimate.normal_force_n, keep);
        apply(y, &mut estimate.force_y_n, keep);
        apply(z, &mut estimate.force_z_n, keep);
        apply(torque, &mut estimate.friction_torque_nm, keep);
        apply(deformation, &mut estimate.deformation_m, u32::MAX);
        apply(angle, &mut estimate.contact_angle_rad, u32::MAX);
        estimate.flags |= HELD.bits() & hold;
        (hold != 0, begins, estimate.parity())
    }

    pub(super) const fn state(&self) -> SafeState {
        match (self.started, self.held) {
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
            instruction_ticks: 0,
        }
    }

    /// What goes out, whether it is held, and whether that has begun.
    fn apply(holding: &mut Holding, index: u32, distrusted: bool) -> (EstimateFrame, bool, bool) {
        let mut estimate = live(index);
        let (held, begins, parity) = holding.apply(&mut estimate, distrusted);
        assert_eq!(parity, estimate.parity());
        (estimate, held, begins)
    }

    #[test]
    fn the_start_is_not_held() {
        let mut holding = Holding::new(10, 100);
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
        let mut holding = Holding::new(10, 100);
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
    fn a_fault_within_the_recovery_time_begins_it_anew_and_is_the_same_hold() {
        let mut holding = Holding::new(10, 100);
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
    fn a_hold_that_lasts_too_long_loses_its_forces() {
        let mut holding = Holding::new(10, 100);
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
