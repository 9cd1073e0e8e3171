//! Energy balance of a run: the work of drive and load, and its uses.
//!
//! `drive + load + gravity = friction heat + damping loss + load friction heat + hold loss + stored
//! + residual`, all in J. The terms of the run are integrated as quadrature states with the motion,
//! each from its own law: the damping loss from the normal law and its elastic part, the friction
//! heat from the friction law and the sliding speed. The stored energy (kinetic, and elastic in the
//! contact) is a function of the first and the last state alone. So the residual checks equations
//! and integrator together: a force without matching work, or a wrong sign, remains in it. Only the
//! hold loss of a held force is a remainder, so the direction of a held force is not checked.

use contact::Stiffness;

/// Minimum drive work to which a residual is related, J.
const ENERGY_FLOOR_J: f64 = 1.0;

/// Terms of the balance, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyAudit {
    /// Work of the fork on the shaft.
    pub drive_work_j: f64,
    /// Absolute work of the fork, with every contribution counted positive; the reference of the
    /// residual.
    pub drive_work_absolute_j: f64,
    /// Work of the load cylinder's force on the shaft; negative while the shaft drives the load.
    pub load_work_j: f64,
    /// Work of gravity on the shaft: decrease of potential energy.
    pub gravity_work_j: f64,
    /// Heat of friction between journal and bearing.
    pub friction_heat_j: f64,
    /// Heat of friction in the load cylinder.
    pub load_friction_heat_j: f64,
    /// Work of the normal force beyond its elastic part, the loss of impacts and of sustained
    /// contact; and the loss of a film, of a flexible shaft and of supports.
    pub damping_loss_j: f64,
    /// Work that a held bearing force loses because it keeps its direction over a communication
    /// step; 0 with the law under error control.
    pub hold_loss_j: f64,
    /// Change of kinetic energy of the shaft and elastic energy of the contact from first to last
    /// state.
    pub stored_change_j: f64,
    /// Remainder of the balance.
    pub residual_j: f64,
    /// The residual relative to the drive's absolute work (at least 1 J).
    pub residual_rel: f64,
}

impl EnergyAudit {
    /// Same terms with the loss of a held force in J, and the residuals of them all.
    #[must_use]
    pub(crate) fn with_hold_loss(self, hold_loss_j: f64) -> Self {
        Self { hold_loss_j, ..self }.with_residuals()
    }

    /// Computes both residuals from the terms.
    pub fn with_residuals(self) -> Self {
        let work = self.drive_work_j + self.load_work_j + self.gravity_work_j;
        let residual_j = work
            - self.friction_heat_j
            - self.load_friction_heat_j
            - self.damping_loss_j
            - self.hold_loss_j
            - self.stored_change_j;
        let residual_rel = residual_j.abs() / self.drive_work_absolute_j.max(ENERGY_FLOOR_J);
        Self { residual_j, residual_rel, ..self }
    }

    /// Every term with its name and unit, in the order of a report.
    pub fn terms(&self) -> [(&'static str, f64); 11] {
        [
            ("drive_work_j", self.drive_work_j),
            ("drive_work_absolute_j", self.drive_work_absolute_j),
            ("load_work_j", self.load_work_j),
            ("gravity_work_j", self.gravity_work_j),
            ("friction_heat_j", self.friction_heat_j),
            ("load_friction_heat_j", self.load_friction_heat_j),
            ("damping_loss_j", self.damping_loss_j),
            ("hold_loss_j", self.hold_loss_j),
            ("stored_change_j", self.stored_change_j),
            ("residual_j", self.residual_j),
            ("residual_rel", self.residual_rel),
        ]
    }
}

/// Elastic energy of a contact in J at a deformation in m: the integral of the stiffness part. It
/// uses Gauss' rule in the square root of the deformation, where laws with half powers are smooth.
pub(crate) fn elastic_energy_j(stiffness: &Stiffness, deformation_m: f64) -> f64 {
    const NODES: [(f64, f64); 5] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ];
    const PANELS: u32 = 4;
    let half = 0.5 * deformation_m.max(0.0).sqrt() / f64::from(PANELS);
    let panel = |i: u32| {
        let middle = half * f64::from(2 * i + 1);
        let at = |u: f64| stiffness.force_n(u * u) * 2.0 * u;
        half * NODES.iter().map(|(x, weight)| weight * at(middle + half * x)).sum::<f64>()
    };
    (0..PANELS).map(panel).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elastic_energy_of_hertz_is_two_fifths_of_force_times_depth() {
        let stiffness = Stiffness::Hertz { coefficient: 1e9 };
        let depth = 2.7e-4_f64;
        let closed = 0.4 * 1e9 * depth.powf(2.5);
        assert!((elastic_energy_j(&stiffness, depth) / closed - 1.0).abs() < 1e-13);
        assert_eq!(elastic_energy_j(&stiffness, -1e-4), 0.0);
    }

    #[test]
    fn the_residual_is_the_remainder_of_the_terms() {
        let audit = EnergyAudit {
            drive_work_j: 10.0,
            drive_work_absolute_j: 20.0,
            friction_heat_j: 7.0,
            stored_change_j: 2.0,
            ..EnergyAudit::default()
        }
        .with_residuals();
        assert_eq!((audit.residual_j, audit.residual_rel), (1.0, 0.05));
    }
}
