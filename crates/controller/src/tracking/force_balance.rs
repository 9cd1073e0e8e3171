//! Force of the bearing from load, weight and inertia, without the contact model.
//!
//! The force `P` of the fork cancels in the equations of the bench (`bench::plants::transmission`):
//!
//! ```text
//! B    = m y'' - J th''/R_c - F_L (1 - R_l/R_d)        R_c = R_d cos th
//! F_cy = B + rho F_f,    rho = R_J/R_c                 the friction's torque acts on the crank too
//! F_cz = m (z'' + g)
//! F_c  = -F_n n + F_f t  =>  F_n = (F_cz (rho - n_z) - B n_y)/det
//!                            F_f = (B n_z - F_cz n_y)/det,   det = n_y^2 + n_z^2 - rho n_z
//! ```
//!
//! `n` is the mean direction of the block. While the journal swings, the mean of the product `F .
//! n` is not the product of the means. `|n|^2` is then below 1, and the difference measures the
//! effect ([`BalanceForce::unsteadiness`]).
//!
//! Limits: fork without play, load on its lever without friction of the cylinder, planar motion. A
//! compliant drive does not matter, because the force of the fork is eliminated.

use crate::integrity::words;
use link::BenchConfiguration;
use link::track::MonitorConfiguration;

use super::block::{Means, STRIDE};
use super::{at_least, at_most};

const GRAVITY_M_S2: f32 = contact::GRAVITY_M_S2 as f32;

/// Parameters of the bench, SI.
#[derive(Clone, Debug)]
pub(super) struct ForceBalance {
    mass_kg: f32,
    weight_n: f32,
    inertia_kg_m2: f32,
    drive_lever_m: f32,
    lever_ratio: f32,
    journal_radius_m: f32,
    crank_vertical_rad: f32,
    /// Converts per sample of a block squared to per second squared.
    per_period_squared: f32,
}
words!(ForceBalance {
    mass_kg,
    weight_n,
    inertia_kg_m2,
    drive_lever_m,
    lever_ratio,
    journal_radius_m,
    crank_vertical_rad,
    per_period_squared,
});

/// Force of the bearing according to the balance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct BalanceForce {
    /// Normal force, N.
    pub(super) normal_n: f32,
    /// Friction force along `t`, N.
    pub(super) friction_n: f32,
    /// Change of the normal force with `B` and with `F_cz`.
    pub(super) normal_by: [f32; 2],
    /// Change of the friction force with `B` and with `F_cz`.
    pub(super) friction_by: [f32; 2],
    /// Part of `B` that is proportional to the inertia, N.
    pub(super) inertia_part_n: f32,
    /// Part of `B` that is proportional to the ratio of the levers, N.
    pub(super) lever_part_n: f32,
    /// `F_cz`, all of it proportional to the mass, N.
    pub(super) weight_part_n: f32,
    /// 1 less the squared length of the mean direction: 0 if the journal did not move around.
    pub(super) unsteadiness: f32,
}

impl ForceBalance {
    pub(super) fn new(configuration: &BenchConfiguration, monitor: &MonitorConfiguration) -> Self {
        let mass_kg = monitor.mass_g as f32 * 1e-3;
        let frequency_hz = 1e6 / (STRIDE as f32 * configuration.sample_period_us as f32);
        Self {
            mass_kg,
            weight_n: mass_kg * GRAVITY_M_S2,
            inertia_kg_m2: monitor.inertia_g_m2 as f32 * 1e-3,
            drive_lever_m: monitor.drive_lever_um as f32 * 1e-6,
            lever_ratio: monitor.load_lever_um as f32 / monitor.drive_lever_um as f32,
            journal_radius_m: configuration.journal_radius_nm as f32 * 1e-9,
            crank_vertical_rad: monitor.crank_vertical_nrad as f32 * 1e-9,
            per_period_squared: frequency_hz * frequency_hz,
        }
    }

    pub(super) fn solve(&self, means: &Means) -> BalanceForce {
        let [y, z, angle] = means.curvature.map(|curvature| curvature * self.per_period_squared);
        let lever_m = self.drive_lever_m * cosine(means.angle_rad - self.crank_vertical_rad);
        let inertia_part_n = -self.inertia_kg_m2 * angle / lever_m;
        let lever_part_n = means.load_n * self.lever_ratio;
        let remaining_n = self.mass_kg * y + inertia_part_n - means.load_n + lever_part_n;
        let force_z_n = self.weight_n + self.mass_kg * z;
        let rho = self.journal_radius_m / lever_m;
        let (n_y, n_z) = (means.normal_y, means.normal_z);
        let length = n_y * n_y + n_z * n_z;
        // A mean direction of length 0 has no meaning; the caller checks the unsteadiness.
        let determinant = at_least(length - rho * n_z, 0.1);
        let per = 1.0 / determinant;
        let normal_by = [-n_y * per, (rho - n_z) * per];
        let friction_by = [n_z * per, -n_y * per];
        BalanceForce {
            normal_n: normal_by[0] * remaining_n + normal_by[1] * force_z_n,
            friction_n: friction_by[0] * remaining_n + friction_by[1] * force_z_n,
            normal_by,
            friction_by,
            inertia_part_n,
            lever_part_n,
            weight_part_n: force_z_n,
            unsteadiness: at_least(1.0 - length, 0.0),
        }
    }
}

/// Cosine with an error of 1e-4 up to 1.2 rad either way; larger angles, which no rudder's crank
/// reaches, are limited.
fn cosine(angle_rad: f32) -> f32 {
    let angle = at_least(at_most(angle_rad, 1.2), -1.2);
    let square = angle * angle;
    1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cosine_is_one() {
        for step in -120..=120_i16 {
            let angle = f32::from(step) * 0.01;
            assert!((cosine(angle) - angle.cos()).abs() < 1.1e-4, "{angle}");
        }
        assert_eq!(cosine(9.0), cosine(1.2));
    }
}
