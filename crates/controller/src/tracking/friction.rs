//! Friction level: the friction force of the balance over the one that the friction network
//! predicts at the normal force of the balance.
//!
//! ```text
//! E   = F_n T_net/(R_J F_net)
//! F_f = L E
//! ```
//!
//! `E` is the signed friction coefficient of the network times the normal force of the balance. `L`
//! is the level: 1 is the friction that the network was trained on.
//!
//! The level is estimated by recursive least squares over the blocks. A block at a reversal of the
//! sliding speed has `E` near 0 and a negligible weight, as has a block in which the journal
//! swings. Errors of inertia, levers, mass and probe offsets are considered as in
//! [`super::clearance`]. Their sign relative to `E` changes with the direction of sliding, so a
//! cycle forth and back cancels part of them.
//!
//! No drive force is needed: the equation of the crank eliminates the fork's force
//! ([`super::force_balance`]). Limits: the network's dependence on speed is assumed to be right;
//! friction elsewhere in the drive (seals, load cylinder) counts as that of the bearing.

use crate::integrity::words;
use link::BenchConfiguration;
use link::track::MonitorConfiguration;

use super::at_least;
use super::block::Means;
use super::force_balance::BalanceForce;

/// Deviation that the level may gain from block to block: 0.012 in a second at 10 kHz.
const WALK: f32 = 0.002;
/// Deviation of a block's friction force that is not configured, N.
const FORCE_NOISE_N: f32 = 10.0;
/// Deviation of a block's friction force over the normal force, per unsteadiness.
const UNSTEADY_SHARE: f32 = 2.0;
/// Deviation of the level at the start.
const START_DEVIATION: f32 = 0.5;

/// Number of considered errors: inertia, levers, mass, offset along y and z.
const CONSIDERED: usize = 5;

/// Constants of the filter of the friction level.
#[derive(Clone, Debug)]
pub(super) struct Friction {
    per_journal_radius: f32,
    /// Standard deviations of the considered errors.
    deviations: [f32; CONSIDERED],
}
words!(Friction { per_journal_radius, deviations });

/// The tracked friction level.
#[derive(Clone, Debug)]
pub(super) struct FrictionState {
    value: f32,
    /// Variance without the considered errors.
    variance: f32,
    /// Change with one standard deviation of each considered error.
    sensitivities: [f32; CONSIDERED],
}

/// One block's friction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Measured {
    /// Friction force at a level of 1, N.
    pub(super) expected_n: f32,
    /// Friction force of the balance, N.
    found_n: f32,
    /// Variance of this block alone, N2.
    pub(super) variance_n2: f32,
    /// Change of the found force with one standard deviation of each considered error, N.
    sensitivities_n: [f32; CONSIDERED],
}

impl Friction {
    pub(super) fn new(configuration: &BenchConfiguration, monitor: &MonitorConfiguration) -> Self {
        let per_mille = |value: u16| f32::from(value) * 1e-3;
        let offset_m = monitor.offset_deviation_nm as f32 * 1e-9;
        let lever = f32::from(monitor.lever_deviation_ppht) * 1e-5 * core::f32::consts::SQRT_2;
        Self {
            per_journal_radius: 1e9 / configuration.journal_radius_nm as f32,
            deviations: [
                per_mille(monitor.inertia_deviation_per_mille),
                lever,
                per_mille(monitor.mass_deviation_per_mille),
                offset_m,
                offset_m,
            ],
        }
    }

    pub(super) fn measure(&self, means: &Means, balance: &BalanceForce) -> Measured {
        let coefficient =
            means.network_torque_nm * self.per_journal_radius / at_least(means.network_normal_n, 1.0);
        let normal_n = at_least(balance.normal_n, 0.0);
        let [by_rest, by_weight] = balance.friction_by;
        let turn = normal_n / at_least(means.distance_m, 1e-6);
        let unit = [
            by_rest * balance.inertia_part_n,
            by_rest * balance.lever_part_n,
            by_weight * balance.weight_part_n,
            turn * means.normal_z,
            -turn * means.normal_y,
        ];
        let mut sensitivities_n = self.deviations;
        for (sensitivity, unit) in sensitivities_n.iter_mut().zip(unit) {
            *sensitivity *= unit;
        }
        let noise_n = FORCE_NOISE_N + UNSTEADY_SHARE * balance.unsteadiness * normal_n;
        Measured {
            expected_n: coefficient * normal_n,
            found_n: balance.friction_n,
            variance_n2: noise_n * noise_n,
            sensitivities_n,
        }
    }
}

impl FrictionState {
    /// The trained friction with a large deviation.
    pub(super) const fn new() -> Self {
        Self { value: 1.0, variance: START_DEVIATION * START_DEVIATION, sensitivities: [0.0; CONSIDERED] }
    }

    /// Takes a block's friction if it counts; if not, changes nothing at the same cost.
    pub(super) fn take(&mut self, measured: &Measured, counts: bool) {
        let gate = if counts { 1.0 } else { 0.0 };
        let considered: f32 = measured.sensitivities_n.iter().map(|s| s * s).sum();
        let prior = self.variance + gate * (WALK * WALK);
        let expected = measured.expected_n;
        let gain =
            gate * prior * expected / (prior * expected * expected + measured.variance_n2 + considered);
        self.value += gain * (measured.found_n - self.value * expected);
        self.variance = prior - gain * expected * prior;
        for (kept, new) in self.sensitivities.iter_mut().zip(measured.sensitivities_n) {
            *kept += gain * (new - expected * *kept);
        }
    }

    /// The level.
    pub(super) fn value(&self) -> f32 {
        self.value
    }

    /// One standard deviation.
    pub(super) fn deviation(&self) -> f32 {
        libm::sqrtf(self.total_variance())
    }

    /// Square of [`Self::deviation`].
    pub(super) fn total_variance(&self) -> f32 {
        self.variance + self.sensitivities.iter().map(|s| s * s).sum::<f32>()
    }
}
