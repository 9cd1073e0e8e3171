//! Radial clearance: distance of the journal from the centre less the deformation that the balance's force asks for.
//!
//! ```text
//! F_el = F_n/(1 + chi d'/v0)                                 the contact law without its damping
//! F_el = c d^2 (3a - d)/a^1.5,   c = sqrt(2) (pi/8) E*        the printed hybrid law with D + d = a: a is measured
//! D    = a - d
//! ```
//!
//! Recursive mean of `D` over the blocks, each with the variance of its force: steadier blocks count for more. What a longer
//! mean does not make smaller, the errors of stiffness, inertia, levers, mass, probe offsets and damping, is carried
//! along as the mean sensitivity to each (a filter with considered parameters, Schmidt 1966) and added to the variance. The walk of
//! [`WALK_M`] a block lets the mean follow wear and temperature.
//!
//! Why it works: `dF/dD = -2F/d`, 0.4 kN/um with Babbitt and 0.06 kN/um with plastic at 5 kN. A tenth of the force is a twentieth
//! of the deformation: 1 um of Babbitt's 20 to 40, 5 um of plastic's 90 to 180.
//!
//! Limits: contact during the block, which a bench under load keeps up; the law's form (a bearing that follows another one has the
//! difference of the two deformations as an error); the approach speed of the configuration, as half of the damping's
//! share is taken as its deviation.

use crate::constants::Sum;
use link::Configuration;
use link::track::MonitorConfiguration;

use super::balance::Balance;
use super::block::{Means, STRIDE};
use super::{at_least, at_most};

/// Deviation that the clearance may gain from a block to the next, m: 0.6 um in a second of 10 kHz.
const WALK_M: f32 = 0.1e-6;
/// Deviation of a block's force that is not told by the configuration, N: noise of angle and load.
const FORCE_NOISE_N: f32 = 15.0;
/// Deviation of a block's force over the force, per unsteadiness.
const UNSTEADY_SHARE: f32 = 2.0;
/// Deviation of a block's mean distance, m.
const DISTANCE_NOISE_M: f32 = 50e-9;
/// Deviation of the damping's share, of the share.
const DAMPING_DEVIATION: f32 = 0.5;
/// Deviation of the clearance at the start, of the configured one.
const START_DEVIATION: f32 = 0.2;

/// Deviations that a block's clearance may be off the tracked one before the two contradict each other.
const CONTRADICTING_DEVIATIONS: f32 = 4.0;

/// Where the first block's root begins, m.
const START_DEFORMATION_M: f32 = 50e-6;
/// Rounds of the root.
pub(super) const ROUNDS: u32 = 5;
/// Least deformation, so that nothing is divided by 0, m.
const LEAST_M: f32 = 1e-7;

/// Number of considered errors: stiffness, inertia, levers, mass, offset along y and z, damping.
const CONSIDERED: usize = 7;

/// The tracked clearance.
#[derive(Clone, Debug)]
pub(super) struct Clearance {
    modulus_factor: f32,
    damping_per_slope: f32,
    deviations: [f32; CONSIDERED],
    value_m: f32,
    variance_m2: f32,
    sensitivities_m: [f32; CONSIDERED],
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
    /// What the root is taken of, m3.
    target: f32,
    /// Share of the damping in the force.
    damping: f32,
    /// Variance that is this block's own, m2.
    own_variance_m2: f32,
    /// Variance that weighs this block: its own and that of the considered errors, m2.
    variance_m2: f32,
    /// Change with one standard deviation of each considered error, m.
    sensitivities_m: [f32; CONSIDERED],
}

impl Clearance {
    pub(super) fn constants(&self, sum: &mut Sum) {
        sum.floats(&[self.modulus_factor, self.damping_per_slope]);
        sum.floats(&self.deviations);
    }

    pub(super) fn new(configuration: &Configuration, monitor: &MonitorConfiguration) -> Self {
        let start_m = configuration.radial_clearance_nm as f32 * 1e-9;
        let approach_um_s = configuration.unseen_approach_um_s.max(configuration.latch_floor_um_s) as f32;
        let per_mille = |value: u16| f32::from(value) * 1e-3;
        let offset_m = monitor.offset_deviation_nm as f32 * 1e-9;
        // Both levers' errors go into their ratio.
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
            value_m: start_m,
            variance_m2: (START_DEVIATION * start_m) * (START_DEVIATION * start_m),
            sensitivities_m: [0.0; CONSIDERED],
            deformation_m: START_DEFORMATION_M,
        }
    }

    /// First step: what the root of the deformation is taken of.
    pub(super) fn begin(&self, means: &Means, balance: &Balance, measured: &mut Measured) {
        let distance_m = at_least(means.distance_m, 1e-6);
        let damping = at_least(at_most(self.damping_per_slope * means.distance_slope_m, 2.0), -0.7);
        let elastic_n = at_least(balance.normal_n, 1.0) / (1.0 + damping);
        measured.damping = damping;
        measured.distance_m = distance_m;
        measured.target = elastic_n * distance_m * libm::sqrtf(distance_m) / self.modulus_factor;
        measured.deformation_m = self.deformation_m;
    }

    /// One of [`ROUNDS`] steps: Heron's root with the weak dependence inside, from the last block's deformation; five are enough from a
    /// factor of 4.
    pub(super) fn round(measured: &mut Measured) {
        let Measured { distance_m, deformation_m, target, .. } = *measured;
        let other_m = target / ((3.0 * distance_m - deformation_m) * deformation_m);
        measured.deformation_m = at_most(at_least(0.5 * (deformation_m + other_m), LEAST_M), distance_m);
    }

    /// Works out how sure a block's clearance is.
    pub(super) fn sensitivities(&self, means: &Means, balance: &Balance, measured: &mut Measured) {
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

    /// Whether a block's clearance is further from the tracked one than errors and wear explain. A considered error is the same one in both: what it
    /// moves them apart counts.
    pub(super) fn is_contradicted_by(&self, measured: &Measured) -> bool {
        let off_m = measured.clearance_m - self.value_m;
        let mut variance_m2 = self.variance_m2 + measured.own_variance_m2;
        for (new, kept) in measured.sensitivities_m.iter().zip(&self.sensitivities_m) {
            let apart_m = new - kept;
            variance_m2 += apart_m * apart_m;
        }
        off_m * off_m > (CONTRADICTING_DEVIATIONS * CONTRADICTING_DEVIATIONS) * variance_m2
    }

    /// Takes a block's clearance if it counts, else leaves everything as it was, at the same cost.
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
        libm::sqrtf(self.whole_variance_m2())
    }

    /// Square of [`Self::deviation_m`].
    pub(super) fn whole_variance_m2(&self) -> f32 {
        self.variance_m2 + self.sensitivities_m.iter().map(|s| s * s).sum::<f32>()
    }
}
