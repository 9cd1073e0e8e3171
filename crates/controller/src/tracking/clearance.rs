//! Radial clearance: distance of the journal from the centre less the deformation that belongs to
//! the force of the balance.
//!
//! ```text
//! F_el = F_n/(1 + chi d'/v0)
//! F_el = c d^2 (3a - d)/a^1.5,   c = sqrt(2) (pi/8) E*
//! D    = a - d
//! ```
//!
//! The first line is the contact law without its damping, the second the hybrid law as printed with
//! the measured distance `a = D + d`.
//!
//! The clearance is a recursive mean of `D` over the blocks, weighted by the variance of the force:
//! steadier blocks count for more. Averaging does not reduce the errors of stiffness, inertia,
//! levers, mass, probe offsets and damping. They are considered parameters (Schmidt 1966): the
//! filter carries the mean sensitivity to each and adds it to the variance. The walk of [`WALK_M`]
//! a block lets the mean follow wear and temperature.
//!
//! The method works because the contact is stiff: `dF/dD = -2F/d`, 0.4 kN/um with Babbitt and 0.06
//! kN/um with plastic at 5 kN. A tenth of the force is a twentieth of the deformation: 1 um of 20
//! to 40 with Babbitt, 5 um of 90 to 180 with plastic.
//!
//! Limits: contact during the block, which a bench under load maintains; the form of the law (for a
//! bearing with another law the difference of the two deformations is an error); the configured
//! approach speed, whose effect has half of the damping's share as its deviation.

use crate::integrity::words;
use link::BenchConfiguration;
use link::track::MonitorConfiguration;

use super::block::{Means, STRIDE};
use super::force_balance::BalanceForce;
use super::{at_least, at_most};

/// Deviation that the clearance may gain from block to block, m: 0.6 um in a second at 10 kHz.
const WALK_M: f32 = 0.1e-6;
/// Deviation of a block's force that is not configured, N: noise of angle and load.
const FORCE_NOISE_N: f32 = 15.0;
/// Deviation of a block's force over the force, per unsteadiness.
const UNSTEADY_SHARE: f32 = 2.0;
/// Deviation of a block's mean distance, m.
const DISTANCE_NOISE_M: f32 = 50e-9;
/// Deviation of the damping's share, relative.
const DAMPING_DEVIATION: f32 = 0.5;
/// Deviation of the clearance at the start, relative to the configured one.
const START_DEVIATION: f32 = 0.2;

/// Deviations between a block's clearance and the tracked one at which they contradict each other.
const CONTRADICTING_DEVIATIONS: f32 = 4.0;

/// Start value of the first block's root, m.
const START_DEFORMATION_M: f32 = 50e-6;
/// Iterations of the root.
pub(super) const ROUNDS: u32 = 5;
/// Smallest deformation, m: prevents a division by 0.
const MIN_M: f32 = 1e-7;

/// Number of considered errors: stiffness, inertia, levers, mass, offset along y and z, damping.
const CONSIDERED: usize = 7;

/// Constants of the filter of the clearance.
#[derive(Clone, Debug)]
pub(super) struct Clearance {
    modulus_factor: f32,
    damping_per_slope: f32,
    /// Standard deviations of the considered errors.
    deviations: [f32; CONSIDERED],
}
words!(Clearance { modulus_factor, damping_per_slope, deviations });

/// The tracked clearance.
#[derive(Clone, Debug)]
pub(super) struct ClearanceState {
    value_m: f32,
    /// Variance without the considered errors, m2.
    variance_m2: f32,
    /// Change with one standard deviation of each considered error, m.
    sensitivities_m: [f32; CONSIDERED],
    /// Deformation of the last block that counted: where the next root begins, m.
    deformation_m: f32,
}

/// One block's clearance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Measured {
    /// Radial clearance, m.
    clearance_m: f32,
    /// Deformation, m.
    deformation_m: f32,
    /// Distance of the journal from the centre, m.
    distance_m: f32,
    /// Radicand of the deformation's root, m3.
    target: f32,
    /// Share of the damping in the force.
    damping: f32,
    /// Variance of this block alone, m2.
    own_variance_m2: f32,
    /// Variance that weights this block: its own and that of the considered errors, m2.
    variance_m2: f32,
    /// Change with one standard deviation of each considered error, m.
    sensitivities_m: [f32; CONSIDERED],
}

impl Clearance {
    pub(super) fn new(configuration: &BenchConfiguration, monitor: &MonitorConfiguration) -> Self {
        let approach_um_s = configuration.unseen_approach_um_s.max(configuration.latch_floor_um_s) as f32;
        let per_mille = |value: u16| f32::from(value) * 1e-3;
        let offset_m = monitor.offset_deviation_nm as f32 * 1e-9;
        // The errors of both levers enter their ratio.
        let lever = f32::from(monitor.lever_deviation_ppht) * 1e-5 * core::f32::consts::SQRT_2;
        Self {
            modulus_factor: core::f32::consts::SQRT_2
                * (core::f32::consts::PI / 8.0)
                * (monitor.effective_modulus_kpa as f32 * 1e3),
            damping_per_slope: monitor.damping_per_mille as f32 * 1e-3 * 1e6
                / (STRIDE as f32 * configuration.sample_period_us as f32)
                / (approach_um_s * 1e-6),
            deviations: [
                per_mille(monitor.stiffness_deviation_per_mille),
                per_mille(monitor.inertia_deviation_per_mille),
                lever,
                per_mille(monitor.mass_deviation_per_mille),
                offset_m,
                offset_m,
                DAMPING_DEVIATION,
            ],
        }
    }

    /// Prepares the root of a block's deformation: the first step.
    pub(super) fn begin(
        &self,
        state: &ClearanceState,
        means: &Means,
        balance: &BalanceForce,
        measured: &mut Measured,
    ) {
        let distance_m = at_least(means.distance_m, 1e-6);
        let damping = at_least(at_most(self.damping_per_slope * means.distance_slope_m, 2.0), -0.7);
        let elastic_n = at_least(balance.normal_n, 1.0) / (1.0 + damping);
        measured.damping = damping;
        measured.distance_m = distance_m;
        measured.target = elastic_n * distance_m * libm::sqrtf(distance_m) / self.modulus_factor;
        measured.deformation_m = state.deformation_m;
    }

    /// One of [`ROUNDS`] iterations of Heron's root, with the weak dependence on the deformation
    /// inside, from the last block's deformation. Five are enough for a factor of 4.
    pub(super) fn round(measured: &mut Measured) {
        let Measured { distance_m, deformation_m, target, .. } = *measured;
        let other_m = target / ((3.0 * distance_m - deformation_m) * deformation_m);
        measured.deformation_m = at_most(at_least(0.5 * (deformation_m + other_m), MIN_M), distance_m);
    }

    /// Computes a block's clearance and its variance.
    pub(super) fn sensitivities(&self, means: &Means, balance: &BalanceForce, measured: &mut Measured) {
        let normal_n = at_least(balance.normal_n, 1.0);
        let half_m = 0.5 * measured.deformation_m;
        let per_force = -half_m / normal_n;
        let [normal_by_rest, normal_by_weight] = balance.normal_by;
        let by_rest = per_force * normal_by_rest;
        let unit = [
            half_m,
            by_rest * balance.inertia_part_n,
            by_rest * balance.lever_part_n,
            per_force * normal_by_weight * balance.weight_part_n,
            means.normal_y,
            means.normal_z,
            half_m * measured.damping / (1.0 + measured.damping),
        ];
        let force_noise_n = FORCE_NOISE_N + UNSTEADY_SHARE * balance.unsteadiness * normal_n;
        let by_force_m = per_force * force_noise_n;
        measured.own_variance_m2 = by_force_m * by_force_m + DISTANCE_NOISE_M * DISTANCE_NOISE_M;
        let mut variance_m2 = measured.own_variance_m2;
        for ((sensitivity, unit), deviation) in
            measured.sensitivities_m.iter_mut().zip(unit).zip(self.deviations)
        {
            *sensitivity = unit * deviation;
            variance_m2 += *sensitivity * *sensitivity;
        }
        measured.variance_m2 = variance_m2;
        measured.clearance_m = measured.distance_m - measured.deformation_m;
    }
}

impl ClearanceState {
    /// The configured clearance with a large deviation.
    pub(super) fn new(configuration: &BenchConfiguration) -> Self {
        let start_m = configuration.radial_clearance_nm as f32 * 1e-9;
        Self {
            value_m: start_m,
            variance_m2: (START_DEVIATION * start_m) * (START_DEVIATION * start_m),
            sensitivities_m: [0.0; CONSIDERED],
            deformation_m: START_DEFORMATION_M,
        }
    }

    /// Returns true if a block's clearance is further from the tracked one than errors and wear
    /// explain. A considered error affects both: only the difference of its effects counts.
    pub(super) fn is_contradicted_by(&self, measured: &Measured) -> bool {
        let off_m = measured.clearance_m - self.value_m;
        let mut variance_m2 = self.variance_m2 + measured.own_variance_m2;
        for (new, kept) in measured.sensitivities_m.iter().zip(&self.sensitivities_m) {
            let apart_m = new - kept;
            variance_m2 += apart_m * apart_m;
        }
        off_m * off_m > (CONTRADICTING_DEVIATIONS * CONTRADICTING_DEVIATIONS) * variance_m2
    }

    /// Takes a block's clearance if it counts; if not, changes nothing at the same cost.
    pub(super) fn take(&mut self, measured: &Measured, counts: bool) {
        let gate = if counts { 1.0 } else { 0.0 };
        let prior = self.variance_m2 + gate * (WALK_M * WALK_M);
        let gain = gate * prior / (prior + measured.variance_m2);
        self.deformation_m += gate * (measured.deformation_m - self.deformation_m);
        self.value_m += gain * (measured.clearance_m - self.value_m);
        self.variance_m2 = prior - gain * prior;
        for (kept, new) in self.sensitivities_m.iter_mut().zip(measured.sensitivities_m) {
            *kept += gain * (new - *kept);
        }
    }

    /// The clearance, m.
    pub(super) fn value_m(&self) -> f32 {
        self.value_m
    }

    /// One standard deviation, m.
    pub(super) fn deviation_m(&self) -> f32 {
        libm::sqrtf(self.total_variance_m2())
    }

    /// Square of [`Self::deviation_m`].
    pub(super) fn total_variance_m2(&self) -> f32 {
        self.variance_m2 + self.sensitivities_m.iter().map(|s| s * s).sum::<f32>()
    }
}
