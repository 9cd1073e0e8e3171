//! Energy balance of a mechanism.
//!
//! `drive + load = stored + damper heat + contact damping + friction heat + residual`, all in J.
//! The works and losses are quadrature states, integrated with the motion: the drive's work from
//! its force, the losses from the laws. The stored energy (kinetic, of
//! gravity, springs and contacts) is a function of the first and the last state alone. So the
//! residual checks equations and integrator together.

/// Minimum absolute work to which a residual is related, J.
const ENERGY_FLOOR_J: f64 = 1e-3;

/// Works and losses that are integrated with the motion.
pub(super) const QUADRATURES: usize = 6;

/// Energies in J: rates of them in W while they are integrated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Flows {
    pub(crate) drive_work: f64,
    /// Drive and load work with every contribution counted positive.
    pub(crate) absolute_work: f64,
    pub(crate) load_work: f64,
    pub(crate) damper_heat: f64,
    pub(crate) contact_damping: f64,
    pub(crate) friction_heat: f64,
}

impl Flows {
    /// Adds the power of a drive in W.
    pub(super) fn add_drive(&mut self, power_w: f64) {
        self.drive_work += power_w;
        self.absolute_work += power_w.abs();
    }

    pub(super) fn to_array(self) -> [f64; QUADRATURES] {
        [
            self.drive_work,
            self.absolute_work,
            self.load_work,
            self.damper_heat,
            self.contact_damping,
            self.friction_heat,
        ]
    }
}

/// Terms of the balance of a run, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MechanismEnergy {
    /// Work of the drives on the mechanism.
    pub drive_work_j: f64,
    /// Work of the loads.
    pub load_work_j: f64,
    /// Work of drives and loads with every contribution counted positive.
    pub absolute_work_j: f64,
    /// Heat of the dampers.
    pub damper_heat_j: f64,
    /// Work of the normal forces beyond their elastic parts.
    pub contact_damping_j: f64,
    /// Heat of friction in the contacts.
    pub friction_heat_j: f64,
    /// Change of kinetic energy.
    pub kinetic_change_j: f64,
    /// Change of the energy of gravity, springs and contacts.
    pub potential_change_j: f64,
    /// Largest kinetic energy of first and last state.
    pub kinetic_j: f64,
}

impl MechanismEnergy {
    /// Remainder of the balance in J.
    pub(crate) fn residual_j(&self) -> f64 {
        self.drive_work_j + self.load_work_j
            - self.damper_heat_j
            - self.contact_damping_j
            - self.friction_heat_j
            - self.kinetic_change_j
            - self.potential_change_j
    }

    /// The remainder relative to the largest of absolute work, kinetic energy and potential change,
    /// at least 1 mJ.
    pub fn residual_rel(&self) -> f64 {
        let scale = self.absolute_work_j.max(self.kinetic_j).max(self.potential_change_j.abs());
        self.residual_j().abs() / scale.max(ENERGY_FLOOR_J)
    }

    /// Every term with its name and unit, in the order of a report.
    pub fn terms(&self) -> [(&'static str, f64); 10] {
        [
            ("drive_work_j", self.drive_work_j),
            ("load_work_j", self.load_work_j),
            ("absolute_work_j", self.absolute_work_j),
            ("damper_heat_j", self.damper_heat_j),
            ("contact_damping_j", self.contact_damping_j),
            ("friction_heat_j", self.friction_heat_j),
            ("kinetic_change_j", self.kinetic_change_j),
            ("potential_change_j", self.potential_change_j),
            ("residual_j", self.residual_j()),
            ("residual_rel", self.residual_rel()),
        ]
    }
}
